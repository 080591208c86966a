"""A tableau as equations, each beside that of the required method.

An equation names the positions and velocities of the stages as the method does: "x + h v3" rather than
"x + h v + h²/2 a2". A student's equation is written with the terms of the right one as far as possible, so that few
terms differ.
"""

import itertools
import math
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from app.lab.diagnosis.explanation import Equation, Piece
from app.lab.diagnosis.tableau import FIRST_ACCELERATION, POWERS, StepTableau

LARGEST_DENOMINATOR = 48
MOST_CHANGES = 3  # of an expression, beyond which it is written in x, v and the accelerations
MOST_VELOCITIES = 4  # of an expression of the right method
SUPERSCRIPTS = {1: "", 2: "²", 3: "³", 4: "⁴"}
NEW = "new"
SAME_COEFFICIENT = 1e-6
SINGULAR = 1e-9  # fraction of the largest determinant, below which terms are no basis

Monomial = tuple[str, int]  # a symbol, and the power of h before it
Expression = dict[Monomial, float]  # a sum of terms with coefficients


class TableauRow(NamedTuple):
    """One row of a tableau, as vectors over x, v and accelerations, and powers of h."""

    name: str
    vector: np.ndarray  # (columns, powers)
    is_position: bool


def lines_of(tableau: StepTableau) -> list[TableauRow]:
    """The rows of a tableau: position and velocity of each stage, and of the result."""
    rows = []
    for stage in range(tableau.stages + 1):
        is_last = stage == tableau.stages
        for letter, part in (("x", tableau.positions), ("v", tableau.velocities)):
            if letter == "x" or is_last or tableau.with_velocity:
                name = f"{NEW} {letter}" if is_last else f"{letter}{stage + 1}"
                rows.append(TableauRow(name, part[stage], letter == "x"))
    return rows


def symbols_of(tableau: StepTableau, line: TableauRow) -> dict[str, np.ndarray]:
    """The symbols that the equation of a row may have, by name."""
    size = tableau.stages + FIRST_ACCELERATION
    unit = np.zeros((size, size, len(POWERS)))
    unit[range(size), range(size), np.flatnonzero(POWERS == 0)[0]] = 1.0
    symbols = {"x": unit[0], "v": unit[1]}
    stage = tableau.stages if line.name.startswith(NEW) else int(line.name[1:]) - 1
    for row in range(stage):
        symbols[f"x{row + 1}"] = tableau.positions[row]
        if tableau.with_velocity:
            symbols[f"v{row + 1}"] = tableau.velocities[row]
        symbols[f"a{row + 1}"] = unit[row + FIRST_ACCELERATION]
    if line.name == f"{NEW} x":
        symbols[f"{NEW} v"] = tableau.velocities[-1]
    return symbols


def distinct(terms: Mapping[Monomial, np.ndarray]) -> list[Monomial]:
    """The terms without duplicates."""
    names = list(terms)
    rows = np.array([terms[name].ravel() for name in names])
    alike = np.abs(rows[:, None] - rows[None]).max(axis=2) <= SAME_COEFFICIENT
    return [name for i, name in enumerate(names) if not alike[i, :i].any()]


def times_power(vector: np.ndarray, power: int) -> np.ndarray:
    """A vector times a power of h."""
    shifted = np.zeros_like(vector)
    if power >= 0:
        shifted[:, power:] = vector[:, : len(POWERS) - power]
    else:
        shifted[:, :power] = vector[:, -power:]
    return shifted


def terms_for(line: TableauRow, symbols: Mapping[str, np.ndarray]) -> dict[Monomial, np.ndarray]:
    """The terms that the equation of a row may have."""
    terms = {}
    for name, vector in symbols.items():
        letter = name.removeprefix(f"{NEW} ")[0]
        if line.is_position:
            powers = {"x": (0, 1), "v": (0, 1, 2), "a": (0, 1, 2, 3)}[letter]
        else:
            powers = {"x": (0,) if name == "x" else (), "v": (0, 1), "a": (-1, 0, 1, 2)}[letter]
        for power in powers:
            terms[name, power] = times_power(vector, power)
    return terms


def evaluated(expression: Expression, terms: Mapping[Monomial, np.ndarray], like: np.ndarray) -> np.ndarray | None:
    """An expression as a vector; None if it has an unknown term."""
    if any(term not in terms for term in expression):
        return None
    return sum((c * terms[term] for term, c in expression.items()), np.zeros_like(like))


def fitted(vector: np.ndarray, columns: list[np.ndarray], tolerance: float) -> np.ndarray | None:
    """The coefficients with which columns add up to a vector, or None."""
    matrix = np.array([column.ravel() for column in columns]).T
    coefficients, *_ = np.linalg.lstsq(matrix, vector.ravel(), rcond=None)
    return coefficients if np.abs(matrix @ coefficients - vector.ravel()).max() <= tolerance else None


def plain_expression(tableau: StepTableau, line: TableauRow) -> Expression:
    """A row in x, v and the accelerations."""
    names = ["x", "v", *(f"a{stage + 1}" for stage in range(tableau.stages))]
    return {
        (name, int(power)): float(c)
        for name, row in zip(names, line.vector, strict=True)
        for power, c in zip(POWERS, row, strict=True)
        if abs(c) > tableau.tolerance
    }


def short_expression(tableau: StepTableau, line: TableauRow) -> Expression:
    """A row with few terms: velocities of the stages rather than accelerations, from x or v if possible."""
    symbols = symbols_of(tableau, line)
    terms = terms_for(line, symbols)
    own = "x" if line.is_position else "v"
    bases = [own, *(name for name in symbols if name.startswith(own) and name != own)]
    movers = [term for term in distinct(terms) if term[1] == 1 and term[0].removeprefix(f"{NEW} ").startswith("v")]
    plain = plain_expression(tableau, line)
    best = plain
    for base in bases:
        for number in range(MOST_VELOCITIES + 1 if line.is_position else 1):
            if number + 1 > len(best) or (number + 1 == len(best) and best is not plain):
                break
            for chosen in itertools.combinations(movers, number):
                some = [(base, 0), *chosen]
                coefficients = fitted(line.vector, [terms[term] for term in some], tableau.tolerance)
                if coefficients is not None:
                    best = dict(zip(some, map(float, coefficients), strict=True))
                    break
    return best


def nearest_expression(tableau: StepTableau, line: TableauRow, right: Expression) -> Expression:
    """A row with the fewest possible changes of the right expression."""
    terms = terms_for(line, symbols_of(tableau, line))
    start = {term: c for term, c in right.items() if term in terms}
    value = evaluated(start, terms, line.vector)
    assert value is not None
    left = line.vector - value
    if np.abs(left).max() <= tableau.tolerance:
        return start
    choice = [term for term in distinct(terms) if np.any(terms[term])]
    candidates = [plain_expression(tableau, line)]
    if (weights := fitted(line.vector, [terms[term] for term in start], tableau.tolerance)) is not None:
        candidates.append(dict(zip(start, map(float, weights), strict=True)))
    for number in range(1, MOST_CHANGES + 1):
        for chosen, changes in sums(left, {term: terms[term] for term in choice}, number, tableau.tolerance):
            candidate = dict(start)
            for term, change in zip(chosen, changes, strict=True):
                candidate[term] = candidate.get(term, 0.0) + change
            candidates.append(candidate)
        if number > 1 and len(candidates) > 1:
            break
    return min(
        (nonzero(candidate, tableau.tolerance) for candidate in candidates),
        key=lambda candidate: rank(candidate, right),
    )


def sums(
    vector: np.ndarray, terms: Mapping[Monomial, np.ndarray], number: int, tolerance: float
) -> Iterator[tuple[tuple[Monomial, ...], list[float]]]:
    """The choices of `number` terms that add up to a vector, with their coefficients."""
    names = list(terms)
    if len(names) < number:
        return
    rows = np.array([terms[name].ravel() for name in names])
    gram, products, square = rows @ rows.T, rows @ vector.ravel(), float(vector.ravel() @ vector.ravel())
    chosen = np.array(list(itertools.combinations(range(len(names)), number)))
    matrices, right = gram[chosen[:, :, None], chosen[:, None, :]], products[chosen]
    regular = np.linalg.det(matrices) > SINGULAR * np.prod(np.diagonal(matrices, axis1=1, axis2=2), axis=1)
    chosen, right = chosen[regular], right[regular]
    coefficients = np.linalg.solve(matrices[regular], right[:, :, None])[:, :, 0]
    likely = square - (coefficients * right).sum(axis=1) <= 1e-9 * square + rows.shape[1] * tolerance**2
    for some, values in zip(chosen[likely], coefficients[likely], strict=True):
        if np.abs(values @ rows[some] - vector.ravel()).max() <= tolerance:
            yield tuple(names[i] for i in some), [float(value) for value in values]


def nonzero(expression: Expression, tolerance: float) -> Expression:
    """An expression without terms of the coefficient 0."""
    return {term: c for term, c in expression.items() if abs(c) > tolerance}


def rank(expression: Expression, right: Expression) -> tuple[int, int, int]:
    """Sort key of expressions: few terms, then likeness to the right one, then round coefficients."""
    denominators = [Fraction(c).limit_denominator(10**6).denominator for c in expression.values()]
    return len(expression), len(differing(expression, right, SAME_COEFFICIENT)), sum(denominators)


def differing(expression: Expression, right: Expression, tolerance: float) -> set[Monomial]:
    """The terms in which two expressions differ."""
    terms = set(expression) | set(right)
    return {term for term in terms if abs(expression.get(term, 0.0) - right.get(term, 0.0)) > tolerance}


class RightMethod(NamedTuple):
    """A right method: its tableau and its equations."""

    tableau: StepTableau
    expressions: tuple[Expression, ...]  # of `lines_of`


def method_of(tableau: StepTableau) -> RightMethod:
    """A tableau as a right method."""
    return RightMethod(tableau, tuple(short_expression(tableau, line) for line in lines_of(tableau)))


class ComparedRow(NamedTuple):
    """A row of a tableau beside that of the required method."""

    name: str
    expression: Expression
    right: Expression
    equation: Equation

    @property
    def is_wrong(self) -> bool:
        return bool(self.equation.right)


def compared(tableau: StepTableau, method: RightMethod) -> list[ComparedRow]:
    """The rows of a tableau beside those of a method with as many stages.

    Rows of a stage at x and v in both are left out.
    """
    tolerance = max(tableau.tolerance, method.tableau.tolerance)
    rows = []
    for line, right in zip(lines_of(tableau), method.expressions, strict=True):
        expression = nearest_expression(tableau, line, right)
        wrong = differing(expression, right, tolerance)
        if wrong or not is_start(line, right):
            pieces = tuple(written(expression, tolerance, wrong, right))
            equation = Equation(line.name, pieces, text_of(right, tolerance) if wrong else "")
            rows.append(ComparedRow(line.name, expression, right, equation))
    return rows


def is_start(line: TableauRow, expression: Expression) -> bool:
    """True if a stage lies at the start of the step."""
    return not line.name.startswith(NEW) and set(expression) == {(line.name[0], 0)}


def equations_of(tableau: StepTableau) -> list[Equation]:
    """The equations of a tableau by itself."""
    equations = []
    for line in lines_of(tableau):
        expression = short_expression(tableau, line)
        if not is_start(line, expression):
            equations.append(Equation(line.name, tuple(written(expression, tableau.tolerance, set(), {}))))
    return equations


def text_of(expression: Expression, tolerance: float) -> str:
    """An expression in one text."""
    return "".join(piece.text for piece in written(expression, tolerance, set(), {}))


def written(expression: Expression, tolerance: float, wrong: set[Monomial], right: Expression) -> Iterator[Piece]:
    """An expression in pieces: states first, then terms with one power of h in a bracket.

    wrong: the terms that differ from those of `right`.
    """
    if not expression:
        yield Piece("0", wrong=bool(wrong))
        return
    is_first = True
    for power in sorted({power for _, power in expression}):
        group = {symbol: c for (symbol, p), c in expression.items() if p == power}
        before = {symbol: c for (symbol, p), c in right.items() if p == power}
        if len(group) == 1 or power == 0:
            for symbol, c in group.items():
                sign = ("" if c > 0 else "-") if is_first else (" + " if c > 0 else " - ")
                yield Piece(sign)
                is_first = False
                yield Piece(single(symbol, power, abs(c), tolerance), (symbol, power) in wrong)
            continue
        denominator = common_denominator(group, tolerance)
        other = common_denominator(before, tolerance) if before else denominator
        numerators = {symbol: c * denominator for symbol, c in group.items()}
        same = all(
            abs(numerators.get(s, 0.0) - before.get(s, 0.0) * other) <= 50 * tolerance for s in {*numerators, *before}
        )
        yield Piece("" if is_first else " + ")
        is_first = False
        yield Piece(step_text(power, denominator), wrong=bool(wrong) and denominator != other)
        yield Piece(" (")
        for number, (symbol, c) in enumerate(numerators.items()):
            yield Piece((" + " if c > 0 else " - ") if number else ("" if c > 0 else "-"))
            factor = "" if abs(abs(c) - 1.0) <= 50 * tolerance else f"{number_text(abs(c), tolerance)} "
            yield Piece(f"{factor}{symbol}", (symbol, power) in wrong and not same)
        yield Piece(")")


def single(symbol: str, power: int, c: float, tolerance: float) -> str:
    """One term: "h/2 v2", "3 h²/4 a1", "0.99995 x"."""
    fraction = fraction_of(c, tolerance)
    if power == 0:
        return symbol if fraction == 1 else f"{number_text(c, tolerance)} {symbol}"
    if fraction is None:
        return f"{number_text(c, tolerance)} {step_text(power, 1)} {symbol}"
    factor = "" if fraction.numerator == 1 else f"{fraction.numerator} "
    return f"{factor}{step_text(power, fraction.denominator)} {symbol}"


def step_text(power: int, denominator: int) -> str:
    """A power of h over a number."""
    over = "" if denominator == 1 else f"/{denominator}"
    if power < 0:
        return f"1/({denominator} h)" if denominator > 1 else "1/h"
    return f"h{SUPERSCRIPTS[power]}{over}"


def common_denominator(group: Mapping[str, float], tolerance: float) -> int:
    """The least common denominator of coefficients; 1 if there is no small one."""
    fractions = [fraction_of(c, tolerance) for c in group.values()]
    if any(fraction is None for fraction in fractions):
        return 1
    least = math.lcm(*(fraction.denominator for fraction in fractions if fraction is not None))
    return least if least <= LARGEST_DENOMINATOR else 1


def fraction_of(c: float, tolerance: float) -> Fraction | None:
    """A coefficient as a fraction of small numbers, or None."""
    fraction = Fraction(c).limit_denominator(LARGEST_DENOMINATOR)
    return fraction if abs(float(fraction) - c) <= max(tolerance, 1e-9) else None


def number_text(c: float, tolerance: float) -> str:
    """A coefficient, as a fraction if it is one."""
    fraction = fraction_of(c, tolerance)
    return f"{c:.6g}" if fraction is None else str(fraction)
