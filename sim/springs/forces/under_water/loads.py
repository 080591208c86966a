"""Steady forces on nodes of lines; their energy counts with that of gravity."""

from sim.jit import kernel
from sim.springs.forces.record import LINES, Force
from sim.springs.points.arrays import is_moving, point_count, push


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for j in range(point_count(p)):
        push(p, a, j, p.loads[j, 0], p.loads[j, 1], p.loads[j, 2])


@kernel(allocates=False)
def energy(x, t, p):
    n, total = p.cols, 0.0
    for j in range(point_count(p)):
        if is_moving(p, j):
            total -= p.loads[j, 0] * x[j] + p.loads[j, 1] * x[n + j] + p.loads[j, 2] * x[2 * n + j]
    return total


FORCE = Force(
    "loads", rank=1, nets=LINES, acts="p.loads.shape[0] > 0", accelerate=accelerate, energy=energy, is_smooth=True,
)  # fmt: skip
