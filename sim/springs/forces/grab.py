"""The grab: a capped, damped pull of one particle towards a target."""

import math

from sim import point_laws
from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.points.arrays import push
from sim.springs.points.each_link import TINY

secant = kernel(inline=True)(point_laws.secant)


@kernel(allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    """At most grab_max from its spring, plus its damping."""
    n, g = p.rows * p.cols, p.grabbed
    b = p.grab_b if with_damping else 0.0
    dx, dy, dz = p.grab_x - x[g], p.grab_y - x[n + g], p.grab_z - x[2 * n + g]
    s = secant(dx, dy, dz, p.grab_k, p.grab_max)
    push(p, a, g, s * dx - b * v[g], s * dy - b * v[n + g], s * dz - b * v[2 * n + g])


@kernel(inline=True)
def damp(x, v, t, s, p, reverse):
    n, g = p.rows * p.cols, p.grabbed
    keep = math.exp(-p.grab_b * p.inverse_masses[g] * s)
    v[g] *= keep
    v[n + g] *= keep
    v[2 * n + g] *= keep
    return 0.0


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The work of the spring is put in, as its energy is not counted."""
    n, g = p.rows * p.cols, p.grabbed
    dx, dy, dz = p.grab_x - x[g], p.grab_y - x[n + g], p.grab_z - x[2 * n + g]
    work = secant(dx, dy, dz, p.grab_k, p.grab_max) * (dx * v[g] + dy * v[n + g] + dz * v[2 * n + g])
    return p.grab_b * (v[g] ** 2 + v[n + g] ** 2 + v[2 * n + g] ** 2) if with_damping else 0.0, work


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """K = k I within reach; beyond it the force is capped and K = (F/r) (I - n n^T)."""
    if part in (TRANSVERSE, FRICTION):
        return
    n, g = p.rows * p.cols, p.grabbed
    dx, dy, dz = p.grab_x - x[g], p.grab_y - x[n + g], p.grab_z - x[2 * n + g]
    r = math.sqrt(dx * dx + dy * dy + dz * dz)
    across, inward = p.grab_k, 0.0
    if part == DAMPING:
        across = p.grab_b
    elif p.grab_k * r > p.grab_max:
        across = p.grab_max / r
        inward = across * (dx * u[g] + dy * u[n + g] + dz * u[2 * n + g]) / (r * r)
    out[g] += across * u[g] - inward * dx
    out[n + g] += across * u[n + g] - inward * dy
    out[2 * n + g] += across * u[2 * n + g] - inward * dz


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """k I within reach, (F/r) (I - n n^T) beyond."""
    n, j = p.rows * p.cols, p.grabbed
    dx, dy, dz = p.grab_x - x[j], p.grab_y - x[n + j], p.grab_z - x[2 * n + j]
    r = math.sqrt(dx * dx + dy * dy + dz * dz) + TINY
    along = across = g * p.grab_b + g * g * p.grab_k
    if p.grab_k * r > p.grab_max:
        along = g * p.grab_b
        across = along + g * g * p.grab_max / r
    add_block(points, j, n, along, across, dx / r, dy / r, dz / r)


FORCE = Force(
    "grab", rank=50, nets=SPRING_NETS, acts="p.grabbed >= 0", accelerate=accelerate, damp=damp, power=power,
    tangent=tangent, blocks=blocks,
)  # fmt: skip
