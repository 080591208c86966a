"""Calls of a student's function for its check, in the process that runs it: without side effects, and with edits.

While a function is called, the solutions of the course stand in for the other functions of the course that it calls.
"""

import contextlib
import functools
import time
import warnings
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import numpy as np

from app.lab.diagnosis.causes import causes, finer_steps, late_causes, traps
from app.lab.diagnosis.edits import Candidate, Tree, more_slips, slips
from app.lab.diagnosis.effects import copied, state_of, watched
from app.lab.diagnosis.oscillator import steps_of_oscillator
from app.lab.process.student_modules import StudentModules

EDIT_TIME = 0.5  # [s] of processor time for the edits of a function
SERIES_TIME = 0.1  # [s] of processor time, after which a series of calls is answered before its end
SLIPS = "slips"
# Kinds of edits beside `SLIPS`.
EDITS = {"traps": traps, "causes": causes, "more slips": more_slips, "finer steps": finer_steps}


class CheckedCalls:
    """Calls of the functions in a student's modules."""

    def __init__(self, modules: StudentModules) -> None:
        self.modules = modules
        self.states: dict[str, Any] = {}  # of the modules, before any watched call
        self.course: dict[str, Callable[..., Any]] = {}  # solutions of the course, by name
        self.called: set[str] = set()  # of these, by the functions that were watched
        self.tree: Tree | None = None  # of the last function with edits
        self.edits: list[tuple[Candidate, Callable[..., Any]]] = []

    def answer(self, kind: str, file: str, function: str, arguments: list[Any]) -> Any:
        """The value of a message of the check (`worker.py`). Raises an error of the student's function, and Effect."""
        if kind == "called":
            names, self.called = sorted(self.called), set()
            return names
        if kind == "words":
            return self.edits_in_words(*arguments)
        if kind == "watch":
            return self.watch(file, function, *arguments)
        if kind == "oscillate":
            return self.oscillate(file, function, *arguments)
        with self.solved([self.modules.loaded[file], *self.modules.others(file)], function):
            if kind == "edits":
                return self.try_edits(file, function, *arguments)
            number, samples = arguments
            return series(self.try_edit(file, self.edits[number][1], sample) for sample in samples)

    @contextlib.contextmanager
    def solved(self, modules: list[ModuleType], function: str) -> Iterator[None]:
        """The course's own solutions in place of the other functions of the course that the student's modules have."""
        before: list[tuple[ModuleType, str, Any]] = []
        for own in modules:
            for key, value in list(vars(own).items()):
                name = key if key in self.course else getattr(value, "__name__", "")
                if name in self.course and name != function and (callable(value) or key == name):
                    before.append((own, key, value))
                    setattr(own, key, functools.partial(self.solution, name))
        try:
            yield
        finally:
            for own, key, value in before:
                setattr(own, key, value)

    def solution(self, name: str, *arguments: Any, **named: Any) -> Any:
        """The value of a solution of the course, whose use is noted."""
        self.called.add(name)
        return self.course[name](*arguments, **named)

    def watch(self, file: str, function: str, twice: int, samples: list[list[Any]]) -> list[Any]:
        """The results of a function without side effects, as of `series`. Raises Effect.

        twice: number of calls that are compared with a second one.
        """
        with self.without_effects(file, function) as call:
            return series(call(sample, twice=i < twice) for i, sample in enumerate(samples))

    def oscillate(self, file: str, function: str, steps: int, samples: list[list[Any]]) -> list[Any]:
        """The results of steps without side effects, each from that before, as of `series`. Raises Effect.

        samples: position and velocity of an oscillator, and the time step.
        """
        with self.without_effects(file, function) as call:
            x, v, z = samples[0]
            return series(steps_of_oscillator(lambda *sample: call(sample, twice=False), x, v, z, steps))

    @contextlib.contextmanager
    def without_effects(self, file: str, function: str) -> Iterator[Callable[..., Any]]:
        """A function as of `watched` in a `with` block: it takes the arguments and `twice`, and raises Effect."""
        module, others = self.modules.loaded[file], self.modules.others(file)
        if file not in self.states:
            self.states[file] = state_of([module])

        def anew() -> tuple[Callable[..., Any], list[ModuleType]]:
            module = self.modules.run(file)
            return plain(getattr(module, function)), [module, *others]

        target, modules = plain(getattr(module, function)), [module, *others]
        if state_of([module]) != self.states[file]:  # an earlier call has changed something
            target, modules = anew()
        with self.solved(modules, function):
            yield lambda sample, *, twice: watched(target, modules, sample, self.modules.folder, anew, twice=twice)

    def try_edits(
        self, file: str, function: str, kind: str, names: list[str], conditions: list[str], arguments: list[Any]
    ) -> list[Any]:
        """The results of the edits of a function: number and result of each. kind: of `EDITS`.

        names, conditions: as of `slips`.
        """
        self.edits, outcomes = [], []
        end = time.process_time() + EDIT_TIME
        try:
            source, known = (self.modules.folder / file).read_bytes(), vars(self.modules.loaded[file])
            tree = self.tree = Tree(source, function, known, tuple(self.course))
        except LookupError:
            return []
        is_clean = raises_no_warning(plain(getattr(self.modules.loaded[file], function)), arguments)
        found_edits = EDITS[kind](tree) if kind != SLIPS else (*slips(tree, names, conditions), *late_causes(tree))
        for candidate in found_edits:
            if time.process_time() > end:
                break
            target = tree.function(candidate)
            if target is None:
                continue
            try:
                with strict(is_clean):
                    value = target(*copied(arguments))
            except Exception:
                continue
            outcomes.append([len(self.edits), value])
            self.edits.append((candidate, target))
        return outcomes

    def edits_in_words(self, numbers: list[int], units: list[tuple[str, str]], most: int) -> list[Any]:
        """Edits in words, without those that join more than `most` pairs of other units, or that no sentence can name.

        units: of the arguments.
        """
        assert self.tree is not None
        chosen = [(number, self.edits[number][0]) for number in numbers]
        known = dict(units)
        fitting = [(number, candidate) for number, candidate in chosen if self.tree.clashes(candidate, known) <= most]
        named = ((number, self.tree.words(candidate)) for number, candidate in fitting)
        return [[number, *words] for number, words in named if words.is_clear]

    def try_edit(self, file: str, target: Callable[..., Any], arguments: list[Any]) -> Any:
        """The result of an edit, which must not warn where the function itself does not. Raises Effect."""
        module = self.modules.loaded[file]
        function = plain(getattr(module, target.__name__))
        with strict(raises_no_warning(function, arguments)):
            return watched(target, [module], arguments, self.modules.folder, lambda: (target, [module]), twice=False)


def series(results: Iterator[Any]) -> list[Any]:
    """The first results of a series of calls, at least one. Raises the error of the first call.

    A later call that fails ends the series: the lab sends it again, as the first.
    """
    end = time.process_time() + SERIES_TIME
    values = [next(results)]
    with contextlib.suppress(BaseException):
        while time.process_time() <= end:
            values.append(next(results))
    return values


def plain(function: Any) -> Any:
    """A function without numba's compiler: the check needs few calls of it."""
    return getattr(function, "py_func", function)


def solutions(sources: dict[str, str]) -> dict[str, Callable[..., Any]]:
    """Functions from their texts, which use no other name than np; without those that cannot be run."""
    functions = {}
    for name, source in sources.items():
        inside: dict[str, Any] = {"np": np}
        with contextlib.suppress(Exception):  # of a teacher's file
            exec(compile(source, f"<{name} of the course>", "exec"), inside)
            functions[name] = inside[name]
    return functions


@contextlib.contextmanager
def strict(is_strict: bool) -> Iterator[None]:
    """Warnings, and numbers that are not finite, are errors in a `with` block."""
    with contextlib.ExitStack() as opened:
        if is_strict:
            opened.enter_context(np.errstate(all="raise", under="ignore"))
            opened.enter_context(warnings.catch_warnings())
            warnings.simplefilter("error")
        yield


def raises_no_warning(function: Callable[..., Any], arguments: list[Any]) -> bool:
    """False if a function warns at these arguments, or has a number on the way that is not finite."""
    try:
        with strict(True):
            function(*copied(arguments))
    except (FloatingPointError, Warning):
        return False
    except Exception:
        return True
    return True
