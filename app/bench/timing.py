"""Ways to time a call. Calls that are compared are timed in turns, so that other load on the machine hits all alike."""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any


def processor_time(call: Callable[[], Any]) -> float:
    """Processor time of this thread in a call [s], which other programs on the machine do not lengthen."""
    start = time.thread_time()
    call()
    return time.thread_time() - start


def in_turns(calls: Sequence[Callable[[], Any]], repeats: int, max_time: float = math.inf) -> list[list[float]]:
    """Wall times [s] of each call, taken in turns.

    Until there are `repeats` of each, or those of the first call add up to `max_time` [s].
    """
    times: list[list[float]] = [[] for _ in calls]
    while len(times[0]) < repeats and sum(times[0]) < max_time:
        for own, call in zip(times, calls, strict=True):
            start = time.perf_counter()
            call()
            own.append(time.perf_counter() - start)
    return times


def median_times(calls: Sequence[Callable[[], Any]], repeats: int) -> list[float]:
    """Median wall time of each call [s], in turns, after one call of each that is not timed: it compiles and plans."""
    for call in calls:
        call()
    return [statistics.median(times) for times in in_turns(calls, repeats)]
