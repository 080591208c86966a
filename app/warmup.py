"""Compile kernels ahead, with a progress bar: `springtide warmup`, and the first start of each scene."""

import hashlib
from pathlib import Path

from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from app.pictures import picture_named
from app.scenes import NAMES, scene_named
from sim.jit import CACHE

# numba keeps the kernels of each installation apart, though all share the one directory.
PLACE = hashlib.sha256(str(Path(__file__).resolve().parent.parent).encode()).hexdigest()[:8]
# What stands for a compiled scene: with its drawing or without, and what serves for either.
MARKS = {True: (".warm",), False: (".headless.warm", ".warm")}


def warm_up() -> int:
    """Compile every scene's kernels and plan its transforms; returns the exit status."""
    for name in NAMES:
        compile_scene(name)
    print(f"Kept in {CACHE}" if CACHE else "Nothing could be kept: no cache directory is writable")
    return 0


def prepare(name: str, *, drawn: bool = True) -> None:
    """Compile a scene's kernels, and its drawing's, unless this version of them has been compiled before."""
    if CACHE is None or not any((CACHE / f"{name}-{PLACE}{mark}").exists() for mark in MARKS[drawn]):
        compile_scene(name, drawn=drawn)


def compile_scene(name: str, *, drawn: bool = True) -> None:
    columns = SpinnerColumn(), TextColumn("compiling {task.description} (once)"), TimeElapsedColumn()
    with Progress(*columns, transient=True) as progress:
        task = progress.add_task(name, total=None)
        for side in (scene_named(name), picture_named(name)) if drawn else (scene_named(name),):
            for part in side.warm_up():
                progress.update(task, description=f"{name}: {part}")
    if CACHE is not None:
        (CACHE / f"{name}-{PLACE}{MARKS[drawn][0]}").touch()
