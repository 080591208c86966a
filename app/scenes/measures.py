"""Default measures of a sweep for a scene that declares none: its plot rows."""

import math
from typing import Any

from app.messages import PlotRow
from app.scenes.contract import Measure, SceneKind
from sim.parameters import parameters_of


def plotted(scene: SceneKind[Any, Any, Any], row: PlotRow) -> dict[str, Measure]:
    """A plot row (t, ...) of a scene's module as measures; () is a row of nothing."""
    values = dict(zip(scene.series, row[1:], strict=True)) if row else {}
    taken = parameters_of(scene.params)
    found = {}
    for axes in scene.plots.values():
        for column in axes.series:
            name = slug(column)
            # The energy of gravity is not the parameter gravity.
            name = f"{name}_{slug(axes.title)}" if name in taken else name
            meaning = column if column == axes.title.lower() else f"{axes.title}: {column}"
            found[name] = Measure(values.get(column, math.nan), axes.unit, meaning)
    return found


def slug(words: str) -> str:
    """Words as a name: "Red buoy's height" is red_buoys_height."""
    return "_".join("".join(c for c in words.lower() if c.isalnum() or c in " -_").replace("-", " ").split())
