"""Files of what was recorded: arrays with units, and plots as CSV and SVG."""

import csv
import dataclasses
import io
import json
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from app.messages import PlotRow
from app.panel.recorder import Kept
from app.render.html import Html
from app.render.line_chart import HEIGHT, WIDTH, line_chart
from app.scenes.contract import AnyKind

MAX_ARRAYS = 300e6  # [bytes] of all arrays of a file, before they are compressed; of more, each second or third frame


def arrays_of(frame: object, before: str = "") -> Iterator[tuple[str, NDArray[np.generic]]]:
    """The arrays of a frame with their names; those of a record within it are named "record_array"."""
    for name in getattr(frame, "_fields", ()):
        value = getattr(frame, name)
        if isinstance(value, np.ndarray):
            yield f"{before}{name}", value
        else:
            yield from arrays_of(value, f"{before}{name}_")


def recording_npz(kind: AnyKind, frames: Sequence[Kept]) -> bytes:
    """The arrays that were drawn as an .npz file: each (frames, ...) under its name, `t` [s], and `about` as JSON.

    `about` holds the scene, the parameters at the end, and the unit of each array. The file holds the last frames that
    have the same arrays in the same shapes. Raises ValueError where nothing was recorded.
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
    for kept in chosen:
        for name, array in arrays_of(kept.frame):
            if name in columns:
                columns[name].append(array)
    params = chosen[-1].params
    about = {
        "scene": kind.name,
        "parameters": {field.name: getattr(params, field.name) for field in dataclasses.fields(params)},
        "units": {"t": "s", **{name: units[name] for name in form}},
    }
    content = io.BytesIO()
    arrays = {name: np.stack(column) for name, column in columns.items()}
    times = np.array([kept.time for kept in chosen])
    np.savez_compressed(content, t=times, about=np.array(json.dumps(about)), **arrays)  # pyright: ignore
    return content.getvalue()


def plots_csv(kind: AnyKind, rows: Sequence[PlotRow]) -> str:
    """Plot rows as CSV: time, and each series with the unit of the plot that shows it. "nan": no value there."""
    units = {name: plot.unit for plot in kind.plots.values() for name in plot.series}
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["t [s]", *(f"{name} [{units[name]}]" if units.get(name) else name for name in kind.series)])
    writer.writerows([repr(value) for value in row] for row in rows)
    return text.getvalue()


def plot_charts(kind: AnyKind, rows: Sequence[PlotRow]) -> list[Html]:
    """A chart as SVG for each plot of the scene that has finite numbers in these rows."""
    if len(rows) < 2:
        return []
    columns = np.array(rows, np.float64).T
    charts = [
        line_chart(
            f"{plot.title} [{plot.unit}]",
            columns[0],
            {name: columns[1 + kind.series.index(name)] for name in plot.series},
        )
        for plot in kind.plots.values()
    ]
    return [chart for chart in charts if chart]


def plots_svg(kind: AnyKind, rows: Sequence[PlotRow]) -> str:
    """All plots of a scene in one SVG file, one below the other. Raises ValueError where there is nothing to draw."""
    charts = plot_charts(kind, rows)
    if not charts:
        raise ValueError("nothing has been plotted yet: let the scene run first")
    placed = "".join(f'<g transform="translate(0 {HEIGHT * i})">{chart}</g>' for i, chart in enumerate(charts))
    size = f'width="{WIDTH}" height="{HEIGHT * len(charts)}" viewBox="0 0 {WIDTH} {HEIGHT * len(charts)}"'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<svg xmlns="http://www.w3.org/2000/svg" {size}>{placed}</svg>\n'
