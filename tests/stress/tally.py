"""What the suite did, counted for the report at its end."""

import collections
import contextlib
import os
from collections.abc import Iterator

SERVED = float(os.environ.get("SPRINGTIDE_STRESS_SOAK", "30"))  # [s] of wall time that each scene is served


class Tally:
    """Counts by kind, and the faults that were injected and survived."""

    def __init__(self) -> None:
        self.counts: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
        self.injected: collections.Counter[str] = collections.Counter()
        self.survived: collections.Counter[str] = collections.Counter()
        self.notes: list[str] = []

    @contextlib.contextmanager
    def fault(self, kind: str, times: int = 1) -> Iterator[None]:
        """Count `times` faults of a kind; they are survived where nothing is raised."""
        self.injected[kind] += times
        yield
        self.survived[kind] += times

    def lines(self) -> Iterator[str]:
        """The report."""
        if self.counts:
            columns = sorted({column for row in self.counts.values() for column in row})
            width = max(map(len, self.counts))
            yield f"{'':{width}}  " + "  ".join(columns)
            for name, row in self.counts.items():
                yield f"{name:{width}}  " + "  ".join(f"{row[column]:>{len(column)},}" for column in columns)
            total = sum(row["changes"] for row in self.counts.values())
            yield f"{total:,} changes of parameters tried with the simulation running"
        yield from self.notes
        for kind in self.injected:
            yield f"{self.survived[kind]:,} of {self.injected[kind]:,} survived: {kind}"
        if self.injected:
            yield f"{self.injected.total():,} faults injected, {self.survived.total():,} survived"
