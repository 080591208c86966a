"""The conditions of a reference solution, in its arguments, for edits of a student's conditions."""

import ast
import copy
import inspect
import textwrap
from collections.abc import Callable, Mapping
from typing import Any


def conditions_of(function: Callable[..., Any]) -> list[str]:
    """The comparisons of a function, each name that it assigns replaced by its formula."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    formulas: dict[str, list[ast.expr]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            formulas.setdefault(node.targets[0].id, []).append(node.value)
    single = {name: values[0] for name, values in formulas.items() if len(values) == 1}
    tests = [node.test for node in ast.walk(tree) if isinstance(node, ast.If | ast.IfExp)]
    return [ast.unparse(Inlined(single).visit(copy.deepcopy(test))) for test in tests]


class Inlined(ast.NodeTransformer):
    """Puts formulas in place of names, and arguments in place of np.asarray of them."""

    def __init__(self, formulas: Mapping[str, ast.expr]) -> None:
        self.formulas = formulas

    def visit_Name(self, node: ast.Name) -> ast.expr:
        formula = self.formulas.get(node.id)
        return node if formula is None else self.visit(copy.deepcopy(formula))

    def visit_Call(self, node: ast.Call) -> ast.expr:
        self.generic_visit(node)
        is_plain = isinstance(node.func, ast.Attribute) and node.func.attr == "asarray"
        return node.args[0] if is_plain else node
