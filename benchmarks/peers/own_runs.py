"""Our own runs of a task: what each errs and takes, and the quickest at a given error."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from benchmarks.reference import RESOLUTION, Positions, Reference, largest_distances
from benchmarks.timing import processor_time

CANDIDATES = 4  # runs that are timed again before the quickest is chosen
MAX_RETIMED = 0.1  # [s] runs that take longer are not timed again: chance matters less


class OwnRun(NamedTuple):
    """One way to run a task. setting: "860 steps" or "rtol 1e-06"."""

    method: str
    setting: str
    run: Callable[[], Positions]
    expected_time: Callable[[], float] = float  # [s] about; 0 where it is not known


class Result(NamedTuple):
    """time [s] of the processor; errors [m] at each of the task's times, NaN where the run was not made."""

    time: float
    errors: tuple[float, ...]


class OwnRuns:
    """All runs of one task, as ladders of one method each, from coarse to fine. Results are kept.

    equal: errors that differ by less than this factor count as equal.
    """

    def __init__(self, ladders: Sequence[Sequence[OwnRun]], reference: Reference, equal: float = 1.0) -> None:
        self.ladders, self.reference, self.equal = ladders, reference, equal
        self.results: dict[tuple[str, str], Result] = {}

    def result(self, run: OwnRun, max_time: float = math.inf) -> Result:
        """Time and errors; the errors are NaN for a run that is expected to take longer than `max_time` [s]."""
        key = run.method, run.setting
        if key not in self.results:
            expected = run.expected_time()
            if expected > max_time:
                return Result(expected, (math.nan,) * len(self.reference.positions))
            found: list[Positions] = []
            time = processor_time(lambda: found.append(run.run()))
            self.results[key] = Result(time, largest_distances(found[0], self.reference))
        return self.results[key]

    def quickest(self, limits: tuple[float, ...]) -> OwnRun | None:
        """Our quickest run with errors of at most `limits` [m]; None if no run on the ladders is so exact."""
        found: list[tuple[float, OwnRun]] = []
        for ladder in self.ladders:
            for run in ladder:
                max_time = 2.0 * min((time for time, _ in found), default=math.inf)
                time, errors = self.result(run, max_time)
                if time > max_time or max(errors) < RESOLUTION * self.reference.uncertainty:
                    break
                if all(error <= self.equal * limit for error, limit in zip(errors, limits, strict=True)):
                    found.append((time, run))
                    break
        if not found:
            return None
        best = sorted(found, key=lambda entry: entry[0])[:CANDIDATES]
        again = [
            (min(processor_time(run.run) for _ in range(3)) if time < MAX_RETIMED else time, run) for time, run in best
        ]
        return min(again, key=lambda entry: entry[0])[1]
