"""Time on systems whose timers are coarse.

Windows ends waits for locks, queues and events at its timer's steps of 1/64 s, unless a program asks for finer ones,
and counts processor time in the same steps. `time.sleep` is exact there since Python 3.11.
"""

import contextlib
import sys
import time
from collections.abc import Iterator

if sys.platform == "win32":
    import ctypes

    TIMER_STEP = 1.0 / 64.0  # [s] by which waits may end late on an idle machine
    # Wall time: a step of the scene is shorter than the steps in which processor time is counted.
    effort_clock = process_effort_clock = time.perf_counter

    @contextlib.contextmanager
    def fine_timer() -> Iterator[None]:
        """Steps of a millisecond, where the system grants them."""
        asked = ctypes.windll.winmm.timeBeginPeriod(1) == 0
        try:
            yield
        finally:
            if asked:
                ctypes.windll.winmm.timeEndPeriod(1)

else:
    TIMER_STEP = 0.0
    effort_clock, process_effort_clock = time.thread_time, time.process_time
    fine_timer = contextlib.nullcontext
