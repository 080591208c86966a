"""Where a source can be made wrong by a small change: constants, flags, signs, operators, logic, indices, swaps.

A fault is a line and the line that takes its place, so that a list of them can be read, and outlives other edits.
"""

import ast
import itertools
from collections.abc import Iterator
from typing import NamedTuple

SMALL, LARGE = 1e-8, 1e9  # constants beyond them guard against 0/0 and overflow, and mean nothing else
PARTNERS = {
    "sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh", "min": "max", "max": "min", "minimum": "maximum",
    "maximum": "minimum", "floor": "ceil", "ceil": "floor", "exp": "expm1", "expm1": "exp", "argmin": "argmax",
    "argmax": "argmin", "real": "imag", "imag": "real",
}  # fmt: skip
SYMMETRIC = {"hypot", "isclose", "gcd", "lcm", "dot", "min", "max", "minimum", "maximum", "print", "zip", "outer"}
NOT_NUMBERS = {"isinstance", "getattr", "setattr", "hasattr", "argument_error", "cast", "TypeVar", "namedtuple"}
OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
OPPOSITES = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
COMPARISONS = {
    ast.Lt: ("<", ">"), ast.LtE: ("<=", ">="), ast.Gt: (">", "<"), ast.GtE: (">=", "<="), ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"), ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}  # fmt: skip
LOGIC = {ast.And: ("and", "or"), ast.Or: ("or", "and")}


class Fault(NamedTuple):
    """One line of a module, and the wrong line that takes its place."""

    module: str  # path from the root of the checkout
    kind: str  # constant, flag, exponent, sign, operator, comparison, logic, index, function or arguments
    before: str  # the line without its indent
    occurrence: int  # 0 for the first such line of the module
    after: str

    def line(self, source: str) -> int | None:
        """The number of its line, from 0; None where the source no longer has it."""
        found = [number for number, line in enumerate(source.split("\n")) if line.strip() == self.before]
        return found[self.occurrence] if self.occurrence < len(found) else None

    def planted(self, source: str) -> str | None:
        """The source with this fault; None where it no longer has the line."""
        number, lines = self.line(source), source.split("\n")
        if number is None:
            return None
        indent = lines[number][: len(lines[number]) - len(lines[number].lstrip())]
        lines[number] = indent + self.after
        return "\n".join(lines)


class Edit(NamedTuple):
    """Text that takes the place of the bytes from `start` to `stop` of a line (from 1)."""

    kind: str
    line: int
    start: int
    stop: int
    text: str


def faults_in(module: str, source: str) -> list[Fault]:
    """Every fault that can be planted into a source, in the order of its lines."""
    lines = source.split("\n")
    faults = []
    for edit in sorted(set(edits(ast.parse(source), source))):
        line = lines[edit.line - 1].encode()
        after = (line[: edit.start] + edit.text.encode() + line[edit.stop :]).decode().strip()
        before = lines[edit.line - 1].strip()
        occurrence = sum(other.strip() == before for other in lines[: edit.line - 1])
        faults.append(Fault(module, edit.kind, before, occurrence, after))
    return faults


def edits(node: ast.AST, source: str) -> Iterator[Edit]:
    """Edits of everything below a node."""
    yield from edits_of(node, source)
    for child in children(node):
        yield from edits(child, source)


def children(node: ast.AST) -> Iterator[ast.AST]:
    """What lies below a node, but for types, texts, refusals and what is imported."""
    if isinstance(node, ast.Raise | ast.Import | ast.ImportFrom | ast.JoinedStr | ast.Assert):
        return
    if isinstance(node, ast.Call) and name_of(node.func) in NOT_NUMBERS:
        return
    if isinstance(node, ast.keyword) and node.arg == "strict":  # of zip: a guard, which no right call trips
        return
    for field, value in ast.iter_fields(node):
        if field in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not has_kind_of_its_own(node, child):
                yield child


def has_kind_of_its_own(node: ast.AST, child: ast.AST) -> bool:
    """Whether a number below `node` is an index or an exponent, so that it is not counted as a constant as well."""
    if isinstance(node, ast.Subscript):
        return child is node.slice and is_number(child)
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow) and child is node.right and is_number(child)


def name_of(function: ast.expr) -> str:
    """The last part of a function's name, or ""."""
    return getattr(function, "attr", getattr(function, "id", ""))


def is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def is_text(node: ast.AST) -> bool:
    """Whether this is a text, a list or a path, which + and / do not add and divide."""
    if isinstance(node, ast.Constant):
        return not is_number(node)
    if isinstance(node, ast.BinOp):
        return is_text(node.left) or is_text(node.right)
    return isinstance(node, ast.JoinedStr | ast.List | ast.Tuple | ast.ListComp | ast.Set | ast.SetComp)


def replaced(kind: str, node: ast.expr, text: str) -> Iterator[Edit]:
    """A whole node, where it lies on one line."""
    if node.lineno == node.end_lineno and node.end_col_offset is not None:
        yield Edit(kind, node.lineno, node.col_offset, node.end_col_offset, text)


def between(kind: str, left: ast.expr, right: ast.expr, source: str, symbol: str, text: str) -> Iterator[Edit]:
    """An operator between two nodes, where all lie on one line."""
    if left.end_lineno != right.lineno or left.end_col_offset is None:
        return
    gap = source.split("\n")[right.lineno - 1].encode()[left.end_col_offset : right.col_offset].decode()
    if gap.count(symbol) == 1:
        start = left.end_col_offset + gap.index(symbol)
        yield Edit(kind, right.lineno, start, start + len(symbol), text)


def changed(value: float) -> str:
    """A number near another: a tenth more, or the next whole one."""
    if isinstance(value, int):
        return str(value + 1)
    return repr(0.1) if value == 0.0 else repr(float(f"{1.1 * value:.15g}"))


def edits_of(node: ast.AST, source: str) -> Iterator[Edit]:
    """Edits of a node itself."""
    if isinstance(node, ast.Constant) and is_number(node):
        value = node.value
        assert isinstance(value, int | float)
        if value == 0 or SMALL < abs(value) < LARGE:
            yield from replaced("constant", node, changed(value))
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield from replaced("flag", node, str(not node.value))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        kind = "sign" if isinstance(node.op, ast.USub) else "logic"
        yield from replaced(kind, node, ast.get_source_segment(source, node.operand) or "")
    elif isinstance(node, ast.BoolOp):
        for left, right in itertools.pairwise(node.values):
            yield from between("logic", left, right, source, *LOGIC[type(node.op)])
    elif isinstance(node, ast.BinOp):
        if isinstance(node.op, ast.Pow) and is_number(node.right):
            assert isinstance(node.right, ast.Constant)
            assert isinstance(node.right.value, int | float)
            yield from replaced("exponent", node.right, changed(node.right.value))
        elif type(node.op) in OPERATORS and not is_text(node):
            kind = "sign" if isinstance(node.op, ast.Add | ast.Sub) else "operator"
            yield from between(kind, node.left, node.right, source, OPERATORS[type(node.op)], OPPOSITES[type(node.op)])
    elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Add | ast.Sub) and not is_text(node.value):
        symbol = OPERATORS[type(node.op)] + "="
        yield from between("sign", node.target, node.value, source, symbol, OPPOSITES[type(node.op)] + "=")
    elif isinstance(node, ast.Compare):
        for left, right, op in zip([node.left, *node.comparators], node.comparators, node.ops, strict=False):
            if type(op) in COMPARISONS:
                yield from between("comparison", left, right, source, *COMPARISONS[type(op)])
    elif isinstance(node, ast.Subscript):
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for part in parts:
            if isinstance(part, ast.Constant) and isinstance(part.value, int) and not isinstance(part.value, bool):
                yield from replaced("index", part, str(part.value - 1 if part.value else 1))
    elif isinstance(node, ast.Attribute) and node.attr in PARTNERS:
        if node.end_lineno is not None and node.end_col_offset is not None:
            start = node.end_col_offset - len(node.attr)
            yield Edit("function", node.end_lineno, start, node.end_col_offset, PARTNERS[node.attr])
    elif isinstance(node, ast.Name) and node.id in PARTNERS and isinstance(node.ctx, ast.Load):
        yield from replaced("function", node, PARTNERS[node.id])
    elif isinstance(node, ast.Call) and name_of(node.func) not in SYMMETRIC | NOT_NUMBERS:
        for first, second in zip(node.args, node.args[1:], strict=False):
            yield from swapped(first, second, source)


def swapped(first: ast.expr, second: ast.expr, source: str) -> Iterator[Edit]:
    """Two arguments that follow each other on one line, in each other's place."""
    one, two = ast.get_source_segment(source, first), ast.get_source_segment(source, second)
    starred = isinstance(first, ast.Starred) or isinstance(second, ast.Starred)
    if starred or is_text(first) or is_text(second) or one == two or first.lineno != second.end_lineno:
        return
    assert first.end_col_offset is not None
    assert second.end_col_offset is not None
    gap = source.split("\n")[first.lineno - 1].encode()[first.end_col_offset : second.col_offset].decode()
    yield Edit("arguments", first.lineno, first.col_offset, second.end_col_offset, f"{two}{gap}{one}")
