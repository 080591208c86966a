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
from sim.springs.near.near_balls import balls_near, sort_balls
from sim.springs.near.windows import are_beside, block_at, blocks_in, region, row_of
from sim.springs.points.arrays import by_net, span
from sim.springs.points.link_pairs import pair_at

UNASKED = 64  # particles or links between two looks at whether the search is to end
LOOKS_UNASKED = 100_000  # pairs between two checks for a stop of the solve
SKIN = 0.5  # of the thickness: how far pairs are looked for beyond it, so that the list of them lasts
# Of particles more, as far as a flat net has only neighbours within WIDEST spacings.
WIDE_SKIN, WIDEST = 1.5, 2.0
NEIGHBOURS = 2  # rows and columns apart, within which a pair is held by links and never pushes
LANES = 32  # of a maximum that is taken side by side


@kernel(inline=True)
def spacing_of(p):
    return min(p.row_spacing, p.col_spacing)


@kernel
def balls_of_particles(x, p):
    """Middle and radius [m] of a ball about each block of particles, (4, blocks)."""
    n, balls = p.rows * p.cols, np.empty((4, blocks_in(p.rows) * blocks_in(p.cols)))
    for block in range(balls.shape[1]):
        top, bottom, left, right = block_at(p, block)
        part = 1.0 / ((bottom - top) * (right - left))
        mx = my = mz = square = 0.0
        for i in range(top, bottom):
            for j in range(i * p.cols + left, i * p.cols + right):
                mx, my, mz = mx + part * x[j], my + part * x[n + j], mz + part * x[2 * n + j]
        for i in range(top, bottom):
            for j in range(i * p.cols + left, i * p.cols + right):
                dx, dy, dz = x[j] - mx, x[n + j] - my, x[2 * n + j] - mz
                square = max(square, dx * dx + dy * dy + dz * dz)
        balls[0, block], balls[1, block], balls[2, block], balls[3, block] = mx, my, mz, math.sqrt(square)
    return balls


@kernel
def without_flat_blocks(x, p, block, beside, near, reach):
    width, off = region(x, x, p, block)
    if not (NEIGHBOURS + 1) * width - 2.0 * off >= reach:
        return near
    count = 0
    for s in range(near):
        if not are_beside(p, block, beside[s]):
            beside[count] = beside[s]
            count += 1
    return count


@kernel
def balls_of_links(x, p):
    """Middle of each link and half its length [m], (4, links)."""
    n, balls = p.cols, np.empty((4, p.cols - 1))
    for j in range(n - 1):
        for e in range(3):
            balls[e, j] = 0.5 * (x[e * n + j] + x[e * n + j + 1])
        dx, dy, dz = span(x, n, j, j + 1)
        balls[3, j] = 0.5 * math.sqrt(dx * dx + dy * dy + dz * dz)
    return balls


@kernel(inline=True)
def is_particle_near(x, p, a, balls, block, reach):
    n, most = p.rows * p.cols, balls[3, block] + reach
    dx, dy, dz = balls[0, block] - x[a], balls[1, block] - x[n + a], balls[2, block] - x[2 * n + a]
    return dx * dx + dy * dy + dz * dz < most * most


@kernel(inline=True)
def are_near_on_grid(p, a, b):
    first, second = row_of(a, p.cols), row_of(b, p.cols)
    i, j = abs(second - first), abs(b - a - (second - first) * p.cols)
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
# Balls about blocks of parts, (4, blocks) [m]; the first row and that after the last of one, and so its columns; and
# False if no part of a block is within reach of part a.
balls_of = by_parts(particles=balls_of_particles, links=balls_of_links)
block_of = by_parts(particles=block_at, links=kernel(lambda p, block: (0, 1, block, block + 1), inline=True))
is_near_block = by_parts(
    particles=is_particle_near, links=kernel(lambda x, p, a, balls, block, reach: True, inline=True)
)  # fmt: skip
# Number of the blocks `beside` one, without those that a flat region shows to have no pairs within reach with it.
without_flat = by_parts(
    particles=without_flat_blocks,
    links=kernel(lambda x, p, block, beside, near, reach: near, inline=True),
)
# Distance [m] within which pairs are looked for.
reach_of = by_parts(
    particles=kernel(
        lambda p: max((1.0 + SKIN) * p.thickness, min((1.0 + WIDE_SKIN) * p.thickness, WIDEST * spacing_of(p))),
        inline=True,
    ),
    links=kernel(lambda p: (1.0 + SKIN) * p.thickness, inline=True),
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


@kernel
def list_part(x, p, a, block, near, beside, balls, reach):
    """List the pairs of part a of a block with parts of those `beside` it."""
    most = p.pairs.shape[0] - 1
    for s in range(near):
        other = beside[s]
        if not is_near_block(x, p, a, balls, other, reach):
            continue
        top, bottom, left, right = block_of(p, other)
        for i in range(top, bottom):
            for b in range(i * p.cols + left, i * p.cols + right):
                if other == block and b <= a:
                    continue
                distance = distance_of(x, p, a, b)
                if distance >= reach or are_joined(p, a, b):
                    continue
                p.nearest[0] = min(p.nearest[0], distance)
                count = p.pairs[most, 0]
                if count == most:
                    return False
                p.pairs[count, 0], p.pairs[count, 1] = a, b
                p.pairs[most, 0] = count + 1
    return True


@kernel
def find_pairs_within(x, p, reach):
    """Fill p.pairs with the pairs nearer than `reach` [m], p.seen with the positions, and p.nearest with the least
    distance of all pairs, at most the reach.

    Where p.pairs is full, the parts after that are left out; its last row keeps the largest number of them.

    No pairs if p.stop cancels: callers of a kernel that may stop here check p.stop afterwards.
    """
    last, done, reported = p.pairs.shape[0] - 1, 0, 0
    balls = balls_of(x, p)
    buckets, beside = sort_balls(balls, reach), np.empty(balls.shape[1], np.int64)
    has_room = True
    p.pairs[last, 0], p.nearest[0] = 0, reach
    for block in range(balls.shape[1]):
        if done >= reported:
            reported = done + UNASKED
            if is_stopped(p.stop):
                p.pairs[last, 0], p.nearest[0] = 0, 0.0
                return
        near = balls_near(balls, buckets, block, reach, beside)
        near = without_flat(x, p, block, beside, near, reach)
        top, bottom, left, right = block_of(p, block)
        for i in range(top, bottom):
            for a in range(i * p.cols + left, i * p.cols + right):
                # Of a net in one heap the search would take the square of its parts.
                if has_room and not list_part(x, p, a, block, near, beside, balls, reach):
                    has_room = False
                    p.pairs[last, 1] = max(p.pairs[last, 1], part_count(p) - done)
                done += 1
        if not has_room:
            p.nearest[0] = 0.0
            break
    for j in range(x.shape[0]):
        p.seen[j] = x[j]


@kernel
def find_pairs(x, p):
    """Fill p.pairs with the pairs within reach."""
    find_pairs_within(x, p, reach_of(p))


@kernel(noalias=True, inline=True)
def mean_shift(x, seen, o, n):
    total = 0.0
    for j in range(n):
        total += x[o + j] - seen[o + j]
    return total / n


@kernel(noalias=True, inline=True)
def add_motion(x, seen, o, n, mx, my, mz, most, lanes):
    """Raise `most` (lanes,) to the squared displacements, less their mean, of as many particles from o on."""
    for k in range(lanes):
        j = o + k
        dx, dy, dz = x[j] - seen[j] - mx, x[n + j] - seen[n + j] - my, x[n + n + j] - seen[n + n + j] - mz
        square = dx * dx + dy * dy + dz * dz
        most[k] = square if square > most[k] else most[k]


@kernel(noalias=True, allocates=False)
def add_motions(x, seen, n, mx, my, mz, most, lanes):
    for part in range(n // lanes):
        add_motion(x, seen, np.uint64(part) * lanes, n, mx, my, mz, most, lanes)
    add_motion(x, seen, n // lanes * lanes, n, mx, my, mz, most, n % lanes)


@kernel(noalias=True)
def farthest(x, seen, n):
    """Largest squared displacement of a particle since the list was made, relative to the mean displacement; NaN if
    any is."""
    mx, my, mz = mean_shift(x, seen, np.uint64(0), n), mean_shift(x, seen, n, n), mean_shift(x, seen, n + n, n)
    # A maximum in lanes is as quick as the memory; a single one waits for each comparison.
    most = np.zeros(LANES)
    add_motions(x, seen, n, mx, my, mz, most, np.uint64(LANES))
    return most.max() if mx + my + mz - (mx + my + mz) == 0.0 else math.nan


@kernel(allocates=False)
def refresh_pairs(x, p):
    """Find the pairs again if a point has moved by half the skin; returns their number, 0 if p.stop cancels."""
    half = 0.5 * (reach_of(p) - p.thickness)
    last = p.pairs.shape[0] - 1
    if p.pairs[last, 0] < 0 or not farthest(x, p.seen, np.uint64(p.rows * p.cols)) < half * half:
        find_pairs(x, p)
    p.looks[0] += p.pairs[last, 0]
    if p.looks[0] > LOOKS_UNASKED:
        if is_stopped(p.stop):
            return 0
        p.looks[0] = 0
    return p.pairs[last, 0]


@kernel(allocates=False)
def pairs_at_hand(x, p):
    """Number of pairs in the list, which `refresh_pairs` has looked at with these x, if it has been called at all."""
    last = p.pairs.shape[0] - 1
    return p.pairs[last, 0] if p.pairs[last, 0] >= 0 else refresh_pairs(x, p)


@kernel
def count_touching(x, p, touching):
    """Add to touching (rows cols,) how many others each particle, or the link from it, touches."""
    for s in range(refresh_pairs(x, p)):
        a, b = p.pairs[s, 0], p.pairs[s, 1]
        if not are_neighbours(p, a, b) and distance_of(x, p, a, b) < p.thickness:
            touching[a] += 1
            touching[b] += 1
