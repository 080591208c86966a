"""The first measures of a sweep as one figure: maps or curves of a grid, scattered points of a random design.

Each measure has a row. If the two parameters with most values have at least five each, they are the axes of a map.
Otherwise the first is the axis of curves, and each curve has one value of the second. A third parameter makes the
columns. Other parameters stay at their first values, and the title names them.
"""

import json
from typing import Any

import numpy as np

from app.scenes.charts import PALETTE
from app.study.tables import MARKERS, draw_map

MAX_ROWS, MAX_COLUMNS, MAX_CURVES = 2, 4, 8
MIN_MAP_VALUES = 5  # of each of two parameters, for a map
MIN_LOG_RATIO = 30.0  # of the largest value to the smallest, for a logarithmic axis
NO_VALUE_GREY = "0.93"  # of cases without a value


def draw(dataset: Any) -> Any:
    """A matplotlib figure of `to_dataset`'s dataset."""
    from matplotlib.figure import Figure

    measures = measures_shown(dataset)
    at_end = dataset[measures].isel(time=-1) if "time" in dataset.dims else dataset[measures]
    swept = list(json.loads(dataset.attrs["identity"])["spec"]["parameters"])
    random = dataset.attrs["design"] == "random"
    ranked = sorted(swept, key=lambda name: rank(dataset[name]))
    across = ranked[:MAX_COLUMNS] if random else [None]
    if not random and len(ranked) > 2:
        across = list(dataset[ranked[2]].values[:MAX_COLUMNS])
    size = (1.2 + 3.4 * len(across), 0.9 + 2.6 * len(measures))
    figure = Figure(figsize=(max(size[0], 5.0), size[1]), layout="constrained")
    panels = figure.subplots(len(measures), len(across), squeeze=False, sharex="col", sharey="row")
    rest = "" if random else ", ".join(f"{name} = {text(dataset[name].values[0])}" for name in ranked[3:])
    when = f"after {dataset.attrs['seconds']:g} s"
    figure.suptitle(f"Sweep of the {dataset.attrs['scene']} scene, {when}" + (f"; {rest}" if rest else ""))
    for row, name in zip(panels, measures, strict=True):
        is_top = name == measures[0]
        image = None
        values = at_end[name]
        colours = scale(values.values)
        for axes, column in zip(row, across, strict=True):
            if random:
                points(axes, dataset[column], values)
            else:
                cut = values.isel(dict.fromkeys(ranked[3:], 0))
                if len(ranked) > 2:
                    cut = cut.sel({ranked[2]: column})
                    axes.set_title(f"{ranked[2]} = {text(column)}" if is_top else "", fontsize=10)
                image = draw_panel(axes, cut, ranked[:2], colours, is_top and axes is row[0])
            axes.label_outer()
            axes.spines[["top", "right"]].set_visible(False)
        if image is not None:
            figure.colorbar(image, ax=list(row), label=label(values))
        else:
            row[0].set_ylabel(label(values))
    return figure


def rank(values: Any) -> tuple[bool, int, bool]:
    """The sort key of parameters as axes: numbers before words, then many values before few."""
    return not is_number(values), -np.unique(values).size, values.dtype.kind != "f"


def measures_shown(dataset: Any) -> list[str]:
    """`diverged_at`, if any case diverged; then the first measures that differ from case to case."""
    names = [name for name in dataset.data_vars if name not in ("end", "message", "run_time", "diverged_at")]
    last = {name: dataset[name].isel(time=-1) if "time" in dataset[name].dims else dataset[name] for name in names}
    differing = [name for name in names if np.unique(last[name].values[np.isfinite(last[name].values)]).size > 1]
    diverged = ["diverged_at"] if np.isfinite(dataset["diverged_at"].values).any() else []
    return (diverged + (differing or names))[:MAX_ROWS] or ["run_time"]


def draw_panel(axes: Any, values: Any, names: list[str], colours: Any, is_first: bool) -> Any:
    """Draw a map (returned, for its colour bar) or curves (None is returned) over one or two parameters."""
    both = len(names) == 2 and all(is_number(values[n]) and values[n].size >= MIN_MAP_VALUES for n in names)
    if both:
        x, y = (values[n] for n in names)
        axes.set_facecolor(NO_VALUE_GREY)
        cells = values.transpose(names[1], names[0]).values
        image = draw_map(axes, x.values, y.values, cells, log=(is_log(x), is_log(y)), cmap="viridis", norm=colours)
        set_axis(axes, "x", x)
        set_axis(axes, "y", y)
        return image
    x = values[names[0]]
    curves = values[names[1]].values[:MAX_CURVES] if len(names) == 2 else [None]
    for index, curve in enumerate(curves):
        y = values if curve is None else values.sel({names[1]: curve})
        style = {"color": PALETTE[index], "marker": MARKERS[index], "markersize": 4}
        axes.plot(positions(x), y.values, label=None if curve is None else text(curve), **style)
    set_axis(axes, "x", x)
    if len(names) == 2 and is_first:
        axes.legend(title=label(values[names[1]]), frameon=False, fontsize=8, title_fontsize=8)
    return None


def points(axes: Any, x: Any, y: Any) -> None:
    """Draw one point for each case."""
    axes.plot(positions(x), y.values, linestyle="", marker=".", color=PALETTE[0])
    set_axis(axes, "x", x)


def is_number(values: Any) -> bool:
    """True if values are numbers and not words or truth values."""
    return values.dtype.kind in "if"


def positions(x: Any) -> Any:
    """Positions of values on an axis: the values themselves, or the order of their names."""
    return x.values if is_number(x) else np.unique(x.values, return_inverse=True)[1]


def is_log(x: Any) -> bool:
    """True if a logarithmic axis shows these values better."""
    low, high = float(x.min()), float(x.max())
    return low > 0.0 and high / low >= MIN_LOG_RATIO


def set_axis(axes: Any, which: str, x: Any) -> None:
    """Set label, scale and ticks of the axis `which`, x or y."""
    getattr(axes, f"set_{which}label")(label(x))
    if not is_number(x):
        names = [text(value) for value in np.unique(x.values)]
        getattr(axes, f"set_{which}ticks")(range(len(names)), names, rotation=20, ha="right", fontsize=8)
    elif is_log(x):
        getattr(axes, f"set_{which}scale")("log")
    elif x.dtype.kind == "i":
        getattr(axes, f"{which}axis").get_major_locator().set_params(integer=True)


def scale(values: Any) -> Any:
    """The norm of the colours of the finite values, logarithmic over a large ratio."""
    from matplotlib.colors import LogNorm, Normalize

    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    return LogNorm(low, high) if low > 0.0 and high / low >= MIN_LOG_RATIO else Normalize(low, high)


def label(values: Any) -> str:
    """The name with its unit."""
    unit = values.attrs.get("units", "1")
    words = values.name.replace("_", " ")
    return words if unit == "1" else f"{words} [{unit}]"


def text(value: Any) -> str:
    """A value in words of a title or legend."""
    return f"{value:.3g}" if isinstance(value, float | np.floating) else str(value)
