"""Files of a recording: arrays with units, and plots as CSV and SVG."""

import csv
import io
import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import PlotRow
from app.panel.recording.recorder import RecordedFrame
from app.render.markup.line_chart import WIDTH, Drawing, line_chart
from app.scenes.charts import Chart, Column, Columns, chart_of, numbers_of, with_numbers
from app.scenes.contract import AnyKind
from app.scenes.setups import described

TIME = "t [s]"  # label of the first column of plots over simulated time
NOTHING = "nothing has been plotted yet: let the scene run first"
MAX_ARRAYS = 300e6  # [bytes] of all arrays of a file, before they are compressed; of more, each second or third frame


def arrays_of(frame: object, before: str = "") -> Iterator[tuple[str, NDArray[np.generic]]]:
    """The arrays of a frame with their names; those of a record within it are named "record_array"."""
    for name in getattr(frame, "_fields", ()):
        value = getattr(frame, name)
        if isinstance(value, np.ndarray):
            yield f"{before}{name}", value
        else:
            yield from arrays_of(value, f"{before}{name}_")


def recording_npz(kind: AnyKind, frames: Sequence[RecordedFrame]) -> bytes:
    """The arrays that were drawn as an .npz file: each (frames, ...) under its name, `t` [s], and `about` as JSON.

    `about` holds the scene, the parameters at the end, and the unit of each array. The file holds the last frames that
    have the same arrays in the same shapes. Raises ValueError if nothing was recorded.
    """
    if not frames:
        raise ValueError("nothing has been recorded yet: let the scene run first")
    units = kind.frame_units
    form = {name: array.shape for name, array in arrays_of(frames[-1].frame) if name in units}
    start = len(frames)
    while start and form == {name: a.shape for name, a in arrays_of(frames[start - 1].frame) if name in units}:
        start -= 1
    size = sum(array.nbytes for name, array in arrays_of(frames[-1].frame) if name in units)
    share = max(1, int(np.ceil(size * (len(frames) - start) / MAX_ARRAYS)))
    chosen = frames[start::share]
    columns: dict[str, list[NDArray[np.generic]]] = {name: [] for name in form}
    for frame in chosen:
        for name, array in arrays_of(frame.frame):
            if name in columns:
                columns[name].append(array)
    about = {
        **described(kind, chosen[-1].params),
        "units": {"t": "s", **{name: units[name] for name in form}},
        "notes": list(kind.notes(chosen[-1].params)),
    }
    content = io.BytesIO()
    arrays = {name: np.stack(column) for name, column in columns.items()}
    times = np.array([frame.time for frame in chosen])
    np.savez_compressed(content, t=times, about=np.array(json.dumps(about)), **arrays)  # pyright: ignore
    return content.getvalue()


class Plotted(NamedTuple):
    """Data of a scene's plots: rows over time, and the complete charts of the scene by their parameter."""

    rows: Sequence[PlotRow]
    curves: Mapping[str, Chart | Columns]

    def between(self, start: float, end: float) -> "Plotted":
        """The charts over time from `start` to `end` [s]; other charts unchanged."""
        curves = {name: within(chart, start, end) for name, chart in self.curves.items()}
        return Plotted([row for row in self.rows if start <= row[0] <= end], curves)


def within(chart: Chart | Columns, start: float, end: float) -> Chart | Columns:
    """The part of a chart over time from `start` to `end` [s]; any other chart unchanged."""
    if not isinstance(chart, Chart) or chart.first != TIME:
        return chart
    mask = (chart.columns[0] >= start) & (chart.columns[0] <= end)
    numbers = chart.numbers and tuple(column if column is None else column[mask] for column in chart.numbers)
    return chart._replace(columns=tuple(column[mask] for column in chart.columns), end=None, numbers=numbers)


def plots_csv(kind: AnyKind, plotted: Plotted) -> str:
    """Plots as CSV with units, a column each; an empty cell means no value. A column without any is left out.

    Plots over the same first column share it. Others stand beside them, and the shorter ones end with empty cells.
    Raises ValueError if there is nothing.
    """
    units = {name: plot.unit for plot in kind.plots.values() for name in plot.series}
    columns: list[tuple[str, Column]] = []
    if plotted.rows:
        names = [TIME, *(f"{name} [{units[name]}]" if units.get(name) else name for name in kind.series)]
        table = zip(names, np.array(plotted.rows, np.float64).T, strict=True)
        columns += [(name, values) for name, values in table if not np.isnan(values).all()]
    first: tuple[str, Column] | None = None
    for name, curve in plotted.curves.items():
        axes = kind.curves[name]
        chart = chart_of(axes, curve)
        before, first = first, (chart.first, chart.columns[0])
        if before is None or before[0] != first[0] or not np.array_equal(before[1], first[1]):
            columns.append(first)
        columns += [(f"{axes.title}: {label} [{unit}]", values) for label, unit, values in numbers_of(axes, chart)[1:]]
    if not any(len(values) for _, values in columns):
        raise ValueError(NOTHING)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([name for name, _ in columns])
    cells = (["" if math.isnan(value) else repr(value) for value in values.tolist()] for _, values in columns)
    writer.writerows(itertools.zip_longest(*cells, fillvalue=""))
    return text.getvalue()


def plot_charts(kind: AnyKind, plotted: Plotted) -> list[Drawing]:
    """A chart as SVG for each plot of the scene that has finite numbers."""
    charts: list[Drawing | None] = []
    if len(plotted.rows) > 1:
        table = np.array(plotted.rows, np.float64).T
        for plot in kind.plots.values():
            lines, columns = with_numbers(plot.lines, [table[1 + kind.series.index(name)] for name in plot.series])
            charts.append(line_chart(plot.heading, TIME, lines, (table[0], *columns)))
    for name, curve in plotted.curves.items():
        axes = kind.curves[name]
        first, lines, columns, end, _ = chart_of(axes, curve)
        if len(columns[0]) > 1:
            charts.append(line_chart(axes.heading, first, lines, columns, end, axes.ticks))
    return [chart for chart in charts if chart is not None]


def plots_svg(kind: AnyKind, plotted: Plotted) -> str:
    """All plots of a scene in one SVG file, one below the other. Raises ValueError if there is nothing to draw."""
    charts = plot_charts(kind, plotted)
    if not charts:
        raise ValueError(NOTHING)
    tops = [0, *itertools.accumulate(chart.height for chart in charts)]
    placed = "".join(
        f'<g transform="translate(0 {top})">{chart.svg}</g>' for top, chart in zip(tops, charts, strict=False)
    )
    size = f'width="{WIDTH}" height="{tops[-1]}" viewBox="0 0 {WIDTH} {tops[-1]}"'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" {size}>{placed}</svg>\n'
