"""Types for a user's checker: the package is marked, and every public function but the kernels is annotated."""

import ast
from pathlib import Path

SIM = Path(__file__).parents[2] / "sim"
Function = ast.FunctionDef | ast.AsyncFunctionDef


def test_the_package_is_marked_as_typed() -> None:
    assert (SIM / "py.typed").is_file()


def is_kernel(function: Function) -> bool:
    """Compiled: its arguments have the types that it is called with."""
    names = "kernel", "each_link", "each_contact", "each_load", "each_face"
    return any(name in ast.unparse(decorator) for decorator in function.decorator_list for name in names)


def public_functions(tree: ast.Module) -> list[Function]:
    """Functions and methods, without those within functions."""
    found = [node for node in tree.body if isinstance(node, Function)]
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            found += [method for method in node.body if isinstance(method, Function)]
    return [one for one in found if (not one.name.startswith("_") or one.name == "__init__") and not is_kernel(one)]


def untyped(function: Function) -> list[str]:
    """Arguments without a type, and "return"."""
    a = function.args
    every = [*a.posonlyargs, *a.args, *a.kwonlyargs, *filter(None, (a.vararg, a.kwarg))]
    missing = [one.arg for one in every if one.annotation is None and one.arg not in ("self", "cls")]
    return missing + ["return"] * (function.returns is None)


def test_every_public_function_is_typed() -> None:
    for path in sorted(SIM.rglob("*.py")):
        functions = public_functions(ast.parse(path.read_text("utf-8")))
        found = {f"{one.name} ({one.lineno})": missing for one in functions if (missing := untyped(one))}
        assert not found, path.relative_to(SIM)
