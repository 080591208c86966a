import dataclasses
import functools

import numpy as np
import pytest

from sim.springs import INTEGRATORS, LAWS, Grab, PinPath, rope
from sim.springs.net import Net
from sim.springs.state import State, advance
from tests.sim.springs.nets import patch
from tests.sim.springs.reference import exact, integrated, slope

SECONDS = 0.5
COARSEST = {1: 400, 2: 50, 4: 50, 5: 100}  # steps that are well inside the asymptotic range, by order
# Orders that doubles can show at length.
LOW = [name for name, record in INTEGRATORS.items() if max(record.order, record.undamped_order) <= 5]
PATH = PinPath(-0.1, ((0.01, -0.02, 0.03), (0.2, -0.1, 0.5), (-0.6, 0.4, 2.0), (1.0, 0.5, -3.0)))
LAB = rope(10, gravity=10.0)
ROPES = {
    "isotropic": LAB,
    "axial, pulled": dataclasses.replace(LAB, damping_model="axial", grab=Grab(0, 4, (1.0, 0.5, 0.5), 50.0, 3.0, 1e3)),
    "undamped": rope(10, gravity=10.0, damping=0.0, drag=0.0),
    "moving root": dataclasses.replace(LAB, pin_paths=(((0, 0), PATH),)),
    "moving root, axial": dataclasses.replace(LAB, damping_model="axial", pin_paths=(((0, 0), PATH),)),
}


@functools.cache
def reference(name: str):
    return exact(ROPES[name], SECONDS)


@functools.cache
def finer(name: str):
    """To round-off, where the other reference is good to 1e-12."""
    state = integrated(ROPES[name], "dop853", SECONDS, 400)
    return state.x, state.v


def counts_of(name: str, least: int = 0) -> list[int]:
    """Numbers of steps over five halvings, or over two and a half where round-off is near."""
    order = INTEGRATORS[name].order
    least = 32 if name == "pefrl" else max(least, COARSEST[order])  # its errors are a hundredth of rk4's
    return [round(least * 2 ** (i if order < 5 else 0.5 * i)) for i in range(6)]


def errors_of(net: Net, name: str, counts, truth, seconds: float = SECONDS):
    """Largest error of any position [m] or velocity [m/s] at the end, for each number of steps."""
    found = []
    for steps in counts:
        state = integrated(net, name, seconds, steps)
        found.append(max(np.abs(state.x - truth[0]).max(), np.abs(state.v - truth[1]).max()))
    return found


def expected(name: str, *, damped: bool) -> int:
    record = INTEGRATORS[name]
    return record.order if damped else record.undamped_order or record.order


@pytest.mark.parametrize("case", ROPES)
@pytest.mark.parametrize("name", LOW)
def test_the_error_falls_at_the_declared_order_over_five_halvings(name, case):
    if INTEGRATORS[name].undamped_only and case != "undamped":
        pytest.skip("refuses damping")
    counts = counts_of(name)
    truth = reference(case) if INTEGRATORS[name].order < 5 else finer(case)
    errors = errors_of(ROPES[case], name, counts, truth)
    assert slope(counts, errors) == pytest.approx(expected(name, damped=case != "undamped"), abs=0.1)


@pytest.mark.parametrize("name", [name for name in LOW if not INTEGRATORS[name].undamped_only])
def test_a_net_of_many_families_converges_at_the_declared_order(name):
    net = patch("axial")
    counts = counts_of(name, 100)
    errors = errors_of(net, name, counts, exact(net, 0.2), 0.2)
    assert slope(counts, errors) == pytest.approx(expected(name, damped=True), abs=0.1)


@functools.cache
def stretched(law: str, damped: bool) -> tuple[Net, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """A taut rope between two pins, its velocities, and the state to which they lead it in 0.1 s."""
    net = rope(6, 1.0, 1.0, 200.0, 2.0 * damped, 0.1 * damped, law=law, end=(1.3, 0.0, 0.2))
    v0 = np.zeros_like(net.x0)
    v0[:, 0, 1:-1] = np.random.default_rng(3).uniform(-0.4, 0.4, (3, 4))
    return net, v0, exact(net, 0.1, v0)


def is_slow_to_compile(name: str, law: str) -> bool:
    """True if a method and a law need a kernel that takes seconds to compile, and that no other test runs."""
    return law != "spring" and name != "leapfrog"


@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize(
    ("name", "law"),
    [
        pytest.param(name, law, marks=pytest.mark.long if is_slow_to_compile(name, law) else ())
        for name in INTEGRATORS
        for law in LAWS
    ],
)
def test_every_method_follows_every_law_at_its_order(name, law, damped):
    record = INTEGRATORS[name]
    if damped and record.undamped_only:
        pytest.skip("a method for undamped nets")
    net, v0, truth = stretched(law, damped)
    order, errors = expected(name, damped=damped), []
    steps = {1: 4000, 2: 400, 4: 50}.get(order, 16)
    for count in (steps, 2 * steps):
        state = integrated(net, name, 0.1, count, v0)
        errors.append(max(np.abs(state.x - truth[0]).max(), np.abs(state.v - truth[1]).max()))
    assert errors[1] < 5e-3
    assert errors[1] < 1e-11 or np.log2(errors[0] / errors[1]) > order - 0.5, errors


def test_dop853_is_of_order_eight():
    # Soft, so that errors are above round-off over two halvings; the reference is the method itself, far finer.
    net = rope(6, stiffness=300.0, damping=0.5, drag=0.1)
    fine = integrated(net, "dop853", 1.0, 300)
    counts = [16, 20, 24, 32, 40, 48, 64]
    errors = errors_of(net, "dop853", counts, (fine.x, fine.v), 1.0)
    assert slope(counts, errors) == pytest.approx(8, abs=0.1)


@pytest.mark.parametrize(
    ("damping", "model", "least", "most"),  # terms of higher order are still seen where there is damping
    [(0.0, "isotropic", 7.7, 8.3), (2.0, "isotropic", 4.8, 5.5), (1.0, "axial", 4.8, 6.3)],
)
def test_rkn8_is_of_order_eight_and_of_five_with_damping(damping, model, least, most):
    net = rope(6, stiffness=300.0, damping=damping, drag=0.2 * damping, damping_model=model)
    fine = integrated(net, "dop853", 1.0, 300)
    counts = [48, 56, 64, 80, 96]
    errors = errors_of(net, "rkn8", counts, (fine.x, fine.v), 1.0)
    assert least < slope(counts, errors) < most


def test_damping_link_by_link_seeds_no_folds():
    """A light rope of 1024 links folds where it is pressed: an error that alternates from link to link grows there."""
    net = rope(1025, 1.0, 1.0 / 1025, 981.0 * 1024, 0.002 * 1024, 0.2 / 1025, 9.81)
    truth = integrated(net, "rk4", 1.0, 36_000).x
    errors = [np.abs(integrated(net, "leapfrog", 1.0, steps).x - truth).max() for steps in (34_000, 48_000)]
    assert errors[0] < 1e-4
    assert slope((34_000, 48_000), errors) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_step_takes_the_declared_evaluations(name):
    """Implicit: of a rope at rest, and one correction more of each stage of a rope that begins to fall."""
    record, damping = INTEGRATORS[name], {} if name != "pefrl" else {"damping": 0.0, "drag": 0.0}
    net = rope(4, gravity=0.0, **damping)
    pulled = dataclasses.replace(net, gravity=(3.0, 5.0, -8.0))
    resting, falling = State.at_rest(net), State.at_rest(pulled)
    advance(net, resting, record, 1e-3, 5)
    advance(pulled, falling, record, 1e-3, 5)
    first = resting.force_evals - 5 * record.evals  # some methods evaluate the forces once at the start
    assert first in (0, 1)
    stages = record.evals - record.evals_outside_corrections if record.implicit else 0
    assert falling.force_evals - first == 5 * (record.evals + stages)


def test_a_moving_root_is_exactly_where_its_path_is():
    net = ROPES["moving root"]
    state = integrated(net, "leapfrog", SECONDS, 97)
    s = SECONDS - PATH.start
    c = np.array(PATH.coefficients)
    assert state.x[:, 0, 0] == pytest.approx(c[0] + c[1] * s + c[2] * s**2 + c[3] * s**3, rel=1e-14)
    assert state.v[:, 0, 0] == pytest.approx(c[1] + 2 * c[2] * s + 3 * c[3] * s**2, rel=1e-14)


def test_the_lab_s_own_figures_of_error_come_out():
    # Lab defaults from horizontal, two seconds: RK4 at 1/60 s is off by 2.0e-6 m and the damped leapfrog is second
    # order where the lab's Euler at the same cost is a hundred times as far off.
    net = rope(10, gravity=10.0)
    truth = exact(net, 2.0)
    rk4, leapfrog, euler = (
        np.abs(integrated(net, name, 2.0, steps).x - truth[0]).max()
        for name, steps in (("rk4", 120), ("leapfrog", 240), ("symplectic_euler", 240))
    )
    assert rk4 == pytest.approx(2.0e-6, rel=0.1)
    assert leapfrog < 0.02 * euler
    assert euler == pytest.approx(8.4e-3, rel=0.1)


def step_matrix(net, name, h):
    """Derivatives of a step by positions and velocities of the free points, by central differences."""
    free = np.repeat(net.inverse_masses()[None] > 0.0, 3, axis=0).ravel()
    rng = np.random.default_rng(3)
    x, v = net.x0.ravel() + 0.1 * rng.standard_normal(free.size) * free, rng.standard_normal(free.size) * free
    at = np.concatenate([np.flatnonzero(free), free.size + np.flatnonzero(free)])
    columns = []
    for j in at:
        ends = []
        for sign in (1.0, -1.0):
            y = np.concatenate([x, v])
            y[j] += sign * 1e-5
            state = State(*y.reshape(2, *net.x0.shape).copy(), lag=INTEGRATORS[name].lag * h)
            advance(net, state, INTEGRATORS[name], h, 1)
            ends.append(np.concatenate([state.x.ravel(), state.v.ravel()])[at])
        columns.append((ends[0] - ends[1]) / 2e-5)
    return np.array(columns).T


@pytest.mark.parametrize("name", [name for name, record in INTEGRATORS.items() if record.order < 5])
def test_a_step_is_symplectic_where_it_is_declared_to_be(name):
    """M^T J M = J of the step's derivative M."""
    matrix = step_matrix(rope(4, damping=0.0, drag=0.0), name, 0.03)
    half = len(matrix) // 2
    J = np.block([[np.zeros((half, half)), np.eye(half)], [-np.eye(half), np.zeros((half, half))]])
    off = np.abs(matrix.T @ J @ matrix - J).max()
    assert off < 1e-7 if INTEGRATORS[name].symplectic else off > 1e-5


@pytest.mark.parametrize("name", INTEGRATORS)
def test_of_a_symplectic_method_the_step_of_an_oscillator_keeps_areas(name):
    """Its matrix has the determinant 1; of one that is not, only an order that rounding hides may have it."""
    net, h, size = rope(2, stiffness=100.0, damping=0.0, drag=0.0, gravity=0.0), 0.03, 1e-5  # omega = 10 1/s
    rest, columns = State.at_rest(net), []
    along = rest.x[:, 0, 1] - rest.x[:, 0, 0]
    along = along / np.linalg.norm(along)
    for place, speed in ((size, 0.0), (0.0, 10.0 * size)):
        state = State.at_rest(net)
        state.x[:, 0, 1] += place * along
        state.v[:, 0, 1] += speed * along
        advance(net, state, INTEGRATORS[name], h, 1)
        columns.append(((state.x - rest.x)[:, 0, 1] @ along / size, state.v[:, 0, 1] @ along / (10.0 * size)))
    change = float(abs(np.linalg.det(np.array(columns)) - 1.0))
    assert change < 1e-9 or not INTEGRATORS[name].symplectic
    assert (change < 1e-9) is (name in (*KEEP_AREAS, "rkn8", "dop853"))


KEEP_AREAS = ("symplectic_euler", "leapfrog", "leapfrog_lagged", "pefrl", "implicit_midpoint")
