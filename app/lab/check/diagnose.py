"""Names the mistake of a function that differs from the reference.

A sentence about the function states a form of it: a typical mistake of the task, terms of a sum, the equations of a
step. It is shown only if that form reproduces the student's results at all inputs. An edit of the student's own
function is shown if it passes everything that decides whether a function is right. If nothing passes, the text names
the inputs or parts at which the function differs, with the values at the smallest such input.
"""

import ast
import contextlib
import inspect
import itertools
import math
import re
import textwrap
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from app.lab.check.comparing import (
    REPAIR_TOLERANCE,
    TOLERANCE,
    call,
    conform,
    form_of,
    has,
    parts,
    reproduces,
    same,
    same_shape,
)
from app.lab.check.inputs import RANDOM, SEED, Sample
from app.lab.check.python_errors import in_plain_words
from app.lab.check.student_function import TASK_LIMIT, EditedFunction, StudentFunction, Trial
from app.lab.checking import Counted, Wrong
from app.lab.diagnosis import differences
from app.lab.diagnosis.conditions import conditions_of
from app.lab.diagnosis.explanation import Explanation, says_repair
from app.lab.diagnosis.steps import explain_step
from app.lab.diagnosis.terms import IGNORED, WHOLE, Term, explain_terms
from app.lab.diagnosis.units import clashes, units_of
from app.lab.process.runner import RunError

TERM_SAMPLES = 16  # random inputs at which terms are compared
MAX_DRAWS = 200  # of inputs, to find enough
UNUSED_SAMPLES = 20  # inputs that are exchanged with each other, for an argument without effect
SMALLER = 1e-3  # of an argument, at which a result that seems not to depend on it is tried too
MAX_REPAIRS = 20  # that are right at one input and are tried at the others
EDITS_LIMIT = 2.0  # [s] for all edits of a kind
MANY = 4  # further texts that may stand at a place, from where on what stands there has no effect
LESS = 4.0  # ratio of the errors of a sum of steps, at least, at a tenth of its steps
NEARLY = 0.05  # of the largest value of a result, within which it is nearly right
UNFIT = ("NaN", "infinite", "wrong shape", "wrong type", "returns nothing")  # results without a test of behaviour
OTHER_SHAPE = "for other numbers of points its results have the wrong shape"
STEP_PARTS = ("new position", "new velocity")
UNIT = re.compile(r"\[([A-Za-z]+)\]")  # the first in a docstring is that of the result
PREFIXES = {"k": 1e-3, "m": 1e3, "M": 1e-6}


def diagnosed(student: StudentFunction, trials: Sequence[Trial]) -> Wrong:
    """The mistake of a function that differs from the reference at some of these inputs. Raises RunError or Wrong."""
    task = student.task
    samples = [trial.sample for trial in trials]
    first = next(i for i, trial in enumerate(trials) if not trial.is_right)
    for i, trial in enumerate(trials):
        if [(p.ndim, p.shape[1:]) for p in parts(trial.result)] != [(p.ndim, p.shape[1:]) for p in parts(trial.right)]:
            text = f"it returns {form_of(trial.result)}; expected {form_of(trial.right)}"
            return with_repair(student, samples, Wrong(text, "wrong shape"), i)
    has_numbers = any(has(np.isfinite, trial.result) for trial in trials)  # without any, too many forms agree with it

    def is_stated(form: Callable[..., Any] | None) -> bool:
        return form is not None and has_numbers and all(has_form(student, form, trial) for trial in trials)

    why = explain(student)
    if why is not None:
        forms = getattr(task.check, "within", lambda form: (form,))(why.form)
        form = next(filter(is_stated, forms), None)
        why = None if form is None else why._replace(form=form)
    unused = why.mistake.removesuffix(" not used") if why is not None and why.text.startswith(IGNORED) else ""
    if unused in task.arguments and not ignores(student, trials, task.arguments.index(unused)):
        why = None
    if (trap := repair(student, samples, first, "traps")) is not None:
        return wrong_of(trap)
    for mistake in getattr(task.check, "MISTAKES", ()):
        if is_stated(mistake.function):
            return Wrong(mistake.hint, mistake.name, why.equations if why else (), mistake.function)
    # Of a step with a single wrong equation that equation says more than brackets that happen to mend it.
    is_clear = (
        why is not None and hasattr(task.check, "METHOD") and sum(bool(line.right) for line in why.equations) == 1
    )
    if not is_clear and (cause := repair(student, samples, first, "causes")) is not None:
        return wrong_of(cause._replace(equations=why.equations if why else ()))
    if why is not None and not why.is_vague:
        return wrong_of(in_units(student, why, trials))
    odd = next((error for trial in trials if (error := student.not_finite(trial)) is not None), None)
    mended = repair(student, samples, first, "slips", "more slips")
    if odd is not None and mended is not None:
        return Wrong(f"{odd}. {mended.text}", odd.mistake, line=mended.line)
    return wrong_of(
        mended
        or why
        or (None if odd is None else Explanation(odd.mistake, str(odd)))
        or in_special_case(student, trials)
        or unused_arguments(student, trials)
        or elsewhere(student, trials)
    )


def with_repair(student: StudentFunction, samples: Sequence[Sample], error: Wrong, first: int | None = None) -> Wrong:
    """A result of another form, with an edit that makes the function right, if there is one.

    first: number of its input; None for the last one.
    """
    explanation = repair(
        student, samples, last_input(student, samples) if first is None else first, "traps", "causes", "slips"
    )
    if explanation is None:
        return error
    return Wrong(f"{error}. {explanation.text}", error.mistake, line=explanation.line)


def last_input(student: StudentFunction, samples: Sequence[Sample]) -> int:
    """Number of the last input that was tried."""
    return next(i for i, sample in enumerate(samples) if sample is student.sample)


def in_units(student: StudentFunction, why: Explanation, trials: Sequence[Trial]) -> Explanation:
    """Explain a constant factor by the units of this task."""
    if why.mistake == "another constant" and (said := getattr(student.task.check, "CONSTANT", "")):
        return why._replace(text=f"{why.text} {said}")
    unit = UNIT.search(student.task.function.__doc__ or "")
    if why.mistake != "constant factor" or unit is None:
        return why
    results, right = (np.concatenate([part.ravel() for t in trials for part in parts(getattr(t, which))])
                    for which in ("result", "right"))  # fmt: skip
    ratio = float(np.median((results / np.where(right == 0.0, np.nan, right))[right != 0.0]))
    prefix = next((sign for sign, factor in PREFIXES.items() if abs(ratio - factor) < 1e-4 * factor), "")
    return why._replace(text=f"{why.text} Is it in {prefix}{unit[1]}? It must be in {unit[1]}.") if prefix else why


def wrong_of(why: Explanation) -> Wrong:
    """An explanation as an exception."""
    return Wrong(why.text, why.mistake, why.equations, why.form, why.line)


def has_form(student: StudentFunction, form: Callable[..., Any], trial: Trial) -> bool:
    """True if the student's result at an input is that of a form."""
    try:
        value = student.normalised(conform(call(form, trial.sample), student.reference(*trial.sample)))
    except Exception:  # an input that breaks the form
        return False
    return reproduces(value, trial.result, trial.right)


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


def repair(student: StudentFunction, samples: Sequence[Sample], first: int, *kinds: str) -> Explanation | None:
    """The edit of the student's own function that makes it right, or None.

    first: number of an input at which the function is wrong. kinds: of edits, of `worker.EDITS`.
    """
    runner, task, sample = student.runner, student.task, samples[first]
    calls_back = any(callable(argument) for argument in sample)  # for many edits: too slow on a busy machine
    if runner.effort - student.effort > TASK_LIMIT / 2.0:
        return None
    units = units_of(task.function.__doc__ or "", task.arguments)
    most = clashes(ast.parse(textwrap.dedent(inspect.getsource(task.function))), units)
    conditions = conditions_of(task.function)
    before, right = runner.effort, student.normalised(student.reference(*sample))
    try:
        for kind in kinds:
            if calls_back and kind not in ("traps", "causes"):
                return None
            try:
                edits = student.ask("edits", kind, task.arguments, conditions, sample, time_limit=EDITS_LIMIT)
                right_ones = [number for number, value in edits if is_repaired(student, value, sample, right)]
                words = student.ask("words", right_ones, list(units.items()), most)
            except RunError:  # an edit that does not end
                continue
            passing = (
                edit
                for number, _, *edit in sorted(words, key=lambda edit: edit[1])[:MAX_REPAIRS]
                if passes(EditedFunction(student, number), samples)
            )
            if (edit := next(passing, None)) is None:
                continue
            # Of a text that is overwritten, say, anything may stand in its place.
            place = [(before, line) for before, _, line in edit[-1]]
            others = [edit for edit in passing if [(before, line) for before, _, line in edit[-1]] == place]
            if kind != "more slips" or len(others) < MANY:
                return explain_repair(*edit)
        return None
    finally:
        student.effort += runner.effort - before  # the student's function is not charged for this


def explain_repair(cause: str, condition: str, replacements: Sequence[Sequence[Any]]) -> Explanation:
    """The words for an edit that makes a student's function right. replacements: as of `EditWords`."""
    before, _, line = replacements[0]
    if condition:
        how = f"It is right if the condition {before} in line {line} {condition} holds."
    elif says_repair(cause):
        return Explanation("", cause, line=line)
    else:
        parts = [
            f"{f'with {after} in place of' if after else 'without'} {before} in line {line}"
            for before, after, line in replacements
        ]
        how = f"{', and '.join(parts)} it is right."
    return Explanation("", f"{cause} {how[0].upper()}{how[1:]}".strip(), line=line)


def is_repaired(student: StudentFunction, value: Any, sample: Sample, right: Any) -> bool:
    """True if a value is the right one at an input."""
    try:
        value = student.normalised(conform(value, student.reference(*sample)))
        return same(value, right, REPAIR_TOLERANCE)
    except (Wrong, ValueError, IndexError):
        return False


def passes(function: StudentFunction, samples: Sequence[Sample]) -> bool:
    """True if a function passes everything that decides whether it is right, within narrower limits."""
    try:
        if not all(same(trial.result, trial.right, REPAIR_TOLERANCE) for trial in function.trials(samples)):
            return False
        behave(function)
    except (RunError, Wrong, ValueError, IndexError):
        return False
    return not hasattr(function.task.check, "METHOD") or explain(function) is None


def unused_arguments(student: StudentFunction, trials: Sequence[Trial]) -> Explanation | None:
    """The arguments that a function leaves unused, or None."""
    if not all(same_shape(trial.result, trial.right) for trial in trials):
        return None
    unused = [name for i, name in enumerate(student.task.arguments) if ignores(student, trials, i)]
    if not unused:
        return None
    return Explanation(f"{unused[0]} not used", f"{IGNORED}{' and '.join(unused)}.")


def ignores(student: StudentFunction, trials: Sequence[Trial], i: int) -> bool:
    """True if the student's result never depends on argument `i`, though the reference does.

    Pairs of inputs are tried, as a force may be 0 at many of them, and then much smaller numbers, as all of the
    task's may be so large that a term is gone; False for a function that is too slow for that.
    """
    changed_reference = False
    some = trials[:UNUSED_SAMPLES]
    pairs = ((one, other.sample[i]) for one, other in itertools.product(some, repeat=2))
    smaller = ((one, SMALLER * one.sample[i]) for one in some if np.asarray(one.sample[i]).dtype.kind == "f")
    for one, value in itertools.chain(pairs, smaller):
        sample = (*one.sample[:i], value, *one.sample[i + 1 :])
        if np.shape(one.sample[i]) != np.shape(value):
            continue
        try:
            if same(one.right, student.normalised(student.reference(*sample))):
                continue
        except (ValueError, IndexError):  # arguments that do not belong together
            continue
        if student.runner.effort - student.effort > TASK_LIMIT / 2.0:
            return False
        changed_reference = True
        try:
            result = student.trial(sample).result
        except (RunError, Wrong):  # as of an input that the task does not have
            return False
        if not same(result, one.result, 0.0):
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
    """The place where a function differs, a fault of its behaviour, or the smallest input. Raises RunError or Wrong."""
    check, names = student.task.check, student.task.arguments
    wrong = min((trial for trial in trials if not trial.is_right), key=lambda trial: size_of(trial.sample))
    compared = compared_parts(trials)
    if text := getattr(check, "contrast", lambda *_: "")(wrong.result, wrong.right, *wrong.sample):
        try:
            behave(student)
        except Wrong as failed:
            if failed.mistake and failed.mistake not in UNFIT:
                return Explanation(failed.mistake, f"{failed} {text}")
        return Explanation("", text)
    if compared is None:
        other = next(trial for trial in trials if not same_shape(trial.result, trial.right))
        raise Wrong(f"it returns {form_of(other.result)}; expected {form_of(other.right)}", "wrong shape")
    explanation = differences.explain_where(compared, names, part_names(student, trials), ())
    if text := other_calls(student, wrong) or steps_in_sum(student, trials):
        return explanation._replace(text=f"{text} {explanation.text}")
    if (error := nearly(trials[:RANDOM])) is not None:
        text = f"At ordinary inputs it differs by at most {100.0 * error:.2g} %: a rounded number, or too large a step?"
        return explanation._replace(text=f"{text} {explanation.text}")
    if explanation.mistake:
        return explanation
    try:
        behave(student)
    except Wrong as failed:
        if failed.mistake not in UNFIT:
            said = str(failed)
            return Explanation(
                failed.mistake, f"{said[0].upper()}{said[1:].rstrip('.')}. {shown_last(student) or explanation.text}"
            )
    return explanation


def other_calls(student: StudentFunction, trial: Trial) -> str:
    """A sentence on a step that calls the acceleration more or less often than the solution does; "" for others.

    Raises RunError.
    """
    if not hasattr(student.task.check, "METHOD"):
        return ""
    *state, acceleration = trial.sample
    own, right = Counted(acceleration), Counted(acceleration)
    student.values([(*state, own)])
    student.reference(*state, right)
    numbers = [f"{n} time{'' if n == 1 else 's'}" for n in (len(own.calls), len(right.calls))]
    if numbers[0] == numbers[1]:
        return ""
    return f"It calls {student.task.arguments[-1]} {numbers[0]} in this step, the solution of the course {numbers[1]}."


def steps_in_sum(student: StudentFunction, trials: Sequence[Trial]) -> str:
    """A sentence on a function that takes time steps of its own, whose error shrinks with them; "" for others.

    Raises RunError.
    """
    wrong = [trial for trial in trials[:RANDOM] if not trial.is_right]
    if not wrong or student.runner.effort - student.effort > TASK_LIMIT / 2.0:
        return ""
    try:
        edits = student.ask("edits", "finer steps", student.task.arguments, [], wrong[0].sample, time_limit=EDITS_LIMIT)
        words = student.ask("words", [number for number, _ in edits], [], 0)  # a smaller number has the same unit
        before = max(map(error_of, wrong))
        for number, _, _, _, [(old, new, line)] in words:
            finer = EditedFunction(student, number)
            after = max(error_of(trial) for trial in finer.trials([trial.sample for trial in wrong]))
            if after * LESS <= before < math.inf:
                return (
                    f"Its largest error is {100.0 * before:.2g} % with {old} in line {line}, and {100.0 * after:.2g} % "
                    f"with {new} there: an error of finite steps. Use the formula instead."
                )
    except (RunError, Wrong):  # an edit that does not end, or has another result
        return ""
    return ""


def error_of(trial: Trial) -> float:
    """The largest error of a result, relative to the largest number of its part; infinite where there is no ratio."""
    worst = 0.0
    for a, b in zip(parts(trial.result), parts(trial.right), strict=True):
        if not (np.isfinite(a).all() and np.isfinite(b).all()):
            return math.inf
        error, scale = float(np.abs(a - b).max(initial=0.0)), float(np.abs(b).max(initial=0.0))
        worst = max(worst, error / scale if scale > 0.0 else math.inf if error > 0.0 else 0.0)
    return worst


def shown_last(student: StudentFunction) -> str:
    """The last call with its result and the right one, if they differ; otherwise ""."""
    if student.last is None or not same_shape(student.last.result, student.last.right):
        return ""
    last = differences.compared(student.last.sample, parts(student.last.result), parts(student.last.right))
    names = part_names(student, [student.last])
    return differences.example(last, student.task.arguments, names) if last.is_wrong else ""


def size_of(sample: Sample) -> int:
    """Count of the numbers of an input."""
    return sum(np.size(value) for value in sample if not callable(value))


def nearly(trials: Sequence[Trial]) -> float | None:
    """The largest relative error of a function that is nearly right at all inputs, and right at not all; else None."""
    worst = max(map(error_of, trials), default=0.0)
    return worst if TOLERANCE < worst <= NEARLY else None


def compared_parts(trials: Sequence[Trial]) -> list[differences.Difference] | None:
    """The trials with their differences; None if results have other shapes."""
    if not all(same_shape(trial.result, trial.right) for trial in trials):
        return None
    return [differences.compared(trial.sample, parts(trial.result), parts(trial.right)) for trial in trials]


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


def error_with_repair(student: StudentFunction, samples: Sequence[Sample], error: RunError) -> RunError:
    """An error of Python, with an edit that makes the function right, if there is one; another error as it is."""
    if error.kind != "raised" or error.loading:
        return error
    first = last_input(student, samples)
    with contextlib.suppress(RunError, Wrong):
        if (explanation := repair(student, samples, first, "traps", "causes", "slips")) is not None:
            return RunError(
                error.kind, f"{error.text.rstrip('.')}. {explanation.text}", error.file, explanation.line or error.line
            )
    return RunError(error.kind, in_plain_words(error.text), error.file, error.line)
