"""Roots of functions of one variable, by the one bracketed search that the library uses."""

from collections.abc import Callable
from typing import Any

import numpy as np

EPSILON = float(np.finfo(np.float64).eps)


def narrowed(
    value_at: Callable[[Any], Any], low: Any, high: Any, resolution: float = 0.0, *, has_slope: bool = False
) -> tuple[Any, Any]:
    """The ends of a bracket of a root, narrowed to `resolution`, or to rounding: the value is below 0 at the first.

    low, high: floats, or arrays of one shape for as many searches at once. value_at(x): below 0 left of the root, 0 or
    above right of it, at x like `low`; with has_slope the pair of this and its derivative. Neither end is evaluated, so
    a value of one sign alone leads to an end.

    Newton's method, with the secant if there is no slope. A step that leaves the bracket, or is longer than half the
    one before, is replaced by halving (Press et al. 2007, Numerical Recipes, section 9.4), so that a function that
    jumps, has no slope, or tells only the sign is searched too. The last step leads to just beyond the root, so that
    both ends of the bracket are known.
    """
    low, high = np.asarray(low, np.float64), np.asarray(high, np.float64)
    x, before, before_value = low + 0.5 * (high - low), np.nan, np.nan
    stride, least = high - low, np.zeros_like(low)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        while True:
            value, slope = value_at(x[()]) if has_slope else (value_at(x[()]), None)
            if slope is None:
                slope = (value - before_value) / (x - before)
            is_below = np.less(value, 0.0)
            low, high = np.where(is_below, x, low), np.where(is_below, high, x)
            finest = np.maximum(resolution, 4.0 * EPSILON * np.maximum(np.abs(low), np.abs(high)))
            middle = low + 0.5 * (high - low)
            if ((high - low <= finest) | (middle <= low) | (middle >= high)).all():  # or no number lies between
                return low[()], high[()]
            # Where a step to just beyond the root was too short, as round-off hides the root, the next is longer.
            is_led = (stride == least) & (is_below == np.less(before_value, 0.0))
            least = np.where(is_led, 4.0 * least, 0.5 * finest)
            step = np.abs(np.asarray(value) / slope)
            is_newton = (step <= np.maximum(0.5 * stride, least)) & (slope > 0.0)
            move = np.maximum(step, least)
            after = np.where(is_below, x + move, x - move)
            is_newton &= (low < after) & (after < high)
            stride = np.where(is_newton, move, 0.5 * (high - low))
            before, before_value, x = x, value, np.where(is_newton, after, low + 0.5 * (high - low))
