"""Names the mistake of any function that differs from the reference solution by one edit of an expression.

The edits are those of a person who writes a formula down: another sign, operator, number, name or function, a part that
is missing, a line that is missing. Functions are compared by their results, so that the student's may be written in any
way.
"""

import ast
import copy
import inspect
import textwrap
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from app.lab.diagnosis.explanation import Equation, Explanation, Piece

OPERATORS: dict[type[ast.operator], tuple[type[ast.operator], ...]] = {
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div, ast.Add), ast.Div: (ast.Mult, ast.Sub),
    ast.Pow: (ast.Mult,),
}  # fmt: skip
COMPARISONS: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.Gt, ast.LtE), ast.Gt: (ast.Lt, ast.GtE), ast.LtE: (ast.GtE, ast.Lt), ast.GtE: (ast.LtE, ast.Gt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,),
}  # fmt: skip
FUNCTIONS = (
    ("sin", "cos", "tan"), ("exp", "exp2"), ("log", "log10", "log2"), ("floor", "ceil", "round", "trunc"),
    ("max", "min"), ("maximum", "minimum"), ("sqrt", "square"), ("sum", "mean"),
)  # fmt: skip
SHORT = 12  # characters of an expression, below which the one around it is shown


class Edit(NamedTuple):
    """A function with one edit. wrong, right: the expression or line that differs; wrong is "" where it is missing."""

    function: Callable[..., Any]
    wrong: str
    right: str


def edits_of(function: Callable[..., Any]) -> Iterator[Edit]:
    """The functions that differ from one by one edit; none of a function that may not end."""
    try:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    except (OSError, TypeError, SyntaxError):
        return
    definition = tree.body[0]
    if not isinstance(definition, ast.FunctionDef) or any(isinstance(node, ast.While) for node in ast.walk(tree)):
        return
    definition.decorator_list = []
    arguments = [argument.arg for argument in definition.args.args]
    nodes = list(ast.walk(tree))
    numbers = {node: number for number, node in enumerate(nodes)}
    parents = {child: parent for parent in nodes for child in ast.iter_child_nodes(parent)}
    for node in nodes:
        shown = node
        while len(source_of(shown)) < SHORT and isinstance(parents.get(shown), ast.expr):
            shown = parents[shown]
        for change in changes_of(node, arguments):
            edited = copy.deepcopy(tree)
            copies = list(ast.walk(edited))
            target, around = copies[numbers[node]], copies[numbers[shown]]
            new = change(target)
            replace_node(edited, target, new)
            found = compiled(edited, function)
            if found is None:
                continue
            if isinstance(node, ast.If | ast.IfExp):
                yield Edit(found, "", f"if {source_of(node.test)}")
            else:
                wrong = new if around is target else around
                yield Edit(found, source_of(wrong) if wrong is not None else "", source_of(shown))


def changes_of(node: ast.AST, arguments: Sequence[str]) -> Iterator[Callable[[Any], ast.AST | None]]:
    """The nodes that may stand in place of one, as functions of it in a copy; None for nothing."""
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
            if value != node.value:
                yield changed("value", int(value) if float(value).is_integer() else value)
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in arguments:
        yield from (changed("id", other) for other in arguments if other != node.id)
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


def replace_node(tree: ast.AST, old: ast.AST, new: ast.AST | None) -> None:
    """Put a node in the place of another; None takes a line out."""

    class Replacement(ast.NodeTransformer):
        def visit(self, node: ast.AST) -> ast.AST | None:
            return (new if new is not None else ast.Pass()) if node is old else self.generic_visit(node)

    if new is not old:
        Replacement().visit(tree)


def source_of(node: ast.AST) -> str:
    """An expression or a line as Python."""
    return ast.unparse(node).replace("np.", "")


def compiled(tree: ast.Module, function: Callable[..., Any]) -> Callable[..., Any] | None:
    """The function of a tree, with the names that another one knows."""
    known = dict(function.__globals__)  # type: ignore[attr-defined]
    try:
        exec(compile(ast.fix_missing_locations(tree), "<edit>", "exec"), known)
    except (SyntaxError, ValueError, TypeError):
        return None
    return known[function.__name__]


def explain_edit(function: Callable[..., Any], agrees: Callable[[Callable[..., Any]], bool]) -> Explanation | None:
    """The edit of the reference solution that a student's function agrees with, or None.

    function: the reference. agrees: whether the student's results are those of a function.
    """
    found = next((edit for edit in edits_of(function) if agrees_somehow(edit.function, agrees)), None)
    if found is None:
        return None
    if not found.wrong:
        return Explanation(f"{found.right} is missing", "The result is that without it.")
    equation = Equation("it has", (Piece(found.wrong, wrong=True),), found.right)
    mistake = f"{found.wrong} in place of {found.right}"
    return Explanation(mistake, f"The result is that of {found.wrong}; it must be {found.right}.", (equation,))


def agrees_somehow(function: Callable[..., Any], agrees: Callable[[Callable[..., Any]], bool]) -> bool:
    """As `agrees`; False of a function that an edit has broken."""
    try:
        return agrees(function)
    except Exception:
        return False
