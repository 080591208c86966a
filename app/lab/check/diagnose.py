"""Names the mistake of a function that differs from the reference.

A sentence about the function states a form of it: a typical mistake of the task, terms of a sum, the equations of a
step, an edit of the reference. It is shown only if that form reproduces the student's results, also at fresh inputs. An
edit of the student's own function is shown if it has the right results there. If nothing passes, the text names the
inputs or parts at which the function differs, with the values at one input.
"""

import contextlib
import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from app.lab.check.comparing import REPAIR_TOLERANCE, call, conform, form_of, has, parts, reproduces, same, same_shape
from app.lab.check.diagnosis import differences
from app.lab.check.diagnosis.edits import explain_edit, explain_repair
from app.lab.check.diagnosis.explanation import Explanation
from app.lab.check.diagnosis.steps import explain_step
from app.lab.check.diagnosis.terms import IGNORED, WHOLE, Term, explain_terms
from app.lab.check.student_function import TASK_LIMIT, StudentFunction, Trial
from app.lab.checking import Wrong
from app.lab.process.runner import RunError

SEED = 20150130
FRESH_SEED = 20261127
FRESH = 24  # fresh inputs, not used to find an explanation
TERM_SAMPLES = 16  # random inputs at which terms are compared
MAX_DRAWS = 200  # of inputs, to find enough
SMALLER = 1e-3  # of an argument, at which a result that seems not to depend on it is tried too
MAX_REPAIRS = 20  # that are right at one input and are tried at the others
UNFIT = ("NaN", "infinite", "wrong shape", "wrong type", "returns nothing")  # results without a test of behaviour
OTHER_SHAPE = "for other numbers of points its results have the wrong shape"
STEP_PARTS = ("new position", "new velocity")
UNIT = re.compile(r"\[([A-Za-z]+)\]")  # the first in a docstring is that of the result
PREFIXES = {"k": 1e-3, "m": 1e3, "M": 1e-6}


def diagnosed(student: StudentFunction, trials: Sequence[Trial]) -> Wrong:
    """The mistake of a function that differs from the reference at some of these inputs. Raises RunError or Wrong."""
    task = student.task
    for trial in trials:
        if [(p.ndim, p.shape[1:]) for p in parts(trial.found)] != [(p.ndim, p.shape[1:]) for p in parts(trial.right)]:
            return Wrong(f"it returns {form_of(trial.found)}; expected {form_of(trial.right)}", "wrong shape")
    rng = np.random.default_rng(FRESH_SEED)
    fresh = [student.trial(tuple(task.check.inputs(rng))) for _ in range(FRESH)]  # type: ignore[union-attr]
    every = [*trials, *fresh]
    has_numbers = any(has(np.isfinite, trial.found) for trial in every)  # without any, too many forms agree with it

    def is_stated(form: Callable[..., Any] | None) -> bool:
        return form is not None and has_numbers and all(has_form(student, form, trial) for trial in every)

    why = explain(student)
    if why is not None:
        forms = getattr(task.check, "within", lambda form: (form,))(why.form)
        form = next(filter(is_stated, forms), None)
        why = None if form is None else why._replace(form=form)
    unused = why.mistake.removesuffix(" not used") if why is not None and why.text.startswith(IGNORED) else ""
    if unused in task.arguments and not ignores(student, every, task.arguments.index(unused)):
        why = None
    if rounds_down(student) and (mended := repair(student, every, of="//")) is not None:
        return wrong_of(mended)
    for mistake in getattr(task.check, "MISTAKES", ()):
        if is_stated(mistake.function):
            return Wrong(mistake.hint, mistake.name, why.equations if why else (), mistake.function)
    if why is not None and not why.is_vague:
        return wrong_of(in_units(student, why, every))
    return wrong_of(
        repair(student, every)
        or why
        or in_special_case(student, every)
        or explain_edit(task.function, task.arguments, is_stated)
        or unused_arguments(student, every)
        or elsewhere(student, every)
    )


def rounds_down(student: StudentFunction) -> bool:
    """True if the student's file uses //, which is easily mistaken for division."""
    try:
        return b"//" in (student.runner.folder / student.task.file).read_bytes()
    except OSError:
        return False


def in_units(student: StudentFunction, why: Explanation, trials: Sequence[Trial]) -> Explanation:
    """Explain a constant factor by the units of this task."""
    if why.mistake == "another constant" and (said := getattr(student.task.check, "CONSTANT", "")):
        return why._replace(text=f"{why.text} {said}")
    unit = UNIT.search(student.task.function.__doc__ or "")
    if why.mistake != "constant factor" or unit is None:
        return why
    found, right = (np.concatenate([part.ravel() for t in trials for part in parts(getattr(t, which))])
                    for which in ("found", "right"))  # fmt: skip
    ratio = float(np.median((found / np.where(right == 0.0, np.nan, right))[right != 0.0]))
    prefix = next((sign for sign, factor in PREFIXES.items() if abs(ratio - factor) < 1e-4 * factor), "")
    return why._replace(text=f"{why.text} Is it in {prefix}{unit[1]}? It must be in {unit[1]}.") if prefix else why


def wrong_of(why: Explanation) -> Wrong:
    """An explanation as an exception."""
    return Wrong(why.text, why.mistake, why.equations, why.form, why.line)


def has_form(student: StudentFunction, form: Callable[..., Any], trial: Trial) -> bool:
    """True if the student's result at an input is that of a form."""
    try:
        value = student.normalised(conform(call(form, trial.sample), student.reference(*trial.sample)))
    except Exception:  # an edit has broken the form
        return False
    return reproduces(value, trial.found, trial.right)


def explain(student: StudentFunction) -> Explanation | None:
    """The difference of a function from the reference by its structure; None if that is inconclusive."""
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


def repair(student: StudentFunction, trials: Sequence[Trial], of: str = "") -> Explanation | None:
    """The edit of the student's own function that makes it right at all inputs, or None. of: text that it removes."""
    runner = student.runner
    calls_back = any(callable(argument) for argument in trials[0].sample)  # for each edit: too slow on a busy machine
    if calls_back or runner.effort - student.effort > TASK_LIMIT / 2.0:
        return None
    first = next(trial for trial in trials if not trial.is_right)
    others = [trial for trial in trials if trial is not first]
    before = runner.effort
    try:
        return first_repair(student, first, others, of)
    finally:
        student.effort += runner.effort - before  # the student's function is not charged for this


def first_repair(student: StudentFunction, first: Trial, others: Sequence[Trial], of: str) -> Explanation | None:
    """As `repair`. first: an input at which the function is wrong."""
    task, runner = student.task, student.runner

    def is_right(value: Any, trial: Trial) -> bool:
        try:
            value = student.normalised(conform(value, student.reference(*trial.sample)))
            return same(value, trial.right, REPAIR_TOLERANCE)
        except (Wrong, ValueError, IndexError):
            return False

    def results(number: int) -> Iterator[tuple[Any, Trial]]:
        return ((runner.edited(task.file, task.name, number, *trial.sample), trial) for trial in others)

    for far in (False,) if of else (False, True):
        try:
            edits = runner.edits(task.file, task.name, *first.sample, far=far)
        except RunError:  # an edit that does not end
            continue
        near = [e for e in edits if (not of or (of in e[1] and of not in e[2])) and is_right(e[-1], first)]
        for number, *edit, _ in sorted(near, key=length_of_change)[:MAX_REPAIRS]:
            with contextlib.suppress(RunError):
                if all(is_right(value, trial) for value, trial in results(number)):
                    return explain_repair(edit)
    return None


def length_of_change(edit: Sequence[Any]) -> tuple[int, int]:
    """Sort key of edits: the change in length of an expression."""
    number, before, after, *_ = edit
    return abs(len(after) - len(before)), number


def unused_arguments(student: StudentFunction, trials: Sequence[Trial]) -> Explanation | None:
    """The arguments that a function leaves unused, or None."""
    if not all(same_shape(trial.found, trial.right) for trial in trials):
        return None
    unused = [name for i, name in enumerate(student.task.arguments) if ignores(student, trials, i)]
    if not unused:
        return None
    return Explanation(f"{unused[0]} not used", f"{IGNORED}{' and '.join(unused)}.")


def ignores(student: StudentFunction, trials: Sequence[Trial], i: int) -> bool:
    """True if the student's result never depends on argument `i`, though the reference does.

    Each pair of inputs is tried, as a force may be 0 at many of them, and then much smaller numbers, as all of the
    task's may be so large that a term is gone; False for a function that is too slow for that.
    """
    changed_reference = False
    pairs = ((one, other.sample[i]) for one, other in itertools.product(trials, repeat=2))
    smaller = ((one, SMALLER * one.sample[i]) for one in trials if np.asarray(one.sample[i]).dtype.kind == "f")
    for one, value in itertools.chain(pairs, smaller):
        sample = (*one.sample[:i], value, *one.sample[i + 1 :])
        if np.shape(one.sample[i]) != np.shape(value):
            continue
        if same(one.right, student.normalised(student.reference(*sample))):
            continue
        if student.runner.effort - student.effort > TASK_LIMIT / 2.0:
            return False
        changed_reference = True
        try:
            found = student.trial(sample).found
        except (RunError, Wrong):  # as of an input that the task does not have
            return False
        if not same(found, one.found):
            return False
    return changed_reference


def in_special_case(student: StudentFunction, trials: Sequence[Trial]) -> Explanation | None:
    """The only special case of the task in which a function differs, or None."""
    cases = getattr(student.task.check, "CASES", ())
    compared = compared_parts(trials)
    if compared is None or not differences.case_of(compared, cases):
        return None
    return differences.explain_where(compared, student.task.arguments, part_names(student, trials), cases)


def elsewhere(student: StudentFunction, trials: Sequence[Trial]) -> Explanation:
    """The place where a function differs, after a fault of its behaviour. Raises RunError or Wrong."""
    check = student.task.check
    wrong = next(trial for trial in trials if not trial.is_right)
    compared = compared_parts(trials)
    if text := getattr(check, "contrast", lambda *_: "")(wrong.found, wrong.right, *wrong.sample):
        found = Explanation("", text)
    elif compared is None:
        other = next(trial for trial in trials if not same_shape(trial.found, trial.right))
        raise Wrong(f"it returns {form_of(other.found)}; expected {form_of(other.right)}", "wrong shape")
    else:
        found = differences.explain_where(compared, student.task.arguments, part_names(student, trials), ())
    if found.mistake:
        return found
    try:
        behave(student)
    except Wrong as error:
        if error.mistake not in UNFIT:
            said = str(error)
            return Explanation(error.mistake, f"{said[0].upper()}{said[1:].rstrip('.')}. {found.text}")
    return found


def compared_parts(trials: Sequence[Trial]) -> list[differences.Difference] | None:
    """The trials with their differences; None if results have other shapes."""
    if not all(same_shape(trial.found, trial.right) for trial in trials):
        return None
    return [differences.compared(trial.sample, parts(trial.found), parts(trial.right)) for trial in trials]


def part_names(student: StudentFunction, trials: Sequence[Trial]) -> tuple[str, ...]:
    """Names of the parts of a result."""
    several = tuple(f"result {i + 1}" for i in range(len(parts(trials[0].right))))
    return STEP_PARTS if hasattr(student.task.check, "METHOD") else several


def behave(student: StudentFunction) -> None:
    """Check the behaviour, if the task has such a check. Raises RunError or Wrong."""
    behaviour = getattr(student.task.check, "behaviour", None)
    if behaviour is None:
        return
    try:
        behaviour(student)
    except (ValueError, IndexError):
        raise Wrong(OTHER_SHAPE, "wrong shape") from None
