"""How many threads a solver takes: one, or two where trying shows that two are quicker just now."""

import os
import time
from collections.abc import Callable

TRY_EVERY = 3.0  # [s] of wall time between two tries of the number not in use
TRIAL = 4  # steps of a try: two threads on a machine with one core free may take a hundred times as long
PIECE = 16  # steps of two threads between two looks at whether they still pay
PAYS = 0.85  # part of one thread's time a step below which two are taken


class ThreadTuner:
    """Shares out the steps of one scene."""

    def __init__(self, *, clock: Callable[[], float] = time.perf_counter, count: int | None = None) -> None:
        """clock: wall time [s]; count: cores of the machine."""
        self.clock = clock
        self.count = count or os.cpu_count() or 1
        self.forget()

    def forget(self) -> None:
        """Start over: another net, or another method."""
        self.threads = 1
        self.each = {1: 0.0, 2: 0.0}  # [s] a step, lately; 0: not known
        self.tried_at = -TRY_EVERY

    def advance(self, steps: int, take: Callable[[int, int], None], *, large: bool) -> None:
        """Take `steps` steps by take(threads, steps); on one thread only, unless `large`."""
        if not large or self.count < 2:
            self.threads = 1
            take(1, steps)
            return
        left = steps
        if self.each[1] > 0.0 and self.clock() - self.tried_at >= TRY_EVERY:
            self.tried_at = self.clock()
            left -= self.timed(3 - self.threads, min(TRIAL, left), take)
        while left:
            left -= self.timed(self.threads, left if self.threads == 1 else min(PIECE, left), take)

    def timed(self, threads: int, steps: int, take: Callable[[int, int], None]) -> int:
        """Take the steps, learn from them, and return how many they were."""
        start = self.clock()
        take(threads, steps)
        self.each[threads] = (self.clock() - start) / steps
        self.threads = 2 if 0.0 < self.each[2] < PAYS * self.each[1] else 1
        return steps
