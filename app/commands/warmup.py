"""`springtide warmup`: compile every kernel and plan every transform, with progress."""

from app.scenes import NAMES
from app.scenes.warmup import compile_scene
from sim.jit import CACHE


def warm_up() -> int:
    """Compile every scene's kernels and plan its transforms; returns the exit status."""
    for name in NAMES:
        compile_scene(name)
    print(f"Kept in {CACHE}" if CACHE else "Nothing could be kept: no cache directory is writable")
    return 0
