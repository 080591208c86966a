"""State of a lab at one time as a labelled dataset."""

import json
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from app.messages import PlotRow
from app.scenes.charts import Chart, Columns, chart_of, numbers_of
from app.scenes.contract import AnyKind, AnyScene, Layout
from app.scenes.quantities import measured
from sim.parameters import parameters_of

if TYPE_CHECKING:
    import xarray

Labelled = tuple[tuple[str, ...], np.ndarray, dict[str, str]]  # dimensions, values, attributes


def to_dataset(kind: AnyKind, scene: AnyScene, rows: Iterable[PlotRow], link: str) -> "xarray.Dataset":
    """The plots over `t` [s]; and, at the time `now` [s], the state, the measures, and the other charts.

    rows: of the plots. link: of the set-up. Called between two steps.
    """
    import xarray as xr  # half a second

    variables: dict[str, Labelled] = {}
    layout = Layout({}, {}, frozenset()) if kind.layout is None else kind.layout(scene)
    table = np.array([*rows]).reshape(-1, 1 + len(kind.series))
    units = {name: plot.unit for plot in kind.plots.values() for name in plot.series}
    for column, name in enumerate(kind.series, 1):
        if name not in layout.unused:
            variables[as_name(name)] = (("t",), table[:, column], attributes(units.get(name, ""), name))
    for name, (array, unit) in scene.arrays().items():
        # If a plot has the same name, the name is that of the state.
        own = f"state_{name}" if name in variables else name
        dimensions = layout.axes.get(name) or tuple(f"{own}_{axis}" for axis in range(array.ndim))
        variables[own] = (dimensions, array, attributes(*split_unit(unit)))
    # The columns of the plots are there already.
    for name, measure in (measured(kind, scene) if kind.quantities else {}).items():
        own = f"measured_{name}" if name in variables else name
        variables[own] = ((), np.array(measure.value), attributes(measure.unit, measure.meaning))
    for parameter, columns in (scene.curves() or {}).items():
        variables.update(columns_of(kind, parameter, columns))
    coordinates: dict[str, tuple[str | tuple[str, ...], np.ndarray, dict[str, str]]] = {
        "t": ("t", table[:, 0], attributes("s", "simulated time")),
        "now": ((), np.array(scene.time), attributes("s", "simulated time of the state")),
    }
    for dimension, labels in layout.labels.items():
        coordinates[dimension] = (dimension, np.array(labels), {})
    values = {name: getattr(scene.params, name) for name in parameters_of(scene.params)}
    about = {"scene": kind.name, "link": link, "parameters": json.dumps(values),
             "notes": "\n".join(kind.notes(scene.params))}  # fmt: skip
    return xr.Dataset(variables, coordinates, about)


def columns_of(kind: AnyKind, parameter: str, columns: Chart | Columns) -> Mapping[str, Labelled]:
    """The columns of a chart that is not over time, as variables over its own dimension."""
    dimension, axes = parameter.removeprefix("plot_"), kind.curves[parameter]
    return {
        as_name(f"{dimension}_{name}"): ((dimension,), values, attributes(unit, f"{axes.title}: {name}"))
        for name, unit, values in numbers_of(axes, chart_of(axes, columns))
    }


def as_name(words: str) -> str:
    """Words as a name that can follow a dot."""
    return "".join(c if c.isalnum() else "_" for c in words)


def split_unit(text: str) -> tuple[str, str]:
    """Unit and meaning of a text such as "J: kinetic, elastic" or "m, of each rope"."""
    at = min((text.find(mark) for mark in (":", ",") if mark in text), default=math.inf)
    return (text, "") if at == math.inf else (text[: int(at)], text[int(at) + 1 :].strip())


def attributes(unit: str, meaning: str = "") -> dict[str, str]:
    """The attributes of a variable."""
    return {"units": unit or "1", **({"long_name": meaning} if meaning else {})}
