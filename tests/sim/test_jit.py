import ast
import contextlib
import io
import os
import textwrap
import tokenize
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from app.__main__ import main
from sim import jit
from sim.cache import processor
from sim.jit import kernel, reachable_hash, sources_hash
from tests.fresh import python

ROOT = Path(__file__).parents[2]
WITH_DOCSTRINGS = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


@kernel
def halved(x):
    return 0.5 * x


@kernel(noalias=True)
def add(x, y):
    for j in range(x.shape[0]):
        x[j] += y[j]


def test_the_hash_changes_with_any_edit_and_any_new_name(tmp_path):
    (tmp_path / "a.py").write_text("x = 1\n", "utf-8")
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "b.py").write_text("y = 1\n", "utf-8")
    first = sources_hash(tmp_path)
    assert sources_hash(tmp_path) == first
    (tmp_path / "inner" / "b.py").write_text("y = 2\n", "utf-8")
    second = sources_hash(tmp_path)
    (tmp_path / "inner" / "b.py").rename(tmp_path / "inner" / "c.py")
    assert len({first, second, sources_hash(tmp_path)}) == 3


def test_another_python_numba_or_llvm_finds_no_kernels_of_this_one(monkeypatch):
    path = ROOT / "sim" / "ocean" / "tile" / "evolve.py"
    found = {reachable_hash(path)}
    for part in (jit.llvmlite, jit.numba):
        monkeypatch.setattr(part, "__version__", "0.0.1")
        found.add(reachable_hash(path))
    monkeypatch.setattr(jit.sys, "implementation", SimpleNamespace(cache_tag="cpython-399"))
    found.add(reachable_hash(path))
    monkeypatch.setattr(jit.sys, "version_info", (3, 99, 9))  # a patch release alone changes nothing
    found.add(reachable_hash(path))
    assert len(found) == 4


def test_other_files_do_not_change_the_hash(tmp_path):
    (tmp_path / "a.py").write_text("x = 1\n", "utf-8")
    first = sources_hash(tmp_path)
    (tmp_path / "notes.txt").write_text("nothing", "utf-8")
    assert sources_hash(tmp_path) == first


def test_a_kernels_folder_is_named_by_what_the_kernel_can_reach(tmp_path):
    code = "import sim.jit as j, pathlib; print(j.kernel_folder(pathlib.Path('sim/ocean/tile/evolve.py').resolve()))"
    found = Path(python(code, SPRINGTIDE_CACHE=str(tmp_path)))
    name = f"evolve-{reachable_hash(ROOT / 'sim' / 'ocean' / 'tile' / 'evolve.py')}"
    assert found == tmp_path / "kernels" / processor() / name
    assert found.is_dir()


def test_the_hash_of_a_kernel_follows_its_imports_and_nothing_else(tmp_path, monkeypatch):
    """An edit in an indirectly imported module makes a new folder; one in another module does not."""
    monkeypatch.setattr(jit, "ROOT", tmp_path)
    sources = {
        "kernel": "from sim.near import (\n    a,\n)\n",
        "near": "import sim.far\n",
        "far": "x = 1\n",
        "other": "",
    }
    (tmp_path / "sim").mkdir()

    def reached() -> str:
        forget_sources()
        return reachable_hash(tmp_path / "sim" / "kernel.py")

    for name, text in sources.items():
        (tmp_path / "sim" / f"{name}.py").write_text(text, "utf-8")
    first = reached()
    (tmp_path / "sim" / "other.py").write_text("y = 2\n", "utf-8")
    assert reached() == first
    (tmp_path / "sim" / "far.py").write_text("x = 2\n", "utf-8")
    assert reached() != first
    monkeypatch.undo()
    forget_sources()


@pytest.mark.parametrize("folder", jit.OWN_PACKAGES)
def test_the_imports_of_our_sources_are_those_that_python_s_parser_sees(folder):
    for path in (ROOT / folder).rglob("*.py"):
        names: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{path}: a relative import is not seen"
                names.update((node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)))
        siblings = set(path.parent.glob("*.py")) if jit.MODULES_OF.search(jit.code_of(path)) else set()
        parsed, found = {file for file in map(jit.source_of, names) if file} | siblings, jit.imported_files(path)
        # Tests hold sources as strings, whose imports count too.
        assert parsed <= found if folder == "tests" else parsed == found, path


def test_a_class_is_no_module_where_the_case_of_names_does_not_count(monkeypatch):
    """As on Windows, where `hull.py` is `Hull.py` too: the key of a kernel was one of two by chance."""

    def is_there(path: Path) -> bool:
        return os.path.isdir(path.parent) and path.name.lower() in map(str.lower, os.listdir(path.parent))

    monkeypatch.setattr(Path, "is_file", is_there)
    forget_sources()
    assert jit.source_of("sim.floating.hulls.hull") == ROOT / "sim" / "floating" / "hulls" / "hull.py"
    assert jit.source_of("sim.floating") == ROOT / "sim" / "floating" / "__init__.py"
    for name in ("sim.floating.Hull", "sim.Floating", "sim.floating.none", "numpy"):
        assert jit.source_of(name) is None, name
    forget_sources()


def forget_sources() -> None:
    for remembered in (jit.names_in, jit.source_of, jit.code_of, jit.imported_files):
        remembered.cache_clear()


COMMENTED = '''\
# A comment: don't "count" it.
"""Docstring of a module."""
from sim.near import a

TEXT = "# no comment"


def first(
    x,  # of any type
) -> None:

    r"""Docstring of a function.

    # Two lines of it.
    """
    return """not
    # a docstring""" * 2


class Second:
    'Docstring of a class.'

    def third(self): # ends a line
        "Docstring of a method."
'''
BARE = '''
from sim.near import a
TEXT = "# no comment"
def first(
    x,
) -> None:
    return """not
    # a docstring""" * 2
class Second:
    def third(self):
'''


def test_code_is_a_source_without_comments_and_docstrings(tmp_path):
    (tmp_path / "a.py").write_text(COMMENTED, "utf-8")
    assert jit.code_of(tmp_path / "a.py") == BARE


def tokens_of(text: str) -> list[str]:
    """Words and signs of a source, by Python's own tokenizer."""
    kept = (tokenize.NAME, tokenize.NUMBER, tokenize.OP, tokenize.STRING)
    with contextlib.suppress(tokenize.TokenError, IndentationError):
        return [token.string for token in tokenize.generate_tokens(io.StringIO(text).readline) if token.type in kept]
    raise AssertionError


def docstrings_of(text: str) -> Counter[str]:
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, WITH_DOCSTRINGS)]
    segments = [ast.get_source_segment(text, node.body[0]) for node in nodes if ast.get_docstring(node) is not None]
    return Counter(filter(None, segments))


@pytest.mark.parametrize(
    "folder", [pytest.param("sim", marks=pytest.mark.long), "sim/springs", "app/scenes/springs", "app/scenes/rope"]
)
def test_the_code_of_our_sources_has_all_of_their_tokens_but_docstrings(folder):
    for path in (ROOT / folder).rglob("*.py"):
        text = path.read_text("utf-8")
        left_out = Counter(tokens_of(text)) - Counter(tokens_of(jit.code_of(path)))
        assert left_out == docstrings_of(text), path


def test_kernels_are_kept_in_the_cache(tmp_path):
    code = """
from sim.springs import rope
from sim.springs.points.acceleration import make_scratch
make_scratch(rope().kernel_view(1.0))
"""
    python(code, SPRINGTIDE_CACHE=str(tmp_path))
    assert list(tmp_path.rglob("*make_scratch*.nbi"))


def test_without_a_writable_cache_kernels_still_compile(tmp_path):
    nowhere = tmp_path / "file"
    nowhere.write_text("not a folder", "utf-8")
    code = """
from sim.jit import CACHE, kernel
@kernel
def doubled(x):
    return 2.0 * x
print(CACHE, doubled(21.0))
"""  # of a kernel without a file, too
    assert python(code, SPRINGTIDE_CACHE=str(nowhere)) == "None 42.0"
    assert nowhere.read_text("utf-8") == "not a folder"


def test_directories_of_long_edited_sources_are_removed(tmp_path):
    stale = tmp_path / "kernels" / "a processor" / "leapfrog-0123456789abcdef"
    fresh = tmp_path / "kernels" / "a processor" / "leapfrog-fedcba9876543210"
    other = tmp_path / "kernels" / "a processor" / "somebody_elses"
    for folder in (stale, fresh, other):
        folder.mkdir(parents=True)
    for folder in (stale, other):
        os.utime(folder, (0, 0))
    python("import sim.jit", SPRINGTIDE_CACHE=str(tmp_path))
    assert not stale.exists()
    assert fresh.exists()
    assert other.exists()  # not made by us


def test_other_libraries_caches_stay_where_they_were():
    python("import numba; before = numba.config.CACHE_DIR; import sim.springs; assert numba.config.CACHE_DIR == before")


def test_a_nan_stays_visible():
    """The flags of fast arithmetic exclude the assumption that there is no NaN."""
    x = np.array([1.0, np.nan, np.inf, -np.inf])
    add(x, np.ones(4))
    assert np.isnan(x[1])
    assert np.isinf(x[2:]).all()
    assert np.isnan(halved(np.nan))


def test_kernels_let_other_threads_run():
    assert halved.targetoptions["nogil"]  # type: ignore[attr-defined]
    assert add.targetoptions["nogil"]  # type: ignore[attr-defined]


INTERPRETED = """
import importlib, pkgutil, sim, app.scenes
from app.__main__ import main
for package in (sim, app.scenes):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        importlib.import_module(module.name)
print(main(["run", "rope", "--seconds", "0.05", "--out", r"{out}", "--set", "points=4"]))
"""


def test_everything_runs_interpreted_for_who_debugs(tmp_path):
    said = python(INTERPRETED.format(out=tmp_path / "a.npz"), NUMBA_DISABLE_JIT="1", SPRINGTIDE_CACHE=str(tmp_path))
    assert said.splitlines()[-1] == "0"
    assert not list(tmp_path.rglob("*.nbi"))
    with np.load(tmp_path / "a.npz") as file:
        interpreted = file["x"][-1]
    assert main(["run", "rope", "--seconds", "0.05", "--out", str(tmp_path / "b.npz"), "--set", "points=4"]) == 0
    with np.load(tmp_path / "b.npz") as file:
        np.testing.assert_allclose(file["x"][-1], interpreted, rtol=1e-12)


ADDS = """
import numpy as np
from sim.jit import kernel
import tests.sim.test_jit as t
x = np.ones(3)
t.add(x, x.copy())
print(x[0])
"""


def test_a_full_disk_costs_a_compilation_and_no_more(tmp_path):
    pytest.importorskip("resource", reason="this system limits no sizes of files")
    full = f"from tests.full_disk import full_disk\nwith full_disk(3000):{textwrap.indent(ADDS, '    ')}"
    assert python(full, SPRINGTIDE_CACHE=str(tmp_path)) == "2.0"
    assert not list(tmp_path.rglob("*.nbc"))


def test_rubbish_in_the_cache_costs_a_compilation_and_no_more(tmp_path):
    assert python(ADDS, SPRINGTIDE_CACHE=str(tmp_path)) == "2.0"
    for pattern in ("*.nbc", "*.nb?"):
        kept = list(tmp_path.rglob(pattern))
        assert kept
        for path in kept:
            path.write_bytes(path.read_bytes()[:40])
        assert python(ADDS, SPRINGTIDE_CACHE=str(tmp_path)) == "2.0"
        # Kept again, and whole.
        assert all(path.stat().st_size > 40 for path in kept)


CALLERS = """
import numpy as np
from sim.jit import kernel, prange

@kernel(parallel=True)
def add_one(x):
    for j in prange(x.shape[0]):
        x[j] += 1.0

@kernel
def add_two(x):
    add_one(x)
    add_one(x)

@kernel
def add_four(x):
    add_two(x)
    add_two(x)
"""


def test_a_kernel_from_the_cache_starts_the_threads_its_callees_need(tmp_path):
    (tmp_path / "callers.py").write_text(CALLERS, "utf-8")
    call = "import callers, numpy as np; x = np.zeros(4); callers.{}(x); print(x.sum())"
    folders = {"SPRINGTIDE_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}
    # The second process compiles its caller with the kernel saved by the first; the third only loads.
    assert [python(call.format(name), **folders) for name in ("add_two", "add_four", "add_four")] == [
        "8.0",
        "16.0",
        "16.0",
    ]
