"""Pairs of a net's parts that are near to each other: particles or, of a chain, links.

They are found by a spatial hash and kept while nothing has moved by half of what they were looked for beyond the
thickness (Verlet's list), so that a force evaluation only runs over a short list. Neighbours along the net do not push
each other: those that links hold, and those with less than pi/2 thicknesses of the net between them at rest. That much
lies between the two sides of the tightest fold, a half circle as wide as the thickness. The list of a chain has them
too, except links with a common point: they must not pass each other (`sim.springs.kicks.apart`).
"""

import math
from typing import Any

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.points.arrays import by_net
from sim.springs.points.link_pairs import pair_at
from sim.springs.points.link_places import longest

UNASKED = 64  # particles or links between two looks at whether the search is to end
SKIN = 0.5  # of the thickness: how far pairs are looked for beyond it, so that the list of them lasts
NEIGHBOURS = 2  # rows and columns apart, within which a pair is held by links and never pushes


@kernel(inline=True)
def reach_of(p):
    """Distance [m] within which pairs are looked for."""
    return (1.0 + SKIN) * p.thickness


@kernel(inline=True)
def particle_place(x, p, i):
    n = p.rows * p.cols
    return x[i], x[n + i], x[2 * n + i]


@kernel(inline=True)
def middle_place(x, p, i):
    n = p.cols
    return 0.5 * (x[i] + x[i + 1]), 0.5 * (x[n + i] + x[n + i + 1]), 0.5 * (x[2 * n + i] + x[2 * n + i + 1])


@kernel(inline=True)
def are_near_on_grid(p, a, b):
    i, j = abs(b // p.cols - a // p.cols), abs(b % p.cols - a % p.cols)
    if i <= NEIGHBOURS and j <= NEIGHBOURS:
        return True
    fold = 0.5 * math.pi * p.thickness
    return (i * p.row_spacing) ** 2 + (j * p.col_spacing) ** 2 < fold * fold


@kernel(inline=True)
def are_near_on_chain(p, a, b):
    return abs(b - a) < 2 or (abs(b - a) - 1) * p.col_spacing < 0.5 * math.pi * p.thickness


@kernel(inline=True)
def particle_distance(x, p, a, b):
    n = p.rows * p.cols
    dx, dy, dz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


def by_parts(particles: Any, links: Any) -> Any:
    """A kernel for nets whose particles touch, and for chains, whose links do."""
    return by_net(rope=links, grid=particles, strand=links)


part_count = by_parts(
    particles=kernel(lambda p: p.rows * p.cols, inline=True), links=kernel(lambda p: p.cols - 1, inline=True)
)  # fmt: skip
place_of = by_parts(particles=particle_place, links=middle_place)
# Largest distance [m] between the places of two parts that are nearer to each other than `reach`.
place_reach = by_parts(
    particles=kernel(lambda x, p, reach: reach, inline=True),
    links=kernel(lambda x, p, reach: reach + math.sqrt(longest(x, np.uint64(p.cols))), inline=True),
)
# True if parts a and b are neighbours along the net, which do not push each other.
are_neighbours = by_parts(particles=are_near_on_grid, links=are_near_on_chain)
# True if they are not listed.
are_joined = by_parts(
    particles=are_near_on_grid, links=kernel(lambda p, a, b: abs(b - a) < 2, inline=True)
)  # fmt: skip
distance_of = by_parts(
    particles=particle_distance,
    links=kernel(lambda x, p, a, b: pair_at(x, p.cols, a, b).distance, inline=True),
)


@kernel(inline=True)
def cell(x, inverse):
    return np.int64(math.floor(x * inverse))


@kernel(inline=True)
def cell_of(x, p, i, inverse):
    px, py, pz = place_of(x, p, i)
    return cell(px, inverse), cell(py, inverse), cell(pz, inverse)


@kernel(inline=True)
def bucket(cx, cy, cz, mask):
    """Teschner's hash of a cell (VMV 2003), to a power of two of buckets."""
    return ((cx * 73856093) ^ (cy * 19349663) ^ (cz * 83492791)) & mask


@kernel
def sort_into_buckets(where, order, mask):
    """Set `order` to the numbers of all items by their buckets `where`; returns where each bucket starts, from 1 on."""
    starts = np.zeros(mask + 2, np.int64)
    for j in range(where.shape[0]):
        starts[where[j] + 1] += 1
    for q in range(mask + 1):
        starts[q + 1] += starts[q]
    for j in range(where.shape[0] - 1, -1, -1):
        starts[where[j] + 1] -= 1
        order[starts[where[j] + 1]] = j
    return starts


@kernel
def find_pairs_within(x, p, reach):
    """Fill p.pairs with the pairs nearer than `reach` [m], p.seen with the positions, and p.nearest with the least
    distance of all pairs, at most the reach.

    Where p.pairs is full, the parts after that are left out; its last row keeps the largest number of them.

    No pairs if p.stop cancels: callers of a kernel that may stop here check p.stop afterwards.
    """
    n = part_count(p)
    inverse = 1.0 / place_reach(x, p, reach)
    mask = 1
    while mask < n:
        mask *= 2
    mask -= 1
    where, order = np.empty(n, np.int64), np.empty(n, np.int64)
    for j in range(n):
        cx, cy, cz = cell_of(x, p, j, inverse)
        where[j] = bucket(cx, cy, cz, mask)
    starts = sort_into_buckets(where, order, mask)
    most = p.pairs.shape[0] - 1
    count, nearest = 0, reach
    p.nearest[0] = 0.0
    for a in range(n):
        if count == most:  # of a net in one heap the search would take the square of its parts
            p.pairs[most, 1] = max(p.pairs[most, 1], n - a)
            break
        if a % UNASKED == 0 and is_stopped(p.stop):
            p.pairs[most, 0] = 0
            return
        ca, cb, cc = cell_of(x, p, a, inverse)
        for near in range(27):
            cx, cy, cz = ca + near // 9 - 1, cb + near // 3 % 3 - 1, cc + near % 3 - 1
            q = bucket(cx, cy, cz, mask)
            end = starts[q + 2] if q < mask else n
            for s in range(starts[q + 1], end):
                b = order[s]
                if b <= a or are_joined(p, a, b):
                    continue
                distance = distance_of(x, p, a, b)
                if distance >= reach:
                    continue
                nearest = min(nearest, distance)
                # Two cells of the 27 may share a bucket: take the pair from the cell that b is in.
                bx, by, bz = cell_of(x, p, b, inverse)
                other = bx == cx and by == cy and bz == cz
                if other and count < most:
                    p.pairs[count, 0], p.pairs[count, 1] = a, b
                    count += 1
                elif other:
                    p.pairs[most, 1] = max(p.pairs[most, 1], n - a)
    p.pairs[most, 0] = count
    p.nearest[0] = nearest if count < most else 0.0
    for j in range(x.shape[0]):
        p.seen[j] = x[j]


@kernel
def find_pairs(x, p):
    """Fill p.pairs with the pairs nearer than (1 + SKIN) thickness."""
    find_pairs_within(x, p, reach_of(p))


@kernel(noalias=True, inline=True)
def mean_shift(x, seen, o, n):
    total = 0.0
    for j in range(n):
        total += x[o + j] - seen[o + j]
    return total / n


@kernel(noalias=True, inline=True)
def farthest(x, seen, n):
    """Largest squared displacement of a particle since the list was made, relative to the mean displacement."""
    mx, my, mz = mean_shift(x, seen, np.uint64(0), n), mean_shift(x, seen, n, n), mean_shift(x, seen, n + n, n)
    most = 0.0
    for j in range(n):
        dx, dy, dz = x[j] - seen[j] - mx, x[n + j] - seen[n + j] - my, x[n + n + j] - seen[n + n + j] - mz
        most = max(most, dx * dx + dy * dy + dz * dz)
    return most


@kernel(allocates=False)
def refresh_pairs(x, p):
    """Find the pairs again if a point has moved by half the skin; returns their number."""
    half = 0.5 * SKIN * p.thickness
    last = p.pairs.shape[0] - 1
    if p.pairs[last, 0] < 0 or not farthest(x, p.seen, np.uint64(p.rows * p.cols)) < half * half:
        find_pairs(x, p)
    return p.pairs[last, 0]


@kernel
def count_touching(x, p, touching):
    """Add to touching (rows cols,) how many others each particle, or the link from it, touches."""
    for s in range(refresh_pairs(x, p)):
        a, b = p.pairs[s, 0], p.pairs[s, 1]
        if not are_neighbours(p, a, b) and distance_of(x, p, a, b) < p.thickness:
            touching[a] += 1
            touching[b] += 1
