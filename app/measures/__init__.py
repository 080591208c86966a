"""What a sweep records of a scene: one module each, named as in `app/scenes`, with `measures(scene)`.

That gives name -> `Measure` of the running scene as it is just now; the names are the same whatever the knobs, and none
is a knob's. A scene without a module here is measured by its plot rows, whose newest is at most one sampling interval
old.
"""

import importlib
import math
import pkgutil
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

from sim.knobs import knobs

NAMES = tuple(module.name for module in pkgutil.iter_modules(__path__))


class Measure(NamedTuple):
    """One number of a running scene."""

    value: float
    unit: str
    meaning: str


def measures_named(name: str) -> Callable[[Any], dict[str, Measure]] | None:
    """The scene's `measures`, or None where it has none of its own."""
    return importlib.import_module(f"{__name__}.{name}").measures if name in NAMES else None


def plotted(scene: ModuleType, row: tuple[float, ...]) -> dict[str, Measure]:
    """A plot row (t, ...) of a scene's module as measures; () is a row of nothing."""
    values = dict(zip(scene.SERIES, row[1:], strict=True)) if row else {}
    taken = knobs(scene.Params)
    found = {}
    for title, unit, series in scene.PLOTS.values():
        for column in series:
            name = slug(column)
            # The energy of gravity is not the knob gravity.
            name = f"{name}_{slug(title)}" if name in taken else name
            meaning = column if column == title.lower() else f"{title}: {column}"
            found[name] = Measure(values.get(column, math.nan), unit, meaning)
    return found


def slug(words: str) -> str:
    """Words as a name: "Red buoy's height" is red_buoys_height."""
    return "_".join("".join(c for c in words.lower() if c.isalnum() or c in " -_").replace("-", " ").split())
