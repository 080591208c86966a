"""All that crosses a thread: commands to the simulation, snapshots from it. Both are immutable."""

import math
from typing import Any, NamedTuple

import numpy as np

from app.ledger import Works

Vector = tuple[float, float, float]

REACH = 100.0  # [m] from the origin: nothing from a browser is placed farther out


def finite_vector(values: Any, reach: float = REACH) -> Vector | None:
    """Three finite numbers within `reach`, or None where it is not three finite numbers."""
    try:
        x, y, z = (float(c) for c in values)
    except (TypeError, ValueError):
        return None
    if not all(math.isfinite(c) for c in (x, y, z)):
        return None
    return min(max(x, -reach), reach), min(max(y, -reach), reach), min(max(z, -reach), reach)


def where_not_finite(picture: Any, name: str = "") -> str:
    """Which part of a picture (records, tuples, float arrays) holds a NaN or an infinity; "" where none does."""
    if isinstance(picture, np.ndarray):
        return "" if picture.dtype.kind != "f" or np.isfinite(picture).all() else name or "an array"
    if isinstance(picture, float):
        return "" if math.isfinite(picture) else name or "a number"
    if isinstance(picture, tuple):
        names = getattr(picture, "_fields", (name,) * len(picture))
        for label, part in zip(names, picture, strict=True):
            where = where_not_finite(part, label)
            if where:
                return where
    return ""


class Play(NamedTuple):
    """Run on."""


class Pause(NamedTuple):
    """Hold still."""


class TogglePlay(NamedTuple):
    """Run on if still, hold still if running."""


class StepOnce(NamedTuple):
    """Hold still and advance by one time step."""


class Halt(NamedTuple):
    """Hold still because something went wrong, and say what."""

    reason: str


class Reset(NamedTuple):
    """Back to the start of the scene, parameters and camera kept."""


class Place(NamedTuple):
    """Put a named thing of the scene (its root, its sphere) at a position [m]."""

    thing: str
    position: Vector


class Grab(NamedTuple):
    """Pull a particle, by flat index, towards a target [m]."""

    particle: int
    target: Vector


class Release(NamedTuple):
    """Let go of the grabbed particle."""


class Point(NamedTuple):
    """Point at what lies on a ray: from `origin` [m] along `direction`."""

    origin: Vector
    direction: Vector


Command = Play | Pause | TogglePlay | StepOnce | Halt | Reset | Place | Grab | Release | Point


class Status(NamedTuple):
    """How the loop fares."""

    running: bool
    time: float  # [s] simulated
    steps: int
    speed: float  # target real-time factor
    actual: float  # real-time factor over the last second
    capped: bool  # time that could not be made up is being dropped
    solve: float  # [s] per frame spent solving
    rate: float  # frames per second published
    halted: str  # why the run stopped by itself, or ""


class Snapshot(NamedTuple):
    """One frame: what the scene shows (frozen, float32), how the loop fares, and numbers for the plots."""

    serial: int
    picture: Any
    status: Status
    gauge: Any
    samples: tuple[tuple[float, ...], ...]  # new plot rows, (t, ...) each
    work: Works  # what the scene did and what it skipped, since it was opened
    curves: Any = None  # knob -> columns of its chart, where a chart is not a course in time


class DivergenceError(Exception):
    """A run left any sane bound; the text says which h omega did it and which step would hold."""
