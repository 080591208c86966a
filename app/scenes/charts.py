"""What a chart shows: of the plot rows over time, or of columns that a scene makes whole."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# Colours that can be told apart with any colour vision (Okabe and Ito, 2008); black and yellow last.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
Columns = tuple[NDArray[np.floating], ...]  # the first is what the others stand over


class PlotAxes(NamedTuple):
    """A chart over time, of columns of the plot rows."""

    title: str
    unit: str
    series: tuple[str, ...]  # names in the scene's `series`


class CurveAxes(NamedTuple):
    """A chart of columns that `Scene.curves` gives whole."""

    title: str
    first: str  # label of the first column
    names: tuple[str, ...]  # of the others
    ticks: tuple[tuple[float, str], ...] = ()  # (value, word) from end to end of a logarithmic scale


class Line(NamedTuple):
    """How one column is drawn."""

    label: str
    colour: str  # CSS
    width: float = 2.0
    dash: tuple[float, ...] = ()
    fill: str = ""  # CSS colour of the area below


class Chart(NamedTuple):
    """Columns with lines that are known only as the scene runs."""

    first: str  # label of the first column
    lines: tuple[Line, ...]
    columns: tuple[NDArray[np.float64], ...]  # the first, then one a line
    end: float  # of the first column's scale, from 0; a change replaces the chart, so it should be rare
