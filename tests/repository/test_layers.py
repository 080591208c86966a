"""Who may import what, read from the sources themselves."""

import ast
import functools
import graphlib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = sorted(path for top in ("sim", "app", "assets", "benchmarks", "tests") for path in (ROOT / top).rglob("*.py"))
# Folders of app/ from left to right: none imports a folder to its left. Those of one entry do not import each other.
ORDER = (
    ("study",),
    ("commands", "notebook"),
    ("server",),
    ("panel",),
    ("scenes",),
    ("lab",),
    ("render",),
    ("formats", "messages", "files"),
)
RANK = {folder: rank for rank, folders in enumerate(ORDER) for folder in folders}
# Rooms of app/lab, in the same way.
LAB_RANK = {room: rank for rank, room in enumerate(
    ("report", "student", "check", "process", "course", "checking", "diagnosis")
)}  # fmt: skip
TOP_MODULES = {"__init__", "__main__", "messages", "files"}  # directly in app/
VIEWING = ("server", "panel", "render")  # folders that may import viser, beside each scene's drawing
SCENES_SHARED = {"springs", "ahead"}  # folders in app/scenes that are no scenes
APART = ("springs", "ocean", "particles")


def named(path: Path) -> str:
    """The path from the root of the checkout."""
    return path.relative_to(ROOT).as_posix()


def below(top: str) -> list[Path]:
    """Sources in a folder."""
    return [path for path in SOURCES if named(path).startswith(f"{top}/")]


def module_of(path: Path) -> str:
    """The dotted name of a source."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def for_types_only(node: ast.AST) -> bool:
    """True for `if TYPE_CHECKING:`."""
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def import_nodes(node: ast.AST, *, types: bool) -> list[ast.Import | ast.ImportFrom]:
    """Every import below a node, anywhere in it; with `types` also where it is for types only."""
    found = []
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import | ast.ImportFrom):
            found.append(child)
        elif types or not for_types_only(child):
            found.extend(import_nodes(child, types=types))
    return found


@functools.cache
def imports(path: Path, *, types: bool = False) -> frozenset[str]:
    """Dotted names of every module that a source imports when it runs, and with `types` of those for types only.

    Relative ones are made absolute.
    """
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    found = set()
    for node in import_nodes(ast.parse(path.read_text("utf-8")), types=types):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        else:
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            module = ".".join(part for part in (base, node.module or "") if part)
            found.add(module)
            found.update(f"{module}.{alias.name}" for alias in node.names)
    return frozenset(found)


def uses(path: Path, package: str) -> bool:
    """Whether a source imports a package or something in it."""
    return any(name == package or name.startswith(package + ".") for name in imports(path))


def offences(paths: list[Path], *packages: str) -> list[str]:
    """Which of the sources import which of the packages."""
    return [f"{named(path)} imports {package}" for path in paths for package in packages if uses(path, package)]


def is_drawing(path: Path) -> bool:
    """Whether this draws a scene: view.py in its folder, or a part of it, *_view.py, there or in drawing/."""
    return "scenes" in path.parts and path.stem.rpartition("_")[2] == "view"


def test_there_are_sources_to_look_at():
    assert len(below("sim")) > 15
    assert imports(ROOT / "sim" / "springs" / "simulate.py") >= {"numpy", "sim.springs.net"}


def test_at_most_four_modules_lie_directly_in_app():
    assert {path.stem for path in (ROOT / "app").glob("*.py")} <= TOP_MODULES


@pytest.mark.parametrize(("top", "rank"), [("app", RANK), ("app/lab", LAB_RANK)])
def test_imports_point_one_way(top: str, rank: dict[str, int]):
    place, wrong = tuple(top.split("/")), []
    for path in below(top):
        own = path.relative_to(ROOT / top).parts[0].removesuffix(".py")
        if own not in rank:
            continue  # __init__ and __main__
        for name in imports(path):
            parts = tuple(name.split("."))
            other = parts[len(place)] if parts[: len(place)] == place and len(parts) > len(place) else own
            if other in rank and other != own and rank[other] <= rank[own]:
                wrong.append(f"{named(path)} imports {name}")
    assert not wrong


@pytest.mark.parametrize(("top", "rank"), [("app", RANK), ("app/lab", LAB_RANK)])
def test_every_folder_has_its_place_in_the_order(top: str, rank: dict[str, int]):
    folders = {path.name for path in (ROOT / top).iterdir() if path.is_dir() and path.name != "__pycache__"}
    modules = {path.stem for path in (ROOT / top).glob("*.py")} - {"__init__", "__main__"}
    assert folders | modules == set(rank)


def test_no_scene_imports_another():
    scenes = {p.name for p in (ROOT / "app" / "scenes").iterdir() if (p / "scene.py").exists()}
    assert len(scenes) >= 4
    wrong = []
    for scene in scenes | SCENES_SHARED:
        others = [f"app.scenes.{other}" for other in scenes - {scene}]
        wrong += offences(below(f"app/scenes/{scene}"), *others)
    assert not wrong


def test_only_the_viewing_folders_and_the_drawings_import_viser():
    paths = [p for p in below("app") if p.relative_to(ROOT).parts[1] not in VIEWING and not is_drawing(p)]
    assert not offences(paths, "viser")


def test_sim_knows_neither_viewer_nor_app_nor_threads():
    others = (
        "viser", "app", "assets", "threading", "multiprocessing", "concurrent", "asyncio", "tests", "scipy",
    )  # fmt: skip
    assert not offences(below("sim"), *others)


def test_the_kernel_decorator_is_the_only_compiler():
    # What students write is compiled in a process of its own, and not kept. The cache asks for which processor.
    allowed = ("sim/jit.py", "sim/compiler.py", "sim/cache.py", "app/lab/process/compiled.py")
    paths = [path for path in [*below("sim"), *below("app"), *below("benchmarks")] if named(path) not in allowed]
    assert not offences(paths, "numba")


def test_springs_ocean_and_particles_do_not_know_each_other():
    wrong = []
    for own in APART:
        others = [f"sim.{other}" for other in (*APART, "floating") if other != own]
        wrong += offences(below(f"sim/{own}"), *others)
    assert not wrong
    assert not offences(below("sim/floating"), "sim.springs", "sim.particles")


@pytest.mark.parametrize("top", ["sim", "app", "benchmarks"])
def test_there_is_no_circle_of_imports(top: str):
    """Those for types only are counted, too."""
    modules = {module_of(path): path for path in below(top)}
    graph = {
        # A package is run before its modules are, so that what they import of it by name is not counted.
        name: {
            other
            for other in imports(path, types=True) & set(modules)
            if not name.startswith(other + ".") and other != name
        }
        for name, path in modules.items()
    }
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as circle:
        pytest.fail(" - ".join(circle.args[1]))


def test_the_spine_is_typed():
    """What viser's own types leave open has names of its own, in app/render/handles/viser_types.py."""
    paths = [*below("app/server"), *below("app/panel"), ROOT / "app" / "scenes" / "contract.py"]
    assert not offences(paths, "typing.Any")


def test_nothing_that_ships_imports_the_tests_or_the_benchmarks():
    assert not offences([*below("sim"), *below("app"), *below("assets")], "tests", "benchmarks")


def test_the_benchmarks_import_neither_the_tests_nor_viser():
    assert not offences(below("benchmarks"), "tests", "viser")


def test_nothing_is_left_to_do():
    words = ("TODO", "FIXME", "XXX", "NotImplementedError")
    left = [(named(path), word) for path in SOURCES for word in words if word in path.read_text("utf-8")]
    assert [entry for entry in left if entry[0] != named(Path(__file__))] == []
