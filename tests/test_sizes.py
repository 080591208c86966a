"""A function fits a screen or two, a class has one job, and a name of a class means one class."""

import ast
from pathlib import Path

ROOT = Path(__file__).parent.parent
MAX_FUNCTION, MAX_CLASS = 80, 300  # lines
# What is longer today. An entry goes as soon as it is cut, and none is added.
LONG_FUNCTIONS = {"sim/springs/integrators/embedded/march.py: march"}
LONG_CLASSES: set[str] = set()


def test_a_name_of_a_class_means_one_class() -> None:
    """In the program and the library together, also for a class within another or within a function."""
    places: dict[str, list[str]] = {}
    for path in (path for top in ("app", "sim") for path in (ROOT / top).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name, []).append(f"{path.relative_to(ROOT).as_posix()}:{node.lineno}")
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_none_is_longer_but_those_that_are_known() -> None:
    functions, classes = set(), set()
    for path in (path for top in ("app", "benchmarks", "sim") for path in (ROOT / top).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                lines = (node.end_lineno or 0) - node.lineno + 1
                name = f"{path.relative_to(ROOT).as_posix()}: {node.name}"
                if isinstance(node, ast.ClassDef):
                    classes |= {name} if lines > MAX_CLASS else set()
                elif lines > MAX_FUNCTION:
                    functions.add(name)
    assert functions == LONG_FUNCTIONS
    assert classes == LONG_CLASSES
