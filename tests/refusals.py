"""Tables of bad arguments: rows of the name in the error, the call that is refused, and words of the error."""

import functools
import re
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest

ARRAYS = (list, tuple, np.ndarray)
Row = tuple[str, Callable[[], object], str]


def each(call: Callable[..., object], prefix: str = "", **bad: Iterable[Any]) -> list[Row]:
    """A row for each bad value of each argument by name, behind `prefix` in the error, which shows the value.

    Some functions show what is like an array as the array that they made of it.
    """
    return [
        (prefix + name, functools.partial(call, **{name: value}), "" if isinstance(value, ARRAYS) else repr(value)[:99])
        for name, values in bad.items()
        for value in values
    ]


def assert_refused(name: str, call: Callable[[], object], words: str = "") -> None:
    """A ValueError that begins with the name and says what is allowed, with `words` in it."""
    with pytest.raises(ValueError, match=rf"(?s)^{re.escape(name)}: .* is not allowed; allowed: \S") as error:
        call()
    assert words in str(error.value)
