"""Air drag by the square of the speed: F = -c |v| v on each point of a rope or cloth, in still air."""

import math
from typing import NamedTuple

from sim.jit import kernel
from sim.springs.forces.matrices import add_block
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.points.arrays import is_moving, point_count, push


class SquareDrag(NamedTuple):
    """Its coefficient."""

    coefficient: float = 0.1  # c [N s^2/m^2]


@kernel(inline=True)
def speed_of(v, n, j):
    """|v| [m/s] of point j."""
    return math.sqrt(v[j] * v[j] + v[n + j] * v[n + j] + v[2 * n + j] * v[2 * n + j])


@kernel(allocates=False)
def accelerate(m, x, v, t, p, with_damping, f, a):
    """All of it is damping."""
    if not with_damping:
        return
    n = p.rows * p.cols
    for j in range(point_count(p)):
        s = -m.coefficient * speed_of(v, n, j)
        push(p, a, j, s * v[j], s * v[n + j], s * v[2 * n + j])


@kernel(allocates=False)
def damp(m, x, v, t, s, p, reverse):
    """The exact solution of m dv/dt = -c |v| v: v(s) = v/(1 + c |v| s/m). It puts no work in."""
    n = p.rows * p.cols
    for j in range(n):
        keep = 1.0 / (1.0 + m.coefficient * p.inverse_masses[j] * speed_of(v, n, j) * s)
        v[j] *= keep
        v[n + j] *= keep
        v[2 * n + j] *= keep
    return 0.0


@kernel(allocates=False)
def power(m, x, v, t, p, with_damping):
    """c |v|^3 over the free points [W], all dissipated."""
    n, total = p.rows * p.cols, 0.0
    if with_damping:
        for j in range(n):
            if is_moving(p, j):
                total += m.coefficient * speed_of(v, n, j) ** 3
    return total, 0.0


@kernel(allocates=False)
def blocks(m, x, v, t, g, p, points):
    """D = c (|v| I + v v^T/|v|): c |v| across the velocity, twice as much along it."""
    n = p.rows * p.cols
    for j in range(n):
        s = speed_of(v, n, j) + 1e-300
        c = g * m.coefficient * s
        add_block(points, j, n, 2.0 * c, c, v[j] / s, v[n + j] / s, v[2 * n + j] / s)


FORCE = Force(
    "square_drag", numbers=SquareDrag, accelerate=accelerate, damp=damp, power=power, blocks=blocks, nets=SPRING_NETS,
    is_smooth=True,
)  # fmt: skip
