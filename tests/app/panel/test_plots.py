"""The scales of the charts."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.messages import ChartLine, RunState, Snapshot, Status
from app.panel.plots import KEPT_DASH, SHOWN_ROWS, Plots, at_times, beside, gaps_in, with_kept, without
from app.scenes import scene_named
from app.scenes.charts import Chart, lines_of, with_numbers

STATUS = Status(RunState.RUNNING, 1.0, 1, 1.0, 1.0, False, 20.0, "")


def test_kept_curves_stand_at_their_times_beside_those_of_the_next_run() -> None:
    kept = [(0.0, 0.0), (1.0, 2.0), (2.0, math.nan), (3.0, 6.0)]
    now = np.array([(0.5, 1.0), (1.5, 3.0)])
    before = np.array(beside([tuple(row) for row in now.tolist()], kept))
    assert before[:, 0].tolist() == [1.0, 2.0, 3.0]
    times = np.union1d(now[:, 0], before[:, 0])
    assert times.tolist() == [0.5, 1.0, 1.5, 2.0, 3.0]
    np.testing.assert_array_equal(at_times(times, now, 1), [1.0, 2.0, 3.0, math.nan, math.nan])
    np.testing.assert_array_equal(at_times(times, before, 1), [math.nan, 2.0, math.nan, math.nan, 6.0])
    assert beside([], kept) == kept
    assert len(beside([(5e3, 0.0)], [(float(t), 0.0) for t in range(10_000)])) == SHOWN_ROWS


def test_a_whole_chart_shows_the_kept_lines_but_no_kept_areas() -> None:
    area, line = ChartLine("floor", "#808080", fill="#808080"), ChartLine("rope 1", "#0072B2", 2.0, (1.0, 1.0))
    now = Chart("t [s]", (area, line), (np.array([0.0, 1.0]), np.zeros(2), np.array([1.0, 2.0])), 2.0)
    before = Chart("t [s]", (area, line), (np.array([0.0, 2.0, 4.0]), np.ones(3), np.array([5.0, 6.0, 7.0])), 5.0)
    both = with_kept(now, before)
    assert [(one.label, one.dash, one.fill) for one in both.lines] == [
        ("floor", (), "#808080"),
        ("rope 1", (1.0, 1.0), ""),
        ("rope 1, kept", KEPT_DASH, ""),
    ]
    assert (both.first, both.end) == ("t [s]", 5.0)
    times, floor, rope, kept = both.columns
    np.testing.assert_array_equal(times, [0.0, 1.0, 2.0, 4.0])
    np.testing.assert_array_equal(floor, [0.0, 0.0, math.nan, math.nan])
    np.testing.assert_array_equal(rope, [1.0, 2.0, math.nan, math.nan])
    np.testing.assert_array_equal(kept, [5.0, 5.5, 6.0, 7.0])


def test_the_curves_of_a_race_are_kept_and_dropped() -> None:
    kind = scene_named("race")
    scene = kind.make(kind.params(ropes=2, points=5, plot_errors=False, plot_energies=False))
    server: Any = None  # no chart is open
    plots = Plots(server, kind)
    for _ in range(3):
        scene.advance(100)
        snapshot: Any = Snapshot(1, scene.frame(), STATUS, None, scene.params, scene.curves())
        plots.update(snapshot, [])
    chart = plots.curves["plot_errors"]
    assert isinstance(chart, Chart)
    assert plots.keep(True) == chart.columns[0][-1] > 0.0
    assert plots.kept_curves["plot_errors"] is chart
    assert plots.keep(False) is None
    assert not plots.kept_curves


@pytest.mark.parametrize("place", [0.0, 0.3, 0.5, 0.75, 1.0])
def test_the_rows_about_a_moment_hold_it_and_move_in_steps_of_half_a_chart(place: float) -> None:
    rows = [(0.1 * i,) for i in range(5 * SHOWN_ROWS + 7)]
    plots, moment = SimpleNamespace(rows=rows), place * rows[-1][0]
    shown = Plots.rows_about(plots, moment)  # type: ignore[arg-type]
    assert shown[0][0] <= moment <= shown[-1][0] + 0.1
    assert len(shown) == SHOWN_ROWS
    first = rows.index(shown[0])
    assert first % (SHOWN_ROWS // 2) == 0 or first == len(rows) - SHOWN_ROWS
    assert Plots.rows_about(plots, None) == rows[-SHOWN_ROWS:]  # type: ignore[arg-type]


def test_a_curve_is_sent_once_and_again_with_other_columns_or_other_kept_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.panel.plots.chart_of", lambda _, columns: columns)
    monkeypatch.setattr("app.panel.plots.with_kept", lambda chart, kept: (chart, kept))
    sent: list[object] = []
    plots = SimpleNamespace(
        curves={"a": "one"}, kept_curves={}, sent_curves={}, kind=SimpleNamespace(curves={"a": None}),
        send=lambda _, chart: sent.append(chart),
    )  # fmt: skip
    for change in ({}, {"curves": {"a": "two"}}, {"kept_curves": {"a": "one"}}, {"kept_curves": {}}):
        vars(plots).update(change)
        for _ in range(3):
            Plots.send_curves(plots, frozenset({"a"}))  # type: ignore[arg-type]
    assert sent == ["one", "two", ("two", "one"), "two"]
    vars(plots).update(curves={"a": "three"})
    Plots.send_curves(plots, frozenset())  # type: ignore[arg-type]
    assert len(sent) == 4


def test_a_line_without_a_number_is_in_no_key() -> None:
    kind, lines = scene_named("mooring"), lines_of(scene_named("mooring").plots["plot_tension"].series)
    scene: Any = kind.make(kind.params(lines=3, segments=10))
    scene.advance(60)
    table = np.array(scene.take_plot_rows()).T
    columns = [table[1 + kind.series.index(line.label)] for line in lines]
    shown, _ = with_numbers(lines, columns)
    assert [line.label for line in shown] == ["line 1", "line 2", "line 3", "largest so far"]
    assert with_numbers(lines, [column[:0] for column in columns])[0] == lines  # before there is any number


def test_a_curve_has_a_gap_where_nothing_was_sampled_and_only_there() -> None:
    times = np.array([0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5, 1.79])
    gaps = gaps_in(times)
    np.testing.assert_allclose(gaps, [[0.3, 1.3]])
    places = np.array([0.0, 0.25, 0.3, 0.31, 0.8, 1.29, 1.3, 1.6])
    found = without(gaps, places, np.ones(len(places)))
    assert np.isnan(found).tolist() == [False, False, False, True, True, True, False, False]
    for few in ([], [1.0], [1.0, 9.0]):
        assert gaps_in(np.array(few)).shape == (0, 2)
    assert np.isnan(without(gaps_in(np.array([1.0])), places, np.ones(len(places)))).sum() == 0
