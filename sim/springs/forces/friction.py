"""Coulomb's law between points and the surfaces that they touch, solved in each step.

In a step of h a point gets the tangential force that stops it against the sum of all other forces, -m (v_t/h + a_t), at
most mu N. So a point that can rest does: its velocity is exactly the surface's, and where it rests is its position,
without a memory of its own. A sliding point gets mu N against its velocity. Each impulse is the one of Moreau's
time-stepping (J. J. Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics, section 10).
"""

import math

from sim import point_laws
from sim.jit import kernel
from sim.springs.forces.contact import surface_velocity, touches
from sim.springs.forces.matrices import FRICTION, add_block, add_product
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.points.arrays import mass_at
from sim.springs.points.each_link import TINY
from sim.springs.points.order import in_turn

touching = kernel(inline=True)(point_laws.touching)
friction_acceleration = kernel(inline=True)(point_laws.friction_acceleration)


@kernel(inline=True)
def grip(depth, vn, w, p):
    """Largest deceleration [m/s^2] by friction of a point of inverse mass w that leaves its surface at vn [m/s]."""
    return p.friction * max(0.0, p.contact_k * depth - p.contact_b * vn) * w


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    if not with_damping:
        return
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        o = 3 * n * surface
        for j in range(n):
            w = p.inverse_masses[j]
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0 or w == 0.0:
                p.held[o + j] = p.held[o + n + j] = p.held[o + 2 * n + j] = 0.0
                continue
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            most = grip(depth, ru * nx + rv * ny + rw * nz, w, p)
            fx, fy, fz = friction_acceleration(nx, ny, nz, ru, rv, rw, a[j], a[n + j], a[2 * n + j], most, p.stop_rate)
            a[j] += fx
            a[n + j] += fy
            a[2 * n + j] += fz
            p.held[o + j], p.held[o + n + j], p.held[o + 2 * n + j] = fx, fy, fz


@kernel(allocates=False)
def damp_on(x, v, t, s, p, on_sphere, reverse):
    """Friction for a time s of every touching point, by the normal force at its velocity. Returns the sphere's work."""
    work = 0.0
    if not touches(x, t, p, on_sphere):
        return work
    n = p.rows * p.cols
    su, sv, sw = surface_velocity(p, on_sphere)
    moves = su != 0.0 or sv != 0.0 or sw != 0.0
    for j in range(n):
        w = p.inverse_masses[j]
        depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
        if depth <= 0.0 or w == 0.0:
            continue
        ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
        vn = ru * nx + rv * ny + rw * nz
        tx, ty, tz = ru - vn * nx, rv - vn * ny, rw - vn * nz
        slow, speed = grip(depth, vn, w, p) * s, math.sqrt(tx * tx + ty * ty + tz * tz)
        lost = min(1.0, slow / speed) if speed > 0.0 else 0.0
        v[j] -= lost * tx
        v[n + j] -= lost * ty
        v[2 * n + j] -= lost * tz
        if moves:
            work -= lost * (tx * su + ty * sv + tz * sw) / w
    return work


@kernel(inline=True)
def damp(x, v, t, s, p, reverse):
    """The floor's, then the sphere's, or in reverse; each with its surface as a constant, which LLVM makes use of."""
    work = 0.0
    for turn in range(2):
        if in_turn(turn, 2, reverse) == 1:
            if p.has_sphere:
                work += damp_on(x, v, t, s, p, True, reverse)
        elif p.has_floor:
            work += damp_on(x, v, t, s, p, False, reverse)
    return work


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere) [W] by the accelerations that `accelerate` has last written to p.held."""
    dissipated = work = 0.0
    if not with_damping:
        return dissipated, work
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        o = 3 * n * surface
        for j in range(n):
            m = mass_at(p, j)
            fx, fy, fz = m * p.held[o + j], m * p.held[o + n + j], m * p.held[o + 2 * n + j]
            dissipated -= fx * (v[j] - su) + fy * (v[n + j] - sv) + fz * (v[2 * n + j] - sw)
            work += fx * su + fy * sv + fz * sw
    return dissipated, work


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """M across the normals of the touching points, as part FRICTION."""
    if part != FRICTION:
        return
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth > 0.0:
                add_product(out, u, j, n, 0.0, mass_at(p, j), nx, ny, nz)


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """The secant of the force over the sliding speed, of each touching point."""
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0:
                continue
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            vn = ru * nx + rv * ny + rw * nz
            speed = math.sqrt((ru - vn * nx) ** 2 + (rv - vn * ny) ** 2 + (rw - vn * nz) ** 2)
            across = g * min(mass_at(p, j) * p.stop_rate, grip(depth, vn, 1.0, p) / (speed + TINY))
            add_block(points, j, n, 0.0, across, nx, ny, nz)


FORCE = Force(
    "friction", rank=1000, nets=SPRING_NETS,
    acts="p.friction > 0.0 and not p.lab_contact and (p.has_floor or p.has_sphere)",
    accelerate=accelerate, damp=damp, power=power, tangent=tangent, blocks=blocks,
)  # fmt: skip
