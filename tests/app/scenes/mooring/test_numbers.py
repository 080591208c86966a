"""Each number and flag that the mooring scene shows, against the library and the state."""

import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest

from app.scenes.mooring import SCENE
from app.scenes.mooring.arrangement import DENSITY, GRAVITY, bearings, first_places, line_types, sections
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.line_scene import FADE
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.readings import report
from app.scenes.mooring.readings.tensions import Tensions
from app.scenes.quantities import measured
from sim.mooring import critical_step
from sim.waves import AMPLITUDE

PARAMS: dict[str, Any] = {"segments": 12, "lines": 2, "steady_force": 15.0, "time_step": 1 / 120, "wave_height": 0.0}


@pytest.fixture(scope="module")
def scene() -> MooringScene:
    """Two lines, pushed away from the first anchor: all four end tensions are different."""
    return MooringScene(MooringParams(**PARAMS))


def snapshot_of(scene: MooringScene) -> Any:
    class Shown:
        frame, readings, params = scene.frame(), scene.readings(), scene.params

    return Shown


def test_tensions_of_both_ends_of_each_line_are_those_of_the_library(scene):
    rest = dataclasses.replace(scene.system, current=(0.0, 0.0, 0.0)).at_rest()
    for i, reading in enumerate(scene.readings().lines):
        tension, ends = rest.tension[10 * (i + 1)], rest.end_tension[10 * (i + 1)]
        assert (reading.anchor, reading.fairlead) == pytest.approx(tuple(ends), rel=1e-6)
        assert (reading.at_anchor.largest, reading.at_fairlead.largest) == (reading.anchor, reading.fairlead)
        assert scene.frame().points[i, 0] == pytest.approx(scene.attached.places.anchors[i], abs=1e-4)
        assert scene.frame().tension[i] == pytest.approx(tension, rel=1e-5)
        first = rest.x[10 * (i + 1)][1] - rest.x[10 * (i + 1)][0]
        up = tension[0] * first[2] / np.linalg.norm(first)
        assert reading.uplift == pytest.approx(max(up, 0.0), abs=1e-3)
        assert bool(scene.frame().uplift[i]) == (up > 0.0)
    assert scene.readings().lines[0].fairlead > 1.2 * scene.readings().lines[1].fairlead


def test_level_forces_of_the_lines_balance_the_steady_force(scene):
    assert scene.force_of_lines() == pytest.approx([-15e3, 0.0], rel=0.05, abs=50.0)
    assert scene.excursion.rest[0] > 0.0


def test_an_anchor_that_is_pulled_upwards_is_flagged_and_one_pushed_down_is_not():
    tensions = Tensions(2)
    up, down = np.array([0.6, 0.0, 0.8]), np.array([0.8, 0.0, -0.6])
    for t, first, second in ((1.0, (10.0, 20.0), (30.0, 5.0)), (3.0, (8.0, 25.0), (31.0, 0.0))):
        at_anchor = np.stack([first[0] * up, second[0] * down])
        at_fairlead = np.stack([-first[1] * up, -second[1] * down])
        tensions.measure(t, np.array([first, second]), at_anchor, at_fairlead)
    first, second = tensions.readings(np.array([7.0, 9.0]))
    assert first[:2] + first[4:7] == pytest.approx((25.0, 8.0, 6.4, 8.0, 7.0))
    assert (first.at_fairlead.largest, first.at_anchor.largest) == (25.0, 10.0)
    assert math.isnan(first.slack_since)
    assert first.slack_fraction == 0.0
    assert second[:2] + second[4:7] == (0.0, 31.0, 0.0, 0.0, 9.0)
    assert (second.at_fairlead.largest, second.at_anchor.largest) == (5.0, 31.0)
    assert (second.slack_since, second.slack_fraction) == (3.0, pytest.approx(2.0 / 3.0))
    assert tensions.most_at == (0, 3.0)


def test_values_for_the_tasks_and_measures_for_sweeps_are_the_readings(scene):
    found, shown, whole = scene.readings(), snapshot_of(scene), measured(SCENE, scene)
    first, p = found.lines[0], scene.params
    expected = {
        "fairlead_tension": first.fairlead, "anchor_tension": first.anchor, "uplift": first.uplift,
        "largest_tension": max(line.at_fairlead.largest for line in found.lines), "line_1_lying_length": first.lying,
        "hanging_length": p.length - first.lying, "line_1_slack_fraction": 0.0, "offset": found.offset,
        "fairlead_height": float(scene.points[0, -1, 2]) + p.depth,
        "line_weight": 9.81 * (80.0 - 1025.0 * math.pi / 4.0 * 0.09**2),
        "largest_tension_line": 1, "largest_tension_time": 0.0, "statistics_start": 0.0, "statistics_duration": 0.0,
    }  # fmt: skip
    assert {name: SCENE.quantities[name].value(shown) for name in expected} == pytest.approx(
        expected, rel=1e-5, abs=1e-9
    )
    expected = {
        "largest_tension": max(line.at_fairlead.largest for line in found.lines),
        "largest_at_anchor": max(line.at_anchor.largest for line in found.lines),
        "largest_uplift": max(line.most_uplift for line in found.lines), "slack_fraction": 0.0,
        "lying_length": found.lines[0].lying + found.lines[1].lying, "largest_offset": found.most_offset,
        "heave": float(scene.state.x[2, scene.system.node_count]),
        "critical_step": critical_step(scene.system, "leapfrog"), "rest_stretch": float(scene.start.stretch.max()),
        "least_tension": min(line.fairlead for line in found.lines),  # of one sample
        "mean_tension": max(line.fairlead for line in found.lines), "tension_deviation": 0.0,
        "breaking_load_use": max(line.fairlead for line in found.lines) / 3450e3,
    }  # fmt: skip
    assert {name: whole[name].value for name in expected} == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_the_panel_says_the_readings(scene):
    shown, found = snapshot_of(scene), scene.readings()
    table = str(report.tension_tables(shown))
    for line in found.lines:
        for force in (line.fairlead, line.anchor, line.at_fairlead.largest, line.at_anchor.largest):
            assert report.kilonewtons(force) in table
    order = [
        table.index(f"<td>{report.kilonewtons(one)}</td>") for one in (found.lines[0].fairlead, found.lines[0].anchor)
    ]
    assert order == sorted(order)
    assert report.kilonewtons(found.lines[0].fairlead) in str(report.figures_of(shown))
    assert report.kilonewtons(1500.0).startswith("1.5")
    slack = found.lines[0]._replace(slack_since=2.0)
    assert "since 3" in str(report.slack_text(slack, 5.0))
    assert str(report.slack_text(found.lines[0], 5.0)) == "never"
    assert "25" in str(report.slack_text(found.lines[0]._replace(slack_fraction=0.25), 5.0))
    assert f"{report.kilonewtons(2.0 * scene.start.scale)} kN" in str(report.readout_of(shown))


def test_lying_length_counts_links_with_both_ends_on_the_bed(scene):
    down = scene.points[:, :, 2] <= -scene.params.depth
    expected = (down[:, 1:] & down[:, :-1]).sum(axis=1) * scene.params.length / scene.params.segments
    assert scene.lying() == pytest.approx(expected)
    assert 0.0 < scene.lying()[0] < scene.lying()[1]  # the slack line lies longer


def test_rows_of_the_plots_are_both_ends_in_kilonewtons(scene):
    scene.plot_rows.restart()
    scene.add_plot_row()
    row = np.array(scene.take_plot_rows())[-1]
    found = scene.readings()
    fairleads, anchors = ([getattr(line, end) for line in found.lines] for end in ("fairlead", "anchor"))
    assert 1e3 * row[1:3] == pytest.approx(fairleads)
    assert 1e3 * row[5] == pytest.approx(max(fairleads))
    assert 1e3 * row[6:8] == pytest.approx(anchors)
    assert np.isnan(row[[3, 4, 8, 9]]).all()
    assert row[10] == pytest.approx(found.offset)


def test_offset_is_level_and_from_the_place_of_rest(scene):
    moved = MooringScene(MooringParams(**PARAMS))
    moved.state.x[:, moved.system.node_count] += (3.0, 4.0, 12.0)
    moved.measure()
    assert moved.readings().offset == pytest.approx(5.0)
    moved.state.x[:, moved.system.node_count] -= (3.0, 4.0, 12.0)
    moved.measure()
    assert (moved.excursion.offset, moved.excursion.largest) == (pytest.approx(0.0, abs=1e-9), pytest.approx(5.0))


def test_waves_and_current_begin_smoothly():
    scene = MooringScene(MooringParams(**{**PARAMS, "wave_height": 3.0, "current": 0.8, "regular": True}))
    fades = []
    for t in (0.0, 0.25 * FADE, 0.5 * FADE, FADE, 3.0 * FADE):
        scene.state.t = t
        fades.append(scene.fade)
        driven = scene.driven()
        if t < FADE:
            p = scene.system.kernel_view(1.0)
            assert driven["current"] == pytest.approx(fades[-1] * p.current)
            assert driven["waves"][AMPLITUDE] == pytest.approx(fades[-1] * p.waves[AMPLITUDE])
            assert driven["waves"][:AMPLITUDE] == pytest.approx(p.waves[:AMPLITUDE])
        else:
            assert driven == {}
    assert fades == pytest.approx([0.0, 0.15625, 0.5, 1.0, 1.0])


@pytest.mark.parametrize("lines", [1, 3, 4])
def test_anchors_stand_evenly_about_the_body_the_first_up_wave(lines):
    params = MooringParams(lines=lines, direction=30.0)
    places = first_places(params)
    assert bearings(params)[0] == pytest.approx(math.radians(210.0))
    assert np.diff(bearings(params)) == pytest.approx(np.full(lines - 1, 2.0 * math.pi / lines))
    for anchor, fairlead, bearing in zip(places.anchors, places.fairleads, bearings(params), strict=True):
        assert anchor == pytest.approx((80.0 * math.cos(bearing), 80.0 * math.sin(bearing), -40.0))
        assert fairlead == pytest.approx((4.5 * math.cos(bearing), 4.5 * math.sin(bearing), -0.5 * 0.55 * 9.0))


def test_the_part_with_floats_lifts_by_its_share():
    params = MooringParams(floats=True, lift=300.0)
    _, lifted = line_types(params)
    assert (DENSITY * lifted.volume - lifted.mass) * GRAVITY == pytest.approx(300.0)
    parts = sections(params)
    assert [round(length / params.length, 3) for _, length, _ in parts] == [0.4, 0.25, 0.35]
    assert sum(count for _, _, count in parts) == params.segments
    assert [kind.name for kind, _, _ in parts] == ["line", "line with floats", "line"]


def test_the_table_of_the_bed_numbers_lines_from_1(scene):
    text = str(report.bed_table(snapshot_of(scene)))
    count = len(scene.readings().lines)
    assert re.findall(r"<tr><td>(-?\d+)</td>", text) == [str(number) for number in range(1, count + 1)]
