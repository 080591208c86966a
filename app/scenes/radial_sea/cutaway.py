"""A window into the sea: a pit without water before a body, on whose far wall the layers are seen as they meet it."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

WAY = (-0.6, -0.8)  # unit vector from the far wall towards the viewer
HALF, LENGTH = 2.1, 7.0  # [m] at size 1: half the wall, and how far the near wall is
FAR, SIDE = 65, 40  # points of the far wall and of each other one, ends included
DEEP = 1.7  # [m] at size 1 of the floor below the mean level


class Section(NamedTuple):
    """The pit and what its walls cut: a closed line of points, the far wall first, from its right end as seen."""

    middle: tuple[float, float]  # [m] of the far wall
    half: float  # [m]
    way: tuple[float, float]
    length: float  # [m]
    floor: float  # [m] height
    points: NDArray[np.float64]  # (n, 2) [m]
    top: NDArray[np.float64]  # (n,) [m] height of the surface
    interface: NDArray[np.float64]  # (n,) [m] height of the water below the oil; the surface where there is none
    oiled: bool  # oil on water, rather than one fluid


def outline(middle: tuple[float, float], size: float) -> NDArray[np.float64]:
    """Points (n, 2) [m] around the pit whose far wall has this middle."""
    (x, y), (wx, wy) = middle, WAY
    half, length = HALF * size, LENGTH * size
    ends = [(half, 0.0), (-half, 0.0), (-half, length), (half, length), (half, 0.0)]
    walls = []
    for i, ((a, b), (c, d)) in enumerate(itertools.pairwise(ends)):
        share = np.linspace(0.0, 1.0, FAR if i == 0 else SIDE)[0 if i == 0 else 1 :]
        walls.append(np.column_stack([a + share * (c - a), b + share * (d - b)]))
    along, across = np.concatenate(walls).T
    return np.column_stack([x - wy * along + wx * across, y + wx * along + wy * across])


def section_at(
    middle: tuple[float, float], size: float, points: NDArray[np.float64], top: NDArray[np.float64],
    interface: NDArray[np.float64], oiled: bool,
) -> Section:  # fmt: skip
    """The pit about `middle` with heights (n,) [m] of surface and interface at its `outline`."""
    floor = min(-DEEP * size, float(interface.min()) - 0.5 * size) if len(top) else -DEEP * size
    if not math.isfinite(floor):
        floor = -DEEP * size
    return Section(middle, HALF * size, WAY, LENGTH * size, floor, points, top, np.minimum(interface, top), oiled)
