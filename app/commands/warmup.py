"""`springtide warmup`: compile every kernel and plan every transform, with progress."""

from rich import get_console

from app.scenes import NAMES
from app.scenes.warmup import all_pieces, compile_here
from sim.jit import CACHE


def warm_up() -> int:
    """Compile every scene's kernels and plan its transforms; returns the exit status."""
    is_terminal = get_console().is_terminal
    for name in NAMES:
        if not is_terminal:
            print(f"Compiling {name}", flush=True)
        compile_here(name, all_pieces(name), lambda text: None)
    print(f"Kept in {CACHE}" if CACHE else "Nothing could be kept: no cache directory is writable")
    return 0
