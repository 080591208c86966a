"""Shaken ropes from taut to mostly slack, against MoorDyn's law of a segment.

`moordyn_slack.csv` was made with MoorDyn 2.7.2: the signed tension of the last segment, GetLineNodeTen along it, with
RK4 at steps of 1e-4 s, no initial relaxation, and the upper end's place and velocity every 0.02 s. A rope of 95 m,
d = 0.04 m, EA = 1.5e6 N, BA = -0.8, Can = 1, Cdn = 1.2, Cdt = 0.05, its mass per length and the anchor's x [m] as in
the row, from the bed at 50 m to the origin. The end moves along the axis by 0.8 m in 6.5 s, faded in over 10 s. Mean
and first harmonic are fits, with the second, over the last three of seven periods. The last column is the fraction of
slack segments, in the second half.
"""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System, simulate, write_moordyn
from sim.mooring import read_moordyn as read
from sim.water import Water
from tests.sim.mooring.systems import Shaking

LENGTH, PERIOD, DURATION, FRAMES = 95.0, 6.5, 45.5, 2276
with Path(__file__).with_name("moordyn_slack.csv").open(encoding="utf-8") as file:
    ROWS = [tuple(map(float, row.values())) for row in csv.DictReader(file)]


def rope(mass: float, anchor: float, segments: float) -> System:
    kind = LineType("rope", 0.04, mass, 1.5e6, -0.8, 1.0, 1.2, 0.0, 0.05)
    points = (Point(1, "fixed", (anchor, 0.0, -50.0)), Point(2, "coupled", (0.0, 0.0, 0.0)))
    return System((Line(1, kind, 1, 2, LENGTH, int(segments)),), points, Water(50.0))


def shaken(system: System, axis: float):
    """Mean, first harmonic and least tension [N] of the last segment, and the fraction of slack segments."""
    motion = {2: Shaking((0.0, 0.0, 0.0), int(axis), 0.8, PERIOD)}
    run = simulate(system, DURATION, FRAMES, motion=motion)
    late = run.t > DURATION - 3.0 * PERIOD + 1e-9
    angle = 2.0 * math.pi / PERIOD * run.t[late]
    columns = [np.ones_like(angle), *(f(n * angle) for n in (1, 2) for f in (np.cos, np.sin))]
    fit = np.linalg.lstsq(np.stack(columns, axis=1), run.tension[1][late, -1], rcond=None)[0]
    lengths = np.linalg.norm(np.diff(run.x[1][FRAMES // 2 :], axis=1), axis=2)
    slack = (lengths <= LENGTH / run.tension[1].shape[1]).mean()
    return fit[0], math.hypot(fit[1], fit[2]), run.tension[1].min(), slack


@pytest.mark.parametrize(
    "row", [pytest.param(row, marks=pytest.mark.long) if row[3] > 50 else row for row in ROWS], ids=str
)
def test_a_rope_of_a_file_has_the_tension_that_moordyn_has(row, tmp_path):
    mass, anchor, axis, segments, mean, first, share = row
    write_moordyn(rope(mass, anchor, segments), tmp_path / "rope.txt")
    found = shaken(read(tmp_path / "rope.txt"), axis)
    assert found[0] == pytest.approx(mean, rel=0.03)
    assert found[1] == pytest.approx(first, rel=0.08)
    assert found[3] == pytest.approx(share, abs=0.02)


def test_a_slack_rope_that_is_no_file_s_has_no_tension_where_it_is_slack_and_nearly_moordyn_s_mean():
    mass, anchor, axis, segments, mean, first, _ = ROWS[1]
    found = shaken(rope(mass, anchor, segments), axis)
    assert found[2] == 0.0
    assert found[0] == pytest.approx(mean, rel=0.03)
    assert found[1] == pytest.approx(first, rel=0.08)
