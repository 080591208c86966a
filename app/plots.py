"""Live plots in a dock of their own, made when first asked for. Long histories thin out; they never grow."""

import time
from collections.abc import Sequence
from types import ModuleType
from typing import Any

import numpy as np
import viser
from viser import uplot

from app.chart import Chart, Line
from app.ledger import Work
from app.messages import Snapshot

EVERY = 0.12  # [s] between two sends
LENGTH = 600  # points kept
COLOURS = ("#4c6ef5", "#f76707", "#12b886", "#ae3ec9", "#868e96", "#e03131", "#1c7ed6")


class Plots:
    """What a scene's `PLOTS` declares: knob -> (title, unit, names of the series in SERIES).

    `CURVES`, where a scene has it, declares charts whose columns each snapshot brings whole: knob -> (title, label of
    the first column, names of the others) and, for a logarithmic scale, its ticks, (value, word) from end to end. In
    place of the columns may come a `Chart`, which has the looks of its lines as well.
    """

    def __init__(self, server: viser.ViserServer, scene: ModuleType) -> None:
        self.server, self.scene = server, scene
        self.curves: dict[str, tuple[Any, ...]] = getattr(scene, "CURVES", {})
        self.rows: list[tuple[float, ...]] = []
        self.charts: dict[str, Any] = {}
        self.looks: dict[str, Any] = {}  # the lines and the scale that each chart of a `Chart` has
        self.sent: dict[str, Any] = {}  # the columns each curve shows, and the last row of each plot
        self.panel: Any = None
        self.sent_at = 0.0
        self.drawn = self.spared = 0  # charts sent anew, and charts that were closed or had nothing new

    def work(self) -> dict[str, Work]:
        return {"charts drawn": Work(self.drawn, self.spared)}

    def update(self, snapshot: Snapshot, params: Any) -> None:
        """Take the snapshot's new rows and, now and then, send what is open."""
        for row in snapshot.samples:
            if row[0] != row[0]:  # a NaN time: the run starts over
                self.rows.clear()
            else:
                self.rows.append(row)
        if len(self.rows) > LENGTH:
            self.rows = self.rows[-LENGTH:]
        now = time.monotonic()
        if now - self.sent_at < EVERY:
            return
        self.sent_at = now
        meant = {*self.scene.PLOTS, *self.curves} - self.scene.hidden(params)
        wanted = {knob for knob in meant if getattr(params, knob)}
        for knob in (*self.scene.PLOTS, *self.curves):
            if knob in self.charts:
                self.charts[knob].visible = knob in wanted
            elif knob in wanted:
                self.charts[knob] = self.add(knob)
        if self.panel is not None:
            self.panel.visible = bool(wanted)
        before = self.drawn
        if wanted:
            self.send(snapshot, wanted)
        self.spared += len(self.scene.PLOTS) + len(self.curves) - (self.drawn - before)

    def send(self, snapshot: Snapshot, wanted: set[str]) -> None:
        """Send the charts that are open and have something new."""
        for knob in wanted & set(snapshot.curves or {}):
            columns = snapshot.curves[knob]
            if self.sent.get(knob) is not columns:
                self.sent[knob] = columns
                # Lines and their columns together: the browser must not see more of one than of the other.
                with self.server.atomic():
                    if isinstance(columns, Chart):
                        self.suit(knob, columns)
                        columns = columns.columns
                    self.charts[knob].data = columns
                self.drawn += 1
        if len(self.rows) < 2:
            return
        behind = [knob for knob in self.scene.PLOTS if knob in wanted and self.sent.get(knob) is not self.rows[-1]]
        table = np.array(self.rows).T if behind else np.empty(0)
        for knob in behind:
            self.sent[knob] = self.rows[-1]
            columns = [1 + self.scene.SERIES.index(name) for name in self.scene.PLOTS[knob][2]]
            self.charts[knob].data = (table[0], *(table[c] for c in columns))
            self.drawn += 1

    def suit(self, knob: str, chart: Chart) -> None:
        """Give a chart the lines and the scale that it has now, where they are others than before."""
        if self.looks.get(knob) != chart[:2] + chart[3:]:
            self.looks[knob] = chart[:2] + chart[3:]
            handle = self.charts[knob]
            handle.series = series_of(chart.first, chart.lines)
            # Left to itself the scale would carry on from the lines before.
            handle.scales = {**handle.scales, "x": uplot.Scale(time=False, auto=False, range=(0.0, chart.end))}

    def add(self, knob: str) -> Any:
        """The chart of one knob, in the dock."""
        if self.panel is None:
            self.panel = self.server.gui.add_panel()
            self.tab = self.panel.add_tab("Plots")
            self.panel.dock_left()
        ticks: tuple[tuple[float, str], ...] = ()
        if knob in self.curves:
            heading, first, names, *rest = self.curves[knob]
            ticks = rest[0] if rest else ()
        else:
            title, unit, names = self.scene.PLOTS[knob]
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
