"""Tensions at the ends of lines, and lines that never push."""

import dataclasses
import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, State, System, point_forces, simulate
from sim.springs.forces.links import set_tensions
from sim.springs.points.acceleration import set_acceleration
from sim.water import Water
from tests.sim.mooring.catenary import catenary
from tests.sim.mooring.systems import Shaking

CHAIN = LineType("chain", 0.1, 100.0, 5e8)
WEIGHT = 9.81 * (CHAIN.mass - 1025.0 * CHAIN.volume)  # [N/m] in water


def chain(segments: int, top: float = 0.0, length: float = 210.0, is_turned: bool = False) -> System:
    points = (Point(1, "fixed", (0.0, 0.0, -50.0)), Point(2, "coupled", (195.0, 0.0, top), mass=50.0))
    ends = (2, 1) if is_turned else (1, 2)
    return System((Line(1, CHAIN, *ends, length, segments),), points, Water(50.0))


@pytest.mark.parametrize("top", [0.0, -1.0])
@pytest.mark.parametrize("is_turned", [False, True])
def test_tensions_at_the_ends_are_those_of_the_catenary(top, is_turned):
    """At 20 segments the last segment's own is 2.4 to 2.7 % smaller than the tension at the fairlead."""
    rest = chain(20, top, is_turned=is_turned).at_rest()
    exact = catenary(210.0, CHAIN.stiffness, WEIGHT, 195.0, 50.0 + top).tension(np.array([0.0, 210.0]))
    found = rest.end_tension[1][::-1] if is_turned else rest.end_tension[1]
    assert found[1] == pytest.approx(exact[1], rel=3e-3)
    assert found[0] == pytest.approx(exact[0], rel=4e-3)  # the bed bears the half segment there
    assert rest.tension[1].max() < 0.98 * exact[1]


def test_tensions_at_the_ends_of_a_hanging_line_bear_its_weight():
    """Straight down from a point: nothing at the lower end, and all of the weight at the upper one."""
    points = (Point(1, "free", (0.0, 0.0, -40.0)), Point(2, "fixed", (0.0, 0.0, -10.0)))
    rest = System((Line(1, CHAIN, 1, 2, 30.0, 6),), points, Water(100.0)).at_rest()
    assert rest.end_tension[1] == pytest.approx([0.0, 30.0 * WEIGHT], abs=1e-5 * WEIGHT)


@pytest.mark.parametrize("bending", [0.0, 3e5])
def test_tensions_at_the_ends_are_the_forces_on_the_holders(bending):
    """Those of one line at a point without a mass; of two lines each has its own share."""
    kind = CHAIN._replace(bending=bending, diameter=0.2, stiffness=5e7)
    points = (
        Point(1, "fixed", (0.0, 0.0, -40.0)), Point(2, "coupled", (60.0, 0.0, 0.0)),
        Point(3, "fixed", (130.0, 20.0, -45.0)),
    )  # fmt: skip
    lines = (Line(1, kind, 1, 2, 78.0, 12), Line(2, kind, 2, 3, 88.0, 9))
    system = System(lines, points, Water(50.0), current=(0.3, 0.0, 0.0))
    run = simulate(system, 2.0, 5, motion={2: Shaking((60.0, 0.0, 0.0), 2, 2.0, 3.0)})
    assert run.end_tension[1].shape == (5, 2)
    assert run.end_tension[1][:, 0] == pytest.approx(np.linalg.norm(run.force[1], axis=1), rel=1e-9)
    assert run.end_tension[2][:, 1] == pytest.approx(np.linalg.norm(run.force[3], axis=1), rel=1e-9)
    state = State.at_rest(system)
    p = system.kernel_view(1.0)
    each = system.line_ends.forces(state.x, state.v, 0.0, p)
    assert each[1] + each[2] == pytest.approx(point_forces(system, state)[2], rel=1e-9)


def test_an_end_on_the_bed_has_no_weight_and_one_above_it_has():
    rest = chain(10, length=240.0).at_rest()
    horizontal = rest.end_tension[1][0]
    assert horizontal == pytest.approx(rest.tension[1][0], rel=1e-6)
    high = dataclasses.replace(chain(10), points=(Point(1, "fixed", (0.0, 0.0, -20.0)), chain(10).points[1]))
    rest = high.at_rest()
    force = point_forces(high, State.still(rest.nodes))[1]
    assert rest.end_tension[1][0] == pytest.approx(float(np.linalg.norm(force)), rel=1e-9)


@pytest.mark.parametrize("slack_damping", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_no_link_pushes_however_fast_it_shortens_except_by_the_law_of_moordyn(seed, slack_damping):
    rng = np.random.default_rng(seed)
    kind = LineType("wire", 0.02, 1.0, 4000.0, 50.0)
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "fixed", (0.0, 4.0, 0.0)))
    system = System(
        (Line(1, kind, 1, 2, 3.0, 8),), points, Water(10.0, density=0.0), bed_stiffness=0.0, slack_damping=slack_damping
    )
    p, n, pushes = system.kernel_view(1.0), 9, 0
    for _ in range(50):
        x, v = rng.normal(0.0, 0.5, 3 * n), rng.normal(0.0, 50.0, 3 * n)
        tension, a = np.empty(8), np.empty(3 * n)
        set_tensions(x, v, p, tension)
        r, dv = (np.diff(one.reshape(3, n)[:, system.nodes_of[1]]) for one in (x, v))
        length = np.linalg.norm(r, axis=0)
        rest, k, c = p.links[0, :3]
        elastic = k * np.maximum(length - rest, 0.0)
        damping = c * (r * dv).sum(axis=0) / length
        expected = elastic + damping
        pushes += int((expected < 0.0).sum())
        if not slack_damping:
            expected = np.where(length > rest, np.maximum(expected, 0.0), 0.0)
            assert tension.min() >= 0.0
        assert tension == pytest.approx(expected, rel=1e-9, abs=1e-9)
        set_acceleration(x, v, 0.0, p, a)
        inner, pull = system.nodes_of[1][1:-1], tension * r / length
        expected = np.diff(pull) / p.mass[inner] + [[0.0], [0.0], [-9.81]]
        assert a.reshape(3, n)[:, inner] == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert pushes > 20


@pytest.mark.parametrize("integrator", ["leapfrog", "rk4"])
@pytest.mark.parametrize("slack_damping", [False, True])
def test_a_chain_that_snaps_and_goes_slack_pushes_only_by_the_law_of_moordyn(integrator, slack_damping):
    """The account of the energy balances."""
    system = dataclasses.replace(chain(8, -2.0), slack_damping=slack_damping)
    motion = {2: Shaking((195.0, 0.0, -2.0), 0, 12.0, 4.0)}
    run = simulate(system, 6.0, 121, 2.5e-4, integrator=integrator, motion=motion, with_account=True)
    if slack_damping:
        assert run.tension[1].min() < -1000.0
    else:
        assert run.tension[1].min() == 0.0
    assert math.isfinite(run.tension[1].max())
    assert np.abs(run.energy.error).max() < 2e-3 * np.abs(run.energy.work).max()


@pytest.mark.parametrize("segments", [1, 2])
@pytest.mark.parametrize("turned", [(1, 2), (2, 1)])
def test_lines_side_by_side_have_the_end_tensions_that_each_has_alone(segments, turned):
    """A heavy chain beside a light, taut rope, in either order and direction, between the same two points."""
    chain, rope = LineType("chain", 0.1, 200.0, 1e8), LineType("rope", 0.05, 5.0, 1e7)
    points = (Point(1, "fixed", (-60.0, 0.0, -30.0)), Point(2, "coupled", (0.0, 0.0, -1.0)))
    lines = (Line(1, chain, 1, 2, 70.0, segments), Line(2, rope, *turned, 60.0, segments))
    alone = {
        line.id: System((line,), points, Water(100.0), bed_stiffness=0.0).at_rest().end_tension[line.id]
        for line in lines
    }
    for order in (lines, lines[::-1]):
        rest = System(order, points, Water(100.0), bed_stiffness=0.0).at_rest()
        for one, expected in alone.items():
            assert rest.end_tension[one] == pytest.approx(expected, rel=1e-9)


def test_a_system_of_lines_costs_in_proportion_to_their_number():
    """Counted in comparisons of their ids, as time is noisy."""

    def comparisons(n: int) -> int:
        points = tuple(
            point for i in range(n)
            for point in (
                Point(CountedId(2 * i + 1), "fixed", (-60.0, i, -30.0)),
                Point(CountedId(2 * i + 2), "coupled", (0.0, i, -1.0)),
            )
        )  # fmt: skip
        lines = tuple(Line(i + 1, CHAIN, CountedId(2 * i + 1), CountedId(2 * i + 2), 70.0, 2) for i in range(n))
        CountedId.compared = 0
        _ = System(lines, points, Water(30.0)).line_ends
        return CountedId.compared

    few, many = comparisons(50), comparisons(200)
    assert 0 < few < many < 4.5 * few


class CountedId(int):
    """An id that counts how often it is compared."""

    compared = 0

    def __eq__(self, other: object) -> bool:
        CountedId.compared += 1
        return int(self) == other

    def __hash__(self) -> int:
        return int(self)
