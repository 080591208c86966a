"""Lines that hang slack, float or lie: they rest in few corrections, with the tensions that MoorPy gives."""

import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, System
from sim.mooring.rest.balance import pull, what_is_left
from sim.mooring.rest.chains import Chains
from sim.mooring.rest.statics import MAX_CORRECTIONS, at_rest
from sim.mooring.tangent import carried_coordinates, free_coordinates
from sim.springs.points.line_arrays import STIFFNESS, LineArrays
from sim.validation import ConvergenceError
from sim.water import Water
from tests.sim.mooring.systems import floating_body

ROPE = LineType("rope", 0.2, 40.0, 2e8)
WEIGHT = (40.0 - 1025.0 * math.pi / 4.0 * 0.2**2) * 9.81  # [N/m] in water


def hanging(length: float, segments: int, anchor: float = -200.0) -> System:
    points = (Point(1, "fixed", (0.0, 0.0, anchor)), Point(2, "coupled", (50.0, 0.0, 0.0)))
    return System((Line(1, ROPE, 1, 2, length, segments),), points, Water(200.0))


def links_matrix(x: np.ndarray, p: LineArrays, along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """The matrix (3 nodes, 3 nodes) of links that resist by `along` and `across` (links,) about x (3, n)."""
    m = p.nodes
    found = np.zeros(9 * m * m)
    a, b = p.ends.T
    r = x[:, b] - x[:, a]
    unit = r / np.maximum(np.linalg.norm(r, axis=0), 1e-12)
    for d in range(3):
        for e in range(3):
            block = (along - across) * unit[d] * unit[e] + (across if d == e else 0.0)
            for i, j, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
                np.add.at(found, (d * m + i) * 3 * m + e * m + j, sign * block)
    return found.reshape(3 * m, 3 * m)


def with_bodies(matrix: np.ndarray, p: LineArrays, start: int) -> np.ndarray:
    """`matrix` (3 nodes, 3 nodes) in free coordinates, plus the bodies' own from column `start` of their rows."""
    free = free_coordinates(p)
    if not len(p.bodies):
        return matrix[np.ix_(free, free)]
    carried, moves = carried_coordinates(p)
    beside = matrix[np.ix_(free, carried)] @ moves
    own = moves.T @ matrix[np.ix_(carried, carried)] @ moves
    for b, row in enumerate(p.bodies):
        own[6 * b : 6 * b + 6, 6 * b : 6 * b + 6] += row[start : start + 36].reshape(6, 6)
    return np.block([[matrix[np.ix_(free, free)], beside], [beside.T, own]])


@pytest.mark.parametrize("ratio", [1.0, 1.004, 1.2, 2.0, 3.0])
@pytest.mark.parametrize("segments", [10, 40, 200, 1000])
def test_a_slack_line_rests_whatever_its_length_and_segments(ratio, segments):
    assert MAX_CORRECTIONS == 60
    length = ratio * 250.0
    rest = hanging(length, segments).at_rest()
    spacing = length / segments
    # The upper part hangs straight: its last link carries what is below the link's middle, to within a segment.
    assert rest.tension[1][-1] == pytest.approx(WEIGHT * (200.0 - 0.5 * spacing), abs=WEIGHT * spacing)
    assert np.abs(np.diff(rest.x[1][: segments // 100 + 1, 2])).max(initial=0.0) < 1e-2  # it lies at the anchor
    assert np.linalg.norm(np.diff(rest.x[1], axis=0), axis=1).max() < spacing * (1.0 + 2.0 * WEIGHT * 200.0 / 2e8)


@pytest.mark.parametrize(
    ("length", "upper", "lower"),
    # MoorPy 1.3.0, solveEquilibrium at 1e-4
    [(210.0, 17121.67, 1821.39), (240.0, 15485.74, 185.33), (249.0, 15311.36, 10.94), (300.0, 15300.42, 0.0)],
)
def test_its_tensions_are_those_of_moorpy(length, upper, lower):
    rest = hanging(length, 400).at_rest()
    assert rest.tension[1][-1] + 0.5 * WEIGHT * length / 400 == pytest.approx(upper, rel=1e-3)
    assert rest.tension[1][0] == pytest.approx(lower, abs=12.0)


def test_a_line_between_high_ends_lies_on_the_bed_between_them():
    rest = hanging(500.0, 60, anchor=-150.0).at_rest()
    heights = rest.x[1][:, 2]
    assert heights.min() > -200.01
    assert (heights < -199.9).sum() > 10
    assert rest.tension[1][0] == pytest.approx(WEIGHT * 50.0, abs=WEIGHT * 500.0 / 60)


@pytest.mark.parametrize("segments", [10, 20, 30, 39, 60])
def test_a_light_line_that_floats_over_short_ends_rests(segments):
    kind = LineType("light", 0.062, 0.97 * 993.683 * math.pi / 4.0 * 0.062**2, 5.4e7, -0.95)
    points = (Point(1, "fixed", (0.0, 0.0, -60.0)), Point(2, "coupled", (10.0, 0.0, -60.0)))
    rest = System((Line(1, kind, 1, 2, 47.34, segments),), points, Water(100.0)).at_rest()
    lift = (1025.0 * kind.volume - kind.mass) * 9.81
    assert rest.x[1][:, 2].max() > -40.0
    steep = np.diff(rest.x[1][:2, 2])[0] / np.linalg.norm(np.diff(rest.x[1][:2], axis=0))
    below = 0.5 * 47.34 * (1.0 - 1.0 / segments)  # of length from the first link's middle to the top
    assert rest.tension[1][0] * steep == pytest.approx(lift * below, rel=0.02)


@pytest.mark.parametrize(
    ("diameter", "fraction", "stiffness", "start", "end", "length", "segments"),
    [
        (0.02, 0.999, 1.26e7, (0.0, -0.01), (18.6, 2.0), 19.09, 80),
        (0.1, 0.999, 2.33e8, (0.0, -25.0), (74.97, -1.0), 86.59, 20),
        (0.039, 0.9999, 5.5e7, (0.0, -0.01), (26.44, 2.0), 27.04, 40),
        (0.02, 0.9999, 1.63e5, (0.0, -20.0), (17.29, 0.0), 26.46, 40),
        (0.1, 1.0001, 3.14e7, (0.0, -50.0), (94.25, 2.0), 118.4, 80),
        (0.2, 0.5, 2.36e8, (0.0, 0.0), (14.92, 0.0), 14.92, 80),
        (0.039, 0.97, 2.05e7, (0.0, 0.0), (505.5, 0.0195), 495.3, 80),
    ],
)
def test_a_line_as_dense_as_water_rests_in_its_surface(diameter, fraction, stiffness, start, end, length, segments):
    kind = LineType("light", diameter, fraction * 1025.0 * math.pi / 4.0 * diameter**2, stiffness)
    points = (Point(1, "fixed", (start[0], 0.0, start[1])), Point(2, "fixed", (end[0], 0.0, end[1])))
    rest = System((Line(1, kind, 1, 2, length, segments),), points, Water(100.0)).at_rest()
    links, weight = np.diff(rest.x[1], axis=0), 9.81 * kind.mass * length / segments
    assert (np.linalg.norm(links, axis=1) <= length / segments * (1.0 + rest.tension[1] / stiffness) + 1e-6).all()
    # Nodes under water all carry the difference of weight and lift; those above it carry the weight.
    pull = np.diff(rest.tension[1] * links[:, 2] / np.linalg.norm(links, axis=1))
    deep, dry = rest.x[1][1:-1, 2] < -length / segments - diameter, rest.x[1][1:-1, 2] > length / segments + diameter
    assert pull[deep] == pytest.approx(weight * (1.0 - 1.0 / fraction), rel=1e-6, abs=1e-6 * weight)
    assert pull[dry] == pytest.approx(weight, rel=1e-6)
    assert np.abs(links[:, 1]).max() < 1e-9


def test_a_stiff_line_far_from_the_origin_rests_to_round_off():
    kind = LineType("stiff", 0.1, 1962.0 / 9.81 + 1025.0 * math.pi / 4.0 * 0.01, 64e9)
    points = (Point(1, "fixed", (0.0, 0.0, -400.0)), Point(2, "fixed", (800.0, 0.0, -300.0)))
    rest = System((Line(1, kind, 1, 2, 1000.0, 500),), points, Water(1000.0), bed_stiffness=0.0).at_rest()
    # 1,288.8 kN at the end itself, and the weight of half a link less in its middle (Irvine's closed form).
    assert rest.tension[1][-1] + 1962.0 * 0.5 * 1000.0 / 500 == pytest.approx(1288.8e3, rel=2e-3)


def test_without_weight_and_tension_every_place_is_at_rest():
    points = (Point(1, "fixed", (0.0, 0.0, -5.0)), Point(2, "fixed", (5.0, 0.0, -5.0)))
    system = System((Line(1, ROPE, 1, 2, 20.0, 10),), points, Water(40.0, gravity=0.0))
    assert np.abs(system.at_rest().tension[1]).max() < 1e-6  # round-off of a stiffness of 1e8 N/m


def test_a_small_mooring_rests_as_its_large_model_does():
    """Forces of a model are those of the original times the cube of the scale: no tolerance is absolute."""
    tension = []
    for scale in (1.0, 1e-4):
        kind = LineType("line", 0.05 * scale, 20.0 * scale**2, 1e7 * scale**3)
        points = (Point(1, "fixed", (-80.0 * scale, 0.0, -40.0 * scale)), Point(2, "fixed", (0.0, 0.0, -1.0 * scale)))
        system = System((Line(1, kind, 1, 2, 95.0 * scale, 20),), points, Water(40.0 * scale), bed_stiffness=3e6)
        tension.append(system.at_rest().tension[1] / scale**3)
    assert tension[1] == pytest.approx(tension[0], rel=1e-6)


def test_what_cannot_rest_says_what_is_left(monkeypatch):
    monkeypatch.setattr("sim.mooring.rest.statics.MAX_CORRECTIONS", 1)
    with pytest.raises(ConvergenceError, match=r"^static state of the mooring: no solution after .* N left$"):
        hanging(300.0, 4).at_rest()


def test_chains_solve_what_the_dense_matrix_does():
    rng = np.random.default_rng(0)
    points = [Point(i, "fixed", (40.0 * math.cos(2.0 * i), 40.0 * math.sin(2.0 * i), -30.0)) for i in range(3)]
    points += [
        Point(9, "free", (0.0, 0.0, -5.0), mass=50.0, volume=3.0), Point(10, "body", (1.0, 0.5, -1.0), body=1),
        Point(11, "body", (-1.0, 0.5, -2.0), body=1),
    ]  # fmt: skip
    lines = [Line(i, ROPE, i, 9, 48.0, 12) for i in range(3)]
    lines += [Line(7, ROPE, 9, 10, 5.0, 1), Line(8, ROPE, 11, 2, 50.0, 7)]
    system = System(tuple(lines), tuple(points), Water(30.0), bodies=(floating_body(10.0),))
    p = system.kernel_view(1.0)
    x = rng.normal(size=(3, p.cols))
    along, across = rng.uniform(1.0, 2.0, len(p.links)), rng.uniform(0.1, 1.0, len(p.links))
    nodes = rng.uniform(0.1, 1.0, p.nodes)[:, None, None] * np.eye(3)
    dense = links_matrix(x, p, along, across)
    dense[np.diag_indices(3 * p.nodes)] += np.tile(nodes[:, 0, 0], 3)
    dense = with_bodies(dense, p, STIFFNESS)
    force = rng.normal(size=len(dense))
    r = x[:, p.ends[:, 1]] - x[:, p.ends[:, 0]]
    unit = (r / np.linalg.norm(r, axis=0)).T
    links = across[:, None, None] * np.eye(3) + (along - across)[:, None, None] * unit[:, :, None] * unit[:, None, :]
    assert Chains(system, p).solve(links, nodes, force) == pytest.approx(np.linalg.solve(dense, force), abs=1e-10)


def test_a_state_at_rest_is_one_for_the_kernels():
    system = hanging(240.0, 40)
    rest = at_rest(system)
    p = system.kernel_view(1.0)
    force, largest = pull(rest.nodes, p)
    assert largest == pytest.approx(rest.tension[1][-1], rel=0.05)  # at the upper end
    assert what_is_left(rest.nodes, p) == (np.abs(force).max(), True)
