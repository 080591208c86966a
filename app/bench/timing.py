"""Timing calls in turn, so that what else the machine does falls on all of them alike."""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any


def in_turn(calls: Sequence[Callable[[], Any]], most: int, enough: float = math.inf) -> list[list[float]]:
    """Wall times [s] of each, taken in turn until there are `most` of each or the first's add up to `enough` [s]."""
    taken: list[list[float]] = [[] for _ in calls]
    while len(taken[0]) < most and sum(taken[0]) < enough:
        for times, call in zip(taken, calls, strict=True):
            start = time.perf_counter()
            call()
            times.append(time.perf_counter() - start)
    return taken


def interleaved(calls: Sequence[Callable[[], Any]], repeats: int) -> list[float]:
    """Median time of each [s], in turn after a call of each that is not timed, to compile and plan."""
    for call in calls:
        call()
    return [statistics.median(times) for times in in_turn(calls, repeats)]
