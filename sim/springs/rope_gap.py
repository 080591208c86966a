"""From kick to kick of a rope's leapfrog: the damping that ends a step and that which begins the next in one pass.

Both go through the even links, the odd ones and drag, in opposite orders. Of a rope without account, whose links are
damped alike in all directions, each component of the velocities stands alone, so that one loop does all of it with the
numbers between in registers. In two passes a step takes 1.05 to 1.1 times as long up to 10 points, and 1.3 to 1.4 times
from 30 to 1000 points.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.damping import other_acts
from sim.springs.laws import by_damping
from sim.springs.points.arrays import by_net

PAD = 4  # numbers beside a component in the room of `cross_gap`, the width of its window
never = kernel(lambda p: False, inline=True)
acts_whole = by_damping(
    whole=kernel(lambda law: True, inline=True), limited=kernel(lambda law: False, inline=True)
)  # fmt: skip


@kernel(inline=True)
def rope_gaps_merge(p):
    """Links on their own, damped alike in all directions, act on each component of the velocities alone."""
    return acts_whole(p.law) and p.damped and not (p.axial or other_acts(p))


# True if `cross_gap` knows the net's damping.
gaps_merge = by_net(rope=rope_gaps_merge, grid=never, lines=never)


class Gap(NamedTuple):
    """Room and coefficients of `cross_gap`: PAD zeros, each component of an even number of points, and PAD zeros."""

    v: NDArray[np.float64]  # velocities
    first: NDArray[np.float64]  # by what part of their relative velocity the link after a point moves this point
    second: NDArray[np.float64]  # and the next one
    keep: NDArray[np.float64]  # fraction of a point's velocity that drag leaves


@kernel
def make_rope_gap(p, decay):
    n = p.cols
    width = n + n % 2
    size = 3 * width + 2 * PAD
    room, first, second, keep = np.zeros(size), np.zeros(size), np.zeros(size), np.ones(size)
    for e in range(3):
        for j in range(n):
            at, wa = PAD + e * width + j, p.inverse_masses[j]
            keep[at] = decay[1, j]
            if j + 1 < n:
                first[at], second[at] = wa * decay[0, j], p.inverse_masses[j + 1] * decay[0, j]
    return Gap(room, first, second, keep)


@kernel
def make_grid_gap(p, decay):
    none = np.empty(0)
    return Gap(none, none, none, none)


# The `Gap` of a net, with decay = make_decay(p, h/2).
make_gap = by_net(rope=make_rope_gap, grid=make_grid_gap, lines=make_grid_gap)


@kernel(noalias=True, inline=True)
def damp_twice(v, first, second, keep, start, count):
    """Links of every second pair from `start` on, then the others, drag, and both again.

    In one pass: each stage follows two points behind the one before, and what lies between is kept in registers.
    """
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    after_one = after_two = after_three = 0.0  # the last point that has been through one, two and three stages
    for k in range(count):
        i = start + two * np.uint64(k)
        u, last = v[i], v[i + one]
        d = last - u
        u += first[i] * d
        last -= second[i] * d
        d = u - after_one
        q = (after_one + first[i - one] * d) * keep[i - one]
        u = (u - second[i - one] * d) * keep[i]
        d = q - after_two
        b = after_two + first[i - two] * d
        q -= second[i - two] * d
        d = b - after_three
        v[i - three] = after_three + first[i - three] * d
        v[i - two] = b - second[i - three] * d
        after_one, after_two, after_three = last, u, q


@kernel(noalias=True, inline=True)
def kick_out(y, s0, v, a, o, n, s):
    for j in range(n):
        y[s0 + j] = v[o + j] + s * a[o + j]


@kernel(noalias=True, inline=True)
def kick_back(y, s0, v, a, o, n, s):
    for j in range(n):
        v[o + j] = y[s0 + j] + s * a[o + j]


@kernel(noalias=True, inline=True)
def multiply(y, x, n):
    for j in range(n):
        y[j] *= x[j]


@kernel(noalias=True, allocates=False)
def cross_rope_gap(v, a, s, gap, p, reverse):
    pad, n = np.uint64(PAD), np.uint64(p.cols)
    width = n + n % np.uint64(2)
    size = np.uint64(3) * width
    if n == width:
        kick_out(gap.v, pad, v, a, np.uint64(0), size, s)
    else:
        for e in range(3):
            kick_out(gap.v, pad + np.uint64(e) * width, v, a, np.uint64(e) * n, n, s)
    if reverse and p.drag > 0.0:
        multiply(gap.v, gap.keep, np.uint64(gap.v.shape[0]))
    # A pair that begins before the first point moves nothing.
    start = pad - np.uint64(1) if reverse else pad
    damp_twice(gap.v, gap.first, gap.second, gap.keep, start, size // np.uint64(2) + np.uint64(2))
    if not reverse and p.drag > 0.0:
        multiply(gap.v, gap.keep, np.uint64(gap.v.shape[0]))
    if n == width:
        kick_back(gap.v, pad, v, a, np.uint64(0), size, s)
    else:
        for e in range(3):
            kick_back(gap.v, pad + np.uint64(e) * width, v, a, np.uint64(e) * n, n, s)


# Nets of several rows take the parts one by one.
cross_no_gap = kernel(lambda v, a, s, gap, p, reverse: None, inline=True)

# From kick to kick, each of a time s [s], past the damping that ends a step and that which begins the next, in the same
# order: of a rope both are one pass over the points. a: accelerations (3 cols,) [m/s2]; gap: of `make_gap`.
cross_gap = by_net(rope=cross_rope_gap, grid=cross_no_gap, lines=cross_no_gap)
