"""How much memory is in use, as far as that can be told from outside."""

import ctypes
import gc
import sys

import psutil

GROWTH = 1.05  # most that is resident at last, over what was after a warm-up


def resident() -> float:
    """What this process holds [MB], without what waits to be collected or is free and only kept by the allocator.

    glibc keeps 20 to 50 MB of what the replay to each newcomer took for a moment. That comes and goes, stays within
    bounds, and would hide a leak.
    """
    gc.collect()
    if sys.platform == "linux":
        ctypes.CDLL(None).malloc_trim(0)
    return psutil.Process().memory_info().rss / 1e6
