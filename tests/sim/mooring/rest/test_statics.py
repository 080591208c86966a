"""Lines at rest, against MoorPy's catenary, MoorDyn and the balance of forces."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System
from sim.water import Water
from tests.sim.mooring.catenary import catenary
from tests.sim.mooring.systems import chain_on_bed, floating_body, taut_rope

# Of 200 random lines, on the bed and free: made with MoorPy 1.3.0 at a tolerance of 1e-10 of the length.
with (Path(__file__).parent / "catenaries.csv").open(newline="") as file:
    CASES = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
GRAVITY, DENSITY = 9.81, 1025.0


def system_of(case: dict[str, float], segments: int) -> System:
    """A line of no volume between the case's ends."""
    kind = LineType("line", 1e-6, case["weight"] / GRAVITY, case["stiffness"])
    low = -case["rise"] if case["on_bed"] else -case["rise"] - 1.0
    depth = case["rise"] if case["on_bed"] else 2.0 * case["length"]
    points = (Point(1, "fixed", (0.0, 0.0, low)), Point(2, "fixed", (case["span"], 0.0, low + case["rise"])))
    # The bed presses by area: of so thin a line it must be the stiffer to leave the line at its height.
    return System(
        (Line(1, kind, 1, 2, case["length"], segments),), points, Water(depth), bed_stiffness=case["weight"] * 1e10
    )


def test_the_catenary_is_that_of_moorpy():
    for case in CASES:
        found = catenary(*(case[name] for name in ("length", "stiffness", "weight", "span", "rise")),
                         on_bed=bool(case["on_bed"]))  # fmt: skip
        tension = math.hypot(case["horizontal"], case["vertical"])
        assert found.horizontal == pytest.approx(case["horizontal"], abs=1e-6 * tension)
        assert found.vertical == pytest.approx(case["vertical"], abs=1e-6 * tension)
        lower = 0.0 if found.lying > 0.0 else found.vertical - found.weight * found.length
        ends = math.hypot(found.horizontal, lower), math.hypot(found.horizontal, found.vertical)
        assert found.tension(np.array([0.0, found.length])) == pytest.approx(ends, rel=1e-12)


def upper_tension(case: dict[str, float], segments: int) -> float:
    """Continuum limit of the tension at the upper end: of the last segment, and the weight above its middle."""
    rest = system_of(case, segments).at_rest()
    x, last = rest.x[1], rest.tension[1][-1]
    step = (x[-1] - x[-2]) / np.linalg.norm(x[-1] - x[-2])
    above = 0.5 * case["weight"] * case["length"] / segments
    return float(np.linalg.norm(last * step + np.array([0.0, 0.0, above])))


@pytest.mark.parametrize("cases", [CASES[:6], pytest.param(CASES, marks=pytest.mark.stress)], ids=["few", "all"])
def test_lines_of_segments_come_near_the_catenary(cases):
    """The error falls with shorter segments; the bound holds if one is shorter than half the lowest radius, H/w."""
    errors, resolved = [], []
    for case in cases:
        exact = math.hypot(case["horizontal"], case["vertical"])
        errors.append([abs(upper_tension(case, n) / exact - 1.0) for n in (25, 100)])
        resolved.append(case["length"] / 100 < 0.5 * case["horizontal"] / case["weight"])
    coarse, fine = np.array(errors).T
    assert np.mean(resolved) > 0.5
    assert fine[resolved].max() < 2e-3
    # A node near the point of touchdown moves the tension by some 1e-4, to either side.
    assert np.all(fine < np.maximum(0.4 * coarse, 2e-4))


@pytest.mark.parametrize(
    ("system", "last", "first"),
    # MoorDyn 2.7.2 at rest; its chain of 20 segments is still swinging there, and is left out.
    [(chain_on_bed(40), 44664.0, 17181.0), (taut_rope(20), 26625.0, 26710.0)],
)
def test_tensions_at_rest_are_those_of_moordyn(system, last, first):
    rest = system.at_rest()
    assert rest.tension[1][-1] == pytest.approx(last, rel=2e-3)
    assert rest.tension[1][0] == pytest.approx(first, rel=2e-3)


def test_three_lines_meet_at_a_free_point_in_balance():
    kind = LineType("rope", 0.05, 10.0, 1e7)
    points = [Point(i, "fixed", (40 * math.cos(2 * i), 40 * math.sin(2 * i), -30.0)) for i in range(3)]
    points.append(Point(9, "free", (0.0, 0.0, -5.0), mass=50.0, volume=3.0))
    system = System(tuple(Line(i, kind, i, 9, 48.0, 12) for i in range(3)), tuple(points), Water(30.0))
    rest = system.at_rest()
    pull = np.zeros(3)
    for i in range(3):
        step = rest.x[i][-2] - rest.x[i][-1]
        pull += rest.tension[i][-1] * step / np.linalg.norm(step)
        half = 48.0 / 12 / 2 * (10.0 - DENSITY * math.pi / 4 * 0.05**2)
        pull[2] -= half * GRAVITY
    pull[2] += (3.0 * DENSITY - 50.0) * GRAVITY
    assert np.abs(pull).max() < 1e-3
    for i in range(3):
        assert np.array_equal(rest.x[i][-1], rest.x[0][-1])


def test_a_body_at_rest_balances_its_lines():
    kind = LineType("chain", 0.05, 60.0, 2e8)
    ends = [(math.cos(a), math.sin(a)) for a in (0.3, 2.5, 4.4)]
    anchors = tuple(Point(i, "fixed", (60 * c, 60 * s, -20.0)) for i, (c, s) in enumerate(ends))
    fairleads = tuple(Point(10 + i, "body", (2 * c, 2 * s, -1.0), body=1) for i, (c, s) in enumerate(ends))
    body = floating_body()
    lines = tuple(Line(i, kind, i, 10 + i, 64.0, 16) for i in range(3))
    rest = System(lines, anchors + fairleads, Water(20.0), bodies=(body,)).at_rest()
    force = -np.asarray(body.stiffness) @ rest.bodies[1]
    for i, fairlead in enumerate(fairleads):
        step = rest.x[i][-2] - rest.x[i][-1]
        pull = rest.tension[i][-1] * step / np.linalg.norm(step)
        pull[2] -= 64.0 / 16 / 2 * (60.0 - DENSITY * math.pi / 4 * 0.05**2) * GRAVITY
        force += np.concatenate((pull, np.cross(fairlead.position, pull)))
    assert np.abs(force).max() < 1e-6 * 2e5
    assert rest.bodies[1][2] < -0.01  # the chains pull it down


def test_a_line_that_floats_hangs_upside_down():
    kind = LineType("float", 0.3, 20.0, 1e8)
    points = (Point(1, "fixed", (0.0, 0.0, -80.0)), Point(2, "fixed", (60.0, 0.0, -80.0)))
    rest = System((Line(1, kind, 1, 2, 70.0, 30),), points, Water(80.0)).at_rest()
    found = catenary(70.0, 1e8, (DENSITY * math.pi / 4 * 0.09 - 20.0) * GRAVITY, 60.0, 0.0, on_bed=False)
    assert rest.x[1][15, 2] + 80.0 == pytest.approx(-found.shape(np.array([35.0]))[1][0], rel=2e-3)
