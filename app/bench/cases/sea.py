"""A frame of the square sea against the bare transforms that it needs, in turns."""

from collections.abc import Callable
from typing import Any

import numpy as np

from app.bench.peers.record import is_installed
from app.bench.peers.sea import PEERS, student
from app.bench.timing import median_times
from sim.ocean import Sea
from sim.ocean.transforms import Transforms

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


def peer_rows(quick: bool) -> list[dict[str, Any]]:
    """Height and displacement at a new time, by us and by each peer that is installed, in turns.

    ms: median. times as long: as our single precision. error: the largest difference from a double-precision frame over
    the standard deviation of the heights; empty for a peer that draws another sea.
    """
    found = []
    for size in (256,) if quick else (256, 512):
        sea = Sea(size=size, length=500.0, spectrum="phillips")
        truth = student(Sea(size=size, length=500.0, spectrum="phillips", precision="double"))
        installed = [peer for peer in PEERS if is_installed(peer.package)]
        frames: dict[str, Callable[[float], Any]] = {"ours": lambda t, sea=sea: ours_at(sea, t)}
        frames |= {peer.name: peer.make(sea) for peer in installed}
        exact = truth(5.0)
        errors = {name: error(frame(5.0), exact) for name, frame in frames.items()}
        times = median_times(tuple(map(running, frames.values())), 12 if quick else 60)
        for name, seconds in zip(frames, times, strict=True):
            found.append(
                {
                    "peer": name,
                    "size": size,
                    "ms": seconds * 1e3,
                    "times as long": seconds / times[0],
                    "error": errors[name],
                }
            )
        found += [{"peer": f"{p.name} (not installed)", "size": size} for p in PEERS if p not in installed]
    return found


def running(frame: Callable[[float], Any]) -> Callable[[], Any]:
    """A call that computes the frame at a new time each time."""
    times = iter(range(1, 10**9))
    return lambda: frame(next(times) / 60.0)


def ours_at(sea: Sea, t: float) -> tuple[np.ndarray, ...]:
    """Height and both displacements, (N, N) [m] each."""
    surface = sea.surface(t)
    displacement = surface.displacement
    return surface.height, displacement[..., 0], displacement[..., 1]


def error(frame: Any, exact: np.ndarray) -> float:
    """Largest difference from the exact fields over the standard deviation of the heights; NaN where not comparable."""
    if frame is None:
        return float("nan")
    return max(float(np.abs(a - b).max()) for a, b in zip(frame, exact, strict=True)) / float(exact[0].std())


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
