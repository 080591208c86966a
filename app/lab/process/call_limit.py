"""The limit of a call: the processor time of its process, so that it is the same on a busy machine.

On Linux the system gives that time. Elsewhere the process reports it repeatedly during a call (`worker.py`).
"""

import os
import sys
import time
from pathlib import Path

MAX_WAIT = 10.0  # ratio of the longest wait to the limit, on a machine that is busy with other processes
MAX_LIBRARY_TIME = 30.0  # [s] of processor time of a call that imports or compiles
LOOKS = 10  # at a process within the limit
SLEEP_SHARE = 0.1  # of the time between two looks, below which a process that has computed counts as asleep
COMPUTING, ENDLESS, ASLEEP, BUSY = "computing", "endless", "asleep", "busy"  # states of a call


class CallLimit:
    """One call. A process that computes has `seconds` of processor time; one that sleeps has `seconds` in a row."""

    def __init__(self, pid: int, seconds: float, wall: float | None = None) -> None:
        """seconds: limit of processor time [s]. wall: of time on the clock [s], `MAX_WAIT` times that by default."""
        self.pid, self.seconds, self.step = pid, seconds, seconds
        self.wall = MAX_WAIT * seconds if wall is None else wall
        self.start = self.looked = self.awake = time.monotonic()  # [s] of looks, and when it last computed
        self.before = self.used = processor_time(pid)[1]  # [s]
        self.looks = 0  # in a row that found it asleep

    def extend(self) -> bool:
        """Allow for work of a library, such as an import; False once that is too long."""
        if self.seconds >= MAX_LIBRARY_TIME:
            return False
        self.seconds = min(self.seconds + self.step, MAX_LIBRARY_TIME)
        self.wall += MAX_WAIT * self.step
        return True

    @property
    def taken(self) -> float:
        """Processor time [s] of the call, as far as known."""
        return self.used - self.before

    @property
    def patience(self) -> float:
        """Time [s] until the next look."""
        left = self.start + self.wall - time.monotonic()
        return max(min(self.seconds / LOOKS, left), 0.0)

    def look(self) -> str:
        """Present state of the call: `COMPUTING`, or the reason for its end."""
        if sys.platform == "linux":
            sleeps, used = processor_time(self.pid)
            self.note(used, sleeps=sleeps)
        now = time.monotonic()
        if self.taken >= self.seconds:
            return ENDLESS
        if self.looks >= LOOKS // 2 and now - self.awake >= self.seconds:
            return ASLEEP
        return BUSY if now - self.start >= self.wall else COMPUTING

    def note(self, used: float, *, sleeps: bool = True) -> None:
        """Note the processor time [s] of the process. sleeps: it does not compute, nor wait for the processor."""
        now = time.monotonic()
        if sleeps and used - self.used <= SLEEP_SHARE * (now - self.looked):
            self.looks += 1
        else:
            self.looks, self.awake = 0, now
        self.used, self.looked = used, now


def processor_time(pid: int) -> tuple[bool, float]:
    """Return (True if it sleeps, processor time [s]) of a process.

    (False, 0.0) on all systems but Linux, and of a process that has ended.
    """
    if sys.platform != "linux":
        return False, 0.0
    try:
        fields = Path(f"/proc/{pid}/stat").read_text("ascii", "replace").rpartition(")")[2].split()
        return fields[0] == "S", sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError, ValueError):
        return False, 0.0
