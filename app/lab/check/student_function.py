"""A student's function for checks."""

import contextlib
import itertools
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.check.comparing import call, conform, has, same
from app.lab.checking import Wrong
from app.lab.course.task import Task
from app.lab.diagnosis.oscillator import oscillator
from app.lab.diagnosis.units import units_of
from app.lab.process.call_limit import MAX_WAIT
from app.lab.process.runner import BUSY, RunError, Runner

TASK_LIMIT = 10.0  # [s] of processor time for all calls of one task
FIRST_SERIES, SERIES_GROWTH = 1, 8  # numbers of inputs: a function that is wrong at the first needs no others
NO_SPECIAL_CASE = ": look for a division by 0, the root of a negative number, or entries that stay NaN"


class Trial(NamedTuple):
    """One input, with the student's result and the right one, in the form in which they are compared."""

    sample: tuple[Any, ...]
    result: Any
    right: Any

    @property
    def is_right(self) -> bool:
        """True if both agree."""
        return same(self.result, self.right)


class StudentFunction:
    """A student's function, called with the types of the reference solution."""

    def __init__(self, runner: Runner, task: Task, *, is_watched: bool = True) -> None:
        """is_watched: a call fails if the function has a side effect."""
        self.runner = runner
        self.task = task
        self.is_watched = is_watched
        self.started, self.effort = time.monotonic(), runner.effort
        self.last: Trial | None = None  # the last call with a result
        self.is_warm = False  # after a first call
        self.takes_all = False  # also results that are not finite
        self.sample: tuple[Any, ...] = ()  # of the last trial

    def __call__(self, *arguments: Any) -> Any:
        """The result, in the form of the reference's. Raises RunError or Wrong."""
        return next(self.results([arguments]))[0]

    def results(self, samples: Sequence[tuple[Any, ...]], twice: int = 0) -> Iterator[tuple[Any, Any]]:
        """The result of each input, in the form of the reference's, beside that one. Raises RunError or Wrong.

        twice: number of the first inputs whose results are compared with a second call.
        """
        done, ahead = 0, FIRST_SERIES
        while done < len(samples):
            part = samples[done : done + ahead]
            with self.measured(part[0]):
                values = self.values(part, max(twice - done, 0))
            for sample, value in zip(part, values, strict=False):
                yield self.in_form(sample, value)
            done, ahead = done + len(values), SERIES_GROWTH * ahead

    def steps_of_oscillator(self, x: np.ndarray, v: np.ndarray, z: float, steps: int) -> Iterator[Any]:
        """The results of steps of an oscillator, each from that before. Raises RunError or Wrong."""
        done = 0
        while done < steps:
            with self.measured((x, v, z, oscillator)):
                values = self.steps(self.sample, steps - done)
            for value in values:
                (x, v), _ = self.in_form((x, v, z, oscillator), value)
                yield x, v
            done += len(values)

    def steps(self, sample: tuple[Any, ...], steps: int) -> list[Any]:
        """The first results of steps, at least one, as the process sends them. Raises RunError."""
        if self.is_watched:
            return self.series("oscillate", steps, [sample[:-1]], steps)
        return self.values([sample])

    @contextlib.contextmanager
    def measured(self, sample: tuple[Any, ...]) -> Iterator[None]:
        """Measure the time of a series of calls that starts at a sample. Raises RunError after too long a time."""
        self.check_time()
        before = self.runner.effort
        self.sample = sample  # a call that fails is the first of its series
        yield
        if not self.is_warm:  # it may have imported or compiled, for which it is not charged
            self.effort += self.runner.effort - before
        self.is_warm = True

    def in_form(self, sample: tuple[Any, ...], value: Any) -> tuple[Any, Any]:
        """A result in the form of the reference's, beside that one. Raises Wrong."""
        self.sample, right = sample, self.reference(*sample)
        result = conform(value, right)
        self.last = Trial(sample, result, right)
        if not self.takes_all and (error := self.not_finite(self.last)) is not None:
            raise error
        return result, right

    def check_time(self) -> None:
        """Raises RunError after more time than a task may take."""
        if self.runner.effort - self.effort > TASK_LIMIT:
            raise RunError("endless", f"{self.task.name} is too slow: {TASK_LIMIT:g} s have passed", self.task.file)
        if time.monotonic() - self.started > MAX_WAIT * TASK_LIMIT:
            raise RunError(BUSY, f"the machine is busy: {MAX_WAIT * TASK_LIMIT:g} s have passed", self.task.file)

    def not_finite(self, trial: Trial) -> Wrong | None:
        """A result that is NaN or infinite where the right one is not; None for any other."""
        for is_such, what, name in ((np.isnan, "NaN (not a number)", "NaN"), (np.isinf, "infinity", "infinite")):
            if has(is_such, trial.result) and not has(is_such, trial.right):
                return Wrong(f"it returns {what}{self.special_case(trial, is_such) or NO_SPECIAL_CASE}", name)
        return None

    def special_case(self, trial: Trial, is_such: Callable[[np.ndarray], np.ndarray]) -> str:
        """The special case of a call that makes its result NaN or infinite, in words; "" if none is sure.

        It is one if the result is another after a small change of the argument.
        """
        arguments = trial.sample
        units = units_of(self.task.function.__doc__ or "", self.task.arguments)
        for i, words in special_cases(self.task.arguments, arguments, units):
            changed = arguments[i] + 0.1 + 0.01 * np.arange(np.size(arguments[i])).reshape(np.shape(arguments[i]))
            with contextlib.suppress(RunError, Wrong):
                value = self.values([(*arguments[:i], changed, *arguments[i + 1 :])])[0]
                if not has(is_such, conform(value, trial.right)):
                    return f" where {words} (0/0)"
        return ""

    def values(self, samples: Sequence[tuple[Any, ...]], twice: int = 0) -> list[Any]:
        """The results of the first of some inputs, as the process sends them. Raises RunError.

        At least one; a later call that fails is not among them. twice: as of `results`.
        """
        if self.is_watched:
            return self.series("watch", twice, samples, len(samples))
        return [self.runner.call(self.task.file, self.task.name, *samples[0])]

    def series(self, kind: str, which: int, samples: Sequence[tuple[Any, ...]], most: int) -> list[Any]:
        """The answer to a message of the check with a number and inputs. most: results. Raises RunError."""
        answer = self.ask(kind, which, [list(sample) for sample in samples])
        if not isinstance(answer, list) or not 1 <= len(answer) <= most:
            self.runner.close()
            raise RunError("ended", f"{self.task.name} wrote into the lab's pipe", self.task.file)
        return answer

    def ask(self, kind: str, *arguments: Any, time_limit: float | None = None) -> Any:
        """The answer to a message of the check (`worker.py`). time_limit: [s]. Raises RunError."""
        return self.runner.ask(kind, self.task.file, self.task.name, list(arguments), time_limit)

    def reference(self, *arguments: Any) -> Any:
        """The result of the reference solution; it cannot change the arguments."""
        return call(self.task.function, arguments)

    def trial(self, sample: tuple[Any, ...]) -> Trial:
        """Its result at an input beside the right one. Raises RunError or Wrong."""
        return next(self.trials([sample]))

    def trials(self, samples: Sequence[tuple[Any, ...]], twice: int = 0) -> Iterator[Trial]:
        """Its results at several inputs beside the right ones. twice: as of `results`. Raises RunError or Wrong."""
        for sample, (result, right) in zip(samples, self.results(samples, twice), strict=True):
            yield Trial(sample, self.normalised(result), self.normalised(right))

    def normalised(self, value: Any) -> Any:
        """A result in the form in which results are compared."""
        return getattr(self.task.check, "normalise", lambda value: value)(value)


class EditedFunction(StudentFunction):
    """A student's function with one edit. number: of the last requested edits."""

    def __init__(self, student: StudentFunction, number: int) -> None:
        super().__init__(student.runner, student.task)
        self.number = number

    def values(self, samples: Sequence[tuple[Any, ...]], twice: int = 0) -> list[Any]:
        """As of `StudentFunction`."""
        return self.series("edited", self.number, samples, len(samples))

    def steps(self, sample: tuple[Any, ...], steps: int) -> list[Any]:
        """As of `StudentFunction`."""
        return self.values([sample])


def special_cases(
    names: Sequence[str], arguments: Sequence[Any], units: Mapping[str, str]
) -> Iterator[tuple[int, str]]:
    """The special cases of a call: the number of an argument, and the case in words: equal arguments, zeros.

    units: of arguments; those of different ones are not compared.
    """
    arrays = [(i, name, a) for i, (name, a) in enumerate(zip(names, arguments, strict=True))
              if isinstance(a, np.ndarray | float)]  # fmt: skip
    for (_, one, a), (i, other, b) in itertools.combinations([entry for entry in arrays if np.ndim(entry[2])], 2):
        if units.get(one) == units.get(other) and np.array_equal(a, b):
            yield i, f"{one} = {other}"
    yield from ((i, f"{name} = 0") for i, name, a in arrays if not np.any(a))
