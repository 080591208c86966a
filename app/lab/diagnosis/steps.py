"""Names the mistake of a step of an integration method, from its tableau."""

import functools
from collections.abc import Callable, Sequence
from typing import Any

from app.lab.diagnosis.equations import NEW, ComparedRow, RightMethod, compared, equations_of, method_of
from app.lab.diagnosis.explanation import Explanation
from app.lab.diagnosis.tableau import NoTableau, StepTableau, merged, order_of, pruned, read_tableau

PARTS = {f"{NEW} x": "The new position is", f"{NEW} v": "The new velocity is"}


def explain_step(
    student: Callable[..., Any], methods: Sequence[Callable[..., Any]], *, with_velocity: bool
) -> Explanation | None:
    """Explain the difference of a step from its method; None without a difference or a tableau.

    methods: different right solutions, the usual one first. with_velocity: whether the acceleration depends on the
    velocity.
    """
    try:
        tableau = read_tableau(student, with_velocity=with_velocity)
    except (NoTableau, ValueError, IndexError, TypeError):  # the last three: results of another shape
        return None
    references = [right_method(method, with_velocity=with_velocity) for method in methods]
    best: tuple[list[ComparedRow], RightMethod] | None = None
    for reference in references:
        for own in (tableau, pruned(tableau), merged(pruned(tableau))):
            if own.stages == reference.tableau.stages:
                rows = compared(own, reference)
                is_likely = reference is references[0] or count_wrong(rows) <= 1
                if is_likely and (best is None or count_wrong(rows) < count_wrong(best[0])):
                    best = rows, reference
    if best is None:
        return explain_stages(merged(pruned(tableau)), references[0].tableau)
    rows, method = best
    if not count_wrong(rows):
        return None
    first = next(row for row in rows if row.is_wrong)
    name, text = mistake_of(first)
    order = order_sentence(tableau, method.tableau)
    return Explanation(name, f"{text} {order}".strip(), tuple(row.equation for row in rows), tableau.step)


@functools.cache
def right_method(step: Callable[..., Any], *, with_velocity: bool) -> RightMethod:
    """A right step as a method."""
    return method_of(read_tableau(step, with_velocity=with_velocity))


def count_wrong(rows: Sequence[ComparedRow]) -> int:
    return sum(row.is_wrong for row in rows)


def explain_stages(tableau: StepTableau, reference: StepTableau) -> Explanation:
    """The explanation of a step with more or fewer states than the method has."""
    few, many = ("few", "more") if tableau.stages < reference.stages else ("many", "fewer")
    number = "1 state" if tableau.stages == 1 else f"{tableau.stages} states"
    text = f"It uses the acceleration at {number}; the method uses it at {many}."
    order = order_sentence(tableau, reference)
    return Explanation(f"too {few} stages", f"{text} {order}".strip(), tuple(equations_of(tableau)), tableau.step)


def order_sentence(tableau: StepTableau, reference: StepTableau) -> str:
    """A sentence on an order of a method that is too low."""
    has, needs = order_of(tableau), order_of(reference)
    if has >= needs:
        return ""
    return f"It has order {has} instead of {needs}." if has else "Smaller steps do not bring it closer to the motion."


def mistake_of(row: ComparedRow) -> tuple[str, str]:
    """The mistake of a wrong row, and the sentence about it."""
    statement, must = said_of(row), f"it must be {row.equation.right}."
    if is_reversed(row):
        return "sign reversed", f"{statement}; {must}"
    if is_chained(row):
        return "stages chained", f"{statement}; {must} Each stage starts from x and v, not from the stage before it."
    if (weights := weights_of(row)) is not None:
        return (
            "weights do not add up to one",
            f"{statement}; {must} The weights add up to {round(weights, 9) + 0.0:.4g} instead of 1.",
        )
    if change := step_change(row):
        return f"h {change}", f"{statement}; {must}"
    return statement[0].lower() + statement[1:], must[0].upper() + must[1:]


def said_of(row: ComparedRow) -> str:
    """The student's row in words."""
    if row.name in PARTS:
        return f"{PARTS[row.name]} {row.equation.text}"
    where = "at the position" if row.name[0] == "x" else "with the velocity"
    return f"Acceleration a{row.name[1:]} is computed {where} {row.equation.text}"


def is_reversed(row: ComparedRow) -> bool:
    """True if each term has the opposite sign."""
    return set(row.expression) == set(row.right) and all(
        abs(c + row.right[term]) < 1e-9 for term, c in row.expression.items()
    )


def is_chained(row: ComparedRow) -> bool:
    """True if a row starts from a stage instead of the start of the step."""
    own = row.name.removeprefix(f"{NEW} ")[0]
    return (
        (own, 0) in row.right
        and (own, 0) not in row.expression
        and any(symbol[0] == own and symbol[1:].isdigit() for symbol, power in row.expression if power == 0)
    )


def weights_of(row: ComparedRow) -> float | None:
    """The sum of the weights of a result with the right terms; None if it is 1, or a term is another one."""
    if row.name not in PARTS or set(row.expression) != set(row.right) or len(row.right) < 3:
        return None
    total = sum(c for (_, power), c in row.expression.items() if power == 1)
    return None if abs(total - 1.0) < 1e-9 else total


def step_change(row: ComparedRow) -> str:
    """ "used twice" or "forgotten" where a term has another power of h than it must have, or ""."""
    for (symbol, power), c in row.right.items():
        if power > 0 and (symbol, power) not in row.expression:
            for change, words in ((1, "used twice"), (-1, "forgotten")):
                if abs(row.expression.get((symbol, power + change), 0.0) - c) < 1e-9:
                    return words
    return ""
