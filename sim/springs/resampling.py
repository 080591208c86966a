"""A net's state on another number of points, so that a motion continues when the grid changes."""

import numpy as np
from numpy.typing import NDArray


def resample(values: NDArray[np.float64], rows: int, cols: int) -> NDArray[np.float64]:
    """(3, rows, cols) linear interpolation of (3, r, c) positions or velocities, spread evenly along both axes.

    A rope has one row. The same numbers of rows and columns give the same values, bit for bit.
    """
    old_rows, old_cols = (np.linspace(0.0, 1.0, count) for count in values.shape[1:])
    new_rows, new_cols = np.linspace(0.0, 1.0, rows), np.linspace(0.0, 1.0, cols)
    in_rows = np.array([[np.interp(new_cols, old_cols, row) for row in component] for component in values])
    in_cols = [[np.interp(new_rows, old_rows, column) for column in component.T] for component in in_rows]
    return np.ascontiguousarray(np.moveaxis(np.array(in_cols), 1, 2))
