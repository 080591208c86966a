"""Gravity. Of ropes, cloths and other nets the loops over links begin with its accelerations."""

from sim.jit import kernel
from sim.springs.forces.record import Force, of_nets
from sim.springs.points.arrays import is_moving, mass_at, point_count, push


@kernel(allocates=False)
def energy(x, t, p):
    """-m g . x over the points that are not prescribed [J]."""
    total = 0.0
    n = p.rows * p.cols
    for j in range(point_count(p)):
        if is_moving(p, j):
            total -= mass_at(p, j) * (p.gx * x[j] + p.gy * x[n + j] + p.gz * x[2 * n + j])
    return total


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for j in range(point_count(p)):
        m = mass_at(p, j)
        push(p, a, j, m * p.gx, m * p.gy, m * p.gz)


FORCE = Force("gravity", rank=0, accelerate=of_nets(lines=accelerate), energy=energy, is_smooth=True)
