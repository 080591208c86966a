"""Results of a student's function: their form, and their comparison with another function's."""

import copy
from collections.abc import Callable
from typing import Any

import numpy as np

from app.lab.checking import Wrong
from app.lab.process.rope_march import entries
from app.lab.process.wire import Foreign

TOLERANCE = 1e-4  # of the largest value of a result: single precision is right too
REPAIR_TOLERANCE = 1e-5  # the same, for what an edit makes right: a small part that is wrong shows at other inputs
FORM_TOLERANCE = 1e-9  # of the largest value of a student's result, within which a form agrees
SINGLE_TOLERANCE = 2e-5  # the same, of results in single precision

# Cures for results of some types.
CURES = {
    "generator": ": write return in place of yield, or list(...) around the brackets",
    "map": ": write list(...) around map(...)",
    "zip": ": write list(...) around zip(...)",
    "coroutine": ": leave out async",
    "function": ": call the function that it returns",
    "builtin_function_or_method": ": call the function that it returns",
    "dict": ": leave out the names",
}


def call(function: Any, arguments: tuple[Any, ...]) -> Any:
    """The function's value at copies of the arguments, without numpy's warnings."""
    with np.errstate(all="ignore"):
        return function(*(copy.deepcopy(a) if isinstance(a, np.ndarray | list) else a for a in arguments))


def conform(value: Any, like: Any) -> Any:
    """`value` in the form of a reference result: a float, an array of float64 or a tuple. Raises Wrong otherwise."""
    if value is None:
        raise Wrong("it returns nothing here: each way through the function must end with a return", "returns nothing")
    if isinstance(value, Foreign | str):
        type_name = value.type_name if isinstance(value, Foreign) else "text"
        cure = CURES.get(type_name, "")
        raise Wrong(f"it returns a value of type {type_name}; expected {form_of(like)}{cure}", "wrong type")
    if isinstance(like, tuple):
        if isinstance(value, np.ndarray):
            value = list(value) if value.ndim else [value]
        if not isinstance(value, tuple | list) or len(value) != len(like):
            raise Wrong(f"it returns {form_of(value)}; expected {form_of(like)}", "wrong shape")
        return tuple(conform(part, entry) for part, entry in zip(value, like, strict=True))
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind == "c":
        raise Wrong("it returns complex numbers: look for the root of a negative number", "wrong type")
    if array.dtype.kind not in "biuf":
        raise Wrong(f"it returns {form_of(value)}; expected {form_of(like)}", "wrong type")
    array = array.astype(np.float64)
    if np.ndim(like) == 0:
        if array.size != 1:
            raise Wrong(f"it returns {form_of(value)}; expected {form_of(like)}", "wrong shape")
        return float(array.reshape(()))
    return array


def form_of(value: Any) -> str:
    """The form of a result, in words."""
    if isinstance(value, tuple):
        return "a tuple of " + " and ".join(form_of(part) for part in value)
    if isinstance(value, list):
        return f"a list of {entries(len(value))}"
    shape = np.shape(value)
    return f"an array of shape {shape}" if shape else "a number"


def parts(value: Any) -> tuple[np.ndarray, ...]:
    """A result as arrays."""
    return tuple(np.asarray(part, np.float64) for part in (value if isinstance(value, tuple) else (value,)))


def same_shape(result: Any, expected: Any) -> bool:
    """True if two results have arrays of the same shapes."""
    return [a.shape for a in parts(result)] == [b.shape for b in parts(expected)]


def same(result: Any, expected: Any, tolerance: float = TOLERANCE) -> bool:
    """True if two results agree within the tolerance, every part relative to its largest value."""
    if not same_shape(result, expected):
        return False
    for a, b in zip(parts(result), parts(expected), strict=True):
        finite = np.isfinite(b)
        scale = np.abs(b[finite]).max(initial=0.0)
        if not np.array_equal(a[~finite], b[~finite], equal_nan=True):
            return False
        if not (np.abs(a[finite] - b[finite]) <= tolerance * scale + 1e-12).all():
            return False
    return True


def has(is_such: Callable[[np.ndarray], np.ndarray], value: Any) -> bool:
    """True if a result has a number of a kind."""
    return any(is_such(part).any() for part in parts(value))


def reproduces(form: Any, result: Any, right: Any) -> bool:
    """True if a form gives a student's result, relative to it, however small. right: for rounding."""
    if not same_shape(form, result):
        return False
    for a, b, c in zip(parts(form), parts(result), parts(right), strict=True):
        finite = np.isfinite(b)
        if not np.array_equal(a[~finite], b[~finite], equal_nan=True):
            return False
        with np.errstate(over="ignore"):
            is_single = np.array_equal(b[finite].astype(np.float32), b[finite])
        tolerance = SINGLE_TOLERANCE if is_single else FORM_TOLERANCE
        rounding = 1e-12 * np.abs(c[np.isfinite(c)]).max(initial=0.0)
        scale = tolerance * np.abs(b[finite]).max(initial=0.0) + rounding
        if not (np.abs(a[finite] - b[finite]) <= scale).all():
            return False
    return True
