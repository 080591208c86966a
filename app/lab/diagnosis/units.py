"""Units of a function's quantities, to refuse an expression that joins quantities of different units.

The docstring of a task has the units of the arguments: "stiffness: k [N/m]". They are followed through assignments and
expressions. A number without a known unit agrees with everything.
"""

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

Dimension: TypeAlias = tuple[float, ...]  # exponents of kg, m, s
SYMBOLS = {"kg": (1, 0, 0), "m": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "Pa": (1, -1, -2), "rad": (0, 0, 0)}
PURE: Dimension = (0.0, 0.0, 0.0)
PART = re.compile(r"([A-Za-z]+)(\d*)")
BRACKETS = re.compile(r"\[([^\]]+)\]")
PLAIN_NUMBERS = (0.5, 1, 2, 3, 4, 6)  # factors of laws; another number may have a unit
# Functions of one argument by the power of its unit that the result has, and functions of a number without a unit.
POWERS = {"sqrt": 1 / 2, "cbrt": 1 / 3, "square": 2}
SAME = (
    "norm", "abs", "absolute", "fabs", "sum", "mean", "float", "array", "asarray", "copy", "round", "reshape",
    "ravel", "roll", "diff", "cumsum", "tuple", "list", "max", "min", "maximum", "minimum", "clip", "hypot",
)  # fmt: skip
PURE_ARGUMENT = ("exp", "log", "log10", "sin", "cos", "tan", "tanh", "sinh", "cosh", "arcsin", "arccos", "arctan")
PRODUCTS = ("dot", "cross", "matmul", "inner", "multiply")


def dimension_of(unit: str) -> Dimension | None:
    """The dimension of a unit such as "kg/m3" or "N s/m"; None for an unknown one."""
    above, _, below = unit.partition("/")
    total = list(PURE)
    for part, sign in [*((p, 1) for p in above.split()), *((p, -1) for p in below.split())]:
        match = PART.fullmatch(part)
        if part == "1":
            continue
        if match is None or match[1] not in SYMBOLS:
            return None
        for i, exponent in enumerate(SYMBOLS[match[1]]):
            total[i] += sign * exponent * int(match[2] or 1)
    return tuple(total)


def units_of(docstring: str, arguments: Sequence[str]) -> dict[str, str]:
    """The units of the arguments of a function that its docstring has."""
    either = "|".join(sorted(arguments, key=len, reverse=True))
    heads = list(re.finditer(rf"(?<!\w)((?:{either})(?:, (?:{either}))*):\s", docstring))
    units_by_name = {}
    for head, end in zip(heads, [*(h.start() for h in heads[1:]), len(docstring)], strict=True):
        names, units = head[1].split(", "), BRACKETS.findall(docstring[head.end() : end])
        if units:
            units_by_name.update(zip(names, units if len(units) == len(names) else units[:1] * len(names), strict=True))
    return units_by_name


def rounded(exponents: Iterable[float]) -> Dimension:
    """Exponents without rounding errors."""
    return tuple(round(exponent, 6) for exponent in exponents)


class Clashes(ast.NodeVisitor):
    """Counts places of a function that join different units. known: dimensions of names."""

    def __init__(self, known: Mapping[str, Dimension | None]) -> None:
        self.known = dict(known)
        self.count = 0

    def joined(self, *dimensions: Dimension | None) -> Dimension | None:
        """The dimension of terms of a sum, or of the sides of a comparison."""
        known = [dimension for dimension in dimensions if dimension is not None]
        if len(set(known)) > 1:
            self.count += 1
            return None
        return known[0] if known else None

    def of(self, node: ast.expr) -> Dimension | None:
        """The dimension of an expression; None if unknown."""
        if isinstance(node, ast.Name):
            return self.known.get(node.id)
        if isinstance(node, ast.Constant):
            return PURE if node.value in PLAIN_NUMBERS else None
        if isinstance(node, ast.BinOp):
            return self.of_operation(node)
        if isinstance(node, ast.Compare):
            self.joined(*(self.of(part) for part in (node.left, *node.comparators)))
            return None
        if isinstance(node, ast.UnaryOp):
            return self.of(node.operand)
        if isinstance(node, ast.IfExp):
            self.of(node.test)
            return self.joined(self.of(node.body), self.of(node.orelse))
        if isinstance(node, ast.Subscript):
            self.of(node.slice)
            return self.of(node.value)
        if isinstance(node, ast.Attribute):
            return self.of(node.value) if node.attr == "T" else PURE if node.attr == "pi" else None
        if isinstance(node, ast.Call):
            return self.of_call(node)
        if isinstance(node, ast.Tuple | ast.List):
            dimensions = [self.of(part) for part in node.elts]
            return dimensions[0] if dimensions and len(set(dimensions)) == 1 else None
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.expr):
                self.of(child)
        return None

    def of_operation(self, node: ast.BinOp) -> Dimension | None:
        """The dimension of a sum, a product or a power."""
        left, right = self.of(node.left), self.of(node.right)
        if isinstance(node.op, ast.Add | ast.Sub | ast.Mod):
            return self.joined(left, right)
        if left is None or (right is None and not isinstance(node.op, ast.Pow)):
            return None
        if isinstance(node.op, ast.Mult | ast.MatMult):
            assert right is not None
            return tuple(a + b for a, b in zip(left, right, strict=True))
        if isinstance(node.op, ast.Div | ast.FloorDiv):
            assert right is not None
            return tuple(a - b for a, b in zip(left, right, strict=True))
        if isinstance(node.op, ast.Pow):
            if right not in (None, PURE):
                self.count += 1
            power = node.right
            if isinstance(power, ast.Constant) and isinstance(power.value, int | float):
                return rounded(a * power.value for a in left)
            return PURE if left == PURE else None
        return None

    def of_call(self, node: ast.Call) -> Dimension | None:
        """The dimension of a function's value."""
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        dimensions = [self.of(part) for part in node.args]
        own = node.func.value if isinstance(node.func, ast.Attribute) else None
        if own is not None and getattr(own, "id", "") not in ("np", "numpy", "math", "linalg") and not dimensions:
            dimensions = [self.of(own)]
        if not dimensions:
            return None
        if name in PURE_ARGUMENT:
            if dimensions[0] not in (None, PURE):
                self.count += 1
            return PURE
        if name in POWERS:
            return None if dimensions[0] is None else rounded(a * POWERS[name] for a in dimensions[0])
        if name in ("maximum", "minimum", "hypot") or (name in ("max", "min") and len(dimensions) > 1):
            return self.joined(*dimensions)
        if name in PRODUCTS and len(dimensions) == 2:
            one, other = dimensions
            return None if one is None or other is None else tuple(a + b for a, b in zip(one, other, strict=True))
        return dimensions[0] if name in SAME else None

    def visit_Assign(self, node: ast.Assign) -> None:
        dimension = self.of(node.value)
        for target in node.targets:
            if isinstance(target, ast.Name):
                self.known[target.id] = dimension

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        dimension = self.of(ast.BinOp(node.target, node.op, node.value))  # type: ignore[arg-type]
        if isinstance(node.target, ast.Name):
            self.known[node.target.id] = dimension

    def visit_For(self, node: ast.For) -> None:
        for part in ast.walk(node.target):
            if isinstance(part, ast.Name):
                self.known[part.id] = None
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        self.of(node.test)
        for part in (*node.body, *node.orelse):
            self.visit(part)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value is not None:
            self.of(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        self.of(node.value)


def clashes(tree: ast.AST, units: Mapping[str, str]) -> int:
    """Number of places of a function that join quantities of different units. units: of its arguments."""
    visitor = Clashes({name: dimension_of(unit) for name, unit in units.items()})
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            for statement in node.body:
                visitor.visit(statement)
            break
    return visitor.count
