"""A magnet at a point, which attracts every point of a net: energy -s/d, d^2 = r^2 + c^2 at a distance r."""

import math
from typing import NamedTuple

from sim.jit import kernel
from sim.springs.forces.matrices import STIFFEST, STIFFNESS, add_block, add_product
from sim.springs.forces.record import Force
from sim.springs.points.arrays import is_moving, point_count, push


class Magnet(NamedTuple):
    """Its numbers."""

    x: float = 0.0  # place [m]
    y: float = 0.0
    z: float = 0.0
    strength: float = 1.0  # s [N m2]
    core: float = 0.1  # c [m], above 0: the force is greatest at a distance of 0.71 c


@kernel(inline=True)
def from_point(m, x, n, j):
    """Vector (3) from point j to the magnet m, and the distance d [m]."""
    dx, dy, dz = m.x - x[j], m.y - x[n + j], m.z - x[2 * n + j]
    return dx, dy, dz, math.sqrt(dx * dx + dy * dy + dz * dz + m.core * m.core)


@kernel(allocates=False)
def accelerate(m, x, v, t, p, with_damping, f, a):
    """F = s r/d^3."""
    n = p.rows * p.cols
    for j in range(point_count(p)):
        dx, dy, dz, d = from_point(m, x, n, j)
        s = m.strength / d**3
        push(p, a, j, s * dx, s * dy, s * dz)


@kernel(allocates=False)
def energy(m, x, t, p):
    """Of the points that are not prescribed."""
    n, total = p.rows * p.cols, 0.0
    for j in range(point_count(p)):
        if is_moving(p, j):
            total -= m.strength / from_point(m, x, n, j)[3]
    return total


@kernel(inline=True)
def stiffnesses(m, dx, dy, dz, d):
    """K [N/m] along the direction to the magnet and across it, and the direction."""
    r = math.sqrt(dx * dx + dy * dy + dz * dz) + 1e-300
    return m.strength / d**3 * (1.0 - 3.0 * r * r / (d * d)), m.strength / d**3, dx / r, dy / r, dz / r


@kernel(allocates=False)
def tangent(m, x, u, t, p, part, longest, out):
    n = p.rows * p.cols
    if part in (STIFFNESS, STIFFEST):
        for j in range(point_count(p)):
            along, across, ex, ey, ez = stiffnesses(m, *from_point(m, x, n, j))
            add_product(out, u, j, n, along, across, ex, ey, ez)


@kernel(allocates=False)
def blocks(m, x, v, t, g, p, points):
    """Without what pushes away: the matrix stays positive definite, and Newton's method takes a few rounds more."""
    n = p.rows * p.cols
    for j in range(n):
        along, across, ex, ey, ez = stiffnesses(m, *from_point(m, x, n, j))
        add_block(points, j, n, g * g * max(0.0, along), g * g * across, ex, ey, ez)


def bound(m: Magnet) -> tuple[float, float]:
    return m.strength / m.core**3, 0.0


FORCE = Force(
    "magnet", numbers=Magnet, accelerate=accelerate, energy=energy, tangent=tangent, blocks=blocks, bound=bound,
    is_smooth=True,
)  # fmt: skip
