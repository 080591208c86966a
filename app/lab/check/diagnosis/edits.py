"""Functions that differ from another one by one edit, to name a mistake.

The edits are typical slips in writing a formula down: another sign, operator, number, name or function, a missing
part, a missing line. Edits of the reference solution are compared with the student's results, so that the
student's function may have any form. Edits of the student's own function (`own_edits`, in the process that runs
it) are compared with the right results.
"""

import ast
import copy
import inspect
import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

from app.lab.check.diagnosis.explanation import Equation, Explanation, Piece

OPERATORS: dict[type[ast.operator], tuple[type[ast.operator], ...]] = {
    ast.Add: (ast.Sub, ast.Mult), ast.Sub: (ast.Add, ast.Div), ast.Mult: (ast.Div, ast.Add, ast.MatMult, ast.Pow),
    ast.Div: (ast.Mult, ast.Sub), ast.Pow: (ast.Mult,), ast.FloorDiv: (ast.Div, ast.Mult), ast.Mod: (ast.Div,),
    ast.MatMult: (ast.Mult,),
}  # fmt: skip
COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.Gt, ast.LtE), ast.Gt: (ast.Lt, ast.GtE), ast.LtE: (ast.GtE, ast.Lt), ast.GtE: (ast.LtE, ast.Gt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
}  # fmt: skip
FUNCTIONS = (
    ("sin", "cos", "tan"), ("exp", "exp2"), ("log", "log10", "log2"), ("floor", "ceil", "round", "trunc"),
    ("max", "min"), ("maximum", "minimum"), ("sqrt", "square"), ("sum", "mean"), ("zeros", "ones"),
)  # fmt: skip
WRAPS = ("np.sqrt({})", "({})**2", "-({})", "1/({})", "2*({})", "({})/2", "({}) + 1", "({}) - 1")  # of any expression
FACTORS = ("np.pi", "(2*np.pi)", "1000", "3", "6")
WHOLE_WRAPS = ("np.abs({})", "np.maximum({}, 0)", "np.exp({})", "np.log({})", "np.floor({})")  # of a whole side
ASARRAY = re.compile(r"np\.asarray\((\w+)\)")  # which says nothing of the formula
SHORT = 12  # characters of an expression, below which the enclosing one is shown
SHORT_IN_LINE = 5  # the same of an expression whose line is given


Change: TypeAlias = Callable[[Any], ast.AST | None]  # of a node in a copy; None takes it out


class Edit(NamedTuple):
    """A function with one edit. before, after: the expression or line that differs; after is "" if it is taken out.

    line: in the file. condition: "always" or "never" where a condition is fixed, which before has.
    """

    function: Callable[..., Any]
    before: str
    after: str
    line: int
    condition: str = ""


def edits_of(function: Callable[..., Any]) -> Iterator[Edit]:
    """The functions that differ from one by one edit; none for a function that may not end."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError):
        return
    yield from edits_of_tree(tree, function.__name__, function.__globals__, is_own=False)  # type: ignore[attr-defined]


def own_edits(source: bytes, name: str, known: Mapping[str, Any], *, far: bool) -> Iterator[Edit]:
    """The functions that differ by one edit from that of a student.

    source: of the file. known: names of its module. far: the less likely edits, without the others.
    """
    for definition in reversed(ast.parse(source).body):
        if isinstance(definition, ast.FunctionDef) and definition.name == name:
            yield from edits_of_tree(ast.Module([definition], []), name, known, is_own=True, far=far)
            return


def edits_of_tree(
    tree: ast.Module, name: str, known: Mapping[str, Any], *, is_own: bool, far: bool = False
) -> Iterator[Edit]:
    """The edits of a function. is_own: of a student's, whose own names count too. far: as of `own_edits`."""
    definition = tree.body[0]
    if not isinstance(definition, ast.FunctionDef) or any(isinstance(node, ast.While) for node in ast.walk(tree)):
        return
    definition.decorator_list = []
    names = [argument.arg for argument in definition.args.args]
    nodes = list(ast.walk(tree))
    if is_own:
        stored = (node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store))
        names = list(dict.fromkeys((*names, *stored)))
    places = {
        child: (parent, field, i)
        for parent in nodes
        for field, value in ast.iter_fields(parent)
        for i, child in enumerate(value if isinstance(value, list) else [value])
        if isinstance(child, ast.AST)
    }
    changes = more_changes if far else changes_of
    for node in nodes[1:]:
        shown: ast.AST = node
        short = SHORT_IN_LINE if is_own else SHORT
        while (len(source_of(shown)) < short or is_sliced(shown)) and isinstance(places[shown][0], ast.expr):
            shown = places[shown][0]
        before, line = source_of(shown), getattr(node, "lineno", 0)
        for change in changes(node, places[node][0], names):
            try:
                new = change(copy.deepcopy(node))
            except SyntaxError:  # of a formula around something that is no value
                continue
            put(places[node], new)
            found = compiled(tree, name, known)
            after = "" if new is None else source_of(new if shown is node else shown)
            put(places[node], node)
            if found is None:
                continue
            if isinstance(node, ast.If | ast.IfExp) and isinstance(new, ast.If | ast.IfExp):  # none is put around it
                is_true = getattr(new.test, "value", False)
                yield Edit(found, source_of(node.test), "", line, "always" if is_true else "never")
            elif after != before:
                yield Edit(found, before, after, line)


def put(place: tuple[ast.AST, str, int], node: ast.AST | None) -> None:
    """Put a node into a field of its parent; None takes a line out."""
    parent, field, i = place
    value = getattr(parent, field)
    if isinstance(value, list):
        value[i] = ast.Pass() if node is None else node
    else:
        setattr(parent, field, node)


def changes_of(node: ast.AST, parent: ast.AST, names: Sequence[str]) -> Iterator[Change]:
    """The nodes that may replace one, as functions of it in a copy; None removes it. names: of values."""
    is_index = isinstance(parent, ast.Subscript | ast.Slice) or is_range(parent)
    if isinstance(node, ast.BinOp):
        yield from (changed("op", other()) for other in OPERATORS.get(type(node.op), ()))
        yield lambda node: node.left
        yield lambda node: node.right
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield from (changed("ops", [other()]) for other in COMPARISONS.get(type(node.ops[0]), ()))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield lambda node: node.operand
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        for value in dict.fromkeys((2 * node.value, node.value / 2, node.value + 1, node.value - 1, -node.value)):
            is_idle = value == 1 and isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Pow)
            if value != node.value and not is_idle and (value >= 0 or not is_index):
                yield changed("value", int(value) if float(value).is_integer() else value)
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
        yield from (changed("id", other) for other in names if other != node.id)
    elif isinstance(node, ast.Call) and node.args:
        yield lambda node: node.args[0]
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        key = "attr" if isinstance(node.func, ast.Attribute) else "id"
        for alike in FUNCTIONS:
            if name in alike:
                yield from (in_function(key, other) for other in alike if other != name)
    elif isinstance(node, ast.AugAssign):
        yield from (changed("op", other()) for other in OPERATORS.get(type(node.op), ()))
        yield lambda node: ast.Assign([node.target], node.value)
        yield lambda _: None
    elif isinstance(node, ast.If | ast.IfExp):
        yield changed("test", ast.Constant(True))
        yield changed("test", ast.Constant(False))
    elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
        yield lambda _: None


def is_sliced(node: ast.AST) -> bool:
    """True for an index with a colon, which is no expression without its array."""
    return isinstance(node, ast.Slice) or any(isinstance(part, ast.Slice) for part in getattr(node, "elts", ()))


def is_range(node: ast.AST) -> bool:
    """True for a call of range."""
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range"


def more_changes(node: ast.AST, parent: ast.AST, names: Sequence[str]) -> Iterator[Change]:
    """Further changes: something around an expression, other indices, swapped parts, a removed line."""
    is_value = isinstance(node, ast.expr) and isinstance(getattr(node, "ctx", ast.Load()), ast.Load)
    is_value = is_value and not isinstance(
        node, ast.Tuple | ast.Slice | ast.Constant | ast.Lambda | ast.Starred | ast.List | ast.ListComp
    )
    is_side = isinstance(parent, ast.Assign | ast.AugAssign | ast.Return) and node is parent.value
    is_part = isinstance(parent, ast.BinOp) and isinstance(parent.op, ast.Add | ast.Sub)
    is_called = isinstance(parent, ast.Call) and node is parent.func
    is_called = is_called or isinstance(parent, ast.Attribute)
    if is_value and not is_called:
        yield from (wrapped(wrap) for wrap in WRAPS)
        if is_side or is_part or isinstance(parent, ast.Call | ast.Tuple):
            factors = (*names, *FACTORS)
            yield from (wrapped(f"({{}})*{factor}") for factor in factors)
            yield from (wrapped(f"({{}})/{factor}") for factor in factors)
        if is_side or isinstance(parent, ast.Tuple):
            yield from (wrapped(wrap) for wrap in WHOLE_WRAPS)
            for name in names:
                yield wrapped(f"({{}}) + {name}")
                yield wrapped(f"({{}}) - {name}")
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool):
        yield from (changed("value", value) for value in (0, 0.5, 3, 4) if value != node.value)
        if isinstance(parent, ast.Subscript | ast.Slice):
            yield from (replaced(name) for name in names)
    elif isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Load):
        yield lambda node: node.value
    elif isinstance(node, ast.Tuple | ast.Call):
        field = "elts" if isinstance(node, ast.Tuple) else "args"
        for i in range(len(getattr(node, field)) - 1):
            yield exchanged(field, i)
        if isinstance(node, ast.Call) and len(node.args) > 1:
            yield lambda node: ast.Call(node.func, node.args[1:], node.keywords)
    elif isinstance(node, ast.BoolOp):
        yield changed("op", ast.Or() if isinstance(node.op, ast.And) else ast.And())
        yield lambda node: node.values[0]
        yield lambda node: node.values[-1]
    elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Subscript):
        yield lambda node: ast.AugAssign(node.targets[0], ast.Add(), node.value)
        yield lambda node: ast.AugAssign(node.targets[0], ast.Sub(), node.value)


def wrapped(text: str) -> Change:
    """An expression put into the {} of a formula."""

    def change(node: Any) -> ast.AST:
        return ast.parse(text.format(ast.unparse(node)), mode="eval").body

    return change


def replaced(name: str) -> Change:
    """A name instead of a node."""
    return lambda _: ast.Name(name, ast.Load())


def exchanged(field: str, i: int) -> Change:
    """Two swapped entries of a list."""

    def change(node: Any) -> ast.AST:
        entries = getattr(node, field)
        entries[i], entries[i + 1] = entries[i + 1], entries[i]
        return node

    return change


def changed(field: str, value: Any) -> Callable[[Any], ast.AST]:
    """A node with another value of one field."""

    def change(node: Any) -> ast.AST:
        setattr(node, field, value)
        return node

    return change


def in_function(key: str, name: str) -> Callable[[Any], ast.AST]:
    """A call of another function."""

    def change(node: Any) -> ast.AST:
        setattr(node.func, key, name)
        return node

    return change


def source_of(node: ast.AST) -> str:
    """An expression or a line as Python."""
    return ast.unparse(node)


def compiled(tree: ast.Module, name: str, known: Mapping[str, Any]) -> Callable[..., Any] | None:
    """The function of a tree, with the names that its module knows."""
    inside = dict(known)
    try:
        exec(compile(ast.fix_missing_locations(tree), "<edit>", "exec"), inside)
    except (SyntaxError, ValueError, TypeError):
        return None
    return inside[name]


def explain_edit(
    function: Callable[..., Any], arguments: Sequence[str], agrees: Callable[[Callable[..., Any]], bool]
) -> Explanation | None:
    """The edit of the reference solution that agrees with a student's function, or None.

    function: the reference. arguments: the names that the student has. agrees: tests a function against the
    student's results.
    """
    definitions = definitions_of(function)
    for edit in edits_of(function):
        if not agrees_somehow(edit.function, agrees):
            continue
        right, wrong = (inlined(text, definitions) for text in (edit.before, edit.after))
        if unknown_names(f"({right}), ({wrong or 0})", arguments):
            continue
        right, wrong = (ASARRAY.sub(r"\1", text).replace("np.", "") for text in (right, wrong))
        if edit.condition:
            text = f"The result matches a function in which the condition {right} {edit.condition} holds."
            return Explanation(f"{right} is not tested", text, form=edit.function)
        if not wrong:
            return Explanation(f"{right} is missing", "The result matches the formula without it.", form=edit.function)
        equation = Equation("it has", (Piece(wrong, wrong=True),), right)
        text = f"The result matches {wrong}; it must be {right}."
        return Explanation(f"{wrong} in place of {right}", text, (equation,), edit.function)
    return None


def definitions_of(function: Callable[..., Any]) -> dict[str, ast.expr]:
    """The formulas of names that a function assigns once."""
    found: dict[str, list[ast.expr]] = {}
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        for target in getattr(node, "targets", [getattr(node, "target", None)]):
            for name in filter(lambda part: isinstance(part, ast.Name), ast.walk(target) if target else ()):
                plain = isinstance(node, ast.Assign) and target is name
                found.setdefault(name.id, []).append(node.value if plain else ast.Constant(None))  # type: ignore[attr-defined]
    return {name: values[0] for name, values in found.items() if len(values) == 1 and not is_none(values[0])}


def is_none(node: ast.expr) -> bool:
    """True for the constant None."""
    return isinstance(node, ast.Constant) and node.value is None


def inlined(text: str, definitions: Mapping[str, ast.expr]) -> str:
    """An expression with formulas in place of names that the student does not have."""

    class Inline(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.expr:
            formula = definitions.get(node.id)
            return node if formula is None or not isinstance(node.ctx, ast.Load) else self.visit(copy.deepcopy(formula))

    try:
        tree = ast.parse(text)
    except SyntaxError:
        return text
    return source_of(Inline().visit(tree))


def unknown_names(text: str, arguments: Sequence[str]) -> bool:
    """True if an expression has a name that is neither an argument nor a function."""
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return True
    called = {node.func for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and node not in called}
    return bool(names - {*arguments, "np"})


def explain_repair(edit: Sequence[Any]) -> Explanation:
    """The words for an edit that makes a student's function right: before, after, line and condition of it."""
    before, after, line, condition = edit
    if condition:
        text = f"It is right if the condition {before} in line {line} {condition} holds."
        return Explanation("", text, line=line)
    if not after:
        return Explanation("", f"Without {before} in line {line} it is right.", line=line)
    return Explanation("", f"With {after} in place of {before} in line {line} it is right.", line=line)


def agrees_somehow(function: Callable[..., Any], agrees: Callable[[Callable[..., Any]], bool]) -> bool:
    """As `agrees`; False of a function that an edit has broken."""
    try:
        return agrees(function)
    except Exception:
        return False
