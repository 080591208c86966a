"""Bending stiffness EI of lines: a quadratic energy of the second differences of positions.

Of a line of segments of length l without strain the curvature at an inner node is d/l^2 with d = x_{i-1} - 2 x_i +
x_{i+1}, and the energy (EI/2) |d|^2 / l^3. Segments that are stretched by a strain e bend as if EI were (1 + e)^2 times
as large. The energy is convex, and its force linear in the positions: neither rest nor the longest stable step need
another method. An end is free to turn; at one that a clamp holds in the direction t the line continues behind it as it
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
from sim.springs.forces.links import set_tensions
from sim.springs.forces.matrices import STIFFEST, STIFFNESS, TRANSVERSE
from sim.springs.forces.record import LINES, Force
from sim.springs.points.arrays import is_moving, push, span

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


@kernel(inline=True)
def push_bend(p, out, i, s, dx, dy, dz):
    """Add s times the stiffness and the vector d of bend i to its three nodes, by their weights."""
    for e in range(3):
        w = s * p.bends[i, WEIGHTS + e] * p.bends[i, BEND_STIFFNESS]
        push(p, out, int(p.bends[i, e]), w * dx, w * dy, w * dz)


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        push_bend(p, a, i, -1.0, dx, dy, dz)


@kernel(noalias=True, allocates=False)
def add_bending_tension(x, p, out):
    """Add the part of the axial force [N] of each link that the bends beside it have."""
    n = p.cols
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        for e in range(2):
            q = int(p.bends[i, LINKS + e])
            if q >= 0:
                rx, ry, rz = span(x, n, p.ends[q, 0], p.ends[q, 1])
                length = math.sqrt(rx * rx + ry * ry + rz * rz)
                along = (dx * rx + dy * ry + dz * rz) / max(length, 1e-12)
                out[q] += p.bends[i, BEND_STIFFNESS] * (along if e == 1 else -along)


@kernel
def set_line_tensions(x, v, p, out):
    """Set the tension (links,) [N] of every link of lines, with its damping and the part from bending."""
    set_tensions(x, v, p, out)
    add_bending_tension(x, p, out)


@kernel(allocates=False)
def energy(x, t, p):
    total = 0.0
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        total += 0.5 * p.bends[i, BEND_STIFFNESS] * (dx * dx + dy * dy + dz * dz)
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """Prescribed nodes put in."""
    n, work = p.cols, 0.0
    for i in range(p.bends.shape[0]):
        dx, dy, dz = bend_at(x, p, i)
        for e in range(3):
            j, s = int(p.bends[i, e]), p.bends[i, WEIGHTS + e] * p.bends[i, BEND_STIFFNESS]
            if not is_moving(p, j):
                work += s * (dx * v[j] + dy * v[n + j] + dz * v[2 * n + j])
    return 0.0, work


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """The constant K of all bends."""
    for i in range(p.bends.shape[0] if part in (STIFFNESS, STIFFEST, TRANSVERSE) else 0):
        dx, dy, dz = bend_at(u, p, i)
        push_bend(p, out, i, 1.0, dx - p.bends[i, OFFSET], dy - p.bends[i, OFFSET + 1], dz - p.bends[i, OFFSET + 2])


FORCE = Force(
    "bending", rank=5, nets=LINES, accelerate=accelerate, energy=energy, power=power, tangent=tangent,
    stores="elastic", is_smooth=True,
)  # fmt: skip
