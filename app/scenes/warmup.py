"""Compile a scene's kernels ahead, and remember which scenes are compiled."""

from collections.abc import Callable, Iterator
from pathlib import Path

from app.scenes import scene_named
from sim.jit import CACHE, ROOT, reachable_hash


def mark_of(name: str, drawn: bool) -> Path | None:
    """The file that stands for a compiled scene, with its drawing or without; None where nothing can be kept."""
    if CACHE is None:
        return None
    folder = ROOT / "app" / "scenes" / name
    sources = [folder / "scene.py", *([folder / "view.py"] if drawn else [])]
    return CACHE / f"{name}{'' if drawn else '-headless'}-{reachable_hash(*sources)}.warm"


def is_compiled(name: str, *, drawn: bool = True) -> bool:
    """Whether this version of a scene's kernels, and its drawing's, has been compiled before."""
    marks = (mark_of(name, True), None if drawn else mark_of(name, False))
    return any(mark is not None and mark.exists() for mark in marks)


def parts(name: str, *, drawn: bool = True) -> Iterator[str]:
    """Compile piece by piece; yields what comes next."""
    yield from scene_named(name).warm_up()
    if drawn:
        from app.scenes import view_module

        yield from view_module(name).warm_up()


def compile_scene(name: str, *, drawn: bool = True, show: Callable[[str], None] = lambda part: None) -> None:
    """Compile a scene's kernels. drawn: and its drawing's. show: told what comes next, beside the terminal."""
    from rich import get_console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TextColumn("compiling {task.description} (once)"), TimeElapsedColumn()
    with Progress(*columns, transient=True, disable=not get_console().is_terminal) as progress:
        task = progress.add_task(name, total=None)
        for part in parts(name, drawn=drawn):
            progress.update(task, description=f"{name}: {part}")
            show(part)
    mark = mark_of(name, drawn)
    if mark is not None:
        mark.touch()


def prepare(name: str, *, drawn: bool = True) -> None:
    """Compile a scene's kernels unless that has been done before."""
    if not is_compiled(name, drawn=drawn):
        compile_scene(name, drawn=drawn)
