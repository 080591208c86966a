"""Who may import what, read from the sources themselves."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SOURCES = sorted(path for top in ("sim", "app", "assets", "tests") for path in (ROOT / top).rglob("*.py"))
VIEWERS = {
    "viewer.py",
    "panel.py",
    "water.py",
    "paint.py",
    "patch.py",
    "guard.py",
    "record.py",
    "plots.py",
    "traffic.py",
}
APART = ("springs", "ocean", "particles")
LONGEST = 400  # lines


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def below(top: str) -> list[Path]:
    return [path for path in SOURCES if named(path).startswith(f"{top}/")]


def imports(path: Path) -> set[str]:
    """Dotted names of every module that a source imports, anywhere in it; relative ones made absolute."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            module = ".".join(part for part in (base, node.module or "") if part)
            found.add(module)
            found.update(f"{module}.{alias.name}" for alias in node.names)
    return found


def uses(path: Path, package: str) -> bool:
    return any(name == package or name.startswith(package + ".") for name in imports(path))


def test_there_are_sources_to_look_at():
    assert len(below("sim")) > 15
    assert imports(ROOT / "sim" / "springs" / "simulate.py") >= {"numpy", "sim.springs.net"}


@pytest.mark.parametrize("path", below("sim"), ids=named)
def test_sim_knows_neither_viewer_nor_app_nor_threads(path):
    for package in (
        "viser",
        "app",
        "assets",
        "threading",
        "multiprocessing",
        "concurrent",
        "asyncio",
        "tests",
        "scipy",
    ):
        assert not uses(path, package), package


@pytest.mark.parametrize("path", [*below("sim"), *below("app")], ids=named)
def test_the_kernel_decorator_is_the_only_compiler(path):
    if named(path) == "sim/jit.py":
        return
    assert not uses(path, "numba")


@pytest.mark.parametrize("path", [p for top in APART for p in below(f"sim/{top}")], ids=named)
def test_springs_ocean_and_particles_do_not_know_each_other(path):
    own = path.relative_to(ROOT).parts[1]
    for other in (*APART, "floating"):
        if other != own:
            assert not uses(path, f"sim.{other}"), other


@pytest.mark.parametrize("path", below("app"), ids=named)
def test_only_the_viewing_files_import_viser(path):
    assert path.name in VIEWERS or path.parent.name == "pictures" or not uses(path, "viser")


@pytest.mark.parametrize("path", [*below("sim"), *below("app"), *below("assets")], ids=named)
def test_nothing_that_ships_imports_the_tests(path):
    assert not uses(path, "tests")


@pytest.mark.parametrize("path", SOURCES, ids=named)
def test_no_file_is_long(path):
    assert len(path.read_text().splitlines()) <= LONGEST


@pytest.mark.parametrize("path", SOURCES, ids=named)
def test_nothing_is_left_to_do(path):
    if path == Path(__file__):
        return
    text = path.read_text()
    for word in ("TODO", "FIXME", "XXX", "NotImplementedError"):
        assert word not in text
