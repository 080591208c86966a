"""Ways to time a call. Calls that are compared are timed in turns, so that other load on the machine hits all alike."""

import math
import os
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

from app.scenes.timer import effort_clock


def load() -> float:
    """Processes that run or wait for the processor, on average over a minute; NaN on Windows, which does not count."""
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else math.nan


def processor_time(call: Callable[[], Any]) -> float:
    """Processor time of this thread in a call [s], which other programs on the machine do not lengthen."""
    start = effort_clock()
    call()
    return effort_clock() - start


def median_times(calls: Sequence[Callable[[], Any]], repeats: int) -> list[float]:
    """Median wall time of each call [s], in turns, after one call of each that is not timed: it compiles and plans."""
    for call in calls:
        call()
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(repeats):
        for own, call in zip(times, calls, strict=True):
            start = time.perf_counter()
            call()
            own.append(time.perf_counter() - start)
    return [statistics.median(own) for own in times]
