"""`kernel`: the only compiler decorator of the repository, and where compiled code is kept.

numba does not notice an edit in a *callee's* file, so the folder that a module's kernels are kept in is named by a hash
of the module and of all modules of ours that it imports: an edit in one of them makes a new folder. Where nothing is
writable, kernels compile at each start.
"""

import contextlib
import functools
import hashlib
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba import prange  # for the kernels that are parallel
from numba.core.caching import CompileResultCacheImpl, IndexDataCacheFile
from numba.core.compiler import Flags
from numba.core.options import TargetOptions
from numba.core.registry import cpu_target
from numba.extending import intrinsic

from sim.compiler import Choice, Entry, EntryCompiler, KernelFlags, Part, PartCompiler, PartResult
from sim.files import locked

__all__ = ["CACHE", "MAX_THREADS", "chosen", "is_stopped", "kernel", "prange", "set_threads"]

ROOT = Path(__file__).resolve().parent.parent
OWN_PACKAGES = ("sim", "app", "tests")
IMPORT = re.compile(r"^\s*(?:from\s+([\w.]+)\s+import\s+(\([^)]*\)|[^\n#]+)|import\s+([\w., ]+))", re.MULTILINE)
KERNEL_FOLDER = re.compile(r"\w+-[0-9a-f]{16}")

MAX_THREADS: int = numba.config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]

# Every flag of `fastmath` but nnan and ninf: a NaN must stay visible to the checks that stop a run.
FASTMATH = {"nsz", "arcp", "contract", "afn", "reassoc"}

STALE_AFTER = 30 * 24 * 3600  # [s] a cache directory unused for this long belongs to sources long edited

# numba knows this flag (numba.core.compiler.Flags) but offers no spelling of it in njit. Without it each loop
# starts with run-time overlap checks on every pair of arrays, a third of the time at 128 points.
_HAS_NOALIAS = hasattr(Flags, "noalias")
if _HAS_NOALIAS:
    cpu_target.options.noalias = TargetOptions.Mapping("noalias")  # type: ignore[attr-defined]


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
    """The files of the modules of ours that a source imports by name."""
    found = set()
    for module, names, modules in IMPORT.findall(path.read_text("utf-8")):
        candidates = [name.split()[0] for name in modules.split(",") if name.strip()]
        if module:
            members = [name.split()[0] for name in names.strip("()").replace("\n", " ").split(",") if name.strip()]
            candidates = [module, *(f"{module}.{name}" for name in members)]
        found.update(file for file in map(source_of, candidates) if file is not None)
    return frozenset(found)


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
    """The writable directory below which compiled kernels are kept, or None where there is none."""
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
    """Where the kernels of a source are kept: named by the module and by the hash of all that it can reach."""
    if CACHE is None:
        return None
    try:
        folder = CACHE / f"{path.stem}-{reachable_hash(path)}"
        folder.mkdir(exist_ok=True)
        os.utime(folder)
    except OSError:
        return None
    return folder


class KernelFile(IndexDataCacheFile):
    """numba's cache file of one kernel, where neither a full disk nor rubbish ends the program: it compiles anew.

    numba keeps the kernels of each checkout apart by the path and the time of the source. The folder is already named
    by the contents, so that checkouts and environments with the same sources share their kernels.
    """

    def load(self, key: Any) -> Any:
        try:
            return super().load(key)
        except Exception:  # whatever unpickling leads to
            return None

    def has(self, key: Any) -> bool:
        """Whether it is kept, as far as the index says."""
        try:
            return key in self._load_index()
        except Exception:  # whatever unpickling leads to
            return False

    def locked(self) -> contextlib.AbstractContextManager[None]:
        """Inside, no other process compiles this kernel."""
        return locked(Path(self._index_path).with_suffix(".lock"))

    def save(self, key: Any, data: Any) -> None:
        with contextlib.suppress(OSError):  # a full disk: kept another time
            try:
                super().save(key, data)
            except OSError:
                raise
            except Exception:  # the index is rubbish: an empty one
                self.flush()
                super().save(key, data)


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
    options: dict[str, Any] = {
        "nogil": True,
        "fastmath": FASTMATH,
        "error_model": "numpy",
        "parallel": parallel,
        "forceinline": inline,
        "_nrt": allocates and not inline,
        "no_cfunc_wrapper": True,
    }
    if noalias and _HAS_NOALIAS:
        options["noalias"] = True
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]
        return function
    folder = kernel_folder(Path(function.__code__.co_filename).resolve())
    entry = compiled(function, folder, "", EntryCompiler, CompileResultCacheImpl, options)
    part = compiled(function, folder, "-part", PartCompiler, PartResult, {**options, "no_cpython_wrapper": True})
    entry.__class__, part.__class__ = Entry, Part
    entry.part = part
    return entry


def compiled(
    function: Callable[..., Any],
    folder: Path | None,
    suffix: str,
    pipeline: type,
    result: type,
    options: dict[str, Any],
) -> Any:
    """numba's function of a kernel, kept in `folder`, in files with `suffix`, as `result` says."""
    previous = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    try:
        # numba reads the setting once, here; other libraries' kernels stay where they were.
        numba.config.CACHE_DIR = str(folder) if folder else previous  # type: ignore[attr-defined]
        made = numba.njit(cache=folder is not None, pipeline_class=pipeline, **options)(function)
    finally:
        numba.config.CACHE_DIR = previous  # type: ignore[attr-defined]
    made._compiler._customize_flags = KernelFlags  # type: ignore[attr-defined]
    if folder is not None:
        cache = made._cache  # type: ignore[attr-defined]
        cache._cache_file = KernelFile(str(folder), cache._impl.filename_base + suffix, "")
        cache._impl.__class__ = result
    return made


def chosen(variants: dict[type, Any]) -> Any:
    """A kernel that stands for one of `variants`, by the class of a record (a NamedTuple) among its arguments.

    Which one is known as soon as the types are, so that a caller holds the code of that one and of no other.
    """
    kernels = list(variants.values())
    if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]

        def call(*args: Any) -> Any:
            return next(variants[type(arg)] for arg in args if type(arg) in variants)(*args)

        return call
    choice: Any = numba.njit(kernels[0].py_func)
    choice.__class__ = Choice
    choice.variants = variants
    return choice


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
    """How many threads the calling thread's parallel kernels take. A kernel that set it could not be cached."""
    numba.set_num_threads(count)
