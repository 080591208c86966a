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

__all__ = ["CACHE", "MAX_THREADS", "kernel", "prange", "set_threads"]

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

    def save(self, key: Any, data: Any) -> None:
        with contextlib.suppress(OSError):  # a full disk: kept another time
            try:
                super().save(key, data)
            except OSError:
                raise
            except Exception:  # the index is rubbish: an empty one
                self.flush()
                super().save(key, data)


class KernelResult(CompileResultCacheImpl):
    """numba's reading of a kept kernel, which also tells its callers what it needs.

    A kernel that calls a parallel one keeps with it that the threads are to be started as it is loaded. numba hands
    that on from callee to caller as both are compiled, but forgets it of a callee that came from the cache: the caller,
    kept in its turn, would end the program that loads it first ("Symbol not found: allocate_sched").
    """

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        result = super().rebuild(target_context, payload)
        result.library._reload_init.update(result.reload_init)
        return result


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
    }
    if noalias and _HAS_NOALIAS:
        options["noalias"] = True
    folder = kernel_folder(Path(function.__code__.co_filename).resolve())
    previous = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    try:
        # numba reads the setting once, here; other libraries' kernels stay where they were.
        numba.config.CACHE_DIR = str(folder) if folder else previous  # type: ignore[attr-defined]
        compiled = numba.njit(cache=folder is not None, **options)(function)
    finally:
        numba.config.CACHE_DIR = previous  # type: ignore[attr-defined]
    if folder is not None and hasattr(compiled, "_cache"):  # a plain function with NUMBA_DISABLE_JIT=1
        cache = compiled._cache  # type: ignore[attr-defined]
        cache._cache_file = KernelFile(str(folder), cache._impl.filename_base, "")
        cache._impl.__class__ = KernelResult
    return compiled


def set_threads(count: int) -> None:
    """How many threads the calling thread's parallel kernels take. A kernel that set it could not be cached."""
    numba.set_num_threads(count)
