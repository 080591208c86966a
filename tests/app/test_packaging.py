"""What the package declares: every import is a declared dependency, and what uses inner names has an upper bound."""

import ast
import functools
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import distribution, packages_distributions, version
from pathlib import Path

from packaging.utils import parse_wheel_filename

from tests.fresh import noted

ROOT = Path(__file__).parents[2]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
PROJECT = SETTINGS["project"]
OWN = {"app", "assets", "benchmarks", "sim"}
# Peers that are no extras of ours: pypbd and bpy are installed by hand, warp's distribution is warp-lang.
BY_HAND = {"bpy", "pypbd"}
DISTRIBUTIONS = {"warp": "warp-lang", "netCDF4": "netcdf4", "elastica": "pyelastica"}


installed = functools.cache(packages_distributions)  # reads the list of files of every distribution


def names_of(requirements: list[str]) -> set[str]:
    """The distributions that requirements name."""
    return {re.split(r"[<>=!~;\[ ]", requirement)[0].lower() for requirement in requirements}


@functools.cache
def parsed() -> dict[Path, ast.Module]:
    """The sources of what ships, and of the benchmarks."""
    paths = (path for top in ("app", "benchmarks", "sim") for path in ROOT.glob(f"{top}/**/*.py"))
    return {path: ast.parse(path.read_text("utf-8")) for path in paths}


def imported(tree: ast.Module, *, at_top: bool) -> set[str]:
    """The packages that a module imports when it is loaded, or in all."""
    found = set()
    for node in tree.body if at_top else ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.partition(".")[0])
    return found


def undeclared(declared: set[str], *, at_top: bool) -> dict[str, set[str]]:
    """File -> its imports of distributions that are not among the declared."""
    distributions = installed()
    wrong = {}
    for path, tree in parsed().items():
        others = imported(tree, at_top=at_top) - OWN - BY_HAND - sys.stdlib_module_names
        named = {
            DISTRIBUTIONS.get(name, distributions.get(name, [name])[0]).lower().replace("_", "-") for name in others
        }
        if named - declared:
            wrong[str(path.relative_to(ROOT))] = named - declared
    return wrong


def test_what_a_module_imports_when_it_is_loaded_is_a_dependency():
    assert undeclared(names_of(PROJECT["dependencies"]), at_top=True) == {}


def test_what_is_imported_anywhere_is_a_dependency_or_an_extra():
    extras = {name for requirements in PROJECT["optional-dependencies"].values() for name in names_of(requirements)}
    assert undeclared(names_of(PROJECT["dependencies"]) | extras, at_top=False) == {}


def test_no_dependency_has_an_upper_bound():
    """Each use of an inner name has a fallback; `test_numba_names.py` and `test_viser_names.py` take them away."""
    assert [r for r in PROJECT["dependencies"] if "<" in r] == []


def test_the_wheel_holds_of_the_assets_what_the_program_reads_and_nothing_else():
    excluded = {Path(path).name for path in SETTINGS["tool"]["hatch"]["build"]["targets"]["wheel"]["exclude"]}
    kept = {path.name for path in (ROOT / "assets").iterdir()} - excluded - {"__init__.py", "__pycache__"}
    sources = "".join(path.read_text("utf-8") for top in ("app", "sim") for path in (ROOT / top).rglob("*.py"))
    assert kept
    assert [name for name in sorted(kept) if name not in sources and f'"{Path(name).stem}"' not in sources] == []
    assert excluded == {
        "bench",
        "make_barge.py",
        "make_models.py",
        "make_tables.py",
        "pictures",
        "shape_panels.py",
        "stability",
    }


def test_the_library_reads_its_tables_without_the_rest_of_the_package(tmp_path: Path):
    shutil.copytree(ROOT / "sim", tmp_path / "sim", ignore=shutil.ignore_patterns("__pycache__"))
    code = (
        "import sys; from sim.floating.linear.linear_table import table_of;"
        "from sim.ocean.weathering.components import *;"
        "tables = [table_of(name).draft.size for name in ('box', 'cylinder', 'sphere')];"
        "oils = len(fluids()) > len(oil_records()) > 0;"
        "print(tables, oils, {'app', 'assets'} & set(sys.modules), *sys.modules['sim'].__path__)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={"SPRINGTIDE_KERNELS": noted()},
        capture_output=True,
        encoding="locale",
        check=True,
    )
    assert done.stdout.strip() == f"[9, 9, 9] True set() {tmp_path / 'sim'}"


def test_the_extra_of_compiled_kernels_names_this_version():
    (kernels,) = PROJECT["optional-dependencies"]["kernels"]
    assert kernels == f"springtide-kernels=={PROJECT['version']}"


def make_kernels(place: Path, *names: str) -> Path:
    """A folder as `springtide warmup --into` makes it, with files of these names."""
    folder = place / "made" / "kernels" / "linux-x86-64-v3"
    (folder / "scene-0123456789abcdef").mkdir(parents=True)
    for name in names:
        (folder / name).write_bytes(name.encode())
    return place / "made"


def test_the_wheel_of_kernels_holds_what_python_calls_and_is_tagged_as_numba_s(tmp_path: Path):
    inner = "scene-0123456789abcdef/step-01234567.cpython-311"
    kept = [
        f"{inner}.nbi",
        f"{inner}.1.nbc",
        "rope-drawn-everything-0123456789abcdef.warm",
        "compiler-0123456789abcdef",
    ]
    folder = make_kernels(tmp_path, *kept, f"{inner}-part.nbi", f"{inner}-part.1.nbc", f"{inner}.lock")
    path = runpy.run_path(str(ROOT / ".ci" / "kernels.py"))["write_wheel"](folder, tmp_path / "out")
    with zipfile.ZipFile(path) as wheel:
        names = wheel.namelist()
        record = wheel.read(next(name for name in names if name.endswith("/RECORD"))).decode()
        about = wheel.read(next(name for name in names if name.endswith("/METADATA"))).decode()
    assert {name for name in names if "dist-info" not in name} == {
        "springtide_kernels/__init__.py",
        *(f"springtide_kernels/kernels/linux-x86-64-v3/{name}" for name in kept),
    }
    assert [line.partition(",")[0] for line in record.splitlines()] == names
    assert f"Requires-Dist: numba=={version('numba')}\n" in about
    tags = {str(tag) for tag in parse_wheel_filename(path.name)[3]}
    assert tags == {
        line.split()[1] for line in (distribution("numba").read_text("WHEEL") or "").splitlines() if "Tag:" in line
    }


def test_the_comparisons_are_in_the_sources_and_not_in_the_wheel():
    targets = SETTINGS["tool"]["hatch"]["build"]["targets"]
    assert (ROOT / "benchmarks" / "command.py").exists()
    assert "benchmarks" in targets["sdist"]["include"]
    assert targets["wheel"]["packages"] == ["app", "assets", "sim"]
