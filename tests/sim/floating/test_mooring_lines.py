"""Elastic mooring lines of many bodies: the catenary of a line without weight, and the surge that they let."""

import math

import numpy as np
import pytest

from sim.floating import Body, Fleet, Hull, make_fleet, step, still_water
from sim.floating.linear.hydrodynamics import linear_hull, natural_frequency
from sim.floating.linear.periods import period
from sim.floating.motion.mooring_lines import MooringLines, fairleads, just_taut, pulls
from sim.floating.motion.rotation import rotation_matrix
from tests.sim.mooring.catenary import catenary

DEPTH, REACH, STIFFNESS = 30.0, 60.0, 2e4  # [m], [m], [N]
LIGHT = 0.05  # [N/m] weight of a line with hardly any


def moored() -> tuple[Fleet, MooringLines]:
    """Two boxes at rest, the second turned and leaning, on lines from their keels."""
    lean = np.array([0.9, 0.2, -0.1, 0.3])
    boxes = [
        Body(Hull.box(2.0, 2.0, 1.0), density=500.0),
        Body(Hull.box(1.0, 1.0, 1.0), density=400.0, position=(9.0, 4.0, 0.1), rotation=lean),
    ]
    fleet = make_fleet(boxes)
    keel, stiffness = np.array([-0.5, -0.5]), np.array([STIFFNESS, 0.3 * STIFFNESS])
    rest = np.array([fleet.position[i] + rotation_matrix(fleet.rotation[i]) @ (0.0, 0.0, -0.5) for i in range(2)])
    return fleet, just_taut(rest, keel, stiffness, DEPTH, REACH)


def test_nothing_pulls_at_rest_and_each_tension_is_that_of_a_catenary_without_weight() -> None:
    fleet, lines = moored()
    six, tension = pulls(lines, fleet.position, fleet.rotation)
    np.testing.assert_allclose(six, 0.0, atol=1e-9)
    np.testing.assert_allclose(tension, 0.0, atol=1e-9)
    position = fleet.position + (2.0, -1.0, 0.6)
    six, tension = pulls(lines, position, fleet.rotation)
    for i in range(2):
        keel = position[i] + rotation_matrix(fleet.rotation[i]) @ (0.0, 0.0, -0.5)
        force = np.zeros(3)
        for k in range(4):
            way = lines.anchors[i, k] - keel
            span, length = math.hypot(*way[:2]), float(lines.length[i, k])
            if np.linalg.norm(way) < length:
                assert tension[i, k] == 0.0
                continue
            found = catenary(length, float(lines.stiffness[i]), LIGHT, span, -way[2], on_bed=False)
            middle = found.vertical - 0.5 * LIGHT * length  # [N] upward pull halfway: weight acts in second order there
            assert tension[i, k] == pytest.approx(math.hypot(found.horizontal, middle), rel=2e-3)
            force += np.append(found.horizontal * way[:2] / span, -middle)
        np.testing.assert_allclose(six[i, :3], force, atol=2e-3 * np.linalg.norm(force))
        np.testing.assert_allclose(six[i, 3:], np.cross(keel - position[i], six[i, :3]), atol=1e-9)
        assert (tension[i] > 0.0).sum() >= 2


@pytest.mark.parametrize("bearing", [0.0, 0.3, 0.8, 2.5, -1.2])
def test_the_stiffness_about_rest_is_that_of_one_line_in_all_level_directions(bearing: float) -> None:
    """EA/L cos^2 of the lines' slope, which is the catenary's rate of H over the span."""
    fleet, lines = moored()
    away = 1e-3 * np.array([math.cos(bearing), math.sin(bearing), 0.0])
    force = pulls(lines, fleet.position + away, fleet.rotation)[0][:, :3]
    place = fairleads(lines, fleet.position, fleet.rotation)
    for i in range(2):
        length, rise = float(lines.length[i, 0]), float(place[i, 2] + DEPTH)
        stiffness = float(lines.stiffness[i]) / length * (REACH / length) ** 2
        spans = math.sqrt(length**2 - rise**2) + np.array([0.9, 1.1])
        level = [catenary(length, float(lines.stiffness[i]), LIGHT, s, rise, on_bed=False).horizontal for s in spans]
        assert (level[1] - level[0]) / 0.2 == pytest.approx(stiffness, rel=0.02)
        np.testing.assert_allclose(force[i, :2], -stiffness * away[:2], atol=1e-5 * stiffness)


def test_a_moored_box_surges_at_the_period_of_its_lines_and_added_mass() -> None:
    """2 pi sqrt((m + A)/K), A that of linear theory at this period; the lines are those in the middle of a step."""
    hull = Hull.box(2.0, 2.0, 1.0)
    fleet = make_fleet([Body(hull, density=512.5)])
    lines = just_taut(fleet.position.copy(), np.array([0.0]), np.array([STIFFNESS]), DEPTH, REACH)
    fleet.position[0, 0] = 0.05
    water, h, crossings = still_water(fleet), 1 / 30, []
    for n in range(3000):
        before = fleet.position[0, 0]
        fleet.mooring[:] = pulls(lines, fleet.position + 0.5 * h * fleet.velocity, fleet.rotation)[0]
        step(fleet, water, h)
        after = fleet.position[0, 0]
        if before > 0.0 >= after:
            crossings.append(h * (n + before / (before - after)))
    length = float(lines.length[0, 0])
    stiffness = STIFFNESS / length * (REACH / length) ** 2
    expected = period(natural_frequency(linear_hull(hull, 0.5), 0, 2.0, stiffness / (1025.0 * 9.81)), 9.81)
    assert np.diff(crossings) == pytest.approx(expected, rel=0.02)
