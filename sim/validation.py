"""Checks of arguments: every error names the argument, the value given and the allowed values, in one line.

A solver that fails has no argument to name: it raises `ConvergenceError`.
"""

import dataclasses
import math
import os
from collections.abc import Iterable
from types import UnionType
from typing import Any, TypeVar

import numpy as np

MAX_DISTANCE = 1e12  # [m] of a position: farther away, the cells of a grid can no longer be counted
MAX_WAVENUMBER = 1e20  # [rad/m]: its powers are still finite
MAX_FREQUENCY = 1e10  # [rad/s] of waves: their wavenumber is then below MAX_WAVENUMBER, too
MAX_SHOWN = 200  # characters of a value in an error
MAX_SHOWN_PATH = 4096  # of one with a path in it, which is shown whole: most systems allow no longer one

MAX_REASONS = 12  # of refusals in one message

Kind = TypeVar("Kind")


class ApproximationWarning(UserWarning):
    """Warning of a result that is not exactly the one asked for; the message names the approximation."""


class ConvergenceError(RuntimeError):
    """A solver that ended without a solution, although its arguments are allowed; its message is one line."""

    def __init__(self, solver: str, residual: str, iterations: int) -> None:
        """solver: name of the problem. residual: with its unit and its place. iterations: number done."""
        super().__init__(f"{solver}: no solution after {iterations} iterations; {residual} left")
        self.solver, self.residual, self.iterations = solver, residual, iterations

    def __reduce__(self) -> tuple[type["ConvergenceError"], tuple[str, str, int]]:
        """Arguments of the error, so that it passes between processes."""
        return ConvergenceError, (self.solver, self.residual, self.iterations)


class DivergenceError(ArithmeticError):
    """A run left any sane bound: the text gives the cause, and a remedy."""

    def __init__(self, text: str, moments: tuple[Any, ...] = ()) -> None:
        """moments: the last ones before that, if there are any to show again slowly."""
        super().__init__(text)
        self.moments = moments


class Refusals:
    """Collects the ValueErrors of its `with` blocks, so that a user learns of all mistakes at once."""

    def __init__(self) -> None:
        self.reasons: list[str] = []

    def __enter__(self) -> None:
        """Begin a block."""

    def __exit__(self, kind: object, error: object, trace: object) -> bool:
        """Keep the reason of a block that was refused."""
        if isinstance(error, ValueError):
            self.reasons.append(str(error))
        return isinstance(error, ValueError)

    def check(self) -> None:
        """Raises ValueError with all reasons, if there are any, or with the first ones and the number of the others."""
        more = len(self.reasons) - MAX_REASONS
        if self.reasons:
            others = [f"{more} more"] if more > 0 else []
            raise ValueError("; ".join([*self.reasons[:MAX_REASONS], *others]))


def argument_error(name: str, value: object, allowed: str) -> ValueError:
    """The form of every argument error, in one line: the name, the value given, and the allowed values."""
    text = repr(value) if isinstance(value, str) else " ".join(repr(value).split())  # in one line, arrays too
    if len(text) > (MAX_SHOWN_PATH if isinstance(value, str) and os.sep in value else MAX_SHOWN):
        is_record = dataclasses.is_dataclass(value) or hasattr(value, "_fields")
        text = f"{type(value).__name__}(...)" if is_record else f"{text[:MAX_SHOWN]}..."
    return ValueError(f"{name}: {text} is not allowed; allowed: {allowed}")


def unreadable(name: str, path: object, error: OSError) -> ValueError:
    """The error for a file that cannot be read: "no such file" if it is missing."""
    reason = "no such file" if isinstance(error, FileNotFoundError) else error.strerror or str(error)
    return ValueError(f"{name}: {path}: {reason[:1].lower()}{reason[1:]}")


def as_float(value: object) -> float:
    """A real number of any kind as a float; NaN for anything else, True and "1" included."""
    if type(value) is float:
        return value
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.integer | np.floating):
        return math.nan
    try:
        return float(value)
    except OverflowError:
        return math.inf


def is_whole_number(value: object) -> bool:
    """True if `value` is an integer (and no bool)."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def check_number(
    name: str, value: object, unit: str, low: float = -math.inf, high: float = math.inf, *, above: bool = False
) -> float:
    """`value` as a finite float in [low, high], or in (low, high] with `above`.

    Raises ValueError with the name, the value and the range.
    """
    number = as_float(value)
    if math.isfinite(number) and low <= number <= high and not (above and number == low):
        return number
    limits = limits_text(low, high, above=above)
    if not limits:
        raise argument_error(name, value, f"a finite number [{unit}]" if unit else "a finite number")
    words = [] if math.isfinite(number) else ["a finite number"] + ["of"] * limits.startswith("at")
    raise argument_error(name, value, " ".join([*words, limits, unit]).rstrip())


def limits_text(low: float, high: float, *, above: bool) -> str:
    """The interval [low, high], or (low, high] with `above`, in words; "" without ends."""
    if low == -math.inf:
        return "" if high == math.inf else f"at most {high:g}"
    if high == math.inf:
        return f"above {low:g}" if above else f"at least {low:g}"
    return f"above {low:g}, at most {high:g}" if above else f"from {low:g} to {high:g}"


def check_positive(name: str, value: object, unit: str, *, allow_infinite: bool = False) -> float:
    """`value` as a float above 0, finite unless `allow_infinite`. Raises ValueError otherwise."""
    if allow_infinite and as_float(value) == math.inf:
        return math.inf
    return check_number(name, value, f"{unit}, or inf" if allow_infinite else unit, 0.0, above=True)


def check_angle(name: str, value: object) -> float:
    """`value` as a float [rad] within one turn, so that degrees are noticed. Raises ValueError otherwise."""
    number = as_float(value)
    if not abs(number) <= 2.0 * math.pi:
        raise argument_error(name, value, "an angle from -2 pi to 2 pi rad")
    return number


def check_kind(name: str, value: Kind, kind: type | UnionType, allowed: str) -> Kind:
    """`value` itself. Raises ValueError unless it is a `kind`."""
    if not isinstance(value, kind):
        raise argument_error(name, value, allowed)
    return value


def check_choice(name: str, value: object, choices: Iterable[str]) -> str:
    """`value` as one of `choices`. Raises ValueError otherwise."""
    allowed = tuple(choices)
    if not isinstance(value, str) or value not in allowed:
        raise argument_error(name, value, "one of " + ", ".join(allowed))
    return value


def check_vector(name: str, value: object, unit: str, length: int = 3) -> tuple[float, ...]:
    """`value` as `length` finite floats. Raises ValueError otherwise."""
    numbers = tuple(as_float(c) for c in value) if isinstance(value, Iterable) else ()
    if len(numbers) != length or not all(math.isfinite(c) for c in numbers):
        raise argument_error(name, value, f"{length} finite numbers [{unit}]")
    return numbers


def as_array(name: str, value: Any, allowed: str) -> np.ndarray:
    """`value` as a float64 array.

    Raises ValueError unless it is a regular array of real numbers; truth values and texts are refused.
    """
    try:
        array = np.asarray(value)
    except ValueError:
        raise argument_error(name, value, allowed) from None
    if array.size and array.dtype.kind not in "iuf":
        raise argument_error(name, value, allowed)
    return array.astype(np.float64)


def read_only(array: np.ndarray) -> np.ndarray:
    """A contiguous copy of an array that nobody can change, for records that are immutable."""
    copy = np.array(array, order="C")
    copy.flags.writeable = False
    return copy


def check_positions(name: str, value: Any, length: int = 2) -> np.ndarray:
    """`value` as contiguous float64 of shape (n, length).

    Raises ValueError for another shape, or positions that are not finite or farther than MAX_DISTANCE.
    """
    allowed = f"positions of shape (n, {length}), finite, at most {MAX_DISTANCE:g} m"
    array = np.ascontiguousarray(as_array(name, value, allowed))
    if array.ndim != 2 or array.shape[1] != length:
        raise argument_error(name, array.shape, allowed)
    bad = ~(np.abs(array) <= MAX_DISTANCE)
    if bad.any():
        raise argument_error(name, float(array[bad][0]), allowed)
    return array


def check_wavenumbers(name: str, value: Any) -> np.ndarray:
    """`value` as a float64 array. Raises ValueError unless every entry is from 0 to MAX_WAVENUMBER."""
    return check_up_to(name, value, MAX_WAVENUMBER, "rad/m")


def check_frequencies(name: str, value: Any) -> np.ndarray:
    """`value` as a float64 array. Raises ValueError unless every entry is from 0 to MAX_FREQUENCY."""
    return check_up_to(name, value, MAX_FREQUENCY, "rad/s")


def check_up_to(name: str, value: Any, high: float, unit: str) -> np.ndarray:
    """`value` as a float64 array. Raises ValueError unless every entry is from 0 to `high`."""
    allowed = f"numbers from 0 to {high:g} {unit}"
    array = as_array(name, value, allowed)
    bad = ~((array >= 0.0) & (array <= high))
    if bad.any():
        raise argument_error(name, float(array[bad].flat[0]), allowed)
    return array
