"""A frame of the square sea as a task of peers."""

import functools
from collections.abc import Sequence

import numpy as np

from app.formats.text_tables import Rows
from benchmarks.peers.ladder import Task, tables
from benchmarks.peers.own_runs import OwnRun, OwnRuns
from benchmarks.peers.sea import PEERS, PRECISIONS, TIME, extended
from benchmarks.reference import Reference
from sim.ocean import Sea


def peer_task(size: int, _: str) -> Task:
    """Height and displacement of a sea at a new time, and our own frames in both precisions.

    An error is the largest distance of any point of the surface from the same sums in extended precision. It is
    round-off, which differs a little from one order of sums to another: within a factor of two it counts as equal.
    """
    seas = {
        precision: Sea(size=size, length=500.0, spectrum="phillips", precision=precision) for precision in PRECISIONS
    }
    truth = Reference((extended(seas["double"], TIME),), float(np.finfo(np.longdouble).eps))
    own = [[OwnRun("frame", f"{name} precision", functools.partial(ours_at, sea))] for name, sea in seas.items()]
    for (frame,) in own:
        frame.run()  # plans the transforms
    return Task(seas["double"], (TIME,), OwnRuns(own, truth, equal=2.0))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers; quick: one size."""
    return tables("S", (256, 512), PEERS, peer_task, words, quick)


def ours_at(sea: Sea) -> tuple[np.ndarray]:
    """Height and both displacements (3, N, N) [m] at the peers' time, recomputed."""
    sea.surface(0.0)  # the sea keeps the fields of the latest time
    surface = sea.surface(TIME)
    displacement = surface.displacement
    return (np.stack([surface.height, displacement[..., 0], displacement[..., 1]]),)
