"""The bed under lines: on each part d l (k_b depth - c_b dz/dt) upwards, and Coulomb friction.

Friction is regularised by the step, as that of `sim.springs.forces.contact`.
"""

import math

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, STIFFEST, STIFFNESS
from sim.springs.forces.record import LINES, Force
from sim.springs.points.arrays import is_moving, push
from sim.springs.points.each_link import TINY
from sim.springs.points.line_points import kick, mobility
from sim.springs.points.order import in_turn


@kernel(inline=True)
def bed_force(x, v, p, i, j, with_damping):
    """Force [N] of the bed on part i at node j: upwards, and against the sliding."""
    n = p.cols
    depth = p.bed - x[2 * n + j]
    fx = fy = fz = 0.0
    if depth > 0.0:
        area = p.parts[i].bed_area
        fz = area * p.bed_stiffness * depth
        if with_damping:
            if p.friction > 0.0:
                speed = math.sqrt(v[j] * v[j] + v[n + j] * v[n + j] + TINY)
                s = min(p.friction * fz / speed, p.parts[i].mass * p.stop_rate)
                fx, fy = -s * v[j], -s * v[n + j]
            fz -= area * p.bed_damping * v[2 * n + j]
    return fx, fy, fz


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        fx, fy, fz = bed_force(x, v, p, i, j, with_damping)
        push(p, a, j, fx, fy, fz)


@kernel(allocates=False)
def damp_part(x, v, s, p, i):
    """Friction on part i; the other damping of the bed is in `sim.springs.kicks.lines`."""
    n, j = p.cols, p.places[i, 0]
    depth = p.bed - x[2 * n + j]
    if depth <= 0.0:
        return
    area = p.parts[i].bed_area
    speed = math.sqrt(v[j] * v[j] + v[n + j] * v[n + j])
    if p.friction > 0.0 and speed > 0.0:
        ex, ey = v[j] / speed, v[n + j] / speed
        over = mobility(p, j, ex, ey, 0.0)
        if over > 0.0:
            impulse = min(p.friction * area * p.bed_stiffness * depth * s, speed / over)
            kick(p, v, j, -impulse * ex, -impulse * ey, 0.0)


@kernel(allocates=False)
def damp(x, v, t, s, p, reverse):
    count = p.places.shape[0]
    for turn in range(count):
        damp_part(x, v, s, p, in_turn(turn, count, reverse))
    return 0.0


@kernel(allocates=False)
def energy(x, t, p):
    """1/2 k_b d l depth^2 over the parts in the bed [J]."""
    total = 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if is_moving(p, j):
            depth = max(0.0, p.bed - x[2 * p.cols + j])
            total += 0.5 * p.parts[i].bed_area * p.bed_stiffness * depth * depth
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """Power dissipated by damping and friction of the bed."""
    n, lost = p.cols, 0.0
    for i in range(p.places.shape[0] if with_damping else 0):
        j = p.places[i, 0]
        if is_moving(p, j):
            fx, fy, fz = bed_force(x, v, p, i, j, True)
            _, _, lift = bed_force(x, v, p, i, j, False)
            lost -= fx * v[j] + fy * v[n + j] + (fz - lift) * v[2 * n + j]
    return lost, 0.0


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """K and D of the parts in the bed, upright; friction is apart, as its strongest damping is 1/h."""
    n = p.cols
    resistance = p.bed_damping if part == DAMPING else p.bed_stiffness if part in (STIFFNESS, STIFFEST) else 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if x[2 * n + j] <= p.bed:
            out[2 * n + j] += resistance * p.parts[i].bed_area * u[2 * n + j]


FORCE = Force(
    "bed", rank=70, nets=LINES, accelerate=accelerate, damp=damp, energy=energy, power=power, tangent=tangent,
    stores="contact",
)  # fmt: skip
