"""Half spectrum to grid: one complex-to-real FFT plan a size and precision, made once, its wisdom kept on disk.

pyfftw is imported here and only when the first plan is made. No 1/N^2: the grid is the plain sum of its waves.
"""

import base64
import binascii
import json
from pathlib import Path
from typing import Any

import numpy as np

from sim.cache import own_folder, shared_folders
from sim.files import replacing
from sim.ocean.tile.buffer_pool import BufferPool

PRECISIONS: dict[str, tuple[type[np.floating[Any]], type[np.complexfloating[Any, Any]]]] = {
    "single": (np.float32, np.complex64),
    "double": (np.float64, np.complex128),
}

_loaded: set[Path] = set()


class Transforms:
    """The transform of one grid size. Not for two threads at once."""

    def __init__(self, size: int, precision: str) -> None:
        import pyfftw

        real, complex_ = PRECISIONS[precision]
        self.count = 0  # transforms run so far
        self.spectrum = pyfftw.zeros_aligned((size, size // 2 + 1), dtype=complex_)  # input; destroyed by each run
        self.grids = BufferPool(size, real)
        self._plan = make_plan(self.spectrum, self.grids.take(1)[0], (0, 1), "FFTW_BACKWARD", "FFTW_DESTROY_INPUT")
        self.spectrum[...] = 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the size and the precision: plans belong to a process."""
        precision = next(name for name, (real, _) in PRECISIONS.items() if real is self.grids.real)
        return Transforms, (self.grids.size, precision), {"count": self.count}

    def set_grid(self, grid: np.ndarray) -> None:
        """`spectrum` as the sum of its waves on `grid` (size, size); the spectrum is overwritten."""
        import pyfftw

        # Planes of a size that is no multiple of 4 do not all begin at the alignment of vector instructions.
        aligned = grid if pyfftw.is_byte_aligned(grid) else self.grids.take(1)[0]
        self._plan.update_arrays(self.spectrum, aligned)
        self._plan.execute()
        self.count += 1
        if aligned is not grid:
            grid[...] = aligned


def make_plan(source: np.ndarray, target: np.ndarray, axes: tuple[int, ...], direction: str, *flags: str) -> Any:
    """The plan from wisdom if available, else one that is measured now (up to a second) and remembered.

    Measuring overwrites both arrays. direction: FFTW_FORWARD or FFTW_BACKWARD; flags: FFTW's.
    """
    import pyfftw

    path, *others = wisdom_paths()
    if path not in _loaded:
        for each in (*others, path):
            load_wisdom(each)
        _loaded.add(path)
    options: dict[str, Any] = {"axes": axes, "direction": direction, "threads": 1}
    flags = ("FFTW_MEASURE", *flags)
    try:
        return pyfftw.FFTW(source, target, flags=(*flags, "FFTW_WISDOM_ONLY"), **options)
    except RuntimeError:  # pyfftw's way to say that there is no wisdom for this plan
        plan = pyfftw.FFTW(source, target, flags=flags, **options)
        save_wisdom(path)
        return plan


def wisdom_paths() -> list[Path]:
    """Paths of FFTW's wisdom, beside the compiled kernels: the user's, and those that are only read."""
    return [folder / "fftw-wisdom.json" for folder in (own_folder(), *shared_folders())]


def load_wisdom(path: Path) -> bool:
    """Load FFTW's wisdom from `path`. Returns False if the file is missing, unreadable or no wisdom."""
    import pyfftw

    try:
        texts = [base64.b64decode(text, validate=True) for text in json.loads(path.read_text("utf-8"))["wisdom"]]
    except (OSError, ValueError, KeyError, TypeError, binascii.Error):
        return False
    if len(texts) != 3 or not all(text.isascii() for text in texts):
        return False
    return any(pyfftw.import_wisdom(tuple(texts)))


def save_wisdom(path: Path) -> bool:
    """Write FFTW's wisdom to `path`, in one step. Returns False if it cannot be written there."""
    import pyfftw

    text = json.dumps({"wisdom": [base64.b64encode(w).decode() for w in pyfftw.export_wisdom()]})
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as draft:
            draft.write_text(text, "utf-8")
    except OSError:
        return False
    return True
