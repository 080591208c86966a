"""Limits of size: a function fits a screen or two, a class has one job, a name means one class, a folder is small."""

import ast
import functools
import importlib
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
MAX_FUNCTION, MAX_CLASS = 80, 300  # lines
# Functions above the limit today. None is added.
LONG_FUNCTIONS = {"sim/springs/integrators/embedded/march.py: march"}
MAX_OBJECT, MAX_ATTRIBUTES = 400, 20  # lines of a class with all its bases; attributes that these assign to self
MAX_FILES = 16  # of code in a folder
CODE = {".css", ".html", ".js", ".mjs", ".py", ".ts"}


@functools.cache
def classes_below(*tops: str) -> list[tuple[Path, ast.ClassDef]]:
    """All classes, with their files."""
    paths = (path for top in tops for path in sorted((ROOT / top).rglob("*.py")))
    trees = ((path, ast.walk(ast.parse(path.read_text("utf-8")))) for path in paths)
    return [(path, node) for path, nodes in trees for node in nodes if isinstance(node, ast.ClassDef)]


def assigned(node: ast.ClassDef) -> set[str]:
    """Names of the attributes that a class assigns to self."""
    return {
        one.attr
        for one in ast.walk(node)
        if isinstance(one, ast.Attribute) and isinstance(one.ctx, ast.Store)
        if isinstance(one.value, ast.Name) and one.value.id == "self"
    }


def base_names(node: ast.ClassDef) -> list[str]:
    """Names of the direct bases, those of generic ones without their arguments."""
    bases = (base.value if isinstance(base, ast.Subscript) else base for base in node.bases)
    return [base.id for base in bases if isinstance(base, ast.Name)]


def test_a_name_of_a_class_means_one_class() -> None:
    """In the program and the library together, also for a class within another or within a function."""
    places: dict[str, list[str]] = {}
    for path, node in classes_below("app", "sim"):
        places.setdefault(node.name, []).append(f"{path.relative_to(ROOT).as_posix()}:{node.lineno}")
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_a_name_that_packages_of_the_library_offer_means_one_thing() -> None:
    """Two packages may offer one thing, but no two things under one name."""
    offers: dict[str, list[tuple[str, Any]]] = {}
    for path in sorted((ROOT / "sim").rglob("__init__.py")):
        package = importlib.import_module(".".join(path.relative_to(ROOT).parent.parts))
        for name in getattr(package, "__all__", ()):
            offers.setdefault(name, []).append((package.__name__, getattr(package, name)))
    assert {"rope", "Sea", "float_in", "moored", "INTEGRATORS"} <= offers.keys()
    of_two = {name: found for name, found in offers.items() if any(one is not found[0][1] for _, one in found)}
    assert of_two == {}


def test_no_function_or_class_is_longer_but_the_one_that_is_known() -> None:
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
    assert classes == set()


def test_no_object_is_larger() -> None:
    """An object becomes smaller by holding others; split into bases it is as large as before."""
    classes = {node.name: node for _, node in classes_below("app", "sim")}

    def with_bases(name: str) -> set[str]:
        return {name}.union(*(with_bases(base) for base in base_names(classes[name]) if base in classes))

    nodes = {name: [classes[part] for part in with_bases(name)] for name in classes}
    lines = {name: sum((one.end_lineno or 0) - one.lineno + 1 for one in parts) for name, parts in nodes.items()}
    attributes = {name: len(set().union(*map(assigned, parts))) for name, parts in nodes.items()}
    assert {name for name, count in lines.items() if count > MAX_OBJECT} == set()
    assert {name for name, count in attributes.items() if count > MAX_ATTRIBUTES} == set()


def test_no_folder_holds_more_files_of_code() -> None:
    """A folder can be read at a glance."""
    tops = ("app", "assets", "benchmarks", "sim", "tests")
    files = [path for top in tops for path in (ROOT / top).rglob("*") if path.suffix in CODE]
    counts = Counter(path.parent.relative_to(ROOT).as_posix() for path in files)
    assert {"app/render/js/sea", "sim/ocean", "tests/browser"} <= counts.keys()
    assert {folder for folder, count in counts.items() if count > MAX_FILES} == set()
