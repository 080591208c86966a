"""Damping of any strength: every method is right where it is stable, and the leapfrog's formula is what it says."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import expm

from sim.springs import INTEGRATORS, Contact, PinPath, cloth, rope
from sim.springs.net import Net
from sim.springs.state import State, advance, energy, velocities
from tests.sim.springs.nets import DAMPABLE, FAMILIES, KNIGHT
from tests.sim.springs.reference import integrated, slope

DAMPINGS = [0.0, 1e-2, 1.0, 30.0, 1e3, 1e4, 1e6]
STEPS = [1 / 60, 1 / 240, 1 / 960]
# Of the largest displacement or speed, by the order of the method: the first order is wrong by its step.
WITHIN = {1: 0.08, 2: 0.003}
GRAVITY = 9.81


def hanging(points: int, stiffness: float, damping: float, drag: float = 0.0, **more) -> Net:
    """A rope that hangs straight down at its rest length: its motion is along itself, and linear."""
    net = rope(points, float(points - 1), 1.0, stiffness, damping, drag, GRAVITY, **more)
    x = np.zeros_like(net.x0)
    x[2, 0] = -np.arange(points)
    return dataclasses.replace(net, x0=x)


def chain_matrices(net: Net) -> tuple[np.ndarray, np.ndarray]:
    """(M^-1 K, M^-1 B) along a rope that is pinned at its first point only."""
    n, family = net.shape[1] - 1, net.families[0]
    links = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    links[-1, -1] = 1.0
    w = 1.0 / net.masses[0, 1:, None]
    return w * family.stiffness * links, w * (family.damping * links + net.drag * np.eye(n))


def closed_form(net: Net, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacements [m] and velocities [m/s] of the free points, from rest, by the matrix exponential."""
    k, b = chain_matrices(net)
    n = len(k)
    zero, column = np.zeros((n, n)), np.zeros((n, 1))
    load = np.full((n, 1), -GRAVITY)
    matrix = np.block([[zero, np.eye(n), column], [-k, -b, load], [np.zeros((1, 2 * n + 1))]])
    found = expm(matrix * seconds)[:, -1]
    return found[:n], found[n : 2 * n]


def largest_stable_step(net: Net, name: str) -> float:
    k, b = chain_matrices(net)
    return min(
        INTEGRATORS[name].stable_step(math.sqrt(max(0.0, omega2)), max(0.0, rate))
        for omega2, rate in zip(np.linalg.eigvalsh(k), np.linalg.eigvalsh(b), strict=True)
    )


def errors_along(net: Net, name: str, h: float, seconds: float) -> tuple[float, float]:
    """Largest error of displacements and of velocities over the largest of each."""
    steps = round(seconds / h)
    state = integrated(net, name, steps * h, steps)
    x, v = closed_form(net, steps * h)
    off_x = np.abs(state.x[2, 0, 1:] - net.x0[2, 0, 1:] - x).max() / np.abs(x).max()
    off_v = np.abs(velocities(net, state)[2, 0, 1:] - v).max() / np.abs(v).max()
    return off_x, off_v


@pytest.mark.parametrize("points", [2, 12])
@pytest.mark.parametrize("name", DAMPABLE)
def test_every_method_is_right_at_every_damping_of_links_at_which_it_is_stable(name, points):
    """Of the midpoint rule only the positions are right where damping is stiff: its velocities swing about."""
    within, tried = WITHIN.get(INTEGRATORS[name].order, 1e-4), 0
    for damping in DAMPINGS:
        for drag in (0.0, 1.0):
            net = hanging(points, 20.0, damping, drag)
            for h in STEPS:
                if h <= largest_stable_step(net, name):
                    off_x, off_v = errors_along(net, name, h, 0.5)
                    assert off_x < within, (damping, drag, h)
                    assert off_v < within or (name == "implicit_midpoint" and damping >= 1e3), (damping, drag, h)
                    tried += 1
    assert tried >= (len(STEPS) * len(DAMPINGS) * 2 if name == "leapfrog" else 10)


def test_a_point_on_a_strong_damper_falls_as_the_damping_says():
    """m = 1 kg, k = 1 N/m, b = 1e4 N s/m: 9.8 mm in 10 s."""
    net = hanging(2, 1.0, 1e4)
    x, v = closed_form(net, 10.0)
    for h in (1.0, *STEPS):
        state = integrated(net, "leapfrog", 10.0, round(10.0 / h))
        assert state.x[2, 0, 1] - net.x0[2, 0, 1] == pytest.approx(x[0], rel=1e-4)
        assert state.v[2, 0, 1] == pytest.approx(v[0], rel=1e-4)


@pytest.mark.parametrize("drag", [1e-2, 1.0, 1e2, 1e4])
@pytest.mark.parametrize("damping", [0.0, 1e-3, 0.1, 10.0])
def test_a_gram_falls_through_the_air_at_its_terminal_speed_whatever_its_links_do(damping, drag):
    """A free rope of two points of 1 g: no link pulls, whatever its damping, and the speed is exact or nearly so."""
    net = dataclasses.replace(hanging(2, 0.0, damping, drag), mass=1e-3, pinned=frozenset())
    for h in STEPS:
        state = integrated(net, "leapfrog", 0.25, round(0.25 / h))
        rate = drag / 1e-3
        speed = GRAVITY / rate * -math.expm1(-rate * 0.25)
        fallen = GRAVITY / rate * (0.25 + math.expm1(-rate * 0.25) / rate)
        assert -state.v[2, 0] == pytest.approx([speed, speed], rel=5e-3)
        # The path that is missing or too long where the drag of the first step is stiff: less than a step's.
        assert net.x0[2, 0] - state.x[2, 0] == pytest.approx([fallen, fallen], rel=5e-3, abs=0.3 * h * speed)


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("damping", [0.0, 1.0, 1e2, 1e4, 1e6])
def test_a_point_sinks_into_floor_and_sphere_as_their_damping_says(damping, law):
    """m x'' = -m g - k x - b x', from rest at the surface; the lab multiplies b of a sphere by the depth."""
    contact = Contact(20.0, damping, 0.0, law)
    floor = dataclasses.replace(hanging(2, 0.0, 0.0, floor=0.0, contact=contact))
    x = floor.x0.copy()
    x[0, 0, 0], x[2, 0, 1] = 50.0, -1e-9
    floor = dataclasses.replace(floor, x0=x)
    sphere = dataclasses.replace(floor, floor=None, sphere=(0.0, 0.0, -1.0, 1.0))
    matrix = np.array([[0.0, 1.0, 0.0], [-20.0, -damping, -GRAVITY], [0.0, 0.0, 0.0]])
    for net in (floor,) if law == "lab" else (floor, sphere):
        for h in STEPS:
            # While it sinks: once the damped force has turned round it is clipped.
            x, v, _ = expm(matrix * 0.25)[:, 2]
            state = integrated(net, "leapfrog", 0.25, round(0.25 / h))
            assert state.x[2, 0, 1] == pytest.approx(x, rel=6e-3)
            assert state.v[2, 0, 1] == pytest.approx(v, rel=1e-2)


@pytest.mark.parametrize("damping", [1e2, 1e4])
def test_a_point_is_pulled_off_a_strongly_damped_floor_freely(damping):
    """The whole normal force is clipped at 0: above the speed at which damping takes all of the push, none is left."""
    net = hanging(2, 0.0, 0.0, floor=0.0, contact=Contact(20.0, damping))
    x, v0 = net.x0.copy(), np.zeros_like(net.x0)
    x[0, 0, 0], x[2, 0, 1], v0[2, 0, 1] = 50.0, -0.01, 5.0
    state = integrated(dataclasses.replace(net, x0=x), "leapfrog", 0.2, 12, v0)
    assert state.v[2, 0, 1] == pytest.approx(5.0 - 0.2 * GRAVITY, rel=1e-12)


SECONDS = 2.0


@pytest.mark.parametrize("damping", [7.0, 20.0, 100.0, 1e3, 1e4, 1e5])
def test_the_lab_s_rope_is_right_within_2_percent_of_its_fall_at_any_damping(damping):
    """Against tr_bdf2 at 1/4000 s, which `test_implicit` compares with the adaptive methods."""
    net = rope(10, damping=damping, drag=0.0)
    truth = integrated(net, "tr_bdf2", SECONDS, 8000).x
    fall = net.x0[2, 0, -1] - truth[2, 0, -1]
    for name in ("leapfrog", "implicit_midpoint", "tr_bdf2"):
        for h in (1 / 60, 1 / 480):
            off = np.abs(integrated(net, name, SECONDS, round(SECONDS / h)).x - truth).max()
            assert off < 0.02 * fall, (name, h)
            assert off < 5e-3 * fall or name != "leapfrog", h


@pytest.mark.parametrize("damping", [1e3, 1e5])
def test_axially_damped_links_turn_with_the_rope_at_second_order(damping):
    """Stiff axial damping would else take energy from whatever turns, in proportion to the step."""
    net = rope(10, damping=damping, drag=0.0, damping_model="axial")
    truth = integrated(net, "rk4", 1.0, round(2.0 * damping) + 10_000).x
    counts = [120, 240, 480]
    errors = [np.abs(integrated(net, "leapfrog", 1.0, steps).x - truth).max() for steps in counts]
    # The largest error is now of one point, now of another.
    assert slope(counts, errors) > 1.6
    assert errors[-1] < 1e-3


def step_matrix(net: Net, h: float) -> np.ndarray:
    """The leapfrog's step of a chain that moves along itself: (2 n, 2 n), of displacements and velocities."""
    n = net.shape[1] - 1
    rest = dataclasses.replace(net, gravity=(0.0, 0.0, 0.0))
    columns = []
    for column in range(2 * n):
        state = State.at_rest(rest)
        (state.x if column < n else state.v)[2, 0, 1 + column % n] += 1e-2
        advance(rest, state, "leapfrog", h, 1)
        columns.append(np.concatenate([(state.x - rest.x0)[2, 0, 1:], state.v[2, 0, 1:]]) / 1e-2)
    return np.array(columns).T


@pytest.mark.parametrize("masses", ["equal", "unequal"])
def test_the_leapfrog_is_stable_below_h_omega_of_2_at_any_damping_and_not_beyond_without(masses):
    for damping in DAMPINGS:
        net = hanging(8, 20.0, damping)
        if masses == "unequal":  # so that neither matrix is a multiple of the other
            net = dataclasses.replace(net, mass_ratios=np.random.default_rng(1).uniform(0.2, 3.0, (1, 8)), drag=3.0)
        k, _ = chain_matrices(net)
        limit = 2.0 / math.sqrt(np.linalg.eigvals(k).real.max())
        for part in (0.1, 0.5, 0.9, 0.999):
            # Every step is an eigenvalue within the unit circle; those on it are simple.
            assert np.abs(np.linalg.eigvals(step_matrix(net, part * limit))).max() < 1.0 + 1e-9
        grows = np.abs(np.linalg.eigvals(step_matrix(net, 1.05 * limit))).max()
        assert grows > 1.1 or damping > 0.0 or masses == "unequal"


def damped_share(y):
    """R(y) of `sim.springs.kicks.formula`."""
    return 1.0 / (1.0 + y + 0.5 * y * y)


def test_the_mass_of_the_central_difference_is_no_less_than_the_net_s():
    """E >= (2 - y)/(2 + y), so that N >= M: the premise of the proof in `sim.springs.kicks.formula`."""
    y = np.logspace(-3, 9, 20_001)
    after = damped_share(0.5 * y) ** 2
    assert (after > 0.0).all()
    assert (np.diff(after) < 0.0).all()
    assert (after > (2.0 - y) / (2.0 + y)).all()


@pytest.mark.parametrize("seed", range(5))
def test_the_form_of_the_proof_falls_for_matrices_that_do_not_commute(seed):
    rng = np.random.default_rng(seed)
    n, h = 6, 1.0
    q, r = rng.standard_normal((2, n, n))
    k = q @ q.T
    k *= 3.99 / np.linalg.eigvalsh(k).max()  # h omega up to 1.9975
    rates, vectors = np.linalg.eigh(r @ r.T * 10.0 ** rng.uniform(-2, 4))
    e = damped_share(0.5 * h * rates) ** 2
    b = (vectors * rates) @ vectors.T
    big = (vectors * (0.5 * h * rates * (1.0 + e) / (1.0 - e))) @ vectors.T
    form = np.block([[big - h * h * k / 4.0, np.zeros((n, n))], [np.zeros((n, n)), h * h * k]])
    assert np.linalg.eigvalsh(form).min() > 0.0
    x, last = rng.standard_normal((2, n))
    sizes = []
    for _ in range(50):
        left, right = big + 0.5 * h * b, 2.0 * big @ x - (big - 0.5 * h * b) @ last - h * h * k @ x
        x, last = np.linalg.solve(left, right), x
        y = np.concatenate([x - last, 0.5 * (x + last)])
        sizes.append(y @ form @ y)
    assert (np.diff(sizes) <= 1e-9 * sizes[0]).all()


def as_sheet(line: Net) -> Net:
    """The same rope by the kernels of nets of several rows."""
    other = (family._replace(stiffness=0.0, damping=0.0) for family in FAMILIES[1:])
    return dataclasses.replace(line, families=(*line.families, *other))


PATH = PinPath(0.0, ((0.0, 0.0, 0.0), (0.5, 0.2, 0.3), (-0.5, 0.4, 1.0), (0.4, 0.5, -1.0)))


@pytest.mark.parametrize(
    ("model", "law"),
    [
        ("isotropic", "spring"),
        ("axial", "spring"),
        ("axial", "slack"),
        pytest.param("isotropic", "slack", marks=pytest.mark.long),  # half a minute of compilation for one more pair
    ],
)
def test_a_rope_s_elimination_and_a_sheet_s_iteration_are_the_same_motion_and_account(model, law):
    for damping in (40.0, 1e3, 1e5):
        line = rope(9, damping=damping, drag=2.0, damping_model=model, law=law)
        line = dataclasses.replace(line, pin_paths=(((0, 0), PATH),))
        a, b = (integrated(net, "leapfrog", 1.0, 60, with_account=True) for net in (line, as_sheet(line)))
        assert b.x == pytest.approx(a.x, abs=1e-8)
        assert b.v == pytest.approx(a.v, abs=1e-6)
        assert (b.dissipated, b.work) == pytest.approx((a.dissipated, a.work), rel=1e-6)
        assert a.unsettled == b.unsettled == 0


def strong(kind: str, model: str, damping: float, law: str = "spring") -> Net:
    if kind == "rope":
        return rope(7, damping=damping, damping_model=model, law=law)
    net = cloth(5, 6, density=30.0, damping=damping, damping_model=model, law=law)
    if kind == "cloth":
        return net
    return dataclasses.replace(net, families=(*net.families[:2], KNIGHT._replace(damping=damping)))


KINDS = ["rope", "cloth", "net"]


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_strongly_damped_free_net_keeps_its_momentum_to_round_off(kind, model):
    for damping in (1e3, 1e5):
        net = dataclasses.replace(strong(kind, model, damping), pinned=frozenset(), gravity=(0.0, 0.0, 0.0), drag=0.0)
        v0 = np.random.default_rng(5).standard_normal(net.x0.shape)
        before = (net.masses * v0).reshape(3, -1).sum(axis=1)
        state = integrated(net, "leapfrog", 10.0, 1000, v0)
        after = (net.masses * state.v).reshape(3, -1).sum(axis=1)
        assert after == pytest.approx(before, abs=1e-12 * (net.masses * np.abs(v0)).sum())


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_strongly_damped_run_in_pieces_is_bit_by_bit_the_run_in_one(kind, model):
    net = strong(kind, model, 1e3)
    whole, pieces = State.at_rest(net), State.at_rest(net)
    advance(net, whole, "leapfrog", 1 / 120, 24)
    for steps in (1, 2, 5, 7, 9):
        advance(net, pieces, "leapfrog", 1 / 120, steps)
    assert (whole.x == pieces.x).all()
    assert (whole.v == pieces.v).all()


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_strongly_damped_net_and_its_account_converge_at_second_order(kind, model):
    net = strong(kind, model, 300.0)
    truth = integrated(net, "rk4", 0.25, 6000, with_account=True)
    counts, start = [120, 240, 480], energy(net, State.at_rest(net)).total
    runs = [integrated(net, "leapfrog", 0.25, steps, with_account=True) for steps in counts]
    errors = [np.abs(run.x - truth.x).max() for run in runs]
    assert slope(counts, errors) > 1.6  # h times the rate is still above 1; `test_order` has smaller ones
    assert errors[-1] < 1e-5
    left = [abs(energy(net, run).total - start + run.dissipated - run.work) for run in runs]
    assert slope(counts, left) > 1.6
    assert runs[-1].dissipated == pytest.approx(truth.dissipated, rel=2e-3)


def test_honey_turns_the_energy_of_its_fall_into_heat():
    """The account of a rope that creeps: stored energy is dissipated as it falls, with nothing left over."""
    net = rope(10, damping=1e4, drag=0.0)
    start = energy(net, State.at_rest(net)).total
    state = integrated(net, "leapfrog", 1.0, 240, with_account=True)
    lost = start - energy(net, state).total
    assert state.dissipated == pytest.approx(lost, rel=1e-3)
    assert lost > 1.0


def test_a_moved_pin_works_on_its_damper():
    """A pin that is drawn at a steady speed from the end of a chain pulls with b times the relative speed."""
    speed = 0.3
    still = (0.0, 0.0, 0.0)
    pulled = PinPath(0.0, (still, (0.0, 0.0, speed), still, still))
    net = dataclasses.replace(hanging(2, 0.0, 1e3), gravity=(0.0, 0.0, 0.0), pin_paths=(((0, 0), pulled),))
    state = integrated(net, "leapfrog", 0.5, 30, with_account=True)
    assert state.v[2, 0, 1] == pytest.approx(speed, rel=1e-9)
    # The point, of 1 kg, takes m u from the pin: m u^2 is put in, and half of it is lost.
    assert state.work == pytest.approx(speed**2, rel=1e-2)
    assert state.dissipated == pytest.approx(0.5 * speed**2, rel=2e-2)


def test_a_line_that_only_pulls_does_not_push_at_any_damping():
    """Two points of a slack line thrown at each other: its damping takes at most its tension, of which it has none."""
    for damping in (1e3, 1e5):
        for net in (rope(2, 1.0, 1.0, 50.0, damping, 0.0, 0.0, law="slack"),):
            for line in (net, as_sheet(net)):
                line = dataclasses.replace(line, pinned=frozenset())
                v0 = np.zeros_like(line.x0)
                v0[:, 0, 1] = 0.3 * (line.x0[:, 0, 0] - line.x0[:, 0, 1])
                state = integrated(line, "leapfrog", 0.5, 60, v0)
                assert state.v == pytest.approx(v0, abs=1e-12)


def test_the_splitting_of_weak_damping_is_right_up_to_where_it_ends():
    """Just below the bound of `sim.springs.kicks.kick` and just above it: links and drag."""
    for drag, damping in ((0.0, 7.4), (0.0, 7.6), (1.0, 7.2), (1.0, 7.3), (14.0, 0.1), (16.0, 0.1)):
        for points in (2, 12):
            assert max(errors_along(hanging(points, 20.0, damping, drag), "leapfrog", 1 / 60, 0.5)) < 0.008
