"""Drag of the air on points, c v. Its accelerations are those of the loops over links, which begin with them."""

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING
from sim.springs.forces.record import SPRING_NETS, Force


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """c v^2 over the free particles [W]."""
    total = 0.0
    if not with_damping:
        return total, 0.0
    n = p.rows * p.cols
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total += v[j] ** 2 + v[n + j] ** 2 + v[2 * n + j] ** 2
    return p.drag * total, 0.0


@kernel(allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """D = c I."""
    if part == DAMPING:
        for j in range(u.shape[0]):
            out[j] += p.drag * u[j]


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    n = p.rows * p.cols
    for j in range(n):
        for e in (0, 3, 5):
            points[j + e * n] += g * p.drag


FORCE = Force(
    "drag", rank=5, nets=SPRING_NETS, acts="p.drag > 0.0", power=power, tangent=tangent, blocks=blocks, is_smooth=True,
)  # fmt: skip
