"""Balls that are near to each other, by a spatial hash: each is about some parts of a net."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel


class Buckets(NamedTuple):
    """Balls sorted by the cells of space that their middles are in."""

    cells: NDArray[np.int64]  # (3, balls)
    order: NDArray[np.int64]  # (balls,) their numbers, by buckets
    starts: NDArray[np.int64]  # (buckets + 2,) where each bucket starts in `order`, from 1 on


@kernel(inline=True)
def cell(x, inverse):
    return np.int64(math.floor(x * inverse))


@kernel(inline=True)
def bucket(cx, cy, cz, mask):
    """Teschner's hash of a cell (VMV 2003), to a power of two of buckets."""
    return ((cx * 73856093) ^ (cy * 19349663) ^ (cz * 83492791)) & mask


@kernel
def sort_balls(balls, reach):
    """The `Buckets` of balls, (4, count): middle and radius [m], in cells as wide as two balls may be apart within
    reach [m]."""
    count, largest, mask = balls.shape[1], 0.0, 1
    for a in range(count):
        largest = max(largest, balls[3, a])
    inverse = 1.0 / (2.0 * largest + reach)
    while mask < count:
        mask *= 2
    mask -= 1
    cells, where, order = np.empty((3, count), np.int64), np.empty(count, np.int64), np.empty(count, np.int64)
    starts = np.zeros(mask + 3, np.int64)
    for a in range(count):
        for e in range(3):
            cells[e, a] = cell(balls[e, a], inverse)
        where[a] = bucket(cells[0, a], cells[1, a], cells[2, a], mask)
        starts[where[a] + 1] += 1
    for q in range(mask + 1):
        starts[q + 1] += starts[q]
    starts[mask + 2] = count
    for a in range(count - 1, -1, -1):
        starts[where[a] + 1] -= 1
        order[starts[where[a] + 1]] = a
    return Buckets(cells, order, starts)


@kernel(inline=True)
def balls_meet(first, a, second, b, reach):
    """True if ball a of one array and ball b of another are nearer to each other than `reach` [m]."""
    dx, dy, dz = second[0, b] - first[0, a], second[1, b] - first[1, a], second[2, b] - first[2, a]
    most = first[3, a] + second[3, b] + reach
    return dx * dx + dy * dy + dz * dz < most * most


@kernel
def balls_near(balls, buckets, a, reach, beside):
    """Fill `beside` (count,) with the balls, from a on, that are nearer to ball a than `reach` [m], itself included.

    They are in order, so that sums over near things do not depend on when a list of them was made. Returns their
    number. reach: at most that of `sort_balls`.
    """
    found, mask, cells = 0, buckets.starts.shape[0] - 3, buckets.cells
    for near in range(27):
        cx, cy, cz = cells[0, a] + near // 9 - 1, cells[1, a] + near // 3 % 3 - 1, cells[2, a] + near % 3 - 1
        q = bucket(cx, cy, cz, mask)
        for s in range(buckets.starts[q + 1], buckets.starts[q + 2]):
            b = buckets.order[s]
            # Two cells of the 27 may share a bucket: take a ball from the cell that it is in.
            is_here = cells[0, b] == cx and cells[1, b] == cy and cells[2, b] == cz
            if b >= a and is_here and balls_meet(balls, a, balls, b, reach):
                beside[found] = b
                found += 1
    beside[:found].sort()
    return found
