"""Timing calls in turn, so that what else the machine does falls on all of them alike."""

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any


def interleaved(functions: Sequence[Callable[[], Any]], repeats: int) -> list[float]:
    """Median time of each [s], called in turn after a call of each that is not timed, to compile and plan."""
    taken: list[list[float]] = [[] for _ in functions]
    for function in functions:
        function()
    for _ in range(repeats):
        for times, function in zip(taken, functions, strict=True):
            start = time.perf_counter()
            function()
            times.append(time.perf_counter() - start)
    return [statistics.median(times) for times in taken]
