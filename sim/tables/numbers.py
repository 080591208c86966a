"""Numbers and missing values as tables write them."""

import math
import re
from collections.abc import Collection, Sequence

import numpy as np

from sim.quantities import number_alone, read_number

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?", re.ASCII)
MISSING = {"", "-", "--", "nan", "na", "n/a", "null", "none", "mm", "missing", "nodata"}  # in small letters
NINES = re.compile(r"-?(?:99+(?:\.(?:0*|9*))?)", re.ASCII)
FILL = 1e20  # from which on a value is the fill value of a netCDF file: no quantity of a table is so large
BEYOND = 2.0  # times the largest of the other values, from which on digits of 9 are no value like them


def is_value(word: str) -> bool:
    """True for a number, or a word for a missing one."""
    return number_of(word) is not None or word.strip().lower() in MISSING


def number_of(word: str) -> float | None:
    """A word as a number, also with the D of Fortran's exponents; inf for a huge one, None for another word."""
    if NUMBER.fullmatch(word):
        return float(word.replace("D", "e").replace("d", "e"))
    try:
        return number_alone(word)
    except ValueError:  # 1,000
        return None


def with_unit(word: str, unit: str) -> float | None:
    """A word with a unit as a number in the unit of its column, as `read_number` reads it; None for another word."""
    try:
        return read_number(word, unit) if unit else None
    except ValueError:
        return None


def values_of(words: Sequence[str], missing: Collection[float] = (), unit: str = "") -> tuple[np.ndarray, int | None]:
    """Numbers (n,) of the words of a column, nan where one is missing; and the first word that is neither, or None.

    Missing are empty words, MM, nan and the like, fill values of netCDF, and numbers of `missing`. unit: of the column;
    a word may have another one of the same quantity.
    """
    values = np.full(len(words), math.nan)
    for i, word in enumerate(words):
        number = number_of(word)
        if number is None:
            if word.strip().lower() in MISSING:
                continue
            number = with_unit(word, unit)
        if number is None or math.isinf(number):
            return values, i
        if abs(number) < FILL and number not in missing:
            values[i] = number
    return values, None


def of_nines(words: Sequence[str]) -> np.ndarray:
    """True (n,) for words of two or more digits of 9, which many programs write for a missing value."""
    return np.array([word[:1] in "9-" and NINES.fullmatch(word) is not None for word in words], bool)


def beyond_others(values: np.ndarray, nines: np.ndarray) -> np.ndarray:
    """True (n,) for values of digits of 9 that are more than BEYOND times all other ones (n,)."""
    others = np.abs(values[~nines & np.isfinite(values)])
    return nines & (np.abs(values) > BEYOND * float(others.max(initial=0.0)))
