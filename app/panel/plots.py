"""Live plots in a dock, made on first use. Rows are kept whether or not a plot is open."""

import bisect
import collections
import itertools
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np
import viser
from numpy.typing import NDArray
from viser import uplot

from app.messages import ChartLine, PlotRow, RunIdentity, RunLine, RunRow
from app.panel.recording.recording_files import Plotted
from app.render.handles.viser_types import GuiHandle
from app.render.markup.axis import Scale, scale_of
from app.scenes.charts import Chart, Columns, chart_of, lines_of, with_numbers
from app.scenes.contract import AnyKind, AnySnapshot

MAX_STEP_RATIO = 3.0  # of a step between two samples and the usual one; a longer step is a gap of the curve
SEND_INTERVAL = 0.12  # [s] between two sends
MAX_ROWS = 5400  # kept: three minutes of a scene that adds 30 a second
SHOWN_ROWS = 900  # in a chart: half a minute of them
CHART_HEIGHT, TALL_CHART_HEIGHT = 180, 220  # [pixels] of a chart, and of one with a logarithmic scale, at first
PADDING = (8, 16, 0, 0)  # [pixels] above, right, below, left: room for half of the highest tick's words
FIRST_AXIS_HEIGHT = 28  # [pixels] of its ticks and their words
KEPT_OPACITY, KEPT_DASH = "99", (5.0, 4.0)  # of the lines of an earlier run: a hexadecimal byte, [pixels]
DOT_SIZE = 11  # [pixels] of a dot
CROSS_CLASS = "springtide-cross"  # of lines that are crosses
EMPTY = np.array([0.0, 1.0])  # the times of a chart without rows

Look: TypeAlias = tuple[str, tuple[ChartLine, ...], float | None, Scale | None]


@dataclass
class Dock:
    """The dock of the charts, beside the picture."""

    panel: GuiHandle
    tab: GuiHandle


class Plots:
    """The charts of one scene: those of `SceneKind.plots` over time, and complete ones of `SceneKind.curves`."""

    def __init__(self, server: viser.ViserServer, kind: AnyKind) -> None:
        self.server, self.kind = server, kind
        self.rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_ROWS)
        self.line = RunLine()  # the runs of the rows
        self.charts: dict[str, viser.GuiUplotHandle] = {}  # by the parameter that opens it
        self.looks: dict[str, Look] = {}  # label, lines and scales of each chart
        self.sent: dict[str, object] = {}  # the ends of the rows that each plot shows
        self.sent_curves: dict[str, tuple[object, object]] = {}  # the columns that each curve shows, and the kept ones
        self.dock: Dock | None = None
        self.open: frozenset[str] = frozenset()  # parameters of the open charts
        self.earlier_rows: tuple[PlotRow, ...] = ()  # rows of an earlier run, drawn beside those of this one
        self.curves: Mapping[str, Chart | Columns] = {}  # the last complete charts of the scene
        self.kept_curves: Mapping[str, Chart | Columns] = {}  # those of an earlier run
        self.has_begun = False  # parameters have been read: charts that open from now on were requested
        self.sent_at = 0.0
        self.drawn = 0  # number of charts sent again

    def keep(self, on: bool) -> float | None:
        """Keep the present curves, to be drawn beside those of later runs, or drop them.

        Returns the time [s] of the last kept row; None without any.
        """
        self.earlier_rows = tuple(self.rows) if on else ()
        self.kept_curves = self.curves if on else {}
        ends = [chart.columns[0][-1] for chart in self.kept_curves.values() if isinstance(chart, Chart)]
        return self.earlier_rows[-1][0] if self.earlier_rows else max(map(float, ends), default=None)

    def plotted(self) -> Plotted:
        """The kept rows, and the present complete charts."""
        return Plotted(tuple(self.rows), self.curves)

    def follow(self, run: RunIdentity) -> None:
        """Drop the rows that do not belong to a run."""
        end = self.line.follow(run)
        while self.rows and self.rows[-1][0] > end:
            self.rows.pop()

    def update(self, snapshot: AnySnapshot, rows: list[RunRow], moment: float | None = None) -> None:
        """Take new rows and, at a few hertz, send open charts. moment: time to show [s]; None: the last."""
        for run, row in rows:
            self.follow(run)
            self.rows.append(row)
        self.follow(snapshot.status.run)
        self.curves = cast(Mapping[str, Chart | Columns], snapshot.curves or {})
        now = time.monotonic()
        if now - self.sent_at < SEND_INTERVAL:
            return
        self.sent_at = now
        names = (*self.kind.plots, *self.kind.curves)
        hidden = self.kind.hidden(snapshot.params)
        wanted = frozenset(name for name in names if name not in hidden and getattr(snapshot.params, name))
        if wanted != self.open:
            self.show(wanted)
        self.has_begun = True
        if wanted:
            self.send_curves(wanted)
            self.send_plots(wanted, moment)

    def show(self, wanted: frozenset[str]) -> None:
        """Show these charts and hide the others, with their dock."""
        was_open, self.open = bool(self.open), wanted
        if self.dock is None:
            panel = self.server.gui.add_panel()
            self.dock = Dock(panel, panel.add_tab("Plots"))
            panel.dock_left()
        self.dock.panel.visible = bool(wanted)
        # A small screen folds it at first, so that the picture has more space. Opening a plot unfolds it.
        if wanted and not was_open and self.has_begun:
            self.dock.panel.expand()
        for name in (*self.kind.plots, *self.kind.curves):
            if name in self.charts:
                self.charts[name].visible = name in wanted
            elif name in wanted:
                self.charts[name] = self.add(name)

    def send_curves(self, wanted: frozenset[str]) -> None:
        """Send the open charts with columns that the scene has replaced."""
        for name, columns in self.curves.items():
            earlier_columns = self.kept_curves.get(name)
            last = self.sent_curves.get(name, (None, None))
            if name not in wanted or (last[0] is columns and last[1] is earlier_columns):
                continue
            self.sent_curves[name] = columns, earlier_columns
            axes = self.kind.curves[name]
            chart = chart_of(axes, columns)
            if earlier_columns is not None and earlier_columns is not columns:
                chart = with_kept(chart, chart_of(axes, earlier_columns))
            self.send(name, chart)

    def rows_about(self, moment: float | None) -> list[PlotRow]:
        """The rows that charts show: the last ones, or those about a moment [s], in steps of half a chart."""
        start = len(self.rows) - SHOWN_ROWS
        if moment is not None and start > 0 and moment < self.rows[start][0]:
            half = SHOWN_ROWS // 2
            index = bisect.bisect_left(self.rows, moment, key=lambda row: row[0])
            start = min(start, max(index // half - 1, 0) * half)
        return list(itertools.islice(self.rows, max(start, 0), max(start, 0) + SHOWN_ROWS))

    def send_plots(self, wanted: frozenset[str], moment: float | None) -> None:
        """Send the open charts over time whose rows are out of date."""
        present_rows, earlier_rows = self.rows_about(moment), self.earlier_rows
        ends = (present_rows[0], present_rows[-1], earlier_rows) if present_rows else (earlier_rows,)
        behind = [name for name in self.kind.plots if name in wanted and self.sent.get(name, 0) != ends]
        if not behind:
            return
        width = 1 + len(self.kind.series)
        now, before = (
            np.array(rows, np.float64).reshape(-1, width) for rows in (present_rows, beside(present_rows, earlier_rows))
        )
        gaps = [gaps_in(one[:, 0]) for one in (now, before)]
        middles = [gap.mean(axis=1) for gap in gaps]  # where the curves have a point without a value
        times = np.unique(np.concatenate((now[:, 0], before[:, 0], *middles)))
        for name in behind:
            self.sent[name] = ends
            axes = self.kind.plots[name]
            rows = [1 + self.kind.series.index(one) for one in axes.series]
            lines, columns = axes.lines, [without(gaps[0], times, at_times(times, now, row)) for row in rows]
            if earlier_rows:
                lines = (*lines, *(kept_line(line) for line in lines))
                columns += [without(gaps[1], times, at_times(times, before, row)) for row in rows]
            lines, columns = with_numbers(lines, columns)
            self.send(name, Chart("t [s]", lines, (times, *columns)))

    def send(self, name: str, chart: Chart) -> None:
        """Send one chart."""
        first, lines, columns, end, _ = chart
        if len(columns[0]) < 2:
            columns = (EMPTY * (end or 1.0), *(np.full(2, math.nan) for _ in lines))
        scale = None if self.is_logarithmic(name) else self.scale_for(name, columns[1:])
        look = first, lines, end, scale
        handle = self.charts[name]
        # Lines, scales and columns are sent together, so that they match in the browser.
        if self.looks.get(name) != look:
            self.looks[name] = look
            handle.series = series_of(first, lines)
            time_scale = uplot.Scale(time=False, auto=end is None)
            if end is not None:  # otherwise the scale would keep that of the lines before
                time_scale["range"] = (0.0, end)
            if scale is None:
                handle.scales = {**(handle.scales or {}), "x": time_scale}
            else:
                handle.scales = {"x": time_scale, "y": uplot.Scale(auto=False, range=(scale.low, scale.high))}
                handle.axes = axes_of(scale.ticks, scale.words)
        handle.data = tuple(np.asarray(column, float) for column in columns)
        self.drawn += 1

    def is_logarithmic(self, name: str) -> bool:
        """True if a chart has a logarithmic scale, from end to end of its ticks."""
        return name in self.kind.curves and bool(self.kind.curves[name].ticks)

    def scale_for(self, name: str, columns: Sequence[NDArray[np.floating]]) -> Scale:
        """The scale of a chart: the one it has, unless the data leave it or fill little of it."""
        finite = np.concatenate(columns)
        finite = finite[np.isfinite(finite)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
        least = {**self.kind.plots, **self.kind.curves}[name].least
        last = self.looks.get(name)
        if last is not None and last[3] is not None and last[3].fits(low, max(high, low + least)):
            return last[3]
        return scale_of(low, high, least)

    def add(self, name: str) -> viser.GuiUplotHandle:
        """The chart that a parameter opens, in the dock."""
        assert self.dock is not None
        if name in self.kind.curves:
            axes = self.kind.curves[name]
            title, first, names, ticks = axes.heading, axes.first, axes.names, axes.ticks
        else:
            plot = self.kind.plots[name]
            title, first, names, ticks = plot.heading, "t [s]", plot.series, ()
        scales = {"x": uplot.Scale(time=False, auto=True)}
        looks = axes_of((0.0, 1.0), ("0", "1"))
        if ticks:
            places, words = tuple(place for place, _ in ticks), tuple(word for _, word in ticks)
            scales["y"] = uplot.Scale(distr=3, log=10, range=(places[0], places[-1]), auto=False)
            looks = axes_of(places, words)
        with self.dock.tab:
            return self.server.gui.add_uplot(
                (EMPTY, np.full(2, math.nan)),
                series_of(first, lines_of(names[:1])),  # the others are known once there are rows
                title=title,
                scales=scales,
                axes=looks,
                height=TALL_CHART_HEIGHT if ticks else CHART_HEIGHT,
                padding=PADDING,
                legend=uplot.Legend(live=False),  # a short key, without a column of values
            )


def beside(rows: Sequence[PlotRow], earlier_rows: Sequence[PlotRow]) -> list[PlotRow]:
    """The rows of an earlier run for the chart of these rows: as many as a chart shows."""
    if not rows:
        return list(earlier_rows[:SHOWN_ROWS])
    candidates = [row for row in earlier_rows if row[0] >= rows[0][0]]
    return [row for i, row in enumerate(candidates) if i < SHOWN_ROWS or row[0] <= rows[-1][0]]


def with_kept(chart: Chart, earlier_chart: Chart) -> Chart:
    """A chart with the lines of an earlier one, without its areas and crosses, which would cover the present ones."""
    here, before = (np.array(one.columns, np.float64).T for one in (chart, earlier_chart))
    places = np.union1d(here[:, 0], before[:, 0])
    indices = [i for i, line in enumerate(earlier_chart.lines) if not (line.fill or line.cross)]
    return Chart(
        chart.first,
        (*chart.lines, *(kept_line(earlier_chart.lines[i]) for i in indices)),
        (
            places,
            *(at_times(places, here, 1 + i) for i in range(len(chart.lines))),
            *(at_times(places, before, 1 + i) for i in indices),
        ),
        None if chart.end is None or earlier_chart.end is None else max(chart.end, earlier_chart.end),
    )


def at_times(times: NDArray[np.float64], rows: NDArray[np.float64], column: int) -> NDArray[np.float64]:
    """A column of rows (n, columns) at other times [s], linear in between; NaN before the first and after the last."""
    if not len(rows):
        return np.full(len(times), math.nan)
    return np.interp(times, rows[:, 0], rows[:, column], math.nan, math.nan)


def gaps_in(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """The gaps between samples, (n, 2) [s]: where nothing was sampled for much longer than usual."""
    steps = np.diff(times)
    if not len(steps):
        return np.empty((0, 2))
    (before,) = np.nonzero(steps > MAX_STEP_RATIO * np.median(steps))
    return np.stack((times[before], times[before + 1]), axis=1)


def without(gaps: NDArray[np.float64], times: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values at times [s], with NaN inside the gaps."""
    inside = np.searchsorted(gaps[:, 0], times, "left") > np.searchsorted(gaps[:, 1], times, "right")
    return np.where(inside, math.nan, values)


def kept_line(line: ChartLine) -> ChartLine:
    """Style of a line of an earlier run."""
    return ChartLine(f"{line.label}, kept", line.colour + KEPT_OPACITY, 1.5, KEPT_DASH)


def axes_of(ticks: tuple[float, ...], words: tuple[str, ...]) -> tuple[uplot.Axis, ...]:
    """The two axes of a chart, the second with words at its ticks.

    `js/panel/charts.js` writes the name of the first, and makes the second as wide as its words are.
    """
    return uplot.Axis(size=FIRST_AXIS_HEIGHT, gap=2), uplot.Axis(splits=ticks, values=words)


def series_of(first: str, lines: Sequence[ChartLine]) -> tuple[uplot.Series, ...]:
    """viser's names of a chart's columns: the abscissa, then a line each."""
    series = [uplot.Series(label=first)]
    for line in lines:
        look = uplot.Series(label=line.label, stroke=line.colour, width=line.width)
        if line.dash:
            look["dash"] = line.dash
        if line.fill:
            look["fill"] = line.fill
        if line.dots:
            look.update({"width": 0.0, "points": {"show": True, "size": DOT_SIZE, "fill": line.colour}})
        if line.cross:  # drawn by `js/panel/charts.js`
            look.update({"label": f"× {line.label}", "class": CROSS_CLASS, "width": 0.0, "points": {"show": False}})
        series.append(look)
    return tuple(series)
