"""Live plots in a dock of their own, made when first asked for. Of a long run the last rows are kept."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, cast

import numpy as np
import viser
from numpy.typing import NDArray
from viser import uplot

from app.messages import PlotRow, WorkCount
from app.render.viser_types import GuiHandle
from app.scenes.charts import Chart, Line
from app.scenes.contract import AnyKind, AnySnapshot

SEND_INTERVAL = 0.12  # [s] between two sends
MAX_ROWS = 600
CHART_HEIGHT, TALL_CHART_HEIGHT = 220, 260  # [pixels] of a chart, and of one with a logarithmic scale
TICK_WIDTH = 66  # [pixels] for the words at a scale
COLOURS = ("#4c6ef5", "#f76707", "#12b886", "#ae3ec9", "#868e96", "#e03131", "#1c7ed6")

Look: TypeAlias = tuple[str, tuple[Line, ...], float]


@dataclass
class Dock:
    """The dock that the charts stand in, beside the picture."""

    panel: GuiHandle
    tab: GuiHandle


class Plots:
    """The charts of one scene: over time those of `SceneKind.plots`, and whole ones those of `SceneKind.curves`."""

    def __init__(self, server: viser.ViserServer, kind: AnyKind) -> None:
        self.server, self.kind = server, kind
        self.rows: list[PlotRow] = []
        self.charts: dict[str, viser.GuiUplotHandle] = {}  # by the parameter that opens it
        self.looks: dict[str, Look] = {}  # label, lines and scale of each chart that a `Chart` gives
        self.sent: dict[str, object] = {}  # the columns that each curve shows, and the last row of each plot
        self.dock: Dock | None = None
        self.sent_at = 0.0
        self.drawn = self.skipped = 0  # charts sent anew, and charts that were closed or had nothing new

    def work(self) -> dict[str, WorkCount]:
        """How many charts were drawn and how many did not have to be."""
        return {"charts drawn": WorkCount(self.drawn, self.skipped)}

    def update(self, snapshot: AnySnapshot, rows: list[PlotRow]) -> None:
        """Take new rows and, at a few hertz, send what is open."""
        for row in rows:
            if row[0] != row[0]:  # a NaN time: the run starts over
                self.rows.clear()
            else:
                self.rows.append(row)
        if len(self.rows) > MAX_ROWS:
            self.rows = self.rows[-MAX_ROWS:]
        now = time.monotonic()
        if now - self.sent_at < SEND_INTERVAL:
            return
        self.sent_at = now
        names = (*self.kind.plots, *self.kind.curves)
        hidden = self.kind.hidden(snapshot.params)
        wanted = {name for name in names if name not in hidden and getattr(snapshot.params, name)}
        for name in names:
            if name in self.charts:
                self.charts[name].visible = name in wanted
            elif name in wanted:
                self.charts[name] = self.add(name)
        if self.dock is not None:
            self.dock.panel.visible = bool(wanted)
        before = self.drawn
        if wanted:
            self.send_curves(snapshot, wanted)
            self.send_plots(wanted)
        self.skipped += len(names) - (self.drawn - before)

    def send_curves(self, snapshot: AnySnapshot, wanted: set[str]) -> None:
        """Send the open charts of columns that the scene has made anew."""
        for name, columns in (snapshot.curves or {}).items():
            if name not in wanted or self.sent.get(name) is columns:
                continue
            self.sent[name] = columns
            # Lines and their columns together: the browser must not see more of one than of the other.
            with self.server.atomic():
                if isinstance(columns, Chart):
                    self.set_look(name, columns)
                    self.charts[name].data = columns.columns
                else:
                    self.charts[name].data = cast("tuple[NDArray[np.float64], ...]", columns)
            self.drawn += 1

    def send_plots(self, wanted: set[str]) -> None:
        """Send the open charts over time that lack the newest row."""
        if len(self.rows) < 2:
            return
        behind = [name for name in self.kind.plots if name in wanted and self.sent.get(name) is not self.rows[-1]]
        table: NDArray[np.float64] = np.array(self.rows).T if behind else np.empty(0)
        for name in behind:
            self.sent[name] = self.rows[-1]
            columns = [1 + self.kind.series.index(series) for series in self.kind.plots[name].series]
            self.charts[name].data = (table[0], *(table[c] for c in columns))
            self.drawn += 1

    def set_look(self, name: str, chart: Chart) -> None:
        """Give a chart the lines and the scale that it has now, where they are others than before."""
        look = chart.first, chart.lines, chart.end
        if self.looks.get(name) == look:
            return
        self.looks[name] = look
        handle = self.charts[name]
        handle.series = series_of(chart.first, chart.lines)
        # Left to itself the scale would carry on from the lines before.
        time_scale = uplot.Scale(time=False, auto=False, range=(0.0, chart.end))
        handle.scales = {**(handle.scales or {}), "x": time_scale}

    def add(self, name: str) -> viser.GuiUplotHandle:
        """The chart that a parameter opens, in the dock."""
        gui = self.server.gui
        if self.dock is None:
            panel = gui.add_panel()
            self.dock = Dock(panel, panel.add_tab("Plots"))
            panel.dock_left()
        if name in self.kind.curves:
            title, first, names, ticks = self.kind.curves[name]
        else:
            plot = self.kind.plots[name]
            title, first, names, ticks = f"{plot.title} [{plot.unit}]", "t [s]", plot.series, ()
        series = series_of(first, [Line(*look) for look in zip(names, COLOURS, strict=False)])
        x_scale = uplot.Scale(time=False, auto=True)
        start = np.array([0.0, 1.0])
        with self.dock.tab:
            if not ticks:
                data = (start, *(start for _ in names))
                return gui.add_uplot(data, series, title=title, scales={"x": x_scale}, height=CHART_HEIGHT)
            places, words = [place for place, _ in ticks], [word for _, word in ticks]
            y_scale = uplot.Scale(distr=3, log=10, range=(places[0], places[-1]), auto=False)
            return gui.add_uplot(
                (start, *(np.full(2, places[0]) for _ in names)),
                series,
                title=title,
                scales={"x": x_scale, "y": y_scale},
                height=TALL_CHART_HEIGHT,
                # The chart's own words for small numbers are zeros, on the axis as in its legend.
                legend=uplot.Legend(live=False),
                axes=(uplot.Axis(), uplot.Axis(splits=tuple(places), values=tuple(words), size=TICK_WIDTH)),
            )


def series_of(first: str, lines: Sequence[Line]) -> tuple[uplot.Series, ...]:
    """What viser calls a chart's columns: the first, which the others stand over, then a line each."""
    series = [uplot.Series(label=first)]
    for line in lines:
        look = uplot.Series(label=line.label, stroke=line.colour, width=line.width)
        if line.dash:
            look["dash"] = line.dash
        if line.fill:
            look["fill"] = line.fill
        series.append(look)
    return tuple(series)
