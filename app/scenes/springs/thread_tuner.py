"""Chooses one or two threads for a solver, by trying which is faster at the moment."""

import os
import time
from collections.abc import Callable

TRIAL_INTERVAL = 3.0  # [s] of wall time between two trials of the number of threads that is not in use
TRIAL_STEPS = 4  # steps of a trial: with one core free, two threads may take a hundred times as long as one
MAX_PART_STEPS = 16  # steps on two threads between two checks that they are still faster
MAX_TIME_RATIO = 0.85  # two threads are used where a step takes less than this part of its time on one


class ThreadTuner:
    """Distributes the steps of one scene over one or two threads."""

    def __init__(self, *, clock: Callable[[], float] = time.perf_counter, count: int | None = None) -> None:
        """clock: wall time [s]; count: cores of the machine."""
        self.clock = clock
        self.count = count or os.cpu_count() or 1
        self.restart()

    def restart(self) -> None:
        """Forget all timings: the net or the method is another."""
        self.threads = 1
        self.step_time = {1: 0.0, 2: 0.0}  # [s] of the last steps, by number of threads; 0: not known
        self.tried_at = -TRIAL_INTERVAL

    def advance(self, steps: int, take: Callable[[int, int], None], *, large: bool) -> None:
        """Take `steps` steps by take(threads, steps). Where not `large`, on one thread."""
        if not large or self.count < 2:
            self.threads = 1
            take(1, steps)
            return
        left = steps
        if self.step_time[1] > 0.0 and self.clock() - self.tried_at >= TRIAL_INTERVAL:
            self.tried_at = self.clock()
            left -= self.timed(3 - self.threads, min(TRIAL_STEPS, left), take)
        while left:
            left -= self.timed(self.threads, left if self.threads == 1 else min(MAX_PART_STEPS, left), take)

    def timed(self, threads: int, steps: int, take: Callable[[int, int], None]) -> int:
        """Take the steps, choose the number of threads by their time, and return how many steps they were."""
        start = self.clock()
        take(threads, steps)
        self.step_time[threads] = (self.clock() - start) / steps
        self.threads = 2 if 0.0 < self.step_time[2] < MAX_TIME_RATIO * self.step_time[1] else 1
        return steps
