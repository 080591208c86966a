"""`kernel`: the only compiler decorator of the repository, and the cache of compiled code.

numba does not notice an edit in a *callee's* file, so the cache folder of a module's kernels is named by a hash of the
module and of all modules of ours that it imports: an edit in one of them makes a new folder. If no folder is writable,
kernels compile at each start.
"""

import contextlib
import functools
import hashlib
import importlib
import inspect
import os
import pkgutil
import platform
import re
import shutil
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import llvmlite
import numba
import platformdirs
from numba import prange  # for the kernels that are parallel
from numba.extending import intrinsic, overload

__all__ = ["CACHE", "MAX_THREADS", "chosen", "is_stopped", "kernel", "modules_of", "prange", "set_threads"]

ROOT = Path(__file__).resolve().parent.parent
OWN_PACKAGES = ("sim", "app", "tests")
IMPORT = re.compile(r"^\s*(?:from\s+([\w.]+)\s+import\s+(\([^)]*\)|[^\n#]+)|import\s+([\w., ]+))", re.MULTILINE)
MODULES_OF = re.compile(r"\bmodules_of\(__name__\)")
KERNEL_FOLDER = re.compile(r"\w+-[0-9a-f]{16}")

MAX_THREADS: int = numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]

# Every flag of `fastmath` but nnan and ninf: a NaN must stay visible to the checks that stop a run.
FASTMATH = {"nsz", "arcp", "contract", "afn", "reassoc"}

STALE_AFTER = 30 * 24 * 3600  # [s] a cache directory unused for this long belongs to sources long edited


def sources_hash(root: Path) -> str:
    """Hash of every Python source below `root`: names and contents."""
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@functools.cache
def source_of(module: str) -> Path | None:
    """The file of a module of ours; None of other modules."""
    if module.partition(".")[0] not in OWN_PACKAGES:
        return None
    path = ROOT.joinpath(*module.split("."))
    return next((file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()), None)


@functools.cache
def imported_files(path: Path) -> frozenset[Path]:
    """The files of the modules of ours that a source imports, by name or by `modules_of`."""
    text = path.read_text("utf-8")
    found = set(path.parent.glob("*.py")) if MODULES_OF.search(text) else set()
    for module, names, modules in IMPORT.findall(text):
        candidates = [name.split()[0] for name in modules.split(",") if name.strip()]
        if module:
            members = [name.split()[0] for name in names.strip("()").replace("\n", " ").split(",") if name.strip()]
            candidates = [module, *(f"{module}.{name}" for name in members)]
        found.update(file for file in map(source_of, candidates) if file is not None)
    return frozenset(found)


def modules_of(package: str) -> list[ModuleType]:
    """All modules of a package of ours, whose kernels are to be part of others': whoever imports it imports them."""
    return [
        importlib.import_module(f"{package}.{module.name}")
        for module in pkgutil.iter_modules(sys.modules[package].__path__)
    ]


def reachable_hash(*paths: Path) -> str:
    """Hash of these sources and of all of ours that they import, directly or not: names and contents."""
    found, waiting = set(), list(paths)
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(imported_files(path))
    digest = hashlib.sha256()
    for path in sorted(found):
        digest.update(path.name.encode() if ROOT not in path.parents else path.relative_to(ROOT).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_directory() -> Path | None:
    """The writable directory below which compiled kernels are cached, or None if no directory is writable."""
    base = Path(os.environ.get("SPRINGTIDE_CACHE") or platformdirs.user_cache_dir("springtide")) / "kernels"
    try:
        base.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=base):
            pass
        for other in base.iterdir():
            if KERNEL_FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > STALE_AFTER:
                shutil.rmtree(other, ignore_errors=True)
    except OSError:
        return None
    return base


CACHE = cache_directory()


@functools.cache
def kernel_folder(path: Path) -> Path | None:
    """Cache folder of a source's kernels: named by the module and by the hash of all modules that it can reach."""
    if CACHE is None:
        return None
    try:
        folder = CACHE / f"{path.stem}-{reachable_hash(path)}"
        folder.mkdir(exist_ok=True)
        os.utime(folder)
    except OSError:
        return None
    return folder


@contextlib.contextmanager
def kept_in(folder: Path | None) -> Iterator[None]:
    """Let kernels that are made inside keep their code in `folder`; other libraries' kernels stay where they were."""
    previous = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    try:
        # numba reads the setting once, when a kernel is made.
        numba.config.CACHE_DIR = str(folder) if folder else previous  # type: ignore[attr-defined]
        yield
    finally:
        numba.config.CACHE_DIR = previous  # type: ignore[attr-defined]


def load_compiler() -> tuple[ModuleType | None, str]:
    """Return `sim.compiler`, or None and the reason why it does not work with the numba that is installed."""
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return None, ""
    try:
        from sim import compiler
    except (AttributeError, ImportError, TypeError) as error:
        return None, str(error)
    try:
        works = f"compiler-{numba.__version__}-{llvmlite.__version__}-{platform.python_version()}-{MAX_THREADS}"
        mark = CACHE / f"{works}-{reachable_hash(Path(compiler.__file__))}" if CACHE is not None else None
        if mark is None or not mark.exists():
            with tempfile.TemporaryDirectory() as folder, kept_in(Path(folder)):
                compiler.check(Path(folder))
            if mark is not None:
                mark.touch()
    except OSError:  # no folder to try it in
        return compiler, ""
    except Exception as error:  # anything may happen where numba's inner parts have changed
        return None, f"{type(error).__name__}: {error}".splitlines()[0]
    return compiler, ""


COMPILER, MISSING = load_compiler()
if MISSING:
    warnings.warn(
        f"numba {numba.__version__} has changed inside ({MISSING}): kernels are compiled in numba's own way, "
        "which takes longer",
        stacklevel=1,
    )


def kernel(
    function: Callable[..., Any] | None = None,
    *,
    noalias: bool = False,
    inline: bool = False,
    allocates: bool = True,
    parallel: bool = False,
) -> Any:
    """Compile `function` with numba, without the GIL, cached on disk.

    noalias: promise that no array argument that is written overlaps another, so that loops vectorise without checks.
    inline: always expand into the calling kernel (for the short loops that a step is made of); implies no allocation.
    allocates: False promises that no array or view is made, so that array arguments are not reference-counted: at ten
    points that counting costs several times the arithmetic.
    parallel: allow numba.prange.
    """
    if function is None:
        return lambda f: kernel(f, noalias=noalias, inline=inline, allocates=allocates, parallel=parallel)
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return function
    options: dict[str, Any] = {
        "nogil": True,
        "fastmath": FASTMATH,
        "error_model": "numpy",
        "parallel": parallel,
        "forceinline": inline,
    }
    folder = kernel_folder(Path(function.__code__.co_filename).resolve())
    with kept_in(folder):
        if COMPILER is None:
            return numba.njit(cache=folder is not None, **options)(function)
        return COMPILER.make_kernel(function, folder, options, noalias=noalias, counts=allocates and not inline)


def chosen(variants: dict[type, Any]) -> Any:
    """A kernel that stands for one of `variants`, by the class of a record (a NamedTuple) among its arguments.

    Which one is known as soon as the types are, so that a caller holds the code of that one and of no other.
    """
    if COMPILER is not None:
        return COMPILER.choose(variants)

    def call(*args: Any) -> Any:
        return next(variants[type(arg)] for arg in args if type(arg) in variants)(*args)

    # Arguments by name: in a tuple of any length each field of the records would be copied.
    names = ", ".join(inspect.signature(next(iter(variants.values()))).parameters)

    def implementation(types: tuple[Any, ...]) -> Any:
        """The call of the variant for arguments of these types; None if there is no such variant."""
        for one in types:
            kernel = variants.get(getattr(one, "instance_class", type(None)))
            if kernel is not None:
                return eval(f"lambda {names}: kernel({names})", {"kernel": kernel})
        return None

    overload(call)(eval(f"lambda {names}: implementation(({names},))", {"implementation": implementation}))
    return call


def _load_of(typing: Any, array: Any, index: Any) -> Any:
    """A number of an array of int64 that another thread may change: an atomic load, which no loop keeps a copy of."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.load_atomic(builder.gep(data, [arguments[1]]), "monotonic", 8)

    return numba.types.int64(array, numba.types.intp), generate


_load: Any = intrinsic(_load_of)

_take_gil = numba.types.ExternalFunction("PyGILState_Ensure", numba.types.int32())
_give_gil = numba.types.ExternalFunction("PyGILState_Release", numba.types.void(numba.types.int32))
_handle_signals = numba.types.ExternalFunction("PyErr_CheckSignals", numba.types.int32())
_forget_error = numba.types.ExternalFunction("PyErr_Clear", numba.types.void())
_call = numba.types.ExternalFunction("PyObject_CallNoArgs", numba.types.intp(numba.types.intp))
_forget = numba.types.ExternalFunction("Py_DecRef", numba.types.void(numba.types.intp))


def _is_stopped(request: Any) -> bool:
    if _load(request, 0) == 0 and (_load(request, 1) != 0 or _load(request, 2) != 0):
        held = _take_gil()
        if _load(request, 2) != 0:
            request[2] = 0
            answer = _call(request[3])
            if answer == 0:
                _forget_error()
            _forget(answer)
        if _load(request, 1) != 0 and _handle_signals() != 0:
            _forget_error()
            request[0] = 1
        _give_gil(held)
    return _load(request, 0) != 0


def _is_stopped_interpreted(request: Any) -> bool:
    return bool(request[0])


# Whether a long solve is to end, by the numbers of `sim.interruption`: the first, set by another thread or by a Ctrl-C.
# Where the third is set, the function of the fourth is called, which raises nothing.
is_stopped: Any = kernel(_is_stopped_interpreted if numba.config.DISABLE_JIT else _is_stopped)  # type: ignore[attr-defined]


def set_threads(count: int) -> None:
    """Set the number of threads of the calling thread's parallel kernels. A kernel that set it could not be cached."""
    numba.set_num_threads(count)
