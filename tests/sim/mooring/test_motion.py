"""Lines in motion: MoorDyn, ropes without water, orders of the integrators, energy, and the longest stable step."""

import dataclasses
import math
import warnings

import numpy as np
import pytest
from scipy.linalg import expm

from sim import springs
from sim.mooring import (
    Line,
    LineType,
    MooredBody,
    Point,
    State,
    System,
    advance,
    critical_step,
    simulate,
)
from sim.mooring.motion import FARTHEST, PIECE, MooringFrames
from sim.mooring.rest.statics import Rest
from sim.springs.analysis.energy import energies, power
from sim.springs.integrators import integrator_named
from sim.springs.kicks.lines import kick_lines, make_lines_system
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.line_points import set_inverse_masses
from sim.validation import ApproximationWarning
from sim.water import Water
from sim.waves import Waves
from tests.sim.mooring.systems import Shaking, chain_on_bed, floating_body, in_vacuum, taut_rope

SPACE = Water(100.0, gravity=0.0, density=0.0)  # neither weight nor water


def harmonic(t: np.ndarray, y: np.ndarray, period: float) -> tuple[float, float]:
    """Mean and amplitude of the first harmonic over the last three periods."""
    last = t > t[-1] - 3.0 * period + 1e-9
    phase = 2.0 * math.pi * t[last] / period
    basis = np.stack([np.ones_like(phase), np.sin(phase), np.cos(phase)], axis=1)
    mean, sine, cosine = np.linalg.lstsq(basis, y[last], rcond=None)[0]
    return float(mean), math.hypot(sine, cosine)


@pytest.mark.parametrize(
    ("system", "motion", "period", "mean", "first"),
    # MoorDyn 2.7.2 in steps of 1e-4 s, its fairlead set every 1e-3 s: set every 1e-2 s, the first harmonic of the chain
    # is a tenth more, as the fairlead then goes in straight lines.
    [
        (chain_on_bed(40), Shaking((0.0, 0.0, 0.0), 0, 1.5, 7.0), 7.0, 44796.2, 1431.1),
        (taut_rope(20), Shaking((0.0, 0.0, -1.0), 2, 0.15, 5.0), 5.0, 26625.9, 4004.3),
    ],
    ids=["chain on the bed", "taut rope"],
)
def test_tension_of_a_shaken_line_is_that_of_moordyn(system, motion, period, mean, first):
    run = simulate(system, duration=8.0 * period, frames=round(400 * period) + 1, motion={2: motion})
    found = harmonic(run.t, run.tension[1][:, -1], period)
    assert found[0] == pytest.approx(mean, rel=1e-3)
    assert found[1] == pytest.approx(first, rel=0.02)


def damped_alone(p, x, v, s) -> np.ndarray:
    """The velocities after damping alone for a time s [s]."""
    found = v.copy()
    set_inverse_masses(x, p)
    kick_lines(x, found, np.zeros_like(found), 0.0, s, p, True, make_lines_system(p), np.zeros(3))
    return found


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, 0.6, 0.8)])
def test_water_acts_on_a_float_by_its_volume_and_areas_alike_in_all_directions(way):
    hair = LineType("hair", 1e-9, 1e-9, 1.0)  # slack, and nothing beside the float
    points = [Point(1, "fixed", (0.0, 0.0, -50.0)), Point(2, "free", (0.0, 0.0, -45.0), 300.0, 0.6, 0.8, 0.5)]
    p = System([Line(1, hair, 1, 2, 20.0, 1)], points, Water(50.0), bed_stiffness=0.0).kernel_view(1.0)
    x, v, a = np.array([0.0, 0.0, 0.0, 0.0, -50.0, -45.0]), np.zeros(6), np.empty(6)
    v[1::2] = 2.0 * np.array(way)
    heavy, drag = 300.0 + 0.5 * 1025.0 * 0.6, 0.5 * 1025.0 * 0.8
    lift = (1025.0 * 0.6 - 300.0) * 9.81
    set_acceleration(x, v, 0.0, p, a)
    assert a[1::2] == pytest.approx((np.array((0.0, 0.0, lift)) - drag * 2.0 * v[1::2]) / heavy, rel=1e-6)
    assert energies(x, v, 0.0, p)[2] == pytest.approx(45.0 * lift, rel=1e-6)
    assert power(x, v, 0.0, p, True)[0] == pytest.approx(drag * 2.0**3, rel=1e-6)
    for _ in range(30):
        v = damped_alone(p, x, v, 0.01)
    assert v[1::2] == pytest.approx(2.0 * np.array(way) / (1.0 + drag * 2.0 * 0.3 / heavy), rel=1e-4)


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
def test_a_line_without_water_and_bed_is_a_rope(integrator):
    kind = LineType("rope", 0.02, 3.0, 2000.0, 0.0 if integrator == "leapfrog" else 15.0)
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "fixed", (2.0, 0.0, 0.3)))
    system = System((Line(1, kind, 1, 2, 1.5, 12),), points, Water(10.0, density=0.0), bed_stiffness=0.0)
    spacing = 1.5 / 12
    net = springs.rope(
        13, 1.5, 3.0 * spacing, 2000.0 / spacing, kind.damping / spacing, 0.0, root=(0.0, 0.0, 0.0),
        end=(2.0, 0.0, 0.3), damping_model="axial",
    )  # fmt: skip
    expected = springs.simulate(net, duration=0.5, frames=6, step=1e-3, integrator=integrator)
    start = State.still(net.x0[:, 0, [0, 12, *range(1, 12)]])
    found = simulate(system, duration=0.5, frames=6, step=1e-3, integrator=integrator, start=start)
    assert np.abs(found.x[1] - expected.x).max() < 1e-12
    assert np.abs(np.subtract(found.energy[:2], expected.energy[:2])).max() < 1e-9


def suspended_in_waves() -> tuple[System, Rest]:
    """A taut line in a regular wave and a current, displaced so that it swings."""
    waves = Waves(
        kx=np.array([0.1]), ky=np.array([0.05]), amplitude=np.array([0.8]), omega=np.array([1.05]),
        phase=np.array([0.2 * math.pi]), water=Water(60.0),
    )  # fmt: skip
    kind = LineType("rope", 0.08, 12.0, 4e4, 200.0, 1.0, 1.2, 0.3, 0.05)
    points = (Point(1, "fixed", (0.0, 0.0, -40.0)), Point(2, "fixed", (30.0, 5.0, -2.0)))
    system = System((Line(1, kind, 1, 2, 46.0, 8),), points, Water(60.0), current=(0.4, 0.1, 0.0), waves=waves)
    return system, system.at_rest()


def end_of(system: System, rest: Rest, integrator: str, h: float, duration: float) -> np.ndarray:
    state = State.still(rest.nodes)
    advance(system, state, integrator, h, round(duration / h))
    return state.x


@pytest.mark.parametrize(
    "integrator",
    [
        "leapfrog", "rk4", "dopri5",
        *(pytest.param(name, marks=pytest.mark.stress) for name in ("explicit_euler", "symplectic_euler", "dop853")),
    ],
)  # fmt: skip
def test_each_integrator_has_its_order_on_a_line_in_waves(integrator):
    system, rest = suspended_in_waves()
    order = springs.INTEGRATORS[integrator].order
    duration = 2.0
    finest = end_of(system, rest, "dopri5", duration / 8192, duration)
    first = {1: 1024, 2: 64, 4: 64, 5: 64, 8: 8}[order]  # of the eighth, 32 reach the round-off of the reference
    errors = [
        np.abs(end_of(system, rest, integrator, duration / n, duration) - finest).max() for n in (first, 2 * first)
    ]
    assert errors[0] < 0.5
    assert math.log2(errors[0] / errors[1]) > order - 0.35


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
def test_the_account_balances_with_everything_at_work(integrator):
    system = dataclasses.replace(chain_on_bed(20), friction=0.3, current=(0.3, 0.2, 0.0))
    motion = Shaking((0.0, 0.0, 0.0), 0, 1.5, 7.0)
    errors = []
    for step in (2e-3, 1e-3):
        run = simulate(
            system, duration=8.0, frames=17, step=step, integrator=integrator, with_account=True, motion={2: motion}
        )
        stored = run.energy.total
        error = stored + run.energy.dissipated - run.energy.work
        errors.append(np.abs(error - error[0]).max())
        assert run.energy.dissipated[-1] > 1e3  # J
    assert errors[1] < 0.02 * run.energy.dissipated[-1]
    assert errors[1] < 0.7 * errors[0]


def moored_body(surge: float) -> System:
    """A body on two taut lines along x, without water or losses."""
    kind = in_vacuum(LineType("wire", 0.02, 1.0, 4e5))
    points = (
        Point(1, "fixed", (-40.0, 0.0, 0.0)), Point(2, "body", (-2.0, 0.0, 0.0), body=1),
        Point(3, "body", (2.0, 0.0, 0.0), body=1), Point(4, "fixed", (40.0, 0.0, 0.0)),
    )  # fmt: skip
    lines = (Line(1, kind, 1, 2, 37.9, 10), Line(2, kind, 3, 4, 37.9, 10))
    return System(lines, points, SPACE, bodies=(floating_body(surge),), bed_stiffness=0.0)


def test_a_moored_body_without_losses_keeps_its_energy_and_surges_at_the_linear_frequency():
    system = moored_body(0.0)
    system = dataclasses.replace(
        system, bodies=(system.bodies[0]._replace(mass=np.diag([2e4, 2e4, 3e4, 8e4, 8e4, 9e4])),)
    )
    rest = system.at_rest()
    x = rest.nodes.copy()
    m = system.node_count
    push = 0.01
    x[0, m] += push
    for line in system.lines:
        at = system.nodes_of[line.id]
        share = np.linspace(0.0, 1.0, len(at)) if line.id == 1 else np.linspace(1.0, 0.0, len(at))
        x[0, at] += push * share
    step = 0.5 * critical_step(system, "leapfrog", State.still(rest.nodes))
    run = simulate(system, duration=1000.0, frames=8001, step=step, start=State.still(x))
    total = run.energy.total
    stiffness = 2.0 * 4e5 / 37.9
    assert np.abs(total - total[0]).max() < 1e-4 * 0.5 * stiffness * push**2
    surge = run.bodies[1][:, 0] - run.bodies[1][:, 0].mean()
    spectrum = np.abs(np.fft.rfft(surge * np.hanning(len(surge))))
    peak = int(spectrum.argmax())
    left, middle, right = np.log(spectrum[peak - 1 : peak + 2])
    found = (peak + 0.5 * (left - right) / (left - 2.0 * middle + right)) / 1000.0 * (8000 / 8001)
    # A third of each line's mass moves with the body.
    expected = math.sqrt(stiffness / (2e4 + 2.0 * 37.9 / 3.0)) / (2.0 * math.pi)
    assert found == pytest.approx(expected, rel=0.01)


def test_a_body_takes_the_pull_of_its_lines_as_a_rope_of_heavy_ends_does():
    """Momentum passes through the joint: a body of mass alone is one more point of the rope."""
    kind = in_vacuum(LineType("wire", 0.02, 1.0, 4e4))
    body = floating_body()._replace(mass=np.diag([50.0] * 3 + [1e9] * 3), stiffness=np.zeros((6, 6)))
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "body", (10.0, 0.0, 0.0), body=1))
    carried = System(
        (Line(1, kind, 1, 2, 10.0, 5),), points, SPACE,
        bodies=(body._replace(place=(10.0, 0.0, 0.0)),), bed_stiffness=0.0,
    )  # fmt: skip
    free = System(
        (Line(1, kind, 1, 2, 10.0, 5),), (points[0], Point(2, "free", (10.0, 0.0, 0.0), mass=50.0)), SPACE,
        bed_stiffness=0.0,
    )  # fmt: skip
    nodes = np.zeros((3, 6))
    nodes[0] = (0.0, 10.4, *np.linspace(0.0, 10.4, 6)[1:-1])
    nodes[1, 2:] = 0.1
    expected = simulate(free, duration=5.0, frames=11, step=2e-3, start=State.still(nodes))
    with_body = np.concatenate((nodes, [[0.4, 0.0], [0.0, 0.0], [0.0, 0.0]]), axis=1)
    found = simulate(carried, duration=5.0, frames=11, step=2e-3, start=State.still(with_body))
    assert np.abs(found.x[1] - expected.x[1]).max() < 1e-9


def grows(system: System, rest: Rest, integrator: str, h: float) -> bool:
    """Whether a small disturbance grows a thousandfold in 400 steps of h."""
    state = State.still(rest.nodes)
    noise = 1e-7 * np.random.default_rng(0).standard_normal(state.x.shape)
    free = system.kernel_view(1.0).inverse_masses > 0.0
    state.x[:, free] += noise[:, free]
    with np.errstate(all="ignore"):
        advance(system, state, integrator, h, 400)
    return not np.abs(state.x - rest.nodes).max() < 1e-4


@pytest.mark.parametrize("lines", [5, pytest.param(50, marks=pytest.mark.stress)])
@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
def test_a_line_diverges_at_the_step_of_the_gauge(lines, integrator):
    rng = np.random.default_rng(1)
    for _ in range(lines):
        depth, length = rng.uniform(20.0, 80.0), rng.uniform(100.0, 200.0)
        kind = LineType("chain", rng.uniform(0.05, 0.12), rng.uniform(40.0, 150.0), 10 ** rng.uniform(7.0, 8.5),
                        -rng.uniform(0.1, 0.8))  # fmt: skip
        span = rng.uniform(0.95, 0.99) * math.sqrt(length**2 - depth**2)  # no link of it is slack
        points = (Point(1, "fixed", (-span, 0.0, -depth)), Point(2, "fixed", (0.0, 0.0, 0.0)))
        system = System((Line(1, kind, 1, 2, length, int(rng.integers(10, 30))),), points, Water(depth))
        rest = system.at_rest()
        h = critical_step(system, integrator, State.still(rest.nodes))
        assert not grows(system, rest, integrator, 0.95 * h)
        # Inside the leapfrog's kick damping makes longer steps stable, at most twice as long here.
        assert grows(system, rest, integrator, (2.0 if integrator == "leapfrog" else 1.05) * h)


def test_a_path_is_made_of_short_pieces_and_one_number_out_of_bounds_ends_a_run():
    system, motion = taut_rope(6), Shaking((0.0, 0.0, -1.0), 2, 0.15, 5.0)
    start, record = State.still(system.at_rest().nodes), integrator_named("rk4")
    for interval in (0.04, 0.05, 0.06, 0.09, 0.11):
        t = np.array([0.0, interval])
        frames = MooringFrames(system, {2: motion}, record, t, 1e-4, start, False)
        assert frames.pieces * frames.piece == pytest.approx(interval)
        assert PIECE / 2 < frames.piece < PIECE * (1.0 + 1e-6)
    assert MooringFrames(system, {}, record, t, 1e-4, start, False).pieces == 1  # nothing moves
    assert frames.is_bounded
    for value in (2.0 * FARTHEST, -2.0 * FARTHEST, math.nan):
        frames.state.x[1, 3] = value
        assert not frames.is_bounded


def test_a_run_that_diverges_ends_with_a_warning_and_what_it_has():
    system = taut_rope(10)
    motion = Shaking((0.0, 0.0, -1.0), 2, 0.15, 5.0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = simulate(
            system,
            duration=5.0,
            frames=51,
            step=20.0 * critical_step(system, "rk4"),
            integrator="rk4",
            motion={2: motion},
        )
    assert run.diverged_at is not None
    assert "critical_step" in str(caught[-1].message)
    assert np.isfinite(run.x[1][0]).all()
    assert np.isnan(run.x[1][-1]).all()


def test_a_step_above_the_critical_one_and_kicks_that_have_not_settled_are_said():
    """A light rope that is thrown about, in steps as long as its drag bears: its slack links never settle."""
    kind = LineType("rope", 1.7e-3, 0.15, 3e7, 4.2e4)
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "fixed", (10.0, 0.0, -5.0)))
    system = System((Line(1, kind, 1, 2, 13.0, 25),), points, Water(30.0))
    calm = State.still(system.at_rest().nodes)
    longest, wild = critical_step(system, "leapfrog", calm), calm.copy()
    wild.v[:, 2:] = np.random.default_rng(1).standard_normal(wild.v[:, 2:].shape)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")  # it diverges, too
        thrown = simulate(system, duration=0.5, frames=2, step=0.0025, start=wild)
    assert thrown.unsettled > 0
    texts = [str(one.message) for one in caught if one.category is ApproximationWarning]
    assert any(text.startswith("step: 0.0025 s is above the critical step of leapfrog") for text in texts)
    assert any(f"had not settled in {thrown.unsettled} steps" in text for text in texts)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ApproximationWarning)
        still = simulate(system, duration=0.01, frames=2, step=0.99 * longest, start=calm)
    assert still.unsettled == 0
    counted = wild.copy()
    advance(system, counted, integrator_named("leapfrog"), 0.0025, 200)
    assert counted.unsettled == thrown.unsettled


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
def test_a_damped_body_decays_as_a_damped_oscillator_does(integrator):
    """Heave and roll of a body on a line that hangs slack, and too light to be felt."""
    kind = LineType("thread", 0.001, 1e-6, 1.0, 0.0)
    damping = np.diag([0.0, 0.0, 2e4, 3e4, 0.0, 0.0])
    body = floating_body()._replace(mass=np.diag([2e4, 2e4, 3e4, 8e4, 8e4, 9e4]), damping=damping)
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "body", (0.0, 0.0, 0.0), body=1))
    system = System(
        (Line(1, kind, 1, 2, 50.0, 2),), points, Water(100.0, density=0.0), bodies=(body,), bed_stiffness=0.0
    )
    nodes = np.zeros((3, 5))
    nodes[2] = (-5.0, 0.3, -2.0, 0.3, 0.0)
    nodes[0, 4] = 0.1
    run = simulate(
        system,
        duration=8.0,
        frames=41,
        step=1e-3,
        integrator=integrator,
        start=State.still(nodes),
        with_account=True,
    )
    for axis, start, (mass, resistance, stiffness) in ((2, 0.3, (3e4, 2e4, 2e5)), (3, 0.1, (8e4, 3e4, 5e5))):
        rate, square = 0.5 * resistance / mass, stiffness / mass
        omega = math.sqrt(square - rate * rate)
        expected = start * np.exp(-rate * run.t) * (np.cos(omega * run.t) + rate / omega * np.sin(omega * run.t))
        assert np.abs(run.bodies[1][:, axis] - expected).max() < 1e-5
    assert run.energy.dissipated[-1] > 0.9 * run.energy.elastic[0]
    assert np.abs(run.energy.error).max() < 1e-4 * run.energy.elastic[0]


def test_each_body_has_its_own_row_of_a_run():
    """Two moored bodies, the second displaced, rotated and moving at the start."""
    kind = LineType("wire", 0.02, 0.5, 1e4, 0.0)
    bodies = tuple(floating_body(1e3)._replace(id=i, place=(20.0 * i, 0.0, 0.0)) for i in (1, 2))
    points = tuple(
        point
        for i in (1, 2)
        for point in (
            Point(i, "fixed", (20.0 * i, 0.0, -9.0)),
            Point(10 * i, "body", (20.0 * i, 0.0, -1.0), body=i),
        )
    )
    lines = tuple(Line(i, kind, i, 10 * i, 8.0, 4) for i in (1, 2))
    system = System(lines, points, Water(30.0, density=0.0), bodies)
    start = State.at_rest(system)
    places, at = start.x[:, -4:].T.reshape(2, 6).copy(), system.node_count + 2
    start.x[:, at], start.x[:, at + 1] = start.x[:, at] + (0.1, 0.2, 0.3), (0.01, 0.02, 0.03)
    start.v[:, at], start.v[:, at + 1] = (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)
    run = simulate(system, 0.01, 2, 1e-3, start=start)
    assert run.bodies[1][0] == pytest.approx(places[0])
    assert run.bodies[2][0] == pytest.approx([*(places[1][:3] + (0.1, 0.2, 0.3)), 0.01, 0.02, 0.03])
    assert run.bodies_v[1][0] == pytest.approx(np.zeros(6), abs=1e-6)
    assert run.bodies_v[2][0] == pytest.approx([1.0, 2.0, 3.0, 0.1, 0.2, 0.3])


def test_a_moved_point_needs_no_velocity_and_one_without_motion_stays():
    system, motion = taut_rope(6), Shaking((0.0, 0.0, -1.0), 2, 0.15, 5.0)
    with_velocity = simulate(system, duration=4.0, frames=21, motion={2: motion})
    without = simulate(system, duration=4.0, frames=21, motion={2: lambda t: motion(t)})
    assert np.abs(with_velocity.x[1] - without.x[1]).max() < 1e-6
    still = simulate(system, duration=1.0, frames=3)
    assert np.abs(still.x[1][:, -1] - (0.0, 0.0, -1.0)).max() == 0.0
    assert np.abs(still.tension[1] - still.tension[1][0]).max() < 1e-3


@pytest.mark.parametrize("rate", [0.3, 20.0, 2e3, 2e5])
def test_damping_of_a_body_decays_as_the_closed_form_and_limits_no_step(rate):
    """By a full damping matrix, against exp(-M^-1 B t) (scipy's expm): of second order, and stable in any step."""
    rng = np.random.default_rng(3)
    square = rng.normal(size=(6, 6))
    mass, damping = np.diag([2e4, 2e4, 3e4, 8e4, 8e4, 9e4]), rate * 1e4 * (square @ square.T)
    body = MooredBody(1, (0.0, 0.0, 0.0), mass, np.zeros((6, 6)), damping)
    hair = LineType("hair", 1e-9, 1e-9, 1e-9, 0.0)
    points = Point(1, "fixed", (0.0, 0.0, -50.0)), Point(2, "body", (0.0, 0.0, 0.0), body=1)
    system = System((Line(1, hair, 1, 2, 80.0, 1),), points, Water(50.0, gravity=0.0, density=0.0), (body,))
    p, s = system.kernel_view(1.0), 0.4
    x, v = np.zeros((3, 4)), np.zeros((3, 4))
    v[:, 2:] = rng.normal(size=(3, 2))
    expected = expm(-s * np.linalg.solve(mass, damping)) @ v[:, 2:].T.reshape(-1)
    errors, begin = [], v.copy()
    for count in (1, 200, 400):
        v = begin.reshape(-1)
        for _ in range(count):
            v = damped_alone(p, x.reshape(-1), v, s / count)
        v = v.reshape(3, 4)
        errors.append(np.abs(v[:, 2:].T.reshape(-1) - expected).max())
        assert v[:, 1] == pytest.approx(v[:, 2], abs=1e-12)  # the fairlead moves with the body
    assert errors[0] < 1.5 * np.abs(begin).max()
    assert errors[2] < 0.3 * errors[1] + 1e-12


def damped(rate: float) -> System:
    """A body on two wires whose damping is `rate` [1/s] times its mass, pushed by 10 kN."""
    wire = LineType("wire", 0.01, 0.5, 1e5, 0.0)
    points = (
        Point(1, "fixed", (-40.0, 0.0, 0.0)), Point(2, "body", (-1.0, 0.0, 0.0), body=1),
        Point(3, "body", (1.0, 0.0, 0.0), body=1), Point(4, "fixed", (40.0, 0.0, 0.0)),
    )  # fmt: skip
    lines = (Line(1, wire, 1, 2, 38.9, 8), Line(2, wire, 3, 4, 38.9, 8))
    body = MooredBody(1, (0.0, 0.0, 0.0), 1e4 * np.eye(6), 1e4 * np.eye(6), rate * 1e4 * np.eye(6))
    return System(lines, points, SPACE, (body,), bed_stiffness=0.0)


@pytest.mark.parametrize("rate", [0.5, 200.0, 2e3, 2e5])
def test_leapfrog_holds_up_to_its_critical_step_at_any_damping_of_a_body(rate):
    still = damped(rate)
    rest = still.at_rest()
    pushed = dataclasses.replace(still, bodies=(still.bodies[0]._replace(steady=(1e4, 0.0, 0.0, 0.0, 0.0, 0.0)),))
    h = critical_step(still, "leapfrog", State.still(rest.nodes))
    run = simulate(pushed, duration=4.0, frames=5, step=0.98 * h, start=State.still(rest.nodes))
    assert run.diverged_at is None
    assert np.abs(run.bodies[1][:, 0]).max() < 1.5


def test_a_strongly_damped_body_creeps_as_rk4_has_it():
    still = damped(200.0)
    rest = still.at_rest()
    pushed = dataclasses.replace(still, bodies=(still.bodies[0]._replace(steady=(1e4, 0.0, 0.0, 0.0, 0.0, 0.0)),))
    expected = 0.02451  # [m] after 5 s, rk4 in steps of 1 ms
    errors = [
        abs(
            simulate(pushed, duration=5.0, frames=2, step=step, start=State.still(rest.nodes)).bodies[1][-1, 0]
            - expected
        )
        for step in (4e-3, 2e-3)
    ]
    assert max(errors) < 1e-4 * expected
