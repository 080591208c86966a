"""Numbers and missing values as tables write them."""

import math
import re
from collections.abc import Sequence

import numpy as np

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][-+]?\d+)?", re.ASCII)
MISSING = {"", "-", "--", "nan", "na", "n/a", "null", "none", "mm", "missing", "nodata"}  # in small letters
NINES = re.compile(r"-?(?:99+(?:\.(?:0*|9*))?)", re.ASCII)
FILL = 1e20  # from which on a value is the fill value of a netCDF file: no quantity of a table is so large
NEAR = 2.0  # ratio of a value to its neighbours, up to which digits of 9 are a value like theirs


def is_value(word: str) -> bool:
    """True for a number, or a word for a missing one."""
    return number_of(word) is not None or word.strip().lower() in MISSING


def number_of(word: str) -> float | None:
    """A word as a number, also with the D of Fortran's exponents; inf for a huge one, None for another word."""
    if not NUMBER.fullmatch(word):
        return None
    return float(word.replace("D", "e").replace("d", "e"))


def values_of(words: Sequence[str], trusted: float = 0.0) -> tuple[np.ndarray, int | None]:
    """Numbers (n,) of the words of a column, nan where one is missing; and the first word that is neither, or None.

    Missing are empty words, MM, nan and the like, and numbers of two or more nines that their neighbours do not
    come near: 99.00 among densities below 4 is missing, 99 between 95 and 104 is not. Those from 0 to `trusted` are
    values.
    """
    values, nines = np.full(len(words), math.nan), np.zeros(len(words), bool)
    for i, word in enumerate(words):
        number = number_of(word)
        if number is None:
            if word.strip().lower() not in MISSING:
                return values, i
        elif math.isinf(number):
            return values, i
        elif abs(number) < FILL:
            values[i] = number
            nines[i] = NINES.fullmatch(word) is not None and not 0.0 <= number <= trusted
    return without_nines(values, nines), None


def without_nines(values: np.ndarray, nines: np.ndarray) -> np.ndarray:
    """The values (n,), nan in place of those of digits of 9 that are not near both neighbours; an end has one."""
    whole = np.flatnonzero(np.isfinite(values) & ~nines)
    found = values.copy()
    for i in np.flatnonzero(nines):
        at = int(np.searchsorted(whole, i))
        beside = values[whole[max(at - 1, 0) : at + 1]]
        is_near = len(beside) and all(abs(values[i]) <= NEAR * abs(b) and abs(b) <= NEAR * abs(values[i])
                                      and b * values[i] > 0.0 for b in beside)  # fmt: skip
        if not is_near:
            found[i] = math.nan
    return found
