"""Contents of a chart: columns of the plot rows over time, or columns that a scene makes whole."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from app.messages import ChartLine

# Colours that can be told apart with any colour vision (Okabe and Ito, 2008); black and yellow last.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
# To tell lines apart in grey, and to see one below another.
DASHES = ((), (10.0, 4.0), (3.0, 3.0), (12.0, 3.0, 3.0, 3.0), (6.0, 6.0), (1.0, 4.0))
COLOURS = ("#7048e8", "#1c7ed6", "#f76707", "#12b886", "#e64980", "#868e96", "#e03131")
Column: TypeAlias = NDArray[np.floating]
Columns: TypeAlias = tuple[Column, ...]  # the first is what the others stand over


class PlotAxes(NamedTuple):
    """A chart over time, of columns of the plot rows."""

    title: str
    unit: str
    series: tuple[str, ...]  # names in the scene's `series`
    least: float = 0.0  # range of the scale, at least, so that rounding does not fill it
    dashed: bool = False  # lines that may cover one another

    @property
    def lines(self) -> tuple[ChartLine, ...]:
        """Styles of its series."""
        lines = lines_of(self.series)
        return dashed(lines) if self.dashed else lines

    @property
    def heading(self) -> str:
        """Title and unit."""
        return f"{self.title} [{self.unit}]"


class CurveAxes(NamedTuple):
    """A chart of columns that `Scene.curves` gives whole."""

    title: str
    unit: str
    first: str  # label of the first column
    names: tuple[str, ...]  # of the others
    ticks: tuple[tuple[float, str], ...] = ()  # (value, word) from end to end of a logarithmic scale
    least: float = 0.0  # range of a linear scale, at least

    @property
    def heading(self) -> str:
        """Title and unit; the words of a logarithmic scale have units."""
        return self.title if self.ticks else f"{self.title} [{self.unit}]"


class Chart(NamedTuple):
    """Columns with lines that are known only as the scene runs."""

    first: str  # label of the first column
    lines: tuple[ChartLine, ...]
    columns: Columns  # the first, then one a line
    end: float | None = None  # of the first column's scale, from 0; None to fit it to the data; a change should be rare
    # Numbers of each line for files, if what is drawn is stacked or clipped; None for a line that is only a mark.
    numbers: tuple[Column | None, ...] | None = None


class Numbers(NamedTuple):
    """One column of a chart for files."""

    name: str
    unit: str
    values: Column


def lines_of(names: Sequence[str]) -> tuple[ChartLine, ...]:
    """The lines of a chart that has them from the start; the sum of the others is drawn the widest."""
    return tuple(
        ChartLine(name, colour, 3.0 if name == "total" else 2.0) for name, colour in zip(names, COLOURS, strict=False)
    )


def dashed(lines: Sequence[ChartLine]) -> tuple[ChartLine, ...]:
    """The lines with unlike dashes."""
    return tuple(line._replace(dash=dash) for line, dash in zip(lines, itertools.cycle(DASHES)))


def with_numbers(
    lines: Sequence[ChartLine], columns: Sequence[Column]
) -> tuple[tuple[ChartLine, ...], tuple[Column, ...]]:
    """The lines that have a number, and their columns, such as those of the moorings there are; all if none has one."""
    there = [bool(np.isfinite(column).any()) for column in columns]
    chosen = [i for i, has in enumerate(there) if has or not any(there)]
    return tuple(lines[i] for i in chosen), tuple(columns[i] for i in chosen)


def chart_of(axes: CurveAxes, columns: Chart | Columns) -> Chart:
    """The chart that a scene's columns are drawn as."""
    return columns if isinstance(columns, Chart) else Chart(axes.first, lines_of(axes.names), columns)


def numbers_of(axes: CurveAxes, chart: Chart) -> list[Numbers]:
    """The columns of a chart for files, the first column first."""
    first, _, unit = chart.first.removesuffix("]").partition(" [")
    values = chart.columns[1:] if chart.numbers is None else chart.numbers
    columns = zip(chart.lines, values, strict=True)
    return [
        Numbers(first, unit, chart.columns[0]),
        *(Numbers(line.label, axes.unit, column) for line, column in columns if column is not None),
    ]
