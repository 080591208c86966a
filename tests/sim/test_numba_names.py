"""Names of numba that are not public: one file uses them, and without any of them kernels still work."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fresh import of_each

ROOT = Path(__file__).parents[2]
PUBLIC = {"llvmlite", "llvmlite.binding", "numba", "numba.extending", "numba.types"}

# Each name that `sim/compiler.py` takes from numba's inside. Without the ones in QUIET compiling is only slower.
NAMES = (
    "CompileResultCacheImpl", "FunctionCache", "IndexDataCacheFile", "JITCodeLibrary", "Compiler", "CompileResult",
    "Flags", "rtsys", "initialize",
    "global_compiler_lock", "lookup_environment", "TargetOptions", "CPUDispatcher", "cpu_target", "event", "serialize",
    "sigutils",
    "_load_index", "_index_path", "flush", "_values", "_codegen", "_data_layout", "_function_pass_manager",
    "_finalized", "_optimize_final_module", "_finalize_final_module", "_finalize_specific", "_ensure_finalized",
    "_final_module", "_shared_module", "_get_module_for_linking", "_reload_init", "get_pointer_to_function",
    "has_dynamic_globals", "enable_object_caching", "set_env", "compile_extra", "no_compile", "targetctx", "reduce",
    "rebuild", "typemap", "typing_context", "insert_user_function", "trigger_event", "normalize_signature", "unliteral",
    "_index_key", "_cache", "_cache_file", "_impl", "load_overload", "save_overload", "_customize_flags",
    "get_call_template", "get_overload", "overloads", "add_overload", "instance_class", "_nrt", "no_cfunc_wrapper",
    "noalias", "no_cpython_wrapper", "Mapping", "set_option", "parse_bitcode", "linkonce_odr", "as_bitcode",
    "global_variables",
)  # fmt: skip
QUIET = {
    "_load_index", "flush", "_finalized", "_optimize_final_module", "_finalize_final_module", "_finalize_specific",
    "_ensure_finalized", "_shared_module", "get_pointer_to_function", "has_dynamic_globals", "compile_extra",
    "_customize_flags",
}  # fmt: skip
SAMPLE = ("IndexDataCacheFile", "_impl", "flush")
UNUSED = "unused"  # no name of numba: the kernels as they are

KERNELS = """
from typing import NamedTuple
import numpy as np
from sim.jit import chosen, kernel

class Round(NamedTuple):
    radius: float

class Square(NamedTuple):
    side: float

@kernel(allocates=False)
def round_area(shape, scale):
    return 3.0 * scale * shape.radius**2

@kernel(inline=True)
def square_area(shape, scale):
    return scale * shape.side**2

area = chosen({Round: round_area, Square: square_area})

@kernel(noalias=True)
def add_areas(total, shape):
    for j in range(total.shape[0]):
        total[j] += area(shape, 2.0)

def areas():
    total = np.zeros(3)
    add_areas(total, Round(1.0))
    add_areas(total, Square(2.0))
    return total.sum() + area(Square(1.0), 1.0)
"""

# A name that numba has changed is one that our source spells in another way. Each is tried in a child of a process that
# has imported numba.
WITHOUT = """
import os, sys, warnings
import numba
for name in sys.argv[1:]:
    sys.stdout.flush()
    child = hasattr(os, "fork") and os.fork()  # Windows cannot: there is one name
    if child:
        os.waitpid(child, 0)
        continue
    sys.path.insert(0, name)
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            import kernels
        lines = [str(w.message) for w in said if "changed inside" in str(w.message)]
        print(name, kernels.areas(), len(lines), flush=True)
    except BaseException as error:
        print(name, type(error).__name__, error, flush=True)
    os._exit(0)
"""


def run_without(names: tuple[str, ...], tmp_path: Path) -> dict[str, tuple[float, int]]:
    """What a few kernels compute and the number of lines about numba, with each of the names spelled in another way."""
    compiler = (ROOT / "sim" / "compiler.py").read_text("utf-8")
    for name in names:
        sources = tmp_path / name / "sim"
        sources.mkdir(parents=True)
        for module in ("__init__", "cache", "files", "jit", "validation"):
            (sources / f"{module}.py").write_bytes((ROOT / "sim" / f"{module}.py").read_bytes())
        (sources / "compiler.py").write_text(re.sub(rf"\b{name}\b", f"{name}_changed", compiler), "utf-8")
        (tmp_path / name / "kernels.py").write_text(KERNELS, "utf-8")
    rows = of_each(WITHOUT, names, tmp_path, {"SPRINGTIDE_CACHE": str(tmp_path / "cache"), "PYTHONPATH": ""})
    return {row[0]: (float(row[1]), int(row[2])) if len(row) == 3 else (float("nan"), 0) for row in rows}


@pytest.mark.parametrize(
    "names", [SAMPLE, pytest.param(NAMES, marks=pytest.mark.stress, id="all")], ids=lambda names: names[0]
)
def test_without_an_inner_name_kernels_work_and_one_line_says_what_is_missing(
    names: tuple[str, ...], tmp_path: Path
) -> None:
    expected = {name: (43.0, name not in QUIET | {UNUSED}) for name in (*names, UNUSED)}
    assert run_without((*names, UNUSED), tmp_path) == expected


def test_one_file_uses_inner_names() -> None:
    users = {
        path.relative_to(ROOT).as_posix()
        for top in ("sim", "app")
        for path in (ROOT / top).rglob("*.py")
        if modules_of_numba(path) - PUBLIC
    }
    assert users == {"sim/compiler.py"}


def modules_of_numba(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(node.module or "")
    return {name for name in found if name.partition(".")[0] in ("numba", "llvmlite")}


@pytest.mark.stress  # compiles in numba's own way: a minute or two each
@pytest.mark.parametrize("scene", ["rope", "cloth", "square_sea", "radial_sea"])
def test_without_an_inner_name_scenes_run(scene: str, tmp_path: Path) -> None:
    code = (
        "import sys, numba.core.environment; del numba.core.environment.lookup_environment\n"
        "from app.__main__ import main; sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "run", scene, "--seconds", "0.05", "--out", str(tmp_path / "out.npz")]
    environment = {**os.environ, "SPRINGTIDE_CACHE": str(tmp_path)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, encoding="locale", check=True)
    assert done.stderr.count("has changed inside") == 1
    assert (tmp_path / "out.npz").exists()
