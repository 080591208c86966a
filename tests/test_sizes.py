"""A function fits a screen or two, and a class has one job."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MAX_FUNCTION, MAX_CLASS = 80, 300  # lines
# What is longer today. An entry goes as soon as it is cut, and none is added.
LONG_FUNCTIONS = {"sim/springs/integrators/embedded/march.py: march"}
LONG_CLASSES: set[str] = set()


def longer(kinds: tuple[type[ast.AST], ...], lines: int) -> set[str]:
    """The functions or classes with more lines than that, each with its file."""
    return {
        f"{path.relative_to(ROOT).as_posix()}: {node.name}"
        for top in ("app", "benchmarks", "sim")
        for path in (ROOT / top).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
        and isinstance(node, kinds)
        and (node.end_lineno or 0) - node.lineno + 1 > lines
    }


@pytest.mark.parametrize(
    ("kinds", "lines", "known"),
    [
        ((ast.FunctionDef, ast.AsyncFunctionDef), MAX_FUNCTION, LONG_FUNCTIONS),
        ((ast.ClassDef,), MAX_CLASS, LONG_CLASSES),
    ],
    ids=["functions", "classes"],
)
def test_none_is_longer_but_those_that_are_known(kinds: tuple[type[ast.AST], ...], lines: int, known: set[str]) -> None:
    assert longer(kinds, lines) == known
    assert longer(kinds, 20)
