"""Differences of a function from the right one: inputs, parts of the result, values."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.diagnosis.explanation import Explanation

AXES = "xyz"
MAX_NUMBERS = 4  # of an argument or a result, shown at most
FIGURES = 4
TOLERANCE = 1e-4  # of the largest value of a result, as in `comparing.py`


class Case(NamedTuple):
    """A special case of a task. words: behind "is wrong". holds: whether arguments are of this case."""

    words: str
    holds: Callable[..., Any]


class Difference(NamedTuple):
    """One input with the student's result and the right one, as arrays of equal shapes."""

    arguments: tuple[Any, ...]
    result: tuple[np.ndarray, ...]
    right: tuple[np.ndarray, ...]
    wrong: tuple[np.ndarray, ...]  # True where a number differs

    @property
    def is_wrong(self) -> bool:
        """True if any number differs."""
        return any(part.any() for part in self.wrong)


def compared(arguments: tuple[Any, ...], result: Sequence[np.ndarray], right: Sequence[np.ndarray]) -> Difference:
    """A trial from the parts of two results."""
    wrong = []
    for a, b in zip(result, right, strict=True):
        if a.shape != b.shape:
            wrong.append(np.ones(b.shape, bool))
            continue
        with np.errstate(all="ignore"):
            scale = np.abs(b[np.isfinite(b)]).max(initial=0.0)
            wrong.append(~((np.abs(a - b) <= TOLERANCE * scale + 1e-12) | (a == b) | (np.isnan(a) & np.isnan(b))))
    return Difference(arguments, tuple(result), tuple(right), tuple(wrong))


def explain_where(
    trials: Sequence[Difference], names: Sequence[str], parts: Sequence[str], cases: Sequence[Case]
) -> Explanation:
    """The place where a function differs, and the first input at which it does.

    names: of the arguments. parts: of the result, where it has more than one.
    """
    wrong = [trial for trial in trials if trial.is_wrong]
    words = [text for text in (case_of(trials, cases), part_of(wrong, parts), entries_of(wrong)) if text]
    share = "" if len(wrong) == len(trials) else f"Right at {len(trials) - len(wrong)} of {len(trials)} inputs. "
    where = f"It is wrong {', '.join(words)} only. " if words else share
    mistake = f"wrong {', '.join(words)}" if words else ""
    return Explanation(mistake, where + example(wrong[0], names, parts))


def case_of(trials: Sequence[Difference], cases: Sequence[Case]) -> str:
    """The case of all wrong inputs, if some inputs are not of it."""
    for case in cases:
        holds = [bool(case.holds(*trial.arguments)) for trial in trials]
        if not all(holds) and all(of_case or not trial.is_wrong for of_case, trial in zip(holds, trials, strict=True)):
            return case.words
    return ""


def part_of(wrong: Sequence[Difference], parts: Sequence[str]) -> str:
    """The only wrong part of a result, if others are right."""
    indices = {i for trial in wrong for i, part in enumerate(trial.wrong) if part.any()}
    return f"in the {parts[indices.pop()]}" if len(parts) > 1 and len(indices) == 1 else ""


def entries_of(wrong: Sequence[Difference]) -> str:
    """The rows or components that are wrong, in words; "" where all are, or no rule is seen."""
    tables = [part for trial in wrong for part in trial.wrong if part.ndim == 2 and part.shape[1] == 3 and part.any()]
    vectors = [part for trial in wrong for part in trial.wrong if part.shape == (3,) and part.any()]
    if len(tables) != sum(part.any() for trial in wrong for part in trial.wrong):
        tables = []
    columns = [table.any(axis=0) for table in tables] or vectors
    rows: list[np.ndarray] = [np.asarray(table.any(axis=1)) for table in tables if len(table) > 2]
    if rows:
        for words, rule in (
            ("at the first point", lambda n: [True] + (n - 1) * [False]),
            ("at the last point", lambda n: (n - 1) * [False] + [True]),
            ("at the first and the last point", lambda n: [True] + (n - 2) * [False] + [True]),
            ("between the first and the last point", lambda n: [False] + (n - 2) * [True] + [False]),
            ("at all points but the first", lambda n: [False] + (n - 1) * [True]),
            ("at all points but the last", lambda n: (n - 1) * [True] + [False]),
        ):
            if all(list(row) == rule(len(row)) for row in rows):
                if words == "at all points but the first" and is_held(wrong):
                    break
                return words
    if columns:
        union = np.any(columns, axis=0)
        if not union.all():
            return f"in {' and '.join(AXES[i] for i in np.flatnonzero(union))}"
    return ""


def is_held(wrong: Sequence[Difference]) -> bool:
    """True if the first point cannot be wrong because it is fixed."""
    return all(not part[0].any() for trial in wrong for part in trial.right)


def example(trial: Difference, names: Sequence[str], parts: Sequence[str]) -> str:
    """One input, and both values there: the first number that differs, or the few of them."""
    i = next(i for i, part in enumerate(trial.wrong) if part.any())
    result, right, wrong = trial.result[i], trial.right[i], trial.wrong[i]
    name = f" as {parts[i]}" if len(parts) > 1 else ""
    which: int | None = None
    if result.ndim and result.size > MAX_NUMBERS:
        which = int(np.argwhere(wrong)[0][0])
        result, right = result[which], right[which]
        name += f" at number {which + 1}" + (" (the last)" if which == len(wrong) - 1 else "")
    inputs = [
        f"{name} = {text}"
        for name, value in zip(names, trial.arguments, strict=True)
        if (text := argument_text(value, which, len(wrong) if wrong.ndim else 0))
    ]
    at = f"With {', '.join(inputs)} it returns" if inputs else "It returns"
    return f"{at} {number(result)}{name}; expected {number(right)}."


def argument_text(value: Any, which: int | None, length: int) -> str:
    """An argument in a text: a number, a short array, or its entry for a result of this number; else ""."""
    if callable(value):
        return ""
    array = np.asarray(value)
    if array.size <= MAX_NUMBERS:
        return number(array)
    if which is not None and array.ndim and len(array) == length and array[which].size <= MAX_NUMBERS:
        return number(array[which])
    return ""


def number(value: Any) -> str:
    """Some numbers in four figures."""
    array = np.asarray(value)
    texts = [f"{float(entry) + 0.0:.{FIGURES}g}" for entry in array.ravel()]  # no -0
    return texts[0] if array.ndim == 0 else f"({', '.join(texts)})"
