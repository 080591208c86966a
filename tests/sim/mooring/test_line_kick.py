"""Damping and drag of lines, however strong: closed forms, dense references, and runs at several steps."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import expm

from sim.mooring import Line, LineType, MooredBody, Point, State, System, advance, simulate
from sim.springs.kicks.line_solver import coupling_of, factorise, solve_factorised
from sim.springs.kicks.lines import kick_lines, make_lines_system
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.line_points import set_inverse_masses
from sim.springs.state import velocities
from sim.water import Water
from tests.sim.mooring.systems import Shaking, chain_on_bed

NO_WATER = Water(10.0, density=0.0)
STEPS = [1 / 60, 1 / 240, 1 / 1200]
HAIR = LineType("hair", 1e-9, 1e-9, 1.0, 0.0)


def with_damping(system: System, damping: float) -> System:
    line = system.lines[0]
    return dataclasses.replace(system, lines=(line._replace(type=line.type._replace(damping=damping)),))


def moved(system: System, x: np.ndarray, h: float, duration: float, v: np.ndarray | None = None) -> State:
    state = State.still(x)
    if v is not None:
        state.v[:] = v
    advance(system, state, "leapfrog", h, round(duration / h))
    return state


@pytest.mark.parametrize("slack_damping", [False, True])
@pytest.mark.parametrize("h", STEPS)
@pytest.mark.parametrize("damping", [0.0, 7.0, 1e2, 1e3, 1e4, 1e6])
def test_a_mass_on_one_damped_segment_sinks_as_the_closed_form(damping, h, slack_damping):
    """m z'' = -k (z - l) - b z' + m g downwards, taut from a stretch of 0.1 m on."""
    mass, k, stretch = 1.0, 20.0, 0.1
    kind = LineType("wire", 1e-9, 1e-9, k, damping)
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "free", (0.0, 0.0, -1.0 - stretch), mass))
    system = System((Line(1, kind, 1, 2, 1.0, 1),), points, NO_WATER, slack_damping=slack_damping, bed_stiffness=0.0)
    x = np.array([point.position for point in points]).T
    state = moved(system, x, h, 2.0)
    matrix = np.array([[0.0, 1.0, 0.0], [-k / mass, -damping / mass, 9.81 - k * stretch / mass], [0.0, 0.0, 0.0]])
    fall, speed, _ = expm(2.0 * matrix) @ (0.0, 0.0, 1.0)
    largest = (9.81 - k * stretch / mass) * mass / k
    scale = max(abs(fall), 0.1 * largest) if damping < 10.0 else abs(fall)
    assert x[2, 1] - state.x[2, 1] == pytest.approx(fall, abs=0.01 * scale)
    if damping > 10.0:
        assert -velocities(system, state)[2, 1] == pytest.approx(speed, abs=0.01 * abs(speed) + 1e-6)


def test_a_mass_leaves_a_damped_segment_at_the_closed_form_s_speed_and_a_dashpot_slows_it_down():
    """x = (u/w) exp(-g t) sin(w t) until the force is 0, at w t = 2 acos(z), then uniform; or damped for ever."""
    omega, ratio, u = 20.0, 0.3, 3.0
    decay, turn = ratio * omega, omega * math.sqrt(1.0 - ratio**2)
    start, end = 0.02, 0.2
    still = math.exp(-decay * start) * u
    place, speed = (
        still * math.sin(turn * start) / turn,
        still * (math.cos(turn * start) - decay / turn * math.sin(turn * start)),
    )
    kind = LineType("wire", 1e-9, 1e-9, omega**2, 2.0 * ratio * omega)
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "free", (1.0 + place, 0.0, -5.0), 1.0))
    x, v = np.array([point.position for point in points]).T, np.zeros((3, 2))
    v[0, 1] = speed
    leaves, slack = 2.0 * math.acos(ratio) / turn, math.pi / turn
    for slack_damping in (False, True):
        system = System(
            (Line(1, kind, 1, 2, 1.0, 1),),
            points,
            dataclasses.replace(NO_WATER, gravity=0.0),
            slack_damping=slack_damping,
            bed_stiffness=0.0,
        )
        state = moved(system, x, (end - start) / 4000, end - start, v)
        if slack_damping:
            back, rest = math.exp(-decay * slack) * u, 2.0 * decay * (end - slack)
            expected = -back * (1.0 - math.exp(-rest)) / (2.0 * decay), -back * math.exp(-rest)
        else:
            away = math.exp(-decay * leaves) * u
            expected = away * math.sin(turn * leaves) / turn - away * (end - leaves), -away
        assert state.x[0, 1] - 1.0 == pytest.approx(expected[0], abs=1e-5)
        assert velocities(system, state)[0, 1] == pytest.approx(expected[1], abs=1e-4)


@pytest.mark.parametrize("damping", [1e3, 1e5, 1e7])
@pytest.mark.parametrize("h", STEPS)
def test_a_damped_chain_sags_as_the_matrix_exponential(damping, h):
    """Upright between two fixed points, stretched by 5 %, so that it stays straight and taut."""
    n, length, mass, stiffness = 10, 20.0, 5.0, 5e4
    kind = LineType("rope", 1e-9, mass, stiffness, damping)
    points = (Point(1, "fixed", (0.0, 0.0, -21.0)), Point(2, "fixed", (0.0, 0.0, 0.0)))
    system = System((Line(1, kind, 1, 2, length, n),), points, NO_WATER, slack_damping=True, bed_stiffness=0.0)
    x = np.zeros((3, n + 1))
    x[2, system.nodes_of[1]] = np.linspace(-21.0, 0.0, n + 1)
    state = moved(system, x, h, 2.0)
    size = n - 1
    laplace = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    m, l0 = mass * length / n, length / n
    matrix = np.zeros((2 * size + 1, 2 * size + 1))
    matrix[:size, size:-1] = np.eye(size)
    matrix[size:-1, :size] = -stiffness / l0 / m * laplace
    matrix[size:-1, size:-1] = -damping / l0 / m * laplace
    matrix[size:-1, -1] = -9.81
    begin = np.zeros(2 * size + 1)
    begin[-1] = 1.0
    moves = (expm(2.0 * matrix) @ begin)[:size]
    inner = system.nodes_of[1][1:-1]
    assert state.x[2, inner] - x[2, inner] == pytest.approx(moves, abs=0.01 * np.abs(moves).max())


def drogue() -> tuple[System, np.ndarray, float]:
    """A light point that 1 kN pulls down, with a drag area of 10 m^2, and its terminal speed."""
    points = (
        Point(1, "fixed", (0.0, 0.0, -5.0)),
        Point(2, "free", (0.0, 0.0, -50.0), 10.0, 10.0 / 1025.0, 10.0, 0.0, None, (0.0, 0.0, -1000.0)),
    )
    system = System((Line(1, HAIR, 1, 2, 90.0, 1),), points, Water(2000.0))
    return system, np.array([point.position for point in points]).T, math.sqrt(1000.0 / (0.5 * 1025.0 * 10.0))


@pytest.mark.parametrize("h", [1.0, 0.05, 0.005, 1e-3])
def test_a_light_point_with_strong_drag_sinks_at_its_terminal_speed(h):
    system, x, speed = drogue()
    begun = moved(system, x, h, 4.0)
    later = begun.copy()
    advance(system, later, "leapfrog", h, round(4.0 / h))
    assert (begun.x[2, 1] - later.x[2, 1]) / 4.0 == pytest.approx(speed, rel=1e-3)
    assert -velocities(system, later)[2, 1] == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("h", [0.05, 0.01, 1e-3])
def test_a_thin_line_drifts_with_a_current_as_fast_as_the_water(h):
    """Its weight is nothing beside its drag: 1 mm thick, between free ends, in 1.5 m/s."""
    kind = LineType("thread", 1e-3, 1025.0 * math.pi / 4.0 * 1e-6, 1.0, 0.0)
    points = (Point(1, "free", (0.0, 0.0, -20.0)), Point(2, "free", (0.0, 0.0, -10.0)))
    system = System((Line(1, kind, 1, 2, 10.0, 5),), points, Water(50.0), current=(1.5, 0.0, 0.0))
    x = np.zeros((3, 6))
    x[2, system.nodes_of[1]] = np.linspace(-20.0, -10.0, 6)
    # |w| falls as w/(1 + D w t/m), so that the line lags by (m/D) log(1 + D w t/m).
    heavy, half = 2.0 * kind.mass, 0.5 * 1025.0 * 1.2e-3
    lag = heavy / half * math.log(1.0 + half * 1.5 * 4.0 / heavy)
    assert moved(system, x, h, 4.0).x[0] == pytest.approx(1.5 * 4.0 - lag, rel=1e-3 if h < 0.05 else 1e-2)


@pytest.mark.parametrize("damping", [1e9, 1e11])
def test_the_tension_of_a_chain_with_strong_internal_damping_is_that_of_any_step(damping):
    system = with_damping(chain_on_bed(20), damping)
    motion = {2: Shaking((0.0, 0.0, 0.0), 0, 1.5, 7.0)}
    runs = [simulate(system, 3.0, 16, step, motion=motion) for step in (0.005, 0.002, 0.0005)]
    for run in runs[:2]:
        assert run.tension[1][1:] == pytest.approx(runs[2].tension[1][1:], rel=0.01)
        assert np.abs(run.x[1] - runs[2].x[1]).max() < 1e-3


@pytest.mark.parametrize("h", [0.02, 0.005, 1e-3])
def test_a_pendulum_on_a_segment_that_hardly_lengthens_has_the_tension_of_a_rigid_one(h):
    """m g cos(a) + m v^2/l: where the link turns, its damper sees no rate that is not there."""
    kind = LineType("wire", 1e-9, 1e-9, 1e7, 1e11)
    angle, length = 0.9, 2.0
    bob = (length * math.sin(angle), 0.0, -5.0 - length * math.cos(angle))
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "free", bob, 3.0))
    system = System((Line(1, kind, 1, 2, length, 1),), points, NO_WATER, slack_damping=True, bed_stiffness=0.0)
    start = State.still(np.array([point.position for point in points]).T)
    run = simulate(system, 2.0, 21, h, start=start)
    x, v = run.x[1][:, 1] - (0.0, 0.0, -5.0), run.v[1][:, 1]
    expected = 3.0 * (-9.81 * x[:, 2] + (v * v).sum(axis=1)) / length
    assert run.tension[1][1:, 0] == pytest.approx(expected[1:], rel=0.01)
    assert np.linalg.norm(x, axis=1) == pytest.approx(length, abs=1e-4)


@pytest.mark.parametrize("h", [0.05, 0.01, 1e-3])
def test_a_node_sinks_into_a_viscous_bed_at_its_terminal_speed(h):
    heavy, area = 40.0, 0.1 * 10.0
    kind = HAIR._replace(diameter=0.1, mass=heavy / 10.0)
    points = (Point(1, "fixed", (-8.0, 0.0, -10.0)), Point(2, "fixed", (8.0, 0.0, -10.0)))
    system = System((Line(1, kind, 1, 2, 20.0, 2),), points, NO_WATER, bed_stiffness=1e-3, bed_damping=1e5)
    state = moved(system, np.array([[-8.0, 8.0, 0.0], [0.0, 0.0, 0.0], [-10.0, -10.0, -10.01]]), h, 2.0)
    speed = heavy * 9.81 / (area * 1e5)
    assert -10.01 - state.x[2, 2] == pytest.approx(2.0 * speed, rel=0.01)
    assert -velocities(system, state)[2, 2] == pytest.approx(speed, rel=1e-3)


def branched() -> System:
    """Three lines at a free point, two more from it to a body, one to a second body, of all orders of their ends."""
    kind = LineType("rope", 0.05, 9.0, 4e4, 3e3, 0.8, 1.2, 0.3, 0.05)
    places = [
        (1, "fixed", (-9.0, 0.0, -20.0)), (2, "coupled", (9.0, 3.0, -20.0)), (3, "free", (0.0, 0.5, -12.0)),
        (4, "body", (-2.0, 0.0, -3.0), 1), (5, "body", (2.0, 1.0, -3.0), 1), (6, "body", (7.0, 0.0, -2.0), 2),
    ]  # fmt: skip
    points = tuple(Point(*place[:3], body=place[3] if len(place) > 3 else None) for place in places)
    ends = [(1, 3, 3), (3, 2, 4), (3, 4, 5), (5, 3, 2), (6, 5, 1), (6, 3, 3)]
    at = {place[0]: np.array(place[2]) for place in places}
    lines = tuple(
        Line(i, kind, a, b, float(np.linalg.norm(at[a] - at[b])) * 0.97, count)
        for i, (a, b, count) in enumerate(ends, 1)
    )
    rng = np.random.default_rng(2)
    bodies = []
    for number, place in ((1, (0.0, 0.0, -2.0)), (2, (7.5, 0.0, -1.0))):
        square = rng.normal(size=(6, 6))
        bodies.append(MooredBody(number, place, 300.0 * (np.eye(6) + 0.05 * square @ square.T), np.zeros((6, 6)),
                                 50.0 * square @ square.T))  # fmt: skip
    return System(lines, points, Water(20.0), tuple(bodies), slack_damping=True, bed_damping=200.0)


def straight(system: System) -> np.ndarray:
    """Positions (3, n) with the nodes of each line equally far apart."""
    x = np.zeros(system.state_shape)
    for line in system.lines:
        a, b = (np.array(next(p.position for p in system.points if p.id == end)) for end in (line.start, line.end))
        x[:, system.nodes_of[line.id]] = a[:, None] + (b - a)[:, None] * np.linspace(0.0, 1.0, line.segments + 1)
    return x


@pytest.mark.parametrize("strong", [1.0, 1e4])
def test_the_kick_of_branched_lines_and_bodies_is_the_dense_exponential(strong):
    """Slowly moving, so that links do not turn and drag is nothing: M v' = -B v, of second order and with its limit."""
    system = branched()
    kind = system.lines[0].type._replace(damping=3e3 * strong)
    system = dataclasses.replace(system, lines=tuple(line._replace(type=kind) for line in system.lines))
    p, x = system.kernel_view(1.0), straight(system).reshape(-1)
    n = p.cols
    free = np.tile(np.append(p.inverse_masses[: p.nodes] > 0.0, np.ones(n - p.nodes, dtype=bool)), 3)
    rest, columns = np.empty(3 * n), []
    set_acceleration(x, np.zeros(3 * n), 0.0, p, rest)
    small = 1e-7  # [m/s]
    for k in np.flatnonzero(free):
        v, a = np.zeros(3 * n), np.empty(3 * n)
        v[k] = small
        for i, (node, body) in enumerate(p.carried):  # what bodies carry moves with them
            j, move = p.nodes + 2 * body, v.reshape(3, n)
            move[:, node] = move[:, j] + np.cross(move[:, j + 1], p.arms[i])
        set_acceleration(x, v, 0.0, p, a)
        columns.append((a - rest)[free] / small)
    matrix = np.array(columns).T
    begin = np.zeros(3 * n)
    begin[free] = small * np.random.default_rng(1).normal(size=int(free.sum()))
    fastest = np.abs(np.linalg.eigvals(matrix)).max()
    set_inverse_masses(x, p)
    room, errors = make_lines_system(p), []
    for s in (0.2 / fastest, 0.1 / fastest):
        v = begin.copy()
        kick_lines(x, v, np.zeros(3 * n), 0.0, s, p, True, room, np.zeros(3))
        errors.append(np.abs(v[free] - expm(s * matrix) @ begin[free]).max() / small)
    assert errors[0] < 2e-3
    assert errors[1] < 0.15 * errors[0]
    v = begin.copy()
    kick_lines(x, v, np.zeros(3 * n), 0.0, 1e3 / fastest, p, True, room, np.zeros(3))
    slow = expm(1e3 / fastest * matrix) @ begin[free]
    assert np.abs(v[free] - slow).max() < 0.2 * np.abs(begin).max()


def test_the_matrix_of_links_is_factorised_with_all_its_fill():
    system = branched()
    p = system.kernel_view(1.0)
    coupling = coupling_of(p.ends, p.inverse_masses > 0.0, p.carried)
    n = len(p.ends)
    rng = np.random.default_rng(4)
    values = np.concatenate((np.full(n, 20.0), np.zeros(len(coupling.rows_below))))
    dense = 20.0 * np.eye(n)
    column_of = np.repeat(np.arange(n), np.diff(coupling.columns_below))
    for value in {int(row[0]) for row in coupling.products if row[0] >= n}:
        values[value] = rng.normal()
        i, j = coupling.rows_below[value - n], column_of[value - n]
        dense[i, j] = dense[j, i] = values[value]
    right = rng.normal(size=n)
    expected = np.linalg.solve(dense, right)
    factorise(values, coupling.columns_below, coupling.rows_below, coupling.link_targets)
    solve_factorised(values, coupling.columns_below, coupling.rows_below, right)
    assert right == pytest.approx(expected, rel=1e-12, abs=1e-14)


def test_a_line_alone_has_a_tridiagonal_matrix():
    p = chain_on_bed(40).kernel_view(1.0)
    assert len(p.rows_below) == 39
    assert (np.diff(p.columns_below) <= 1).all()
