"""Statistics of the mooring's tensions: against numpy, without drags, and begun again."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.commands.added_files import with_mooring
from app.messages import GrabTo, Place, Release, RestartStatistics
from app.scenes.mooring import SCENE
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.files.file_scene import FileScene
from app.scenes.mooring.parameters import PRESETS, MooringParams, hidden
from app.scenes.mooring.readings.report import figures_of, kilonewtons, marks_of, notes_of, tension_tables
from app.scenes.mooring.readings.tensions import SETTLING_PERIODS, RunningStatistics, Tensions
from app.scenes.quantities import measured
from app.scenes.setups import make_setup
from sim.numerics.extreme_values import LEAST_PEAKS
from sim.parameters import check_record
from tests.app.scenes.mooring.test_start import FILES

PERIOD = 1.0  # [s] of the waves here
FEW: dict[str, Any] = {"segments": 12, "lines": 2, "time_step": 1 / 240, "wave_period": PERIOD, "wave_height": 0.5}


def snapshot_of(scene: Any) -> Any:
    status = SimpleNamespace(halted="")
    return SimpleNamespace(params=scene.params, frame=scene.frame(), readings=scene.readings(), status=status)


def test_running_statistics_are_those_of_all_numbers_by_their_times():
    rng = np.random.default_rng(3)
    values, times = rng.normal(1e6, 1e3, (500, 3)), rng.uniform(0.01, 0.02, 500)
    found = RunningStatistics(3)
    assert all(math.isnan(number) for end in found.each() for number in end)
    for row, duration in zip(values, times, strict=True):
        found.add(row, duration)
    mean = np.average(values, axis=0, weights=times)
    deviation = np.sqrt(np.average((values - mean) ** 2, axis=0, weights=times))
    expected = np.stack([values.min(axis=0), mean, values.max(axis=0), deviation], axis=1)
    assert np.array(found.each())[:, :4] == pytest.approx(expected, rel=1e-9)
    assert found.duration == pytest.approx(times.sum())


def test_the_scene_has_the_statistics_of_both_ends_of_each_line():
    scene = MooringScene(MooringParams(**FEW))
    samples = [scene.end_tension()[:, ::-1]]
    for _ in range(360):
        scene.advance(1)
        samples.append(scene.end_tension()[:, ::-1])
    all_of = np.array(samples)
    for i, line in enumerate(scene.readings().lines):
        for j, end in enumerate((line.at_fairlead, line.at_anchor)):
            one = all_of[:, i, j]
            assert (end.least, end.largest) == (one.min(), one.max())
            assert (end.mean, end.deviation) == pytest.approx((one[1:].mean(), one[1:].std()), rel=1e-6)
    found = scene.readings()
    assert found.duration == pytest.approx(1.5)
    assert (found.since, found.counts) == (0.0, True)
    assert math.isnan(found.dragged)
    values = measured(SCENE, scene)
    fairleads = all_of[:, :, 0]
    assert values["breaking_load_use"].value == pytest.approx(fairleads.max() / 3450e3)
    assert values["mean_tension"].value == pytest.approx(fairleads[1:].mean(axis=0).max())
    assert values["tension_deviation"].value == pytest.approx(fairleads[1:].std(axis=0).max(), rel=1e-6)


def test_a_drag_and_three_periods_after_it_are_left_out_and_said_apart():
    tensions, up = Tensions(1), np.array([[0.0, 0.0, 1.0]])
    for step in range(1, 101):
        t = 0.1 * step
        if 20 < step <= 40:
            tensions.leave_out(t, PERIOD)
        dragged = 20 < step < 40 + 10 * SETTLING_PERIODS * PERIOD
        pull = 1000.0 if dragged else 10.0 + 0.1 * (step % 2)
        tensions.measure(t, np.array([[5.0, pull]]), 5.0 * up, pull * up)
    (line,) = tensions.readings(np.zeros(1))
    assert line.at_fairlead.largest == pytest.approx(10.1)
    assert line.at_fairlead.mean == pytest.approx(10.05, abs=5e-3)
    assert tensions.dragged == 1000.0
    assert tensions.at_fairlead.duration == pytest.approx(10.0 - 2.0 - SETTLING_PERIODS * PERIOD, abs=0.15)
    assert tensions.most_at[1] < 2.01


@pytest.mark.parametrize("drag", ["body", "anchor", "vessel"])
def test_what_the_mouse_does_leaves_the_numbers_as_they_are(drag):
    if drag == "vessel":
        scene: Any = FileScene(MooringParams(moordyn_file=str(FILES / "shared_line.txt"), time_step=4e-3, **WAVES))
    else:
        scene = MooringScene(MooringParams(**FEW))
    scene.advance(240)
    before = scene.readings()
    scene.handle(Place("anchor 1", (-82.0, 0.0, 0.0)) if drag == "anchor" else GrabTo(0, (8.0, 0.0, 0.0), 1))
    scene.advance(480)
    during = scene.readings()
    assert not during.counts
    assert during.dragged > 0.0
    assert [line.at_fairlead for line in during.lines] == [line.at_fairlead for line in before.lines]
    assert (during.most_offset, during.duration) == (before.most_offset, before.duration)
    assert [line.most_uplift for line in during.lines] == [line.most_uplift for line in before.lines]
    assert during.offset > before.most_offset
    shown = snapshot_of(scene)
    values = {name: quantity.value(shown) for name, quantity in SCENE.quantities.items() if quantity.shown}
    assert (values["dragged_tension"], values["statistics_duration"]) == (during.dragged, before.duration)
    assert SCENE.quantities["dragged_tension"].value(SimpleNamespace(readings=before)) is None
    assert f"while dragged: <b>{kilonewtons(during.dragged)}</b> kN" in notes_of(shown)["Tensions"]
    assert "left out until" in notes_of(shown)["Tensions"]
    scene.handle(Release(1))
    while not scene.readings().counts:
        scene.advance(24)
        assert scene.time < 30.0
    after = scene.readings()
    assert after.duration > before.duration
    assert scene.time - 5.0 * PERIOD < after.duration + 10.0 * PERIOD


WAVES: dict[str, Any] = {"wave_height": 0.5, "wave_period": PERIOD}


def test_the_statistics_begin_again_at_once():
    scene = MooringScene(MooringParams(**FEW))
    scene.advance(240)
    row = scene.take_plot_rows()[-1]
    scene.handle(RestartStatistics())
    found = scene.readings()
    assert (found.since, found.duration) == (pytest.approx(1.0), 0.0)
    for line, now in zip(found.lines, scene.end_tension()[:, 1], strict=True):
        assert line.at_fairlead[:4] == (now, now, now, 0.0)
    assert found.most_offset == found.offset
    scene.advance(240)
    assert scene.readings().duration == pytest.approx(1.0)
    assert scene.take_plot_rows()[-1][5] < row[5] * 1.5  # the largest so far is that since then
    scene.reset()
    assert scene.readings().since == 0.0


def test_the_use_is_of_the_breaking_load_and_without_one_there_is_none():
    scene = MooringScene(MooringParams(**FEW, breaking_load=1000.0))
    largest = max(line.at_fairlead.largest for line in scene.readings().lines)
    shown = snapshot_of(scene)
    assert "<th>use<br>%</th>" in str(tension_tables(shown))
    assert f", {100.0 * largest / 1e6:.2g}\xa0% of breaking load" in str(figures_of(shown))
    assert marks_of(shown)["breaking_load"] == ""
    scene.params = dataclasses.replace(scene.params, breaking_load=0.0)
    shown = snapshot_of(scene)
    assert "use" not in str(tension_tables(shown))
    assert "unknown" in marks_of(shown)["breaking_load"]
    assert "set the breaking load" in notes_of(shown)["Tensions"]
    assert "%" not in str(figures_of(shown))
    assert math.isnan(measured(SCENE, scene)["breaking_load_use"].value)


def test_a_file_has_no_breaking_load_until_one_is_set():
    path = FILES / "chain.txt"
    assert with_mooring(MooringParams(), path, make_setup(SCENE, "")).breaking_load == 0.0
    own = make_setup(SCENE, "", {"breaking_load": 5000.0})
    assert with_mooring(own.params, path, own).breaking_load == 5000.0
    assert "breaking_load" not in hidden(MooringParams(moordyn_file=str(path)))


@pytest.mark.parametrize("preset", PRESETS)
def test_no_preset_begins_near_its_breaking_load(preset):
    params = check_record(MooringParams, PRESETS[preset])
    scene = MooringScene(params)
    largest = max(line.fairlead for line in scene.readings().lines)
    assert params.breaking_load == 0.0 or largest < 0.2 * 1e3 * params.breaking_load


def test_the_tension_of_three_hours_is_expected_from_the_peaks_that_count():
    """Of a sine there is one height; without enough peaks, or while it is dragged, there is not a number."""
    tensions, up = Tensions(1), np.array([[0.0, 0.0, 1.0]])
    for step in range(1, 40 * (LEAST_PEAKS + 3)):
        pull = 50.0 + 20.0 * math.sin(2.0 * math.pi * step / 40.0 - 1e-3)
        if step == 60:
            assert math.isnan(tensions.readings(np.zeros(1))[0].at_fairlead.expected)
        tensions.measure(0.1 * step, np.array([[5.0, pull]]), 5.0 * up, pull * up)
    (line,) = tensions.readings(np.zeros(1))
    assert line.at_fairlead.expected == pytest.approx(70.0, rel=0.01)
    assert math.isnan(line.at_anchor.expected)  # it never rises above its mean
    tensions.restart()
    assert math.isnan(tensions.readings(np.zeros(1))[0].at_fairlead.expected)
