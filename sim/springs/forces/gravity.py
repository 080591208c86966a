"""Gravity. Its accelerations are those of the loops over links, which begin with them."""

from sim.jit import kernel
from sim.springs.arrays import mass_at
from sim.springs.forces.record import Force


@kernel(allocates=False)
def energy(x, t, p):
    """-m g . x over the free particles [J]."""
    total = 0.0
    n = p.rows * p.cols
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total -= mass_at(p, j) * (p.gx * x[j] + p.gy * x[n + j] + p.gz * x[2 * n + j])
    return total


FORCE = Force("gravity", rank=0, energy=energy, stores="gravity", is_smooth=True)
