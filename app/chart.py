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
    """Columns over a first one, whole at each snapshot."""

    first: str  # label of the first column
    lines: tuple[Line, ...]
    columns: tuple[NDArray[np.float64], ...]  # the first, then one a line
    end: float  # of the first column's scale, from 0; best changed seldom, as the chart is then made anew
