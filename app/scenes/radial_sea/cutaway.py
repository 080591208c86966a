"""A cutaway of the sea: a box without water beside a body, so that its far wall shows the layers where they meet it."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

DIRECTION = (-0.6, -0.8)  # unit vector from the far wall towards the viewer
HALF_WIDTH, LENGTH = 2.1, 7.0  # [m] at size 1: half the far wall, and its distance from the near wall
FAR_WALL_POINTS, WALL_POINTS = 65, 40  # along the far wall and along each other wall, ends included
FLOOR_DEPTH = 1.7  # [m] at size 1 of the floor below the mean level
MIN_WATER_DEPTH = 0.5  # [m] at size 1 from the lowest point of the interface to the floor


class Cutaway(NamedTuple):
    """The box, and its outline on the surface: a closed line, the far wall first, from its right end as seen."""

    middle: tuple[float, float]  # [m] of the far wall
    half_width: float  # [m] of the far wall
    direction: tuple[float, float]  # unit vector from the far wall to the near one
    length: float  # [m] between those walls
    floor: float  # [m] height
    points: NDArray[np.float64]  # (n, 2) [m]
    top: NDArray[np.float64]  # (n,) [m] height of the surface
    interface: NDArray[np.float64]  # (n,) [m] height of the water below the oil; the surface if there is no oil
    has_oil: bool  # oil on water, rather than one fluid


def outline(middle: tuple[float, float], size: float) -> NDArray[np.float64]:
    """Points (n, 2) [m] around the box. Its far wall has this middle [m]; it suits bodies of this size."""
    (x, y), (dx, dy) = middle, DIRECTION
    half, length = HALF_WIDTH * size, LENGTH * size
    corners = [(half, 0.0), (-half, 0.0), (-half, length), (half, length), (half, 0.0)]
    walls = []
    for i, ((a, b), (c, d)) in enumerate(itertools.pairwise(corners)):
        share = np.linspace(0.0, 1.0, FAR_WALL_POINTS if i == 0 else WALL_POINTS)[0 if i == 0 else 1 :]
        walls.append(np.column_stack([a + share * (c - a), b + share * (d - b)]))
    along, across = np.concatenate(walls).T
    return np.column_stack([x - dy * along + dx * across, y + dx * along + dy * across])


def cutaway_at(
    middle: tuple[float, float], size: float, points: NDArray[np.float64], top: NDArray[np.float64],
    interface: NDArray[np.float64], has_oil: bool,
) -> Cutaway:  # fmt: skip
    """The cutaway about `middle` [m] with heights (n,) [m] of surface and interface at its `outline` (n, 2) [m]."""
    floor = min(-FLOOR_DEPTH * size, float(interface.min()) - MIN_WATER_DEPTH * size) if len(top) else math.nan
    if not math.isfinite(floor):
        floor = -FLOOR_DEPTH * size
    interface = np.minimum(interface, top)
    return Cutaway(middle, HALF_WIDTH * size, DIRECTION, LENGTH * size, floor, points, top, interface, has_oil)
