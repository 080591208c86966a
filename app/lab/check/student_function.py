"""A student's function for checks."""

import contextlib
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.check.comparing import call, conform, has, same
from app.lab.checking import Wrong
from app.lab.course.task import Task
from app.lab.process.call_limit import MAX_WAIT
from app.lab.process.runner import BUSY, RunError, Runner

TASK_LIMIT = 10.0  # [s] of processor time for all calls of one task
NO_SPECIAL_CASE = ": look for a division by 0, the root of a negative number, or entries that stay NaN"


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
        self.last: Trial | None = None  # the last call with a result
        self.is_warm = False  # after a first call
        self.takes_all = False  # also results that are not finite
        self.sample: tuple[Any, ...] = ()  # of the last trial

    def __call__(self, *arguments: Any) -> Any:
        """The result, in the form of the reference's. Raises RunError or Wrong."""
        if self.runner.effort - self.effort > TASK_LIMIT:
            raise RunError("endless", f"{self.task.name} is too slow: {TASK_LIMIT:g} s have passed", self.task.file)
        if time.monotonic() - self.started > MAX_WAIT * TASK_LIMIT:
            raise RunError(BUSY, f"the machine is busy: {MAX_WAIT * TASK_LIMIT:g} s have passed", self.task.file)
        is_first, before = not self.is_warm, self.runner.effort
        value = self.value(*arguments)
        self.is_warm = True
        if is_first:  # it may have imported or compiled, for which it is not charged
            self.effort += self.runner.effort - before
        if self.like is None:
            self.like = self.reference(*arguments)
        found = conform(value, self.like)
        self.last = Trial(arguments, found, self.reference(*arguments))
        if not self.takes_all and (error := self.not_finite(self.last)) is not None:
            raise error
        return found

    def not_finite(self, trial: Trial) -> Wrong | None:
        """A result that is NaN or infinite where the right one is not; None for any other."""
        for is_such, what, name in ((np.isnan, "NaN (not a number)", "NaN"), (np.isinf, "infinity", "infinite")):
            if has(is_such, trial.found) and not has(is_such, trial.right):
                return Wrong(f"it returns {what}{self.special_case(trial.sample, is_such) or NO_SPECIAL_CASE}", name)
        return None

    def special_case(self, arguments: tuple[Any, ...], is_such: Callable[[np.ndarray], np.ndarray]) -> str:
        """The special case of a call that makes its result NaN or infinite, in words; "" if none is sure.

        It is one if the result is another after a small change of the argument.
        """
        for i, words in special_cases(self.task.arguments, arguments):
            changed = arguments[i] + 0.1 + 0.01 * np.arange(np.size(arguments[i])).reshape(np.shape(arguments[i]))
            with contextlib.suppress(RunError, Wrong):
                if not has(is_such, conform(self.value(*arguments[:i], changed, *arguments[i + 1 :]), self.like)):
                    return f" where {words} (0/0)"
        return ""

    def value(self, *arguments: Any) -> Any:
        """The result as the process sends it. Raises RunError."""
        if self.is_watched:
            return self.runner.watch(self.task.file, self.task.name, *arguments, twice=self.twice)
        return self.runner.call(self.task.file, self.task.name, *arguments)

    def reference(self, *arguments: Any) -> Any:
        """The result of the reference solution; it cannot change the arguments."""
        return call(self.task.function, arguments)

    def trial(self, sample: tuple[Any, ...], *, twice: bool = False) -> Trial:
        """Its result at an input beside the right one. twice: compared with a second call. Raises RunError or Wrong."""
        self.sample, self.like, self.twice = sample, self.reference(*sample), twice
        found = self.normalised(self(*sample))
        self.twice = False
        return Trial(sample, found, self.normalised(self.like))

    def normalised(self, value: Any) -> Any:
        """A result in the form in which results are compared."""
        return getattr(self.task.check, "normalise", lambda value: value)(value)


class EditedFunction(StudentFunction):
    """A student's function with one edit. number: of the last requested edits."""

    def __init__(self, student: StudentFunction, number: int) -> None:
        super().__init__(student.runner, student.task)
        self.number = number

    def value(self, *arguments: Any) -> Any:
        """The result as the process sends it. Raises RunError."""
        return self.runner.edited(self.task.file, self.task.name, self.number, *arguments)


def special_cases(names: Sequence[str], arguments: Sequence[Any]) -> Iterator[tuple[int, str]]:
    """The special cases of a call: the number of an argument, and the case in words: equal arguments, zeros."""
    arrays = [(i, name, a) for i, (name, a) in enumerate(zip(names, arguments, strict=True))
              if isinstance(a, np.ndarray | float)]  # fmt: skip
    for (_, one, a), (i, other, b) in itertools.combinations([entry for entry in arrays if np.ndim(entry[2])], 2):
        if np.array_equal(a, b):
            yield i, f"{one} = {other}"
    yield from ((i, f"{name} = 0") for i, name, a in arrays if not np.any(a))
