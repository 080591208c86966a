"""Judges a student's function: against the reference at random inputs, then by its behaviour.

A wrong function is compared with the typical mistakes of its task, then looked at by its structure
(`diagnosis/`): the tableau of a step, the terms of a sum. Any function can leave an argument unused.
"""

import copy
import dataclasses
import itertools
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.lab.call_limit import MAX_WAIT
from app.lab.checking import Wrong, number_text
from app.lab.diagnosis.edits import explain_edit
from app.lab.diagnosis.effects import EFFECTS
from app.lab.diagnosis.explanation import Equation, Explanation
from app.lab.diagnosis.steps import explain_step
from app.lab.diagnosis.terms import WHOLE, Term, explain_terms
from app.lab.rope_march import entries
from app.lab.runner import BUSY, RunError, Runner
from app.lab.source import read_source
from app.lab.task import Task
from app.lab.wire import Foreign

MAX_TRIES = 3  # of a check, on a machine that is too busy to start a process
RETRY_INTERVAL = 0.5  # [s] between two of them
SAMPLES = 12  # random inputs
TWICE = 3  # of them are tried twice
TERM_SAMPLES = 16  # random inputs at which terms are compared
MAX_DRAWS = 200  # of inputs, to find so many
TOLERANCE = 1e-4  # of the largest value of a result: single precision is right too
TASK_LIMIT = 10.0  # [s] of processor time for all calls of one task
NO_SPECIAL_CASE = ": look for a division by 0 or the root of a negative number"
SEED = 20150130


@dataclasses.dataclass(frozen=True)
class Verdict:
    """Result of the check of one function.

    state: "not begun", "right", "wrong", "failed" (no result), or "not checked" (the machine is too busy). mistake: the
    name of a recognised mistake, or "". place: file and line of a mistake, as an editor takes it: "rope.py:17"; "" if
    it is unknown. file: the file that does not run, whatever function of it is asked for, or "". equations: what a
    wrong function does, beside the right ones.
    """

    state: str
    text: str = ""
    mistake: str = ""
    place: str = ""
    file: str = ""
    equations: tuple[Equation, ...] = ()

    @property
    def sentence(self) -> str:
        """The mistake in words."""
        named = f"{self.mistake}: " if self.state == "wrong" and self.mistake else ""
        if self.file:
            file, _, line = self.place.partition(":")
            where = ", ".join([*([file] if file != self.file else []), *([f"line {line}"] if line else [])])
            named = f"{self.file} does not run: {where}{': ' if where else ''}"
        return named + self.text + ("" if self.text.endswith((".", "?", "!")) else ".")

    @property
    def located(self) -> str:
        """The mistake in words, after its place."""
        return self.sentence if self.file or not self.place else f"{self.place}: {self.sentence}"


@dataclasses.dataclass(frozen=True)
class Points:
    """A curve of the student's function beside the reference. student: None where it has no result."""

    x_label: str
    y_label: str
    x: np.ndarray
    reference: np.ndarray
    student: np.ndarray | None


class StudentFunction:
    """A student's function, called with the types of the reference solution."""

    def __init__(self, runner: Runner, task: Task, *, is_watched: bool = True) -> None:
        """is_watched: a call fails where the function does something besides its result."""
        self.runner = runner
        self.task = task
        self.is_watched = is_watched
        self.twice = False  # each call is compared with a second one
        self.started, self.effort = time.monotonic(), runner.effort
        self.like: Any = None  # a result of the reference solution

    def __call__(self, *arguments: Any) -> Any:
        """The result, in the form of the reference's. Raises RunError or Wrong."""
        if self.runner.effort - self.effort > TASK_LIMIT:
            raise RunError("endless", f"{self.task.name} is too slow: {TASK_LIMIT:g} s are over", self.task.file)
        if time.monotonic() - self.started > MAX_WAIT * TASK_LIMIT:
            raise RunError(BUSY, f"the machine is busy: {MAX_WAIT * TASK_LIMIT:g} s are over", self.task.file)
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


def call(function: Any, arguments: tuple[Any, ...]) -> Any:
    """The function's value at copies of the arguments, without numpy's warnings."""
    with np.errstate(all="ignore"):
        return function(*(copy.deepcopy(a) if isinstance(a, np.ndarray | list) else a for a in arguments))


def conform(value: Any, like: Any) -> Any:
    """`value` in the form of a reference result: a float, an array of float64 or a tuple. Raises Wrong otherwise."""
    if value is None:
        raise Wrong("it returns nothing: the last line must be return ...", "returns nothing")
    if isinstance(value, Foreign | str):
        found = value.type_name if isinstance(value, Foreign) else "text"
        raise Wrong(f"it returns a value of type {found}; expected is {form_of(like)}", "wrong type")
    if isinstance(like, tuple):
        if isinstance(value, np.ndarray):
            value = list(value) if value.ndim else [value]
        if not isinstance(value, tuple | list) or len(value) != len(like):
            raise Wrong(f"it returns {form_of(value)}; expected is {form_of(like)}", "wrong shape")
        return tuple(conform(part, entry) for part, entry in zip(value, like, strict=True))
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind == "c":
        raise Wrong("it returns complex numbers: look for the root of a negative number", "wrong type")
    if array.dtype.kind not in "biuf":
        raise Wrong(f"it returns {form_of(value)}; expected is {form_of(like)}", "wrong type")
    array = array.astype(np.float64)
    if np.ndim(like) == 0:
        if array.size != 1:
            raise Wrong(f"it returns {form_of(value)}; expected is {form_of(like)}", "wrong shape")
        return float(array.reshape(()))
    return array


def form_of(value: Any) -> str:
    """The form of a result, in words."""
    if isinstance(value, tuple):
        return "a tuple of " + " and ".join(form_of(part) for part in value)
    if isinstance(value, list):
        return f"a list of {entries(len(value))}"
    shape = np.shape(value)
    return f"an array of shape {shape}" if shape else "a number"


def parts(value: Any) -> tuple[np.ndarray, ...]:
    """A result as arrays."""
    return tuple(np.asarray(part, np.float64) for part in (value if isinstance(value, tuple) else (value,)))


def same_shape(found: Any, expected: Any) -> bool:
    """True if two results have arrays of the same shapes."""
    return [a.shape for a in parts(found)] == [b.shape for b in parts(expected)]


def same(found: Any, expected: Any) -> bool:
    """True if two results agree within the tolerance, every part relative to its largest value."""
    if not same_shape(found, expected):
        return False
    for a, b in zip(parts(found), parts(expected), strict=True):
        finite = np.isfinite(b)
        scale = np.abs(b[finite]).max(initial=0.0)
        if not np.array_equal(a[~finite], b[~finite], equal_nan=True):
            return False
        if not (np.abs(a[finite] - b[finite]) <= TOLERANCE * scale + 1e-12).all():
            return False
    return True


def has(is_such: Callable[[np.ndarray], np.ndarray], value: Any) -> bool:
    """True if a result has a number of a kind."""
    return any(is_such(part).any() for part in parts(value))


def special_case(names: Sequence[str], arguments: Sequence[Any]) -> str:
    """The case in which a function was called, in words: arguments that are equal, or else 0; "" for any other."""
    arrays = [(name, a) for name, a in zip(names, arguments, strict=True) if isinstance(a, np.ndarray | float | int)]
    pairs = itertools.combinations([(name, a) for name, a in arrays if np.ndim(a)], 2)
    found = [f"{one} = {other}" for (one, a), (other, b) in pairs if np.array_equal(a, b)]
    found = found or [f"{name} = 0" for name, a in arrays if not np.any(a)]
    return f" where {' and '.join(found)} (0/0)" if found else ""


def check_program(folder: Path, runner: Runner, task: Task) -> Verdict:
    """Judge the student's function of a programming task."""
    try:
        source = read_source((folder / task.file).read_bytes())
    except OSError:  # the call says what is wrong with the file
        source = read_source(b"")
    if not source.is_begun(task.name):
        return Verdict("not begun")
    verdict = judged(runner, task, source.line_of(task.name))
    for _ in range(1, MAX_TRIES):
        if verdict.state != "not checked":
            break
        time.sleep(RETRY_INTERVAL)
        verdict = judged(runner, task, source.line_of(task.name))
    return verdict


def not_checked(why: str) -> Verdict:
    """The verdict on a function that could not be run by no fault of its own."""
    return Verdict("not checked", f"could not be checked ({why})")


def judged(runner: Runner, task: Task, line: int | None) -> Verdict:
    """As `check_program`, of a function that is begun, once. line: on which it begins."""
    student = StudentFunction(runner, task)
    try:
        compare(student)
        behave(student)
        check_exactly(student)
    except RunError as error:
        place = place_of(error.file, error.line)
        if error.kind == BUSY:
            return not_checked(error.text)
        if error.kind in EFFECTS:
            return Verdict("wrong", error.text, error.kind, place)
        return Verdict("failed", error.text, error.kind, place, task.file if error.loading else "")
    except Wrong as error:
        return Verdict("wrong", str(error), error.mistake, place_of(task.file, line), equations=error.equations)
    return Verdict("right")


def place_of(file: str, line: int | None) -> str:
    """A place in a student's folder, as editors take it."""
    return f"{file}:{line}" if line else file


def draw(runner: Runner, task: Task) -> Points | None:
    """The curve of a task for the report; None where the task has none."""
    curve = getattr(task.check, "CURVE", None)
    if curve is None:
        return None
    x = np.asarray(curve.x, np.float64)
    reference = np.asarray(curve.values(task.function, x), np.float64)
    try:
        found = np.asarray(curve.values(StudentFunction(runner, task, is_watched=False), x), np.float64)
    except (RunError, Wrong, ValueError, IndexError):  # its message stands above the curve
        found = None
    if found is not None and found.shape != x.shape:
        found = None
    return Points(curve.x_label, curve.y_label, x, reference, found)


def behave(student: StudentFunction) -> None:
    """Check the behaviour, where the task has such a check. Raises RunError or Wrong."""
    behaviour = getattr(student.task.check, "behaviour", None)
    if behaviour is None:
        return
    try:
        behaviour(student)
    except (ValueError, IndexError):
        raise Wrong(
            "for other numbers of points its results do not have the shape that they must have", "wrong shape"
        ) from None


def compare(student: StudentFunction) -> None:
    """Compare with the reference at random inputs. Raises RunError or Wrong."""
    task = student.task
    rng = np.random.default_rng(SEED)
    samples = [tuple(task.check.inputs(rng)) for _ in range(SAMPLES)]  # type: ignore[union-attr]
    normalise = getattr(task.check, "normalise", lambda value: value)
    expected = [normalise(student.reference(*sample)) for sample in samples]
    found = []
    for i, sample in enumerate(samples):
        student.like, student.twice = student.reference(*sample), i < TWICE
        found.append(normalise(student(*sample)))
    if all(same(a, b) for a, b in zip(found, expected, strict=True)):
        return

    def agrees(function: Callable[..., Any]) -> bool:
        return all(same(a, normalise(call(function, s))) for a, s in zip(found, samples, strict=True))

    if any(agrees(other) for other in getattr(task.check, "ALTERNATIVES", ())):
        return
    why = explain(student)
    for mistake in getattr(task.check, "MISTAKES", ()):
        if agrees(mistake.function):
            raise Wrong(mistake.hint, mistake.name, why.equations if why else ())
    for a, b in zip(found, expected, strict=True):
        if [(p.ndim, p.shape[1:]) for p in parts(a)] != [(p.ndim, p.shape[1:]) for p in parts(b)]:
            raise Wrong(f"it returns {form_of(a)}; expected is {form_of(b)}", "wrong shape")
    why = why or explain_edit(task.function, agrees)
    if why is not None:
        raise Wrong(why.text, why.mistake, why.equations)
    if all(same_shape(a, b) for a, b in zip(found, expected, strict=True)):
        name_unused_arguments(student, samples, found)
    behave(student)
    for a, b in zip(found, expected, strict=True):
        if not same_shape(a, b):
            raise Wrong(f"it returns {form_of(a)}; expected is {form_of(b)}", "wrong shape")
    first = next(i for i in range(SAMPLES) if not same(found[i], expected[i]))
    given = ", ".join(
        f"{name} = {number_text(value)}"
        for name, value in zip(task.arguments, samples[first], strict=True)
        if not callable(value)
    )
    right = sum(same(a, b) for a, b in zip(found, expected, strict=True))
    raise Wrong(
        f"right at {right} of {SAMPLES} random inputs. With {given} it returns {number_text(found[first])}; "
        f"expected is {number_text(expected[first])}"
    )


def check_exactly(student: StudentFunction) -> None:
    """Raises Wrong for a step whose coefficients differ by less than the results may."""
    if hasattr(student.task.check, "METHOD") and (why := explain(student)) is not None:
        raise Wrong(why.text, why.mistake, why.equations)


def explain(student: StudentFunction) -> Explanation | None:
    """The difference of a function from the reference; None where its structure does not tell."""
    check = student.task.check
    try:
        if (method := getattr(check, "METHOD", None)) is not None:
            return explain_step(student, method.steps, with_velocity=method.with_velocity)
        adds_up = getattr(check, "adds_up", lambda *_: True)
        rng = np.random.default_rng(SEED)
        drawn = (tuple(check.inputs(rng)) for _ in range(MAX_DRAWS))  # type: ignore[union-attr]
        chosen = (sample for sample in drawn if adds_up(student, *sample))
        samples = list(itertools.islice(chosen, TERM_SAMPLES))
        if len(samples) < TERM_SAMPLES:
            return None
        terms = getattr(check, "TERMS", (Term(WHOLE, "", student.task.function),))
        return explain_terms(student, terms, getattr(check, "GROUPS", ()), student.task.arguments, samples)
    except (RunError, Wrong):
        return None


def name_unused_arguments(student: StudentFunction, samples: list[Any], found: list[Any]) -> None:
    """Raises Wrong for a function that leaves an argument unused."""
    unused = [name for i, name in enumerate(student.task.arguments) if ignores(student, samples, found, i)]
    if unused:
        raise Wrong(f"the result does not change with {' and '.join(unused)}", f"{unused[0]} not used")


def ignores(student: StudentFunction, samples: list[Any], found: list[Any], i: int) -> bool:
    """True if the student's result never depends on argument `i`, though the reference does.

    found: the student's results. Each pair of samples is tried, as a force may be 0 at many of them; False for a
    function that is too slow for that.
    """
    normalise = getattr(student.task.check, "normalise", lambda value: value)
    changed_reference = False
    for (first, result), second in itertools.product(zip(samples, found, strict=True), samples):
        other = (*first[:i], second[i], *first[i + 1 :])
        if np.shape(first[i]) != np.shape(second[i]) or same(student.reference(*first), student.reference(*other)):
            continue
        if student.runner.effort - student.effort > TASK_LIMIT / 2.0:
            return False
        changed_reference = True
        student.like = student.reference(*other)
        if not same(normalise(student(*other)), result):
            return False
    return changed_reference
