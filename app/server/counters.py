"""Work counts: what was done for a scene since it was opened, and what did not have to be done.

Each part that works counts for itself and offers its counts as `work()`: what -> `WorkCount`. This module puts them
together for the panel, the benchmark and the tests. Each count is written by one thread only.
"""

import functools
import sys
import time
from pathlib import Path

from app.messages import WorkCount, WorkCounts

ROOT = Path(__file__).parent.parent.parent
OWN_PACKAGES = ("sim", "app")
HEAVY_PACKAGES = ("matplotlib", "pyfftw", "trimesh")  # up to half a second each, and no scene needs them all


def gather(*parts: WorkCounts) -> dict[str, WorkCount]:
    """All of them in one; raises ValueError where two parts count the same thing."""
    whole: dict[str, WorkCount] = {}
    for part in parts:
        for what, work in part.items():
            if what in whole:
                raise ValueError(f"{what}: counted in two places")
            whole[what] = work
    return whole


@functools.cache
def own_sources() -> int:
    """How many modules `sim` and `app` have."""
    return sum(1 for package in OWN_PACKAGES for _ in (ROOT / package).rglob("*.py"))


def modules() -> dict[str, WorkCount]:
    """Our own modules and the heavy packages of others: imported by this process, or not."""
    own = sum(1 for name in list(sys.modules) if name.partition(".")[0] in OWN_PACKAGES)
    heavy = sum(name in sys.modules for name in HEAVY_PACKAGES)
    return {
        "modules imported": WorkCount(own, max(own_sources() - own, 0)),
        "heavy packages imported": WorkCount(heavy, len(HEAVY_PACKAGES) - heavy),
    }


class Unwatched:
    """Processor time that this process takes while nobody looks."""

    def __init__(self) -> None:
        self.busy = self.idle = 0.0  # [s]
        self.since: tuple[float, float] | None = None  # (wall, processor) [s] when last looked, while nobody did

    def note(self, audience: int) -> None:
        """Look once; what passed since the last look counts where there was no audience at either."""
        now = (time.monotonic(), time.process_time()) if audience == 0 else None
        if now and self.since:
            busy = now[1] - self.since[1]
            self.busy += busy
            self.idle += max(now[0] - self.since[0] - busy, 0.0)
        self.since = now

    def work(self) -> dict[str, WorkCount]:
        """Busy and idle time [s]."""
        return {"processor time, nobody looking": WorkCount(self.busy, self.idle, "s")}
