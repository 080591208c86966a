"""The skip ledger: what was done for a scene since it was opened, and what did not have to be done.

Whoever works counts, and offers its counts as `work()`: what -> `Work`. Here they are put together for the panel, the
benchmark and the tests. Each count is written by one thread only.
"""

import functools
import html
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parent.parent
OWN = ("sim", "app")
HEAVY = ("matplotlib", "pyfftw", "trimesh")  # up to half a second each, and no scene needs them all


class Work(NamedTuple):
    """Work of one kind: how much was done, and how much was not needed."""

    done: float
    skipped: float = 0.0
    unit: str = ""  # of both, where they are not plain counts

    @property
    def share(self) -> float:
        """The part that was skipped, 0 to 1."""
        return self.skipped / (self.done + self.skipped) if self.skipped else 0.0


Works = Mapping[str, Work]


def gather(*parts: Works) -> dict[str, Work]:
    """All of them in one; raises ValueError where two parts count the same thing."""
    whole: dict[str, Work] = {}
    for part in parts:
        for what, work in part.items():
            if what in whole:
                raise ValueError(f"{what}: counted in two places")
            whole[what] = work
    return whole


@functools.cache
def own_sources() -> int:
    """How many modules `sim` and `app` have."""
    return sum(1 for package in OWN for _ in (ROOT / package).rglob("*.py"))


def modules() -> dict[str, Work]:
    """Our own modules and the heavy packages of others: imported by this process, or not."""
    own = sum(1 for name in list(sys.modules) if name.partition(".")[0] in OWN)
    heavy = sum(name in sys.modules for name in HEAVY)
    return {
        "modules imported": Work(own, max(own_sources() - own, 0)),
        "heavy packages imported": Work(heavy, len(HEAVY) - heavy),
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

    def work(self) -> dict[str, Work]:
        return {"processor time, nobody looking": Work(self.busy, self.idle, "s")}


def rows(works: Works) -> list[dict[str, Any]]:
    """A table: what, done, skipped, skipped [%]."""
    return [
        {
            "what": f"{what} [{work.unit}]" if work.unit else what,
            "done": work.done,
            "skipped": work.skipped,
            "skipped [%]": 100.0 * work.share,
        }
        for what, work in works.items()
    ]


def short(value: float) -> str:
    """A count whole, anything else to three digits."""
    return f"{value:,.0f}" if value == int(value) else f"{value:.3g}"


def table(works: Works) -> str:
    """The ledger as an HTML table."""
    cell = '<td style="text-align:right;padding-left:8px">'
    lines = [
        f"<tr><td>{html.escape(row['what'])}</td>{cell}{short(row['done'])}</td>{cell}{short(row['skipped'])}</td>"
        f"{cell}{row['skipped [%]']:.0f}</td></tr>"
        for row in rows(works)
    ]
    head = f"<tr><td></td>{cell}<b>done</b></td>{cell}<b>not needed</b></td>{cell}<b>%</b></td></tr>"
    return f'<table style="width:100%;font-variant-numeric:tabular-nums">{head}{"".join(lines)}</table>'
