"""Calls a student's function at many arguments, in the process that runs it: a table for a scene.

Only numpy is imported here, so that the process starts fast.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.process.rope_march import Unfit, fitting, not_a_number


class Interval(NamedTuple):
    """Values that a result may have, ends included."""

    low: float
    high: float
    unit: str

    def __str__(self) -> str:
        if np.isinf(self.high):
            return f"{self.low:g} {self.unit} or more".replace("  ", " ")
        return f"{self.low:g} to {self.high:g} {self.unit}".rstrip()


def tabulate(
    function: Callable[..., Any],
    name: str,
    columns: Sequence[np.ndarray],
    shape: tuple[int, ...] | None,
    allowed: Interval,
) -> np.ndarray:
    """(n, *shape) results of the function for each row of its arguments, columns of shape (n, ...).

    shape: None for the number of entries of each result, (n,). Raises Unfit for a result of another shape or type, or
    that is not finite or not allowed.
    """
    rows = len(columns[0])
    table = np.empty((rows, *(shape or ())))
    with np.errstate(all="ignore"):
        for i in range(rows):
            row = [column[i].copy() if column.ndim > 1 else column[i].item() for column in columns]
            result = function(*row)
            value = np.array(float(len(result))) if shape is None else fitting(name, result, shape, function)
            if np.isnan(value).any():
                raise not_a_number(name, function)
            is_fit = (allowed.low <= value) & (value <= allowed.high) & ~np.isinf(value)
            if not is_fit.all():
                arguments = ", ".join(np.array2string(column[i], precision=4) for column in columns)
                text = f"{name}({arguments}) returns {value[~is_fit][0]:.4g}; expected {allowed}"
                raise Unfit("out of range", text, function)
            table[i] = value
    return table
