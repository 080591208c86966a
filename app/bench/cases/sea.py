"""A frame of the square sea against the bare transforms that it needs, in turns."""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from app.bench.own_runs import OwnRun, OwnRuns, Reference
from app.bench.peers.ladder import Task
from app.bench.peers.ladder import tables as peer_ladders
from app.bench.peers.sea import PEERS, PRECISIONS, extended
from app.bench.timing import median_times
from app.experiments.tables import Rows
from sim.ocean import Sea
from sim.ocean.transforms import Transforms

QUICK_REPEATS, REPEATS = 60, 400
PEER_TIME = 5.0  # [s] of the frame that peers compute


def rows(quick: bool) -> list[dict[str, Any]]:
    """Rows with name, size, ms (median), ratio_to_fft (to the bare transforms of the same row), transforms.

    Single precision, one thread. The bare transforms run with the sea's own measured plan, from as many spectra and
    into as many grids as the frame uses.
    """
    found = []
    for size in (128, 256) if quick else (64, 128, 256, 512):
        found += [row(name, size, fields, QUICK_REPEATS if quick else REPEATS) for name, fields in FRAMES.items()]
    return found


def peer_task(size: int, _: str) -> Task:
    """Height and displacement of a sea at a new time, and our own frames in both precisions.

    An error is the largest distance of any point of the surface from the same sums in extended precision. It is
    round-off, which differs a little from one order of sums to another: within a factor of two it counts as equal.
    """
    seas = {
        precision: Sea(size=size, length=500.0, spectrum="phillips", precision=precision) for precision in PRECISIONS
    }
    truth = Reference((extended(seas["double"], PEER_TIME),), float(np.finfo(np.longdouble).eps))
    own = [[OwnRun("frame", f"{name} precision", functools.partial(ours_at, sea))] for name, sea in seas.items()]
    for (frame,) in own:
        frame.run()  # plans the transforms
    return Task(seas["double"], (PEER_TIME,), OwnRuns(own, truth, equal=2.0))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers; quick: one size."""
    return peer_ladders("S", (256, 512), PEERS, peer_task, words, quick)


def ours_at(sea: Sea) -> tuple[np.ndarray]:
    """Height and both displacements (3, N, N) [m] at the peers' time, computed anew."""
    sea.surface(0.0)  # the sea keeps the fields of the latest time
    surface = sea.surface(PEER_TIME)
    displacement = surface.displacement
    return (np.stack([surface.height, displacement[..., 0], displacement[..., 1]]),)


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
