"""Checks of what nets are built of: one clear line that names the thing, its value and what is allowed."""

import math
from collections.abc import Iterable

import numpy as np

from sim.knobs import refusal


def as_float(value: object) -> float:
    """A real number of any kind as a float; NaN for anything else, True and "1" included."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def check_number(name: str, value: object, lo: float, hi: float, unit: str, *, above: bool = False) -> float:
    """`value` as a float in [lo, hi] (above: in (lo, hi]); raises ValueError with name, value and range."""
    number = as_float(value)
    if math.isfinite(number) and lo <= number <= hi and not (above and number == lo):
        return number
    low = f"above {lo:g}" if above else f"from {lo:g}"
    allowed = f"{low}{f' to {hi:g}' if hi < math.inf else ''} {unit}".rstrip()
    raise refusal(name, value, allowed if allowed != "from -inf" else "a finite number")


def check_vector(name: str, value: object, length: int = 3) -> tuple[float, ...]:
    """`value` as `length` finite floats; raises ValueError otherwise."""
    numbers = tuple(as_float(c) for c in value) if isinstance(value, Iterable) else ()
    if len(numbers) != length or not all(math.isfinite(c) for c in numbers):
        raise refusal(name, value, f"{length} finite numbers [m]")
    return numbers


def check_choice(name: str, value: object, choices: Iterable[str]) -> str:
    if not isinstance(value, str) or value not in choices:
        raise refusal(name, value, "one of " + ", ".join(choices))
    return value
