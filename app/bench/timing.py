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


def wall_time(call: Callable[[], Any]) -> float:
    """Time that passes in a call [s]."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def undisturbed_time(call: Callable[[], Any]) -> float:
    """The lesser of wall time and processor time of all threads in a call [s].

    On a busy machine a long call waits for a core, and one shorter than a slice of the scheduler does not: wall times
    would favour the short one. Several threads at once make the wall time the lesser.
    """
    start, used = time.perf_counter(), time.process_time()
    call()
    return min(time.process_time() - used, time.perf_counter() - start)


def in_turns(
    calls: Sequence[Callable[[], Any]],
    repeats: int,
    max_time: float = math.inf,
    least: int = 1,
    timed: Callable[[Callable[[], Any]], float] = wall_time,
) -> list[list[float]]:
    """Times [s] of each call by `timed`, taken in turns.

    Until there are `repeats` of each, or at least `least` and those of the first call add up to `max_time` [s].
    """
    times: list[list[float]] = [[] for _ in calls]
    while len(times[0]) < repeats and (len(times[0]) < least or sum(times[0]) < max_time):
        for own, call in zip(times, calls, strict=True):
            own.append(timed(call))
    return times


def median_times(calls: Sequence[Callable[[], Any]], repeats: int) -> list[float]:
    """Median wall time of each call [s], in turns, after one call of each that is not timed: it compiles and plans."""
    for call in calls:
        call()
    return [statistics.median(times) for times in in_turns(calls, repeats)]
