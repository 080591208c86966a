"""A chart whose lines are known only as the scene runs: what a scene's `curves` may give for a knob."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Line(NamedTuple):
    """How one column is drawn."""

    label: str
    colour: str  # CSS
    width: float = 2.0
    dash: tuple[float, ...] = ()
    fill: str = ""  # CSS colour of the area below


class Chart(NamedTuple):
    """Columns over a first one, whole at each snapshot; a NaN leaves a gap."""

    title: str
    first: str  # label of the first column
    lines: tuple[Line, ...]
    columns: tuple[NDArray[np.float64], ...]  # the first, then one a line
    ticks: tuple[tuple[float, str], ...] = ()  # of a logarithmic scale from the first to the last; none: linear, fitted
