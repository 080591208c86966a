"""Live plots in a dock of their own, made when first asked for. Long histories thin out; they never grow."""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from viser import uplot

from app.messages import PlotRow, Snapshot, WorkCount
from app.scenes.charts import Chart, Line
from app.scenes.contract import SceneKind

EVERY = 0.12  # [s] between two sends
LENGTH = 600  # points kept
COLOURS = ("#4c6ef5", "#f76707", "#12b886", "#ae3ec9", "#868e96", "#e03131", "#1c7ed6")


class Plots:
    """What a scene's `PLOTS` declares: parameter -> (title, unit, names of the series in SERIES).

    `CURVES`, where a scene has it, declares charts whose columns each snapshot brings whole: parameter -> (title, label
    of
    the first column, names of the others) and, for a logarithmic scale, its ticks, (value, word) from end to end. In
    place of the columns may come a `Chart`, which has the looks of its lines as well.
    """

    def __init__(self, server: viser.ViserServer, scene: SceneKind[Any, Any, Any]) -> None:
        self.server, self.scene = server, scene
        self.curves = scene.curves
        self.rows: list[tuple[float, ...]] = []
        self.charts: dict[str, Any] = {}
        self.looks: dict[str, Any] = {}  # the lines and the scale that each chart of a `Chart` has
        self.sent: dict[str, Any] = {}  # the columns each curve shows, and the last row of each plot
        self.panel: Any = None
        self.sent_at = 0.0
        self.drawn = self.spared = 0  # charts sent anew, and charts that were closed or had nothing new

    def work(self) -> dict[str, WorkCount]:
        return {"charts drawn": WorkCount(self.drawn, self.spared)}

    def update(self, snapshot: Snapshot, rows: list[PlotRow]) -> None:
        """Take new rows and, now and then, send what is open."""
        for row in rows:
            if row[0] != row[0]:  # a NaN time: the run starts over
                self.rows.clear()
            else:
                self.rows.append(row)
        if len(self.rows) > LENGTH:
            self.rows = self.rows[-LENGTH:]
        params = snapshot.params
        now = time.monotonic()
        if now - self.sent_at < EVERY:
            return
        self.sent_at = now
        meant = {*self.scene.plots, *self.curves} - self.scene.hidden(params)
        wanted = {parameter for parameter in meant if getattr(params, parameter)}
        for parameter in (*self.scene.plots, *self.curves):
            if parameter in self.charts:
                self.charts[parameter].visible = parameter in wanted
            elif parameter in wanted:
                self.charts[parameter] = self.add(parameter)
        if self.panel is not None:
            self.panel.visible = bool(wanted)
        before = self.drawn
        if wanted:
            self.send(snapshot, wanted)
        self.spared += len(self.scene.plots) + len(self.curves) - (self.drawn - before)

    def send(self, snapshot: Snapshot, wanted: set[str]) -> None:
        """Send the charts that are open and have something new."""
        for parameter in wanted & set(snapshot.curves or {}):
            columns = snapshot.curves[parameter]
            if self.sent.get(parameter) is not columns:
                self.sent[parameter] = columns
                # Lines and their columns together: the browser must not see more of one than of the other.
                with self.server.atomic():
                    if isinstance(columns, Chart):
                        self.suit(parameter, columns)
                        columns = columns.columns
                    self.charts[parameter].data = columns
                self.drawn += 1
        if len(self.rows) < 2:
            return
        behind = [
            parameter
            for parameter in self.scene.plots
            if parameter in wanted and self.sent.get(parameter) is not self.rows[-1]
        ]
        table = np.array(self.rows).T if behind else np.empty(0)
        for parameter in behind:
            self.sent[parameter] = self.rows[-1]
            columns = [1 + self.scene.series.index(name) for name in self.scene.plots[parameter][2]]
            self.charts[parameter].data = (table[0], *(table[c] for c in columns))
            self.drawn += 1

    def suit(self, parameter: str, chart: Chart) -> None:
        """Give a chart the lines and the scale that it has now, where they are others than before."""
        if self.looks.get(parameter) != chart[:2] + chart[3:]:
            self.looks[parameter] = chart[:2] + chart[3:]
            handle = self.charts[parameter]
            handle.series = series_of(chart.first, chart.lines)
            # Left to itself the scale would carry on from the lines before.
            handle.scales = {**handle.scales, "x": uplot.Scale(time=False, auto=False, range=(0.0, chart.end))}

    def add(self, parameter: str) -> Any:
        """The chart of one parameter, in the dock."""
        if self.panel is None:
            self.panel = self.server.gui.add_panel()
            self.tab = self.panel.add_tab("Plots")
            self.panel.dock_left()
        ticks: tuple[tuple[float, str], ...] = ()
        if parameter in self.curves:
            heading, first, names, ticks = self.curves[parameter]
        else:
            title, unit, names = self.scene.plots[parameter]
            heading, first = f"{title} [{unit}]", "t [s]"
        series = series_of(first, [Line(*look) for look in zip(names, COLOURS, strict=False)])
        scales = {"x": uplot.Scale(time=False, auto=True)}
        more: dict[str, Any] = {"height": 220}
        start = np.array([0.0, 1.0])
        if ticks:
            places, words = zip(*ticks, strict=True)
            scales["y"] = uplot.Scale(distr=3, log=10, range=(places[0], places[-1]), auto=False)
            # The chart's own words for small numbers are zeros, on the axis as in its legend.
            more = {"height": 260, "legend": uplot.Legend(live=False)}
            more["axes"] = (uplot.Axis(), uplot.Axis(splits=places, values=words, size=66))
            start = np.full(2, places[0])
        with self.tab:
            return self.server.gui.add_uplot(
                (np.array([0.0, 1.0]), *(start for _ in names)), series, title=heading, scales=scales, **more
            )


def series_of(first: str, lines: Sequence[Line]) -> tuple[uplot.Series, ...]:
    """What viser calls a chart's columns: the one they stand over, then a line each."""
    series = [uplot.Series(label=first)]
    for line in lines:
        look = uplot.Series(label=line.label, stroke=line.colour, width=line.width)
        if line.dash:
            look["dash"] = line.dash
        if line.fill:
            look["fill"] = line.fill
        series.append(look)
    return tuple(series)
