"""Checks of arguments: one refusal in one form for a number that physics does not allow."""

import math
from typing import Any

import numpy as np

from sim.knobs import refusal


def above_zero(name: str, value: Any, unit: str, infinite: bool = False) -> float:
    """`value` as a float. Raises ValueError unless it is above 0 (and finite, unless `infinite`)."""
    allowed = f"a number above 0 {unit}" + (", or inf" if infinite else "")
    number = as_number(name, value, allowed)
    if not number > 0.0 or (math.isinf(number) and not infinite):
        raise refusal(name, value, allowed)
    return number


def not_negative(name: str, value: Any, unit: str) -> float:
    """`value` as a float. Raises ValueError unless it is finite and 0 or above."""
    allowed = f"0 or above, finite {unit}"
    number = as_number(name, value, allowed)
    if not 0.0 <= number < math.inf:
        raise refusal(name, value, allowed)
    return number


def within(name: str, value: Any, lo: float, hi: float, unit: str = "") -> float:
    """`value` as a float. Raises ValueError unless lo <= value <= hi."""
    allowed = f"{lo:g} to {hi:g} {unit}".rstrip()
    number = as_number(name, value, allowed)
    if not lo <= number <= hi:
        raise refusal(name, value, allowed)
    return number


def finite(name: str, value: Any, unit: str = "") -> float:
    """`value` as a float. Raises ValueError unless it is finite."""
    allowed = f"a finite number {unit}".rstrip()
    number = as_number(name, value, allowed)
    if not math.isfinite(number):
        raise refusal(name, value, allowed)
    return number


def is_whole(value: Any) -> bool:
    """Whether `value` is an integer (and no bool)."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def as_number(name: str, value: Any, allowed: str) -> float:
    """`value` as a float. Raises ValueError for what is no real number."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        raise refusal(name, value, allowed)
    return float(value)


def positions(name: str, value: Any) -> np.ndarray:
    """`value` as contiguous float64 of shape (n, 2). Raises ValueError for another shape or what is not finite."""
    array = np.ascontiguousarray(value, np.float64)
    if array.ndim != 2 or array.shape[1] != 2:
        raise refusal(name, array.shape, "positions of shape (n, 2) [m]")
    if not np.isfinite(array).all():
        raise refusal(name, float(array[~np.isfinite(array)][0]), "finite positions [m]")
    return array


def wavenumbers(name: str, value: Any) -> np.ndarray:
    """`value` as a float64 array. Raises ValueError unless every entry is finite and 0 or above."""
    array = np.asarray(value, dtype=np.float64)
    bad = ~((array >= 0.0) & np.isfinite(array))
    if bad.any():
        raise refusal(name, float(array[bad].flat[0]), "0 or above, finite rad/m")
    return array
