"""Folders of caches: compiled kernels and plans of transforms.

The user's folder comes first. Others are read and never written: those that `SPRINGTIDE_KERNELS` lists, that of the
distribution `springtide-kernels`, and that of the installation, which `springtide warmup --into` fills. All of them
look alike: `kernels/PROCESSOR` and the plans beside.
Kernels are made for this processor, or for a level that many processors have; see `LEVELS`. Loading one runs its code,
so a shared folder has to belong to someone whose programs one would run.
"""

import hashlib
import importlib.util
import os
import platform
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import llvmlite.binding as llvm
import numba
import platformdirs

from sim.validation import argument_error

INSTALLED = Path(sys.prefix) / "share" / "springtide"  # the folder of the installation
PACKAGE = "springtide_kernels"  # of the distribution `springtide-kernels`, which `.ci/kernels.py` makes
SHARED_VARIABLE = "SPRINGTIDE_KERNELS"
# Intel's library of vector functions: kernels that call it do not load where it is absent.
VECTOR_LIBRARY = "-svml" if getattr(numba.config, "USING_SVML", False) else ""  # type: ignore[attr-defined]


class Level(NamedTuple):
    """Common features of a family of processors. A newer one of the family has more."""

    machines: tuple[str, ...]  # as `platform.machine` names them, in small letters
    cpu: str  # LLVM's name
    features: tuple[str, ...]  # LLVM's names of what a processor needs
    tuning: str = ""  # LLVM's words on how to use them


_V3 = (
    "avx", "avx2", "bmi", "bmi2", "cx16", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sahf", "sse3", "sse4.1",
    "sse4.2", "ssse3", "xsave",
)  # fmt: skip

# From the richest to the poorest. Source: System V ABI, AMD64 supplement, table 3.1.
LEVELS = {
    "x86-64-v4": Level(
        ("x86_64", "amd64"),
        "x86-64-v4",
        (*_V3, "avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl"),
        # LLVM's vectors of this level have half the width of the processor's, and are as slow as those of v3.
        "-prefer-256-bit",
    ),
    "x86-64-v3": Level(("x86_64", "amd64"), "x86-64-v3", _V3),
    "arm64": Level(("arm64", "aarch64"), "generic", ()),
}


def host_features() -> dict[str, bool]:
    """Features of this processor, by LLVM's names; empty if LLVM cannot tell."""
    try:
        return dict(llvm.get_host_cpu_features())
    except RuntimeError:
        return {}


def host_levels() -> tuple[str, ...]:
    """The levels that this processor has, from the richest to the poorest."""
    machine, has = platform.machine().lower(), host_features()
    return tuple(
        name
        for name, level in LEVELS.items()
        if machine in level.machines and all(has.get(feature) for feature in level.features)
    )


def level_environment(name: str) -> dict[str, str]:
    """Environment in which numba compiles for a level. Raises ValueError if this processor does not have it."""
    if name not in host_levels():
        raise argument_error("--processor", name, "what this processor has: " + (", ".join(host_levels()) or "none"))
    return {"NUMBA_CPU_NAME": LEVELS[name].cpu, "NUMBA_CPU_FEATURES": LEVELS[name].tuning}


def processor() -> str:
    """Name of the processor that numba compiles for: a level, or all that numba knows of this one."""
    return f"{target_name()}{VECTOR_LIBRARY}"


def target_name() -> str:
    """The same without the vector library that kernels call."""
    cpu, features = numba.config.CPU_NAME, numba.config.CPU_FEATURES  # type: ignore[attr-defined]
    for name, level in LEVELS.items():
        if (cpu, features) == (level.cpu, level.tuning):
            return f"{sys.platform}-{name}"
    known = (
        llvm.get_process_triple(),
        cpu or llvm.get_host_cpu_name(),
        sorted(host_features().items()) if features is None else features,
        bool(numba.config.ENABLE_AVX),  # type: ignore[attr-defined]
    )
    name = re.sub(r"\W", "-", known[1])
    return f"{sys.platform}-{name}-{hashlib.sha256(repr(known).encode()).hexdigest()[:8]}"


def own_folder() -> Path:
    """The user's folder, which may not exist."""
    return user_folder("SPRINGTIDE_CACHE", platformdirs.user_cache_dir)


def user_folder(variable: str, folder_of: Callable[[str], str]) -> Path:
    """The folder that an environment variable names, else that of platformdirs for this program.

    Without a home folder (a container with a user of any number) it is one that cannot be made: then nothing is kept.
    """
    try:
        return Path(os.environ.get(variable) or folder_of("springtide"))
    except RuntimeError:
        return Path(os.devnull, "springtide")


def packaged_folders() -> list[Path]:
    """The folder of the distribution `springtide-kernels`, if it is installed."""
    package = importlib.util.find_spec(PACKAGE)
    return [Path(folder) for folder in (package and package.submodule_search_locations) or ()]


def shared_folders() -> tuple[Path, ...]:
    """Folders to read from: of `SPRINGTIDE_KERNELS`, of `springtide-kernels`, of the installation.

    None if the variable is empty.
    """
    named = os.environ.get(SHARED_VARIABLE)
    if named == "":
        return ()
    folders = [*map(Path, filter(None, (named or "").split(os.pathsep))), *packaged_folders(), INSTALLED]
    return tuple(folder for folder in dict.fromkeys(folders) if folder != own_folder())


def shared_kernels() -> tuple[Path, ...]:
    """Folders of kernels for this processor and for its levels, in the order in which they are looked for."""
    levels = (f"{sys.platform}-{level}{VECTOR_LIBRARY}" for level in host_levels())
    names = dict.fromkeys([processor(), *levels])
    folders = (folder / "kernels" / name for folder in shared_folders() for name in names)
    return tuple(folder for folder in folders if folder.is_dir())
