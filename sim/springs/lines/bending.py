"""Bending stiffness EI of lines: a quadratic energy of the second differences of positions.

Of a line of segments of length l without strain the curvature at an inner node is d/l^2 with d = x_{i-1} - 2 x_i +
x_{i+1}, and the energy (EI/2) |d|^2 / l^3. Segments that are stretched by a strain e bend as if EI were (1 + e)^2 times
as large. The energy is convex, and its force linear in the positions: neither rest nor the longest stable step need
another method. An end is free to turn; at one that a clamp holds in the direction t the line goes on behind it as it
does before it, turned about t, so that d = x_1 - x_0 - l t with twice the stiffness.

A row of `bends` holds three nodes, their weights, the stiffness 2 energy/|d|^2 [N/m], a vector [m] and the links before
and after the middle: d = sum of weights times positions, plus the vector. The bends at inner nodes are sums over three
nodes; of a clamp the third weight is 0 and there is no link before it (-1).

The bends pull along the links too, by EI times the squared curvature: `add_bending_tension`.

Source: Hall and Goupee (2015), Ocean Eng. 104:590, and MoorDyn's theory, which has 2 sin(a/2) in place of sin(a) of the
angle a between two segments.
"""

import math

from sim.jit import kernel

NODES, WEIGHTS, BEND_STIFFNESS, OFFSET, LINKS = 0, 3, 6, 7, 10  # columns


@kernel(inline=True)
def bend_at(x, p, i):
    """The vector d [m] of bend i."""
    n, row = p.cols, p.bends[i]
    a, b, c = int(row[0]), int(row[1]), int(row[2])
    return (
        row[3] * x[a] + row[4] * x[b] + row[5] * x[c] + row[7],
        row[3] * x[n + a] + row[4] * x[n + b] + row[5] * x[n + c] + row[8],
        row[3] * x[2 * n + a] + row[4] * x[2 * n + b] + row[5] * x[2 * n + c] + row[9],
    )


@kernel(noalias=True, allocates=False)
def add_bending(x, p, f):
    """Add the forces [N] of all bends."""
    n = p.cols
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        for e in range(3):
            j, s = int(p.bends[i, e]), p.bends[i, 3 + e] * p.bends[i, 6]
            f[j] -= s * dx
            f[n + j] -= s * dy
            f[2 * n + j] -= s * dz


@kernel(noalias=True, allocates=False)
def add_bending_tension(x, p, out):
    """Add the part of the axial force [N] of each link that the bends beside it have."""
    n = p.cols
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        for e in range(2):
            q = int(p.bends[i, 10 + e])
            if q >= 0:
                a, b = p.ends[q, 0], p.ends[q, 1]
                rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                length = math.sqrt(rx * rx + ry * ry + rz * rz)
                along = (dx * rx + dy * ry + dz * rz) / max(length, 1e-12)
                out[q] += p.bends[i, 6] * (along if e == 1 else -along)


@kernel(allocates=False)
def bending_energy(x, p):
    """Energy [J] of all bends."""
    total = 0.0
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        total += 0.5 * p.bends[i, 6] * (dx * dx + dy * dy + dz * dz)
    return total


@kernel(allocates=False)
def bending_rate(x, v, p):
    """Rate [W] of the energy of all bends at velocities v (3 n,)."""
    n, rate = p.cols, 0.0
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        for e in range(3):
            j, s = int(p.bends[i, e]), p.bends[i, 3 + e] * p.bends[i, 6]
            rate += s * (dx * v[j] + dy * v[n + j] + dz * v[2 * n + j])
    return rate
