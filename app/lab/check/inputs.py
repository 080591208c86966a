"""The inputs that decide whether a function is right.

They are random ones of the task, the same with quantities of other sizes, the numbers of the lab's scenes (`EXAMPLES`
of the task), and inputs at the edges of each comparison of the reference: on it, and on both sides of it.
"""

import ast
import functools
import inspect
import itertools
import operator
import textwrap
from collections.abc import Callable, Iterator, Sequence
from types import ModuleType
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from app.lab.check.comparing import call, same
from app.lab.diagnosis.units import units_of

SEED = 20150130
RANDOM = 36  # random inputs of the task
RESIZED = 12  # further ones with quantities of other sizes
SIZES = (0.1, 10.0)  # factors of a quantity
BISECTIONS = 60
BESIDE = (0.02, 0.2)  # distances from an edge, as fractions of the way between two inputs on its two sides
SAME_ON_BOTH_SIDES = 1e-9  # fraction of that way, by which a result that is continuous does not change
COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip
LARGER_OR_SMALLER = ("max", "min", "maximum", "minimum")

Sample: TypeAlias = tuple[Any, ...]


class Edge(NamedTuple):
    """Inputs at one comparison of the reference. text: of the comparison. on: None if the result jumps there."""

    text: str
    on: Sample | None
    beside: tuple[Sample, ...]


@functools.cache
def inputs_of(check: ModuleType, name: str) -> tuple[Sample, ...]:
    """All inputs of the task with this Python file. name: of its function."""
    function = getattr(check, name)
    rng = np.random.default_rng(SEED)
    drawn = [tuple(check.inputs(rng)) for _ in range(RANDOM)]
    chosen = [*drawn, *resized(function, rng, (tuple(check.inputs(rng)) for _ in range(RESIZED)))]
    chosen += [tuple(example) for example in getattr(check, "EXAMPLES", ())]
    for edge in edges(function, chosen):
        chosen += [sample for sample in (edge.on, *edge.beside) if sample is not None]
    return tuple(chosen)


def resized(function: Callable[..., Any], rng: np.random.Generator, drawn: Iterator[Sample]) -> Iterator[Sample]:
    """Inputs whose quantities of one unit are all 10 times larger or smaller; none for a step of a method."""
    names = list(inspect.signature(function).parameters)
    units = units_of(function.__doc__ or "", names)
    for sample in drawn:
        factors = {unit: rng.choice(SIZES) for unit in dict.fromkeys(units.values()) if unit != "rad"}
        sizes = [factors.get(units.get(name, "")) for name in names]
        if any(map(callable, sample)) or not factors:
            return
        yield tuple(value if factor is None else value * factor for value, factor in zip(sample, sizes, strict=True))


class ComparisonNotes(ast.NodeTransformer):
    """Notes the difference of the two sides of each comparison of numbers in a function."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def noted(self, node: ast.expr, name: str, sides: Sequence[ast.expr]) -> ast.expr:
        self.texts.append(ast.unparse(node))
        number = ast.Constant(len(self.texts) - 1)
        return ast.Call(ast.Name("compared", ast.Load()), [number, ast.Constant(name), *sides], [])

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        if len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
            return self.noted(node, type(node.ops[0]).__name__, (node.left, node.comparators[0]))
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in LARGER_OR_SMALLER and len(node.args) == 2 and not node.keywords:
            return self.noted(node, name, node.args)
        return node


class Watched:
    """A reference solution whose comparisons are seen."""

    def __init__(self, function: Callable[..., Any]) -> None:
        transformer = ComparisonNotes()
        tree = transformer.visit(ast.parse(textwrap.dedent(inspect.getsource(function))))
        self.texts = transformer.texts
        self.notes: dict[int, np.ndarray] = {}
        inside = {**function.__globals__, "compared": self.compared}  # type: ignore[attr-defined]
        exec(compile(ast.fix_missing_locations(tree), "<reference>", "exec"), inside)
        self.function = inside[function.__name__]  # type: ignore[attr-defined]

    def compared(self, number: int, name: str, one: Any, other: Any) -> Any:
        """The value of a comparison, or the larger or smaller of two numbers."""
        self.notes[number] = np.asarray(one, np.float64) - np.asarray(other, np.float64)
        if name in LARGER_OR_SMALLER:
            return (np.maximum if name.startswith("max") else np.minimum)(one, other)
        return next(compare(one, other) for kind, compare in COMPARISONS.items() if kind.__name__ == name)

    def sides(self, sample: Sample) -> dict[int, np.ndarray]:
        """The differences of the two sides of each comparison that is made at an input."""
        self.notes = {}
        call(self.function, sample)
        return self.notes


def edges(function: Callable[..., Any], drawn: Sequence[Sample]) -> list[Edge]:
    """For each comparison of a reference, inputs on it and on both sides of it, between two of those drawn.

    A comparison without inputs of equal shapes on both sides, as of whole numbers, has none.
    """
    watched = Watched(function)
    noted = [(sample, watched.sides(sample)) for sample in drawn]
    all_edges = []
    for number, text in enumerate(watched.texts):
        pairs = (
            (one, other, first)
            for (one, a), (other, b) in itertools.combinations(noted, 2)
            if number in a and number in b and (first := first_crossing(a[number], b[number])) is not None
        )
        for one, other, first in pairs:
            if (edge := edge_between(function, watched, number, text, one, other, first)) is not None:
                all_edges.append(edge)
                break
    return all_edges


def first_crossing(one: np.ndarray, other: np.ndarray) -> int | None:
    """The first entry that has another sign; None if the shapes differ, or none has."""
    if one.shape != other.shape:
        return None
    changed = np.flatnonzero((one.ravel() < 0.0) != (other.ravel() < 0.0))
    return int(changed[0]) if len(changed) else None


def edge_between(
    function: Callable[..., Any], watched: Watched, number: int, text: str, one: Sample, other: Sample, entry: int
) -> Edge | None:
    """The edge of a comparison on the way from one input to another; None if it is not met there.

    The way changes a single argument, if that is enough. entry: of the arrays that are compared.
    """
    for changing in [*([i] for i in range(len(one))), list(range(len(one)))]:
        if any(not is_real(one[i]) or np.shape(one[i]) != np.shape(other[i]) for i in changing):
            continue

        def at(way: float, changing: Sequence[int] = changing) -> Sample:
            return tuple(
                a + way * (b - a) if i in changing else a for i, (a, b) in enumerate(zip(one, other, strict=True))
            )

        def is_negative(way: float, at: Callable[[float], Sample] = at) -> bool:
            side = watched.sides(at(way)).get(number)
            return side is not None and bool(side.ravel()[entry] < 0.0)

        if is_negative(0.0) == is_negative(1.0):
            continue
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if is_negative(middle) == is_negative(0.0) else (low, middle)
        before, after = (call(function, at(high + step)) for step in (-SAME_ON_BOTH_SIDES, SAME_ON_BOTH_SIDES))
        ways = [high + sign * step for step in BESIDE for sign in (-1.0, 1.0) if 0.0 <= high + sign * step <= 1.0]
        return Edge(text, at(high) if same(before, after) else None, tuple(map(at, ways)))
    return None


def is_real(value: Any) -> bool:
    """True for a real number, or an array of them."""
    return isinstance(value, float | np.ndarray) and np.asarray(value).dtype.kind == "f"
