"""`kernel`: the only compiler decorator of the repository, and the cache of compiled code.

numba does not notice an edit in a *callee's* file, so the cache folder of a module's kernels is named by a hash of the
code of the module and of all modules of ours that it imports: an edit in one of them makes a new folder, an edit of
comments and docstrings does not. Kernels are looked for in the user's folder, then in those of `sim/cache.py` that are
only read. A kernel that none of them has is compiled into the user's folder, or at each start if that is not writable.
"""

import atexit
import contextlib
import functools
import hashlib
import importlib
import inspect
import os
import pkgutil
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
from numba import prange  # for the kernels that are parallel
from numba.extending import intrinsic, overload

from sim.cache import own_folder, processor, shared_kernels

__all__ = [
    "CACHE",
    "MAX_THREADS",
    "chosen",
    "compile_ahead",
    "generated",
    "is_stopped",
    "kernel",
    "modules_of",
    "prange",
    "set_threads",
]

ROOT = Path(__file__).resolve().parent.parent
OWN_PACKAGES = ("sim", "app", "tests")
IMPORT = re.compile(r"^\s*(?:from\s+([\w.]+)\s+import\s+(\([^)]*\)|[^\n#]+)|import\s+([\w., ]+))", re.MULTILINE)
MODULES_OF = re.compile(r"\bmodules_of\(__name__\)")
# A string, or the rest of a line and the lines after it that hold nothing but spaces and comments.
STRING = r'''"""(?:\\.|[^\\])*?"""|\'\'\'(?:\\.|[^\\])*?\'\'\'|"(?:\\.|[^\\\n"])*"|'(?:\\.|[^\\\n'])*\''''
NO_CODE = re.compile(rf"({STRING})|(?:[ \t]*(?:#[^\n]*)?\n)+", re.DOTALL)
# Text before a docstring: the last line of a `def` or `class`, or nothing.
DOCSTRING = re.compile(
    rf"(\A\n?|^[ \t]*(?:(?:async +)?def|class)\b[^\n]*:\n|^[ \t]*\)[^\n]*:\n)[ \t]*[rRuU]?(?:{STRING})\n",
    re.DOTALL | re.MULTILINE,
)
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
def names_in(folder: Path) -> frozenset[str]:
    """Names of the files and folders in a folder; none where it is no folder."""
    try:
        return frozenset(os.listdir(folder))
    except OSError:
        return frozenset()


@functools.cache
def source_of(module: str) -> Path | None:
    """The file of a module of ours; None of other modules.

    By the names in its folder: to Windows and macOS the class `Hull` of a package is a module, too, that of `hull.py`.
    """
    if module.partition(".")[0] not in OWN_PACKAGES:
        return None
    path = ROOT.joinpath(*module.split("."))
    if f"{path.name}.py" in names_in(path.parent):
        return path.with_suffix(".py")
    return path / "__init__.py" if path.name in names_in(path.parent) and "__init__.py" in names_in(path) else None


@functools.cache
def code_of(path: Path) -> str:
    """A source without its comments, docstrings and empty lines.

    By regular expressions, as Python's parser takes a second for all of ours.
    """
    code = NO_CODE.sub(lambda match: match[1] or "\n", path.read_text("utf-8") + "\n")
    return DOCSTRING.sub(r"\1", code)


@functools.cache
def imported_files(path: Path) -> frozenset[Path]:
    """The files of the modules of ours that a source imports, by name or by `modules_of`."""
    text = code_of(path)
    files = set(path.parent.glob("*.py")) if MODULES_OF.search(text) else set()
    for module, names, modules in IMPORT.findall(text):
        candidates = [name.split()[0] for name in modules.split(",") if name.strip()]
        if module:
            members = [name.split()[0] for name in names.strip("()").replace("\n", " ").split(",") if name.strip()]
            candidates = [module, *(f"{module}.{name}" for name in members)]
        files.update(file for file in map(source_of, candidates) if file is not None)
    return frozenset(files)


def modules_of(package: str) -> list[ModuleType]:
    """Import all modules of a package, so that their kernels can be linked into others."""
    return [
        importlib.import_module(f"{package}.{module.name}")
        for module in pkgutil.iter_modules(sys.modules[package].__path__)
    ]


def reachable_hash(*paths: Path) -> str:
    """Hash of these sources and of all of ours that they import, directly or not: names and code.

    The versions of Python (without its patch release), numba and llvmlite count too.
    """
    sources, waiting = set(), list(paths)
    while waiting:
        path = waiting.pop()
        if path not in sources:
            sources.add(path)
            waiting.extend(imported_files(path))
    versions = sys.implementation.cache_tag, numba.__version__, llvmlite.__version__
    digest = hashlib.sha256(repr(versions).encode())
    for path in sorted(sources):
        digest.update(path.name.encode() if ROOT not in path.parents else path.relative_to(ROOT).as_posix().encode())
        digest.update(code_of(path).encode())
    return digest.hexdigest()[:16]


def cache_directory() -> Path | None:
    """The writable directory below which compiled kernels are cached, or None if no directory is writable."""
    base = own_folder() / "kernels" / processor()
    try:
        base.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=base):
            pass
        for other in base.parent.glob("*/*"):
            if KERNEL_FOLDER.fullmatch(other.name) and time.time() - other.stat().st_mtime > STALE_AFTER:
                shutil.rmtree(other, ignore_errors=True)
    except OSError:
        return None
    return base


CACHE = cache_directory()
SHARED = shared_kernels()  # only read


@functools.cache
def folder_name(path: Path) -> str:
    """Name of the folders of a source's kernels: of the module and of the hash of all modules that it can reach."""
    return f"{path.stem}-{reachable_hash(path)}"


@functools.cache
def kernel_folder(path: Path) -> Path | None:
    """The writable folder of a source's kernels; None also for typed-in source without a file."""
    if CACHE is None or not path.is_file():
        return None
    try:
        folder = CACHE / folder_name(path)
        folder.mkdir(exist_ok=True)
        os.utime(folder)
    except OSError:
        return None
    return folder


def is_kept(name: str) -> bool:
    """True if a file of this name is in the writable folder of this processor or in one that is only read."""
    return any((folder / name).exists() for folder in (CACHE, *SHARED) if folder is not None)


def keep(name: str) -> None:
    """Put an empty file of this name into the writable folder, if there is one and its disk is not full."""
    if CACHE is not None:
        with contextlib.suppress(OSError):
            (CACHE / name).touch()


@functools.cache
def scratch() -> Path | None:
    """A folder for numba, which makes no cache without one that is writable; nothing is kept there."""
    try:
        folder = tempfile.mkdtemp(prefix="springtide-")
    except OSError:
        return None
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


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
        mark = f"compiler-{reachable_hash(Path(compiler.__file__))}"
        if not is_kept(mark):
            with tempfile.TemporaryDirectory() as folder, kept_in(Path(folder)):
                compiler.check(Path(folder))
            keep(mark)
    except OSError:  # no folder to try it in
        return compiler, ""
    except Exception as error:  # anything may happen where numba's inner parts have changed
        return None, f"{type(error).__name__}: {error}".splitlines()[0]
    return compiler, ""


COMPILER, MISSING = load_compiler()
if MISSING:
    warnings.warn(
        f"numba {numba.__version__} has changed inside ({MISSING}): kernels are compiled in numba's own way, "
        "which takes longer, and run up to five times slower",
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
    points that counting costs several times the arithmetic. A kernel that calls one without counting that returns an
    array, alone or in a record (`link_at` of lines does), needs it too: it would release an array that nobody counted.
    Compiling it raises TypeError.
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
    path = Path(function.__code__.co_filename).resolve()
    folder = kernel_folder(path)
    if COMPILER is None:
        with kept_in(folder):
            return numba.njit(cache=folder is not None, **options)(function)
    place = folder or (scratch() if path.is_file() else None)
    folders = None
    if place is not None:
        folders = COMPILER.Folders(folder, tuple(other / folder_name(path) for other in SHARED))
    with kept_in(place):
        return COMPILER.make_kernel(function, folders, options, noalias=noalias, counts=allocates and not inline)


def compile_ahead(kernel: Any, *arguments: Any) -> Any:
    """Compile a kernel for calls by other kernels, ahead of the first one.

    arguments: values of the types of the call. Returns a stand-in for the result, as an argument of the next such call.
    Does nothing where kernels are compiled in numba's own way.
    """
    if COMPILER is None:
        return None
    types = (one if isinstance(one, numba.types.Type) else numba.typeof(one) for one in arguments)
    return kernel.compile_part(tuple(types))


def generated(source: str, names: dict[str, Any], module: str, **options: Any) -> Any:
    """A kernel whose source, one function, was written by the program; saved with the kernels of this module of ours.

    names: the kernels that it calls, by their names in the source. options: as of `kernel`. Two kernels of one module
    must differ in the name of the function, as numba's own cache does not look at what names stand for.
    """
    scope = {**names, "__name__": module}
    code = compile(source, str(Path(sys.modules[module].__file__ or "").resolve()), "exec")
    exec(code, scope)
    return kernel(scope[code.co_names[0]], **options)


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


# True if a long solve is to end, by the numbers of `sim.interruption`: the first, set by another thread or by a Ctrl-C.
# Where the third is set, the function of the fourth is called, which raises nothing.
is_stopped: Any = kernel(_is_stopped_interpreted if numba.config.DISABLE_JIT else _is_stopped)  # type: ignore[attr-defined]


def set_threads(count: int) -> None:
    """Set the number of threads of the calling thread's parallel kernels. A kernel that set it could not be cached."""
    numba.set_num_threads(count)
