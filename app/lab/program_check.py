"""Judges a student's function: against the reference at random inputs, then by its behaviour.

A wrong function is compared with the typical mistakes of its task, and with those that any function can have: the
sign, a factor, an argument that is not used.
"""

import ast
import copy
import dataclasses
import time
from pathlib import Path
from typing import Any

import numpy as np

from app.lab.checking import Wrong, number_text
from app.lab.runner import RunError, Runner
from app.lab.task import Task
from app.lab.wire import Foreign

SAMPLES = 12  # random inputs
TOLERANCE = 1e-4  # of the largest value of a result: single precision is right too
TASK_LIMIT = 10.0  # [s] for all calls of one task
SEED = 20150130


@dataclasses.dataclass(frozen=True)
class Verdict:
    """Result of the check of one function.

    state: "not begun", "right", "wrong" or "failed" (no result). mistake: the name of a recognised mistake, or "".
    place: file and line of a mistake, as an editor takes it: "rope.py:17"; "" if it is unknown.
    """

    state: str
    text: str = ""
    mistake: str = ""
    place: str = ""

    @property
    def sentence(self) -> str:
        """The mistake in words."""
        named = f"{self.mistake}: " if self.state == "wrong" and self.mistake else ""
        return named + self.text + ("" if self.text.endswith((".", "?", "!")) else ".")


@dataclasses.dataclass(frozen=True)
class Points:
    """A curve of the student's function beside the reference. student: None where it has no result."""

    x_label: str
    y_label: str
    x: np.ndarray
    reference: np.ndarray
    student: np.ndarray | None


class Student:
    """A student's function, called with the types of the reference solution."""

    def __init__(self, runner: Runner, task: Task) -> None:
        self.runner = runner
        self.task = task
        self.started = time.monotonic()
        self.like: Any = None  # a result of the reference solution

    def __call__(self, *arguments: Any) -> Any:
        """The result, in the form of the reference's. Raises RunError or Wrong."""
        if time.monotonic() - self.started > TASK_LIMIT:
            raise RunError("endless", f"{self.task.name} is too slow: {TASK_LIMIT:g} s are over", self.task.file)
        value = self.runner.call(self.task.file, self.task.name, *arguments)
        if self.like is None:
            self.like = self.reference(*arguments)
        return conform(value, self.like)

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
        return f"a list of {len(value)} entries"
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


def definition(folder: Path, task: Task) -> ast.FunctionDef | None:
    """The function in the student's file; None if it is not there, or the file cannot be parsed."""
    try:
        tree = ast.parse((folder / task.file).read_bytes())
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):  # the last two where it nests too deeply
        return None
    found = (node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == task.name)
    return next(found, None)


def is_begun(folder: Path, task: Task) -> bool:
    """True if the function in the student's file has a body: more than a docstring, `...` and `pass`.

    True without a function too: running the file says what is wrong.
    """
    node = definition(folder, task)
    return node is None or not all(is_empty(line) for line in node.body)


def is_empty(line: ast.stmt) -> bool:
    """True if a line is a docstring, `...` or `pass`."""
    return isinstance(line, ast.Pass) or (isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant))


def check_program(folder: Path, runner: Runner, task: Task) -> Verdict:
    """Judge the student's function of a programming task."""
    if (folder / task.file).is_file() and not is_begun(folder, task):
        return Verdict("not begun")
    student = Student(runner, task)
    try:
        compare(student)
        behave(student)
    except RunError as error:
        return Verdict("failed", error.text, error.kind, place_of(error.file, error.line))
    except Wrong as error:
        node = definition(folder, task)
        return Verdict("wrong", str(error), error.mistake, place_of(task.file, node and node.lineno))
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
        found = np.asarray(curve.values(Student(runner, task), x), np.float64)
    except (RunError, Wrong, ValueError, IndexError):  # its message stands above the curve
        found = None
    if found is not None and found.shape != x.shape:
        found = None
    return Points(curve.x_label, curve.y_label, x, reference, found)


def behave(student: Student) -> None:
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


def compare(student: Student) -> None:
    """Compare with the reference at random inputs. Raises RunError or Wrong."""
    task = student.task
    rng = np.random.default_rng(SEED)
    samples = [tuple(task.check.inputs(rng)) for _ in range(SAMPLES)]  # type: ignore[union-attr]
    normalise = getattr(task.check, "normalise", lambda value: value)
    expected = [normalise(student.reference(*sample)) for sample in samples]
    found = []
    for sample in samples:
        student.like = student.reference(*sample)
        value = normalise(student(*sample))
        for part in parts(value):
            if np.isnan(part).any() and not any(np.isnan(p).any() for p in parts(expected[len(found)])):
                raise Wrong(
                    "it returns NaN (not a number): look for a division by 0 or the root of a negative number", "NaN"
                )
        found.append(value)
    if all(same(a, b) for a, b in zip(found, expected, strict=True)):
        return
    for other in getattr(task.check, "ALTERNATIVES", ()):
        if all(same(a, normalise(call(other, s))) for a, s in zip(found, samples, strict=True)):
            return
    for mistake in getattr(task.check, "MISTAKES", ()):
        if all(same(a, normalise(call(mistake.function, s))) for a, s in zip(found, samples, strict=True)):
            raise Wrong(mistake.hint, mistake.name)
    for a, b in zip(found, expected, strict=True):
        if [(p.ndim, p.shape[1:]) for p in parts(a)] != [(p.ndim, p.shape[1:]) for p in parts(b)]:
            raise Wrong(f"it returns {form_of(a)}; expected is {form_of(b)}", "wrong shape")
    if all(same_shape(a, b) for a, b in zip(found, expected, strict=True)):
        name_common_mistake(student, samples, found, expected)
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


def name_common_mistake(student: Student, samples: list[Any], found: list[Any], expected: list[Any]) -> None:
    """Raises Wrong for a mistake that a function of any task can have."""
    task = student.task
    if all(same(a, negative(b)) for a, b in zip(found, expected, strict=True)):
        raise Wrong("every result has the right size and the wrong sign", "sign reversed")
    if factor := common_factor(found, expected):
        raise Wrong(f"every result is {factor:.4g} times what it must be", "constant factor")
    unused = [name for i, name in enumerate(task.arguments) if ignores(student, samples, i)]
    if unused:
        raise Wrong(f"the result does not change with {' and '.join(unused)}", f"{unused[0]} not used")


def negative(value: Any) -> Any:
    """A result with its sign reversed."""
    return tuple(-part for part in value) if isinstance(value, tuple) else -np.asarray(value)


def common_factor(found: list[Any], expected: list[Any]) -> float | None:
    """The number that all results are too large by, if there is one."""
    a = np.concatenate([part.ravel() for value in found for part in parts(value)])
    b = np.concatenate([part.ravel() for value in expected for part in parts(value)])
    both = np.isfinite(a) & np.isfinite(b)
    if not np.array_equal(np.isfinite(a), np.isfinite(b)) or not (norm := float(b[both] @ b[both])):
        return None
    factor = float(a[both] @ b[both]) / norm
    fits = all(same(x, scaled(y, factor)) for x, y in zip(found, expected, strict=True))
    return factor if fits and factor != 0.0 else None


def scaled(value: Any, factor: float) -> Any:
    """A result times a number."""
    return tuple(factor * part for part in value) if isinstance(value, tuple) else factor * np.asarray(value)


def ignores(student: Student, samples: list[Any], i: int) -> bool:
    """True if the student's result does not depend on argument `i`, though the reference does."""
    changed_reference = False
    for first, second in zip(samples[:3], samples[3:6], strict=True):
        if np.shape(first[i]) != np.shape(second[i]):
            continue
        other = (*first[:i], second[i], *first[i + 1 :])
        if same(student.reference(*first), student.reference(*other)):
            continue
        changed_reference = True
        student.like = student.reference(*other)
        if not same(
            student(*other), conform(student.runner.call(student.task.file, student.task.name, *first), student.like)
        ):
            return False
    return changed_reference
