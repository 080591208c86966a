"""A student's function for checks."""

import itertools
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.check.comparing import call, conform, has, same
from app.lab.checking import Wrong
from app.lab.course.task import Task
from app.lab.process.call_limit import MAX_WAIT
from app.lab.process.runner import BUSY, RunError, Runner

TASK_LIMIT = 10.0  # [s] of processor time for all calls of one task
NO_SPECIAL_CASE = ": look for a division by 0 or the root of a negative number"


class Trial(NamedTuple):
    """One input, with the student's result and the right one, in the form in which they are compared."""

    sample: tuple[Any, ...]
    found: Any
    right: Any

    @property
    def is_right(self) -> bool:
        """True if both agree."""
        return same(self.found, self.right)


class StudentFunction:
    """A student's function, called with the types of the reference solution."""

    def __init__(self, runner: Runner, task: Task, *, is_watched: bool = True) -> None:
        """is_watched: a call fails if the function has a side effect."""
        self.runner = runner
        self.task = task
        self.is_watched = is_watched
        self.twice = False  # each call is compared with a second one
        self.started, self.effort = time.monotonic(), runner.effort
        self.like: Any = None  # a result of the reference solution

    def __call__(self, *arguments: Any) -> Any:
        """The result, in the form of the reference's. Raises RunError or Wrong."""
        if self.runner.effort - self.effort > TASK_LIMIT:
            raise RunError("endless", f"{self.task.name} is too slow: {TASK_LIMIT:g} s have passed", self.task.file)
        if time.monotonic() - self.started > MAX_WAIT * TASK_LIMIT:
            raise RunError(BUSY, f"the machine is busy: {MAX_WAIT * TASK_LIMIT:g} s have passed", self.task.file)
        if self.is_watched:
            value = self.runner.watch(self.task.file, self.task.name, *arguments, twice=self.twice)
        else:
            value = self.runner.call(self.task.file, self.task.name, *arguments)
        if self.like is None:
            self.like = self.reference(*arguments)
        found = conform(value, self.like)
        for is_such, what, name in ((np.isnan, "NaN (not a number)", "NaN"), (np.isinf, "infinity", "infinite")):
            if has(is_such, found) and not has(is_such, self.reference(*arguments)):
                why = special_case(self.task.arguments, arguments)
                raise Wrong(f"it returns {what}{why or NO_SPECIAL_CASE}", name)
        return found

    def reference(self, *arguments: Any) -> Any:
        """The result of the reference solution; it cannot change the arguments."""
        return call(self.task.function, arguments)

    def trial(self, sample: tuple[Any, ...], *, twice: bool = False) -> Trial:
        """Its result at an input beside the right one. twice: compared with a second call. Raises RunError or Wrong."""
        self.like, self.twice = self.reference(*sample), twice
        found = self.normalised(self(*sample))
        self.twice = False
        return Trial(sample, found, self.normalised(self.like))

    def normalised(self, value: Any) -> Any:
        """A result in the form in which results are compared."""
        return getattr(self.task.check, "normalise", lambda value: value)(value)


def special_case(names: Sequence[str], arguments: Sequence[Any]) -> str:
    """The special case of a call, in words: equal arguments, otherwise zeros; "" for any other."""
    arrays = [(name, a) for name, a in zip(names, arguments, strict=True) if isinstance(a, np.ndarray | float | int)]
    pairs = itertools.combinations([(name, a) for name, a in arrays if np.ndim(a)], 2)
    found = [f"{one} = {other}" for (one, a), (other, b) in pairs if np.array_equal(a, b)]
    found = found or [f"{name} = 0" for name, a in arrays if not np.any(a)]
    return f" where {' and '.join(found)} (0/0)" if found else ""
