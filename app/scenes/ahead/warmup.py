"""Compiling ahead: the pieces of each scene, and a marker file for each compiled piece."""

import functools
import gc
from collections.abc import Callable, Iterable

from app.messages import BaseParams
from app.scenes import scene_named, view_named
from sim.jit import ROOT, is_kept, keep, reachable_hash

EVERYTHING = "everything"  # stands for all pieces of a scene, so that a later start need not ask it for them


@functools.cache
def hash_of(name: str, drawn: bool) -> str:
    """Hash of all sources that a scene's kernels, and its drawing's, can reach."""
    folder = ROOT / "app" / "scenes" / name
    return reachable_hash(folder / "scene.py", *([folder / "view.py"] if drawn else []))


def mark_of(name: str, piece: str, *, drawn: bool) -> str:
    """Name of the file that stands for a compiled piece. drawn: of the drawing."""
    kind = "drawn" if drawn else "headless"
    return f"{name}-{kind}-{piece.replace(' ', '_')}-{hash_of(name, drawn)}.warm"


def is_marked(name: str, piece: str, *, drawn: bool) -> bool:
    """True if this version of a piece has been compiled before, here or into a folder that is only read."""
    return is_kept(mark_of(name, piece, drawn=drawn))


def all_pieces(name: str) -> tuple[tuple[str, bool], ...]:
    """(piece, whether it is of the drawing) of a scene, those of the drawing last.

    None of these takes long: where two processes share the pieces, both come to their end at about the same time.
    """
    drawing = ((piece, True) for piece in view_named(name).WARM_UP)
    return *((piece, False) for piece in scene_named(name).warm_up()), *drawing


def missing(name: str, params: BaseParams | None = None) -> tuple[tuple[str, bool], ...]:
    """Pieces of `all_pieces` still to be compiled. params: only those that run with these parameters; None: all.

    A scene that is compiled as a whole is not imported for that.
    """
    if params is None and is_marked(name, EVERYTHING, drawn=True):
        return ()
    needs = scene_named(name).needs
    needed = None if params is None or needs is None else needs(params)
    ahead = () if is_marked(name, EVERYTHING, drawn=True) else all_pieces(name)
    wanted = [(piece, drawn) for piece, drawn in ahead if drawn or needed is None or piece in needed]
    if needed is not None:
        wanted = [(piece, False) for piece in scene_named(name).warm_up_on_use() if piece in needed] + wanted
    return tuple((piece, drawn) for piece, drawn in wanted if not is_marked(name, piece, drawn=drawn))


def compile_piece(name: str, piece: str, *, drawn: bool) -> None:
    """Compile one piece, and remember it."""
    kind = scene_named(name)
    # A compiler makes many objects that stay: looking through all of them again and again takes a fifth of the time.
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        pieces = view_named(name).WARM_UP if drawn else {**kind.warm_up_on_use(), **kind.warm_up()}
        pieces[piece]()
    finally:
        if was_enabled:
            gc.enable()
    keep(mark_of(name, piece, drawn=drawn))
    # The drawing, and with it viser, is asked only where all else is compiled.
    done = all(is_marked(name, other, drawn=False) for other in kind.warm_up())
    if done and all(is_marked(name, other, drawn=True) for other in view_named(name).WARM_UP):
        keep(mark_of(name, EVERYTHING, drawn=True))


def compile_here(name: str, pieces: Iterable[tuple[str, bool]], show: Callable[[str], None]) -> None:
    """Compile pieces in this process. show: told which comes next, as text; on a terminal it is shown there too."""
    from rich import get_console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TextColumn("compiling {task.description} (once)"), TimeElapsedColumn()
    with Progress(*columns, transient=True, disable=not get_console().is_terminal) as progress:
        task = progress.add_task(name, total=None)
        for piece, drawn in pieces:
            progress.update(task, description=f"{name}: {piece}")
            show(f"{name}: {piece}")
            compile_piece(name, piece, drawn=drawn)


def prepare(name: str, *, drawn: bool = True) -> None:
    """Compile the kernels of a scene that are not compiled yet. drawn: those of its drawing, too."""
    pieces = all_pieces(name) if drawn else tuple((piece, False) for piece in scene_named(name).warm_up())
    todo = [(piece, of_drawing) for piece, of_drawing in pieces if not is_marked(name, piece, drawn=of_drawing)]
    if todo:
        compile_here(name, todo, lambda text: None)
