"""Judges a student's function: against the reference at many inputs (`inputs.py`), then by its behaviour.

A wrong function is compared with the typical mistakes of its task, then analysed by its structure
(`diagnosis/`): the tableau of a step, the terms of a sum. Any function can leave an argument unused.
"""

import contextlib
import dataclasses
import inspect
import textwrap
import time
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from app.lab.check.comparing import call, same
from app.lab.check.diagnose import behave, diagnosed, error_with_repair, explain, with_repair
from app.lab.check.inputs import inputs_of
from app.lab.check.python_errors import in_plain_words
from app.lab.check.student_function import StudentFunction
from app.lab.checking import Wrong
from app.lab.course.source import read_source
from app.lab.course.task import Task
from app.lab.diagnosis.effects import EFFECTS
from app.lab.diagnosis.explanation import Equation
from app.lab.process.runner import BUSY, RunError, Runner

MAX_TRIES = 3  # of a check, on a machine that is too busy to start a process
RETRY_INTERVAL = 0.5  # [s] between two of them
TWICE = 3  # of the inputs are tried twice


@dataclasses.dataclass(frozen=True)
class Verdict:
    """Result of the check of one function.

    state: "not begun", "right", "wrong", "failed" (no result), "not checked" (the machine is too busy), or "waits"
    (right, but it calls a function of the course that is not). calls: the functions of the course that it calls.
    mistake: the name of a recognised mistake, or "". place: file and line of a mistake, as an editor takes it:
    "rope.py:17"; "" if it is unknown. file: the file that does not run, or "". equations: of a wrong function, beside
    the right ones.
    """

    state: str
    text: str = ""
    mistake: str = ""
    place: str = ""
    file: str = ""
    equations: tuple[Equation, ...] = ()
    calls: tuple[str, ...] = ()

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
    """A curve of the student's function beside the reference. student: None if it has no result."""

    x_label: str
    y_label: str
    x: np.ndarray
    reference: np.ndarray
    student: np.ndarray | None


def check_program(folder: Path, runner: Runner, task: Task, tasks: Iterable[Task] = ()) -> Verdict:
    """Judge the student's function of a programming task.

    tasks: their solutions stand in for the student's functions that this one calls.
    """
    runner.course = {
        other.name: textwrap.dedent(inspect.getsource(other.function))
        for other in tasks if other.check is not None and other.name != task.name
    }  # fmt: skip
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
    """The verdict on a function that could not be run for an external reason."""
    return Verdict("not checked", f"could not be checked ({why})")


def judged(runner: Runner, task: Task, line: int | None) -> Verdict:
    """As `check_program`, once, for a function under way. line: its first one."""
    student = StudentFunction(runner, task)
    try:
        compare(student)
        behave(student)
        check_exactly(student)
    except RunError as error:
        place = place_of(error.file, error.line)
        if error.kind == BUSY:
            return not_checked(error.text)
        if error.kind == "missing" and error.text == f"there is no function {task.name}":
            return Verdict("not begun")
        if error.kind in EFFECTS:
            return Verdict("wrong", error.text, error.kind, place)
        text = in_plain_words(error.text) if error.loading else error.text
        return Verdict("failed", text, error.kind, place, task.file if error.loading else "")
    except Wrong as error:
        place = place_of(task.file, error.line or line)
        return Verdict("wrong", str(error), error.mistake, place, equations=error.equations)
    with contextlib.suppress(RunError):
        return Verdict("right", calls=tuple(str(name) for name in student.ask("called")))
    return Verdict("right")


def settled(name: str, verdicts: Mapping[str, Verdict]) -> Verdict:
    """The verdict on a function, given those on all: "waits" if it is right, but calls one that is not."""
    verdict = verdicts[name]
    if verdict.state != "right":
        return verdict
    for called in verdict.calls:
        other = verdicts.get(called)
        if other is not None and other.state not in ("right", "not checked"):
            what = "is not written yet" if other.state == "not begun" else "is wrong"
            text = f"It is right, but it calls {called}, which {what}: mend that first"
            return dataclasses.replace(
                verdict, state="waits", text=text.replace("mend", "write") if "yet" in what else text
            )
    return verdict


def place_of(file: str, line: int | None) -> str:
    """A place in a student's folder, as editors take it."""
    return f"{file}:{line}" if line else file


def draw(runner: Runner, task: Task) -> Points | None:
    """The curve of a task for the report; None if the task has none."""
    curve = getattr(task.check, "CURVE", None)
    if curve is None:
        return None
    x = np.asarray(curve.x, np.float64)
    reference = np.asarray(curve.values(task.function, x), np.float64)
    try:
        values = np.asarray(curve.values(StudentFunction(runner, task, is_watched=False), x), np.float64)
    except (RunError, Wrong, ValueError, IndexError):  # its message stands above the curve
        values = None
    if values is not None and values.shape != x.shape:
        values = None
    return Points(curve.x_label, curve.y_label, x, reference, values)


def compare(student: StudentFunction) -> None:
    """Compare with the reference at all inputs. Raises RunError or Wrong."""
    check = student.task.check
    samples = inputs_of(check, student.task.name)
    student.takes_all = True
    try:
        trials = list(student.trials(samples, TWICE))
    except RunError as error:
        raise error_with_repair(student, samples, error) from None
    except Wrong as error:
        raise with_repair(student, samples, error) from None
    student.takes_all = False
    if all(trial.is_right for trial in trials):
        return
    alternatives = getattr(check, "ALTERNATIVES", ())
    if any(all(same(t.result, student.normalised(call(other, t.sample))) for t in trials) for other in alternatives):
        return
    raise diagnosed(student, trials)


def check_exactly(student: StudentFunction) -> None:
    """Raises Wrong for a step whose coefficients differ by less than the results may."""
    if hasattr(student.task.check, "METHOD") and (why := explain(student)) is not None:
        raise Wrong(why.text, why.mistake, why.equations)
