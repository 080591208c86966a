"""A frame of the square sea against the bare transforms that it needs, in turns."""

from collections.abc import Callable
from typing import Any

from benchmarks.timing import median_times
from sim.ocean import Sea
from sim.ocean.tile.transforms import Transforms

QUICK_REPEATS, REPEATS = 60, 400


def rows(quick: bool) -> list[dict[str, Any]]:
    """Rows with name, size, ms (median), ratio_to_fft (to the bare transforms of the same row), transforms.

    Single precision, one thread. The bare transforms run with the sea's own measured plan, from as many spectra and
    into as many grids as the frame uses.
    """
    found = []
    for size in (128, 256) if quick else (64, 128, 256, 512):
        found += [row(name, size, fields, QUICK_REPEATS if quick else REPEATS) for name, fields in FRAMES.items()]
    return found


FRAMES: dict[str, tuple[str, ...]] = {
    "height": ("height",),
    "height, displacement": ("height", "displacement"),
    "height, displacement, slope": ("height", "displacement", "slope"),
    "height, displacement, jacobian": ("height", "displacement", "jacobian"),
    "height, displacement, viscous": ("height", "displacement"),
    "height, displacement, rings": ("height", "displacement"),
}


def row(name: str, size: int, fields: tuple[str, ...], repeats: int) -> dict[str, Any]:
    """Time one kind of frame against its transforms."""
    viscosity = 1e-6 if name.endswith("viscous") else 0.0
    sea = Sea(size=size, length=500.0, viscosity=viscosity, choppiness=1.0 if len(fields) > 1 else 0.0)
    if name.endswith("rings"):
        sea.ripples.add(0.0, [[250.0, 250.0]], width=4.0, volume=1.0)
    times = iter(range(1, 10**9))

    def frame() -> None:
        surface = sea.surface(next(times) / 60.0)
        for field in fields:
            getattr(surface, field)

    frame()
    before = sea.transforms.count
    frame()
    count = sea.transforms.count - before
    bare = bare_transforms(sea, count)
    ours, transforms = median_times((frame, bare), repeats)
    return {"name": name, "size": size, "ms": ours * 1e3, "ratio_to_fft": ours / transforms, "transforms": count}


def bare_transforms(sea: Sea, count: int) -> Callable[[], None]:
    """`count` transforms by the sea's own plan, each with its own spectrum and grid (all zero: c2r eats its input)."""
    sets = [Transforms(sea.size, sea.precision) for _ in range(count)]
    grids = [each.grids.take(1)[0] for each in sets]

    def bare() -> None:
        for each, grid in zip(sets, grids, strict=True):
            each.set_grid(grid)

    return bare
