"""Names the mistake of a force or another sum: a missing term, or one of a wrong form.

The student's results, less the right terms, are compared with one term in many forms: each is computed from changed
arguments, times a power of one, or by a formula that its task lists. A form that leaves nothing, with one factor for
all inputs, is what the student has written. So are pairs of terms.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from app.lab.diagnosis.effects import copied
from app.lab.diagnosis.explanation import Equation, Explanation, Piece
from app.lab.diagnosis.factors import factor_text, is_simple

TOLERANCE = 2e-5  # of the largest part of a result at an input: single precision is right too
SMALL_CHANGE = 0.02  # of a constant, which is given in per cent
FAR_FROM_ONE = 3.0  # decades of a factor, beyond which terms of a sum are not looked at
EXPONENTS = (1.0, -1.0, 2.0, -2.0, 0.5, -0.5)
FACTORS = {2.0: "twice {}", 0.5: "half of {}", -1.0: "-{}"}
FAR_FETCHED = 3.0  # cost of a change of the whole result, above which an edit of the student's function is likelier
AXES = "xyz"
UNUSED = "does not use "
IGNORED = "The result does not change with "
WHOLE = "the result"  # name of all terms together

Function = Callable[..., Any]
Rearrangement = Callable[[tuple[Any, ...]], tuple[Any, ...]]  # of the arguments
Apply = Callable[[np.ndarray, tuple[Any, ...]], np.ndarray]  # a changed value, from the right one and the arguments


class Form(NamedTuple):
    """A wrong form of a term. why: the mistake in a sentence."""

    formula: str
    why: str
    function: Function


class Term(NamedTuple):
    """A term of the right result.

    name: as "the spring". formula: how it is written. function: its value, from the arguments of the task. forms:
    wrong ones beside those that any term can have.
    """

    name: str
    formula: str
    function: Function
    forms: tuple[Form, ...] = ()


class Group(NamedTuple):
    """Terms that one line of a program computes, so that they are wrong together. terms: their names."""

    name: str
    formula: str
    terms: tuple[str, ...]
    forms: tuple[Form, ...] = ()


class ChangedForm(NamedTuple):
    """A form of terms. text: in words, behind their name; "" as it must be. cost: how far-fetched it is."""

    text: str
    vector: np.ndarray  # values at all inputs, one after the other
    cost: float
    apply: Apply
    form: Form | None = None  # if it is one of a list


class Unit(NamedTuple):
    """One or more terms considered together. members: the terms; none for a further term."""

    name: str
    formula: str
    members: tuple[int, ...]
    forms: tuple[Form, ...]
    like: tuple[int, ...] = ()  # terms that a further term is a form of

    @property
    def terms(self) -> tuple[int, ...]:
        """Terms that this term may be a form of."""
        return self.members or self.like


class Finding(NamedTuple):
    """A form of a unit, with its factor, that explains the student's results."""

    unit: Unit
    change: ChangedForm
    factor: float
    cost: float


class Inputs:
    """The inputs at which terms are compared. names: of the arguments."""

    def __init__(
        self, names: Sequence[str], samples: Sequence[tuple[Any, ...]], results: Sequence[np.ndarray],
        student_results: Sequence[np.ndarray],
    ) -> None:  # fmt: skip
        """results, student_results: the right ones and the student's; the larger sets the scale at each input."""
        self.names, self.samples = tuple(names), samples
        self.shapes = [result.shape for result in results]
        self.lengths = np.array([result.size for result in results])
        self.scales = [
            float(np.abs(pair).max(initial=0.0)) or 1.0 for pair in zip(results, student_results, strict=True)
        ]
        self.kinds = [kind_of(argument) for argument in samples[0]]

    def joined(self, values: Sequence[np.ndarray]) -> np.ndarray:
        """Values at all inputs, relative to the right results, one after the other."""
        return np.concatenate([value.ravel() / scale for value, scale in zip(values, self.scales, strict=True)])

    def vector(self, function: Function, change: Rearrangement | None = None) -> np.ndarray:
        """The values of a function at all inputs, as `joined`; NaN if it has none. change: of the arguments."""
        values = []
        with np.errstate(all="ignore"):
            for sample, shape in zip(self.samples, self.shapes, strict=True):
                arguments = copied(sample)
                try:
                    value = np.asarray(function(*(change(arguments) if change else arguments)), np.float64)
                except (ArithmeticError, TypeError, ValueError):  # of Python's numbers, where numpy has infinity or NaN
                    value = np.full(shape, np.nan)
                values.append(value)
        return self.joined(values)

    def argument(self, i: int) -> np.ndarray:
        """A number among the arguments, once for each value of a result."""
        return np.repeat([float(sample[i]) for sample in self.samples], self.lengths)

    def blocks(self, vector: np.ndarray) -> list[np.ndarray]:
        """Values one after the other as arrays of the results' shapes."""
        parts = np.split(vector, np.cumsum(self.lengths)[:-1])
        return [part.reshape(shape) for part, shape in zip(parts, self.shapes, strict=True)]


def kind_of(argument: Any) -> str:
    """ "number", "vector" (one dimension), "points" (more), or ""."""
    if isinstance(argument, float | np.floating):
        return "number"
    if isinstance(argument, np.ndarray) and argument.dtype.kind == "f":
        return "vector" if argument.ndim == 1 else "points"
    return ""


def explain_terms(
    student: Function, terms: Sequence[Term], groups: Sequence[Group], names: Sequence[str],
    samples: Sequence[tuple[Any, ...]],
) -> Explanation | None:  # fmt: skip
    """The difference of a function from a sum of terms; None if no change of one or two of them explains it.

    student: a function of the arguments. terms: what its result must add up, at all samples. names: of the arguments.
    """
    try:
        results = [right_result(terms, sample) for sample in samples]
        student_results = [np.asarray(student(*copied(sample)), np.float64) for sample in samples]
    except (TypeError, ValueError):  # not an array of numbers
        return None
    if any(a.shape != b.shape or not np.isfinite([a, b]).all() for a, b in zip(student_results, results, strict=True)):
        return None
    factor = factor_of_all(student_results, results)
    if factor and abs(math.log10(abs(factor))) >= FAR_FROM_ONE:
        text = f"Every result is {factor_text(factor)} times what it must be."
        power = math.copysign(10.0 ** round(math.log10(abs(factor))), factor)
        if not is_simple(factor) and abs(factor - power) <= SMALL_CHANGE * abs(power):
            text = f"Every result is about {power:g} times what it must be: look for a unit, such as km in place of m."
        return Explanation("constant factor", text, (), lambda *sample: factor * right_result(terms, sample))
    inputs = Inputs(names, samples, results, student_results)
    y = inputs.joined(student_results)
    values = values_of(terms, inputs)
    if np.abs(y - values.right.sum(axis=0)).max() <= TOLERANCE:  # it differs elsewhere
        return None
    units = units_of(terms, groups)
    changes = [changes_of(unit, terms, values, inputs) for unit in units]
    findings = one_change(y, values.right, units, changes) or two_changes(y, values.right, units, changes)
    if not findings:
        return None
    lines = [Equation(line_name(term), (Piece(term.formula),)) for term in terms if term.formula]
    for finding in findings:
        for i in finding.unit.members:
            lines = [
                changed_line(line, finding, terms[i]) if line.name == line_name(terms[i]) else line for line in lines
            ]
    mistake, text = mistake_of(findings[0])
    others = [f"{name[0].upper()}{name[1:]}. {why}" for name, why in map(mistake_of, findings[1:])]
    is_plain = findings[0].unit.name == WHOLE and (not findings[0].change.text or text.startswith(IGNORED))
    is_odd = is_plain and not is_simple(findings[0].factor) and abs(findings[0].factor - 1.0) > SMALL_CHANGE
    is_vague = (
        is_odd
        or any(finding.factor == 0.0 for finding in findings)
        or (findings[0].unit.name == WHOLE and not is_plain and findings[0].cost >= FAR_FETCHED)
    )
    return Explanation(mistake, " ".join([text, *others]), tuple(lines), stated(findings, terms), is_vague)


def factor_of_all(student_results: Sequence[np.ndarray], results: Sequence[np.ndarray]) -> float:
    """The factor between all results of two functions, within `TOLERANCE`; 0 without one."""
    a, b = (np.concatenate([value.ravel() for value in values]) for values in (student_results, results))
    largest = np.argmax(np.abs(b))
    factor = float(a[largest] / b[largest]) if b[largest] else 0.0
    return factor if (np.abs(a - factor * b) <= TOLERANCE * np.abs(factor * b)).all() else 0.0


def stated(findings: Sequence[Finding], terms: Sequence[Term]) -> Function:
    """The function that the student has written, according to findings."""
    changed = {i for finding in findings for i in finding.unit.members}

    def value(i: int, arguments: tuple[Any, ...]) -> np.ndarray:
        return np.asarray(terms[i].function(*copied(arguments)), np.float64)

    def function(*arguments: Any) -> Any:
        total: Any = sum(value(i, arguments) for i in range(len(terms)) if i not in changed)
        for finding in findings:
            right = np.sum([value(i, arguments) for i in finding.unit.terms], axis=0)
            total = total + finding.factor * finding.change.apply(right, copied(arguments))
        return total

    return function


def right_result(terms: Sequence[Term], sample: tuple[Any, ...]) -> np.ndarray:
    """The sum of the terms."""
    with np.errstate(all="ignore"):
        return np.sum([np.asarray(term.function(*copied(sample)), np.float64) for term in terms], axis=0)


def units_of(terms: Sequence[Term], groups: Sequence[Group]) -> list[Unit]:
    """Single terms, groups, all but one, all."""
    number = {term.name: i for i, term in enumerate(terms)}
    units = [Unit(term.name, term.formula, (i,), term.forms) for i, term in enumerate(terms)]
    units += [
        Unit(group.name, group.formula, tuple(number[name] for name in group.terms), group.forms) for group in groups
    ]
    everything = tuple(range(len(terms)))
    taken = {frozenset(unit.members) for unit in units}
    if len(terms) > 2:
        for i, term in enumerate(terms):
            rest = (*everything[:i], *everything[i + 1 :])
            if frozenset(rest) not in taken:
                units.append(Unit(f"everything but {term.name}", "", rest, ()))
    if frozenset(everything) not in taken:
        units.append(Unit(WHOLE, "", everything, ()))
    return units


class Argument(NamedTuple):
    """A change of the arguments of a term. text: in words. doubles: the number of the argument that is doubled."""

    text: str
    cost: float
    change: Rearrangement
    doubles: int | None = None


class TermValues(NamedTuple):
    """The values of each term, as it must be and with changed arguments.

    right: (terms, values). changed: (terms, changes, values).
    """

    right: np.ndarray
    changes: list[Argument]
    changed: np.ndarray


def values_of(terms: Sequence[Term], inputs: Inputs) -> TermValues:
    """The values of the terms, each computed once."""
    changes = list(argument_changes(inputs))
    right = np.array([inputs.vector(term.function) for term in terms])
    changed = np.array([[inputs.vector(term.function, other.change) for other in changes] for term in terms])
    return TermValues(right, changes, changed)


def changes_of(unit: Unit, terms: Sequence[Term], values: TermValues, inputs: Inputs) -> list[ChangedForm]:
    """All forms of a unit that are finite and not 0."""
    members = list(unit.members)
    with np.errstate(all="ignore"):
        same, totals = values.right[members].sum(axis=0), values.changed[members].sum(axis=0)
    changes = [ChangedForm("", same, 0.0, lambda right, _: right)]
    changes += [
        ChangedForm(f"is {form.formula}", inputs.vector(form.function), 1.0, form_apply(form), form)
        for form in unit.forms
    ]
    for other, total in zip(values.changes, totals, strict=True):
        if unit.name != WHOLE or other.text.startswith(UNUSED):  # the rest are edits of the reference solution
            apply = rearranged([terms[i].function for i in members], other.change)
            changes.append(ChangedForm(other.text, total, other.cost, apply))
        if (i := other.doubles) is not None:
            has = exponent_in(same, total)
            for exponent in EXPONENTS:
                with np.errstate(all="ignore"):
                    vector = same * inputs.argument(i) ** exponent
                text = power_text(inputs.names[i], has, exponent, whole=unit.name == WHOLE)
                likely = abs(exponent) == 1.0 or has == -exponent
                changes.append(ChangedForm(text, vector, 2.0 if likely else 3.5, times_power(i, exponent)))
    changes += [
        ChangedForm(
            text, np.concatenate([change(block).ravel() for block in inputs.blocks(same)]), cost, of_value(change)
        )
        for text, cost, change in value_changes(same, inputs)
    ]
    return [
        change for change in changes if np.isfinite(change.vector).all() and np.abs(change.vector).max() > TOLERANCE
    ]


def form_apply(form: Form) -> Apply:
    """A form as a change of a value."""
    return lambda _, arguments: np.asarray(form.function(*arguments), np.float64)


def rearranged(functions: Sequence[Function], change: Rearrangement) -> Apply:
    """Terms at changed arguments as a change of a value."""
    return lambda _, arguments: np.sum([np.asarray(f(*change(copied(arguments))), float) for f in functions], axis=0)


def times_power(i: int, exponent: float) -> Apply:
    """A further power of an argument as a change of a value."""
    return lambda right, arguments: right * float(arguments[i]) ** exponent


def of_value(change: Callable[[np.ndarray], np.ndarray]) -> Apply:
    """A change that needs no arguments."""
    return lambda right, _: change(right)


def exponent_in(values: np.ndarray, doubled: np.ndarray) -> float | None:
    """The power of an argument in values, a multiple of 1/2; None if they are no power of it.

    doubled: the values with twice the argument.
    """
    factor = float(values @ doubled / (values @ values)) if values.any() else 0.0
    exponent = round(2.0 * np.log2(factor)) / 2.0 if factor > 0.0 else 0.0
    return exponent if np.allclose(doubled, 2.0**exponent * values, rtol=1e-6) else None


def power_text(name: str, has: float | None, exponent: float, *, whole: bool) -> str:
    """Words for a term that has another power of an argument.

    has: the right one; None if it is no power. whole: there is no other term.
    """
    now = exponent if has is None else has + exponent
    if now == 0.0 and whole:
        return f"{UNUSED}{name}"
    if has is None or not exponent.is_integer() or not has.is_integer():
        of = {1.0: "", 2.0: "the square of ", 0.5: "the root of "}[abs(exponent)]
        return f"is {'multiplied' if exponent > 0.0 else 'divided'} by {of}{name}"
    verb, other = ("multiplied", "divided") if (now or has) > 0.0 else ("divided", "multiplied")
    if now == 0.0:
        return f"is not {verb} by {name}"
    if has == 0.0:
        return f"is {verb} by {name}" + (" twice" if abs(now) == 2.0 else "")
    if now * has < 0.0:
        return f"is {verb} by {name} instead of {other}"
    return f"is {verb} by {name} {times(now)} instead of {times(has)}"


def times(number: float) -> str:
    """A number of times in words."""
    return {1.0: "once", 2.0: "twice"}.get(abs(number), f"{abs(number):g} times")


def with_argument(i: int, function: Callable[[tuple[Any, ...]], Any]) -> Rearrangement:
    """A change of one argument."""
    return lambda arguments: (*arguments[:i], function(arguments), *arguments[i + 1 :])


def argument_changes(inputs: Inputs) -> Iterator[Argument]:
    """Changes of the arguments that any term can have."""
    names, kinds = inputs.names, inputs.kinds
    for i, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        if not kind:
            continue
        yield Argument(f"{UNUSED}{name}", 2.0, with_argument(i, lambda a, i=i: 0.0 * a[i]))
        for factor, words in FACTORS.items():
            change = with_argument(i, lambda a, i=i, factor=factor: factor * a[i])
            doubles = i if factor == 2.0 and kind == "number" else None
            yield Argument(f"uses {words.format(name)} in place of {name}", 3.0, change, doubles)
        if kind == "number":
            yield Argument(f"uses 1 in place of {name}", 2.5, with_argument(i, lambda a: 1.0))
            for exponent, words in ((2.0, "the square of"), (0.5, "the root of"), (-1.0, "one over")):
                change = with_argument(i, lambda a, i=i, exponent=exponent: a[i] ** exponent)
                yield Argument(f"uses {words} {name} in place of {name}", 3.0, change)
        for j, other in enumerate(names):
            if j == i or kinds[j] != kind:
                continue
            yield Argument(f"uses {other} in place of {name}", 3.0, with_argument(i, lambda a, j=j: a[j]))
            if j > i:
                text = f"has {name} and {other} swapped"
                yield Argument(text, 2.5, lambda a, i=i, j=j: swapped(a, i, j))


def swapped(arguments: tuple[Any, ...], i: int, j: int) -> tuple[Any, ...]:
    """Arguments with two exchanged."""
    new_arguments = list(arguments)
    new_arguments[i], new_arguments[j] = new_arguments[j], new_arguments[i]
    return tuple(new_arguments)


def value_changes(same: np.ndarray, inputs: Inputs) -> Iterator[tuple[str, float, Callable[[np.ndarray], np.ndarray]]]:
    """Changes of the value of a term: words, cost, function of the value at one input."""
    yield "has only absolute values", 3.0, np.abs
    yield "is cut at 0 from below", 3.0, lambda y: np.maximum(y, 0.0)
    yield "is cut at 0 from above", 3.0, lambda y: np.minimum(y, 0.0)
    blocks = inputs.blocks(same)
    if all(shape and shape[-1] == 3 for shape in inputs.shapes):
        sizes = np.abs(np.concatenate([block.reshape(-1, 3) for block in blocks])).max(axis=0)
        own = np.flatnonzero(sizes > 0.0)
        for shift in (1, 2):
            text = "has its components in another order"
            if len(own) == 1:
                text = f"acts along {AXES[(own[0] + shift) % 3]} instead of {AXES[own[0]]}"
            yield text, 2.0, lambda y, shift=shift: np.roll(y, shift, axis=-1)
    if all(len(shape) == 2 for shape in inputs.shapes):
        for what, less in (("points", 0), ("links", 1)):
            yield f"is multiplied by the number of {what}", 3.0, lambda y, less=less: y * (len(y) - less)
            yield f"is divided by the number of {what}", 3.0, lambda y, less=less: y / (len(y) - less)
        for which, row in (("first", 0), ("second", 1), ("last", -1)):
            yield f"leaves out the {which} point", 2.5, lambda y, row=row: without_row(y, row)


def without_row(block: np.ndarray, row: int) -> np.ndarray:
    """Values of points without those of one."""
    new_block = block.copy()
    new_block[row] = 0.0
    return new_block


def one_change(
    y: np.ndarray, right: np.ndarray, units: Sequence[Unit], changes: Sequence[Sequence[ChangedForm]]
) -> list[Finding]:
    """Find the form of one unit that explains the results; an empty list if no form does."""
    best: Finding | None = None
    for unit, forms in zip(units, changes, strict=True):
        left = y - total_of(right, set(range(len(right))) - set(unit.members))
        if np.abs(left).max() <= TOLERANCE:
            best = cheaper(best, Finding(unit, forms[0], 0.0, size_cost(unit)))
            continue
        for form in forms:
            if (factor := factor_between(left, form)) and may_be_told(unit, form, factor):
                best = cheaper(
                    best, Finding(unit, form, rounded(factor), form.cost + size_cost(unit) + factor_cost(factor))
                )
    if best is None:
        best = one_more(y, right, units, changes)
    return [] if best is None else [best]


def one_more(
    y: np.ndarray, right: np.ndarray, units: Sequence[Unit], changes: Sequence[Sequence[ChangedForm]]
) -> Finding | None:
    """An additional term beside the right ones, or None."""
    left, best = y - total_of(right, set(range(len(right)))), None
    for unit, forms in zip(units, changes, strict=True):
        for form in forms:
            if (factor := factor_between(left, form)) and is_simple(factor):
                extra = Unit(f"a further term like {unit.name}", "", (), (), unit.members)
                best = cheaper(
                    best, Finding(extra, form, rounded(factor), form.cost + size_cost(unit) + factor_cost(factor))
                )
    return best


def two_changes(
    y: np.ndarray, right: np.ndarray, units: Sequence[Unit], changes: Sequence[Sequence[ChangedForm]]
) -> list[Finding]:
    """Find the forms of two units that explain the results; an empty list if no pair does."""
    best: tuple[float, list[Finding]] | None = None
    for (one, ones), (other, others) in itertools.combinations(zip(units, changes, strict=True), 2):
        if set(one.members) & set(other.members):
            continue
        left = y - total_of(right, set(range(len(right))) - set(one.members) - set(other.members))
        a, b = (np.array([form.vector for form in forms]) for forms in (ones, others))
        aa, bb, ab = (a * a).sum(axis=1)[:, None], (b * b).sum(axis=1)[None, :], a @ b.T
        ya, yb = (a @ left)[:, None], (b @ left)[None, :]
        determinant = aa * bb - ab * ab
        with np.errstate(all="ignore"):
            p, q = (ya * bb - yb * ab) / determinant, (yb * aa - ya * ab) / determinant
            rest = left @ left - p * ya - q * yb
        fits = (determinant > 1e-9 * aa * bb) & (rest <= len(y) * TOLERANCE**2 + 1e-9 * (left @ left))
        for i, j in np.argwhere(fits):
            factors = float(p[i, j]), float(q[i, j])
            if np.abs(left - factors[0] * a[i] - factors[1] * b[j]).max() > TOLERANCE or not all(
                map(is_simple, factors)
            ):
                continue
            findings = [
                Finding(unit, form, rounded(float(factor)), form.cost + size_cost(unit) + factor_cost(factor))
                for unit, form, factor in ((one, ones[i], p[i, j]), (other, others[j], q[i, j]))
            ]
            cost = sum(finding.cost for finding in findings)
            if best is None or cost < best[0]:
                best = cost, findings
    return [] if best is None else [finding for finding in best[1] if not is_right(finding)]


def factor_between(left: np.ndarray, form: ChangedForm) -> float:
    """The factor of a form that explains all values; 0 if no factor does."""
    factor = float(left @ form.vector / (form.vector @ form.vector))
    return factor if np.abs(left - factor * form.vector).max() <= TOLERANCE else 0.0


def may_be_told(unit: Unit, form: ChangedForm, factor: float) -> bool:
    """True for a factor that identifies the mistake: a simple one, or any one of the whole result."""
    return is_simple(factor) or (unit.name == WHOLE and not form.text)


def is_right(finding: Finding) -> bool:
    """True if a unit is as it must be."""
    return not finding.change.text and finding.factor == 1.0


def total_of(right: np.ndarray, members: set[int]) -> np.ndarray:
    """The sum of some right terms."""
    return right[sorted(members)].sum(axis=0)


def cheaper(one: Finding | None, other: Finding) -> Finding:
    """The likelier of two findings."""
    return other if one is None or other.cost < one.cost else one


def size_cost(unit: Unit) -> float:
    """More terms that are wrong in the same way are less likely than fewer, except all."""
    return 0.0 if len(unit.members) == 1 else 0.2 if unit.formula else 0.3 if unit.name == WHOLE else 0.4


def factor_cost(factor: float) -> float:
    """The cost of a factor: 1 is free, a sign and small numbers are likely."""
    size = abs(rounded(factor))
    if size < TOLERANCE:
        return 0.0
    return (0.0 if factor > 0.0 else 0.5) + (0.0 if size == 1.0 else 1.0 if size in (0.5, 2.0) else 1.5)


def rounded(factor: float) -> float:
    """A factor, rounded to a small fraction if it is near one."""
    for denominator in (1, 2, 3, 4, 6):
        nearest = round(factor * denominator) / denominator
        if abs(nearest - factor) <= 10 * TOLERANCE * max(1.0, abs(factor)):
            return nearest
    return factor


def mistake_of(finding: Finding) -> tuple[str, str]:
    """The mistake of a finding, and the sentence about it."""
    unit, change, factor = finding.unit, finding.change, finding.factor
    if unit.name == WHOLE and not change.text and factor:
        if factor == -1.0:
            return "sign reversed", "Every result has the right size and the wrong sign."
        if not is_simple(factor) and abs(factor - 1.0) <= SMALL_CHANGE:
            size = f"{100.0 * abs(factor - 1.0):.2g} % too {'large' if factor > 1.0 else 'small'}"
            return "another constant", f"The law is right. Every result is {size}: a constant in it has another value."
        return "constant factor", f"Every result is {factor_text(factor)} times what it must be."
    if unit.name == WHOLE and change.text.startswith(UNUSED):
        name = change.text.removeprefix(UNUSED)
        return f"{name} not used", f"{IGNORED}{name}."
    if not unit.members:
        return (
            "a term too much",
            f"Beside the right terms there is {unit.name}{', which ' + words(finding) if change.text else ''}.",
        )
    why = [change.form.why] if change.form else []
    must = f"It must be {unit.formula}." if unit.formula else "This holds for every input tried."
    return f"{unit.name} {words(finding)}", " ".join([*why, must])


def words(finding: Finding) -> str:
    """The mistake, behind the name of the unit."""
    text, factor = finding.change.text, finding.factor
    if factor == 0.0:
        return "is 0" if finding.unit.name == WHOLE else "is missing"
    if not text:
        return "has the wrong sign" if factor == -1.0 else f"is {factor_text(factor)} times what it must be"
    if factor == 1.0:
        return text
    return text + (", with the wrong sign" if factor == -1.0 else f", times {factor_text(factor)}")


def line_name(term: Term) -> str:
    """The name of a term before its equation."""
    return term.name.removeprefix("the ")


def changed_line(line: Equation, finding: Finding, term: Term) -> Equation:
    """The line of a term as the student has it."""
    change, factor = finding.change, finding.factor
    formula = change.form.formula if change.form else term.formula
    if change.text and not change.form:
        own = f"as below, but it {words(finding)}"
    elif factor in (0.0, 1.0):
        own = formula if factor else "0"
    else:
        own = f"-[{formula}]" if factor == -1.0 else f"{factor_text(factor)} [{formula}]"
    return Equation(line.name, (Piece(own, wrong=True),), term.formula)
