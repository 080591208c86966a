"""The table of quantities of a scene: name -> unit, meaning, and the number at an instant.

A name is one number in one unit for all that read it: sweeps, `lab.data()`, `run --list`, texts of the panel, and
texts and conditions of tasks. An instant is a snapshot, or for a sweep a scene that is read as one (`SceneInstant`).
"""

import functools
import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

from app.formats.formatting import with_unit
from app.messages import PlotRow
from app.scenes.charts import PlotAxes
from sim.parameters import parameters_of


class Quantity(NamedTuple):
    """One number of a scene."""

    unit: str  # "1" for none
    meaning: str
    value: Callable[[Any], float | None]  # of an instant; None: the scene has no such number then
    recorded: bool = True  # a sweep and `lab.data()` keep it
    shown: bool = True  # a snapshot has it, so a task may name it
    floor: Callable[[Any], float | None] | None = None  # of a length, to which it is known; NaN: it is not known


Quantities = Mapping[str, Quantity]


class HasQuantities(Protocol):
    """The parts of a `SceneKind` from which its quantities come."""

    @property
    def params(self) -> type[Any]:
        """The record of parameters."""
        ...

    @property
    def series(self) -> tuple[str, ...]:
        """Names of the columns of a plot row after its time."""
        ...

    @property
    def plots(self) -> Mapping[str, PlotAxes]:
        """The axes of each plot, by the parameter that opens it."""
        ...

    @property
    def quantities(self) -> Quantities:
        """The table, empty without entries."""
        ...

    @property
    def instant(self) -> Callable[..., object]:
        """The function that makes an instant of a scene, for the recorded quantities."""
        ...


class Measure(NamedTuple):
    """A quantity as a sweep records it."""

    value: float
    unit: str
    meaning: str


class SceneInstant:
    """The present state of a scene, with the parts of a snapshot. Each is made once, when a quantity first needs it.

    A scene whose quantities need more derives its own; none draws a frame.
    """

    def __init__(self, scene: Any) -> None:
        self.scene, self.params = scene, scene.params

    @functools.cached_property
    def readings(self) -> Any:
        """The readings of the scene."""
        return self.scene.readings()


def for_tasks(unit: str, meaning: str, value: Callable[[Any], float | None]) -> Quantity:
    """A quantity that tasks name and no sweep records."""
    return Quantity(unit, meaning, value, recorded=False)


def for_sweeps(unit: str, meaning: str, value: Callable[[Any], float | None]) -> Quantity:
    """A quantity that a snapshot lacks: only the scene itself can compute it."""
    return Quantity(unit, meaning, value, shown=False)


def read(table: Quantities, name: str, instant: Any) -> float:
    """The number of this name at an instant; NaN if the scene does not have it then."""
    value = table[name].value(instant)
    return math.nan if value is None else value


def written(table: Quantities, name: str, instant: Any, digits: int = 3) -> str:
    """The number of this name with its unit, as texts of the panel write it."""
    return with_unit(read(table, name, instant), table[name].unit, digits)


def measured(kind: HasQuantities, scene: Any, row: PlotRow = ()) -> dict[str, Measure]:
    """The recorded quantities of a scene, NaN for those that it does not have now.

    row: the newest plot row, for a scene without a table.
    """
    instant = kind.instant(scene) if kind.quantities else dict(zip(kind.series, row[1:], strict=False))
    table = recorded_quantities(kind)
    return {name: Measure(read(table, name, instant), one.unit, one.meaning) for name, one in table.items()}


def recorded_quantities(kind: HasQuantities) -> Quantities:
    """The quantities that a sweep of the scene records; those of its plots if it has no table."""
    table = kind.quantities or plotted_quantities(kind)
    return {name: quantity for name, quantity in table.items() if quantity.recorded}


def plotted_quantities(kind: HasQuantities) -> Quantities:
    """The columns of the plots as quantities. Their instant is a plot row: column -> value."""
    taken = parameters_of(kind.params)
    quantities = {}
    for axes in kind.plots.values():
        for column in axes.series:
            name = slug(column)
            # The energy of gravity is not the parameter gravity.
            name = f"{name}_{slug(axes.title)}" if name in taken else name
            meaning = column if column == axes.title.lower() else f"{axes.title}: {column}"
            quantities[name] = Quantity(
                axes.unit or "1", meaning, lambda row, column=column: row.get(column), shown=False
            )
    return quantities


def slug(words: str) -> str:
    """Words as a name: "Red buoy's height" is red_buoys_height."""
    return "_".join("".join(c for c in words.lower() if c.isalnum() or c in " -_").replace("-", " ").split())
