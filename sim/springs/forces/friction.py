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

touching = kernel(inline=True)(point_laws.touching)
stopping = kernel(inline=True)(point_laws.stopping)

# The accelerations that friction holds against: those of the state at hand; the same, noted for later; those noted.
# Implicit methods hold against those at the start of a step, so that friction depends on velocities alone in the step,
# as its blocks say. Then Newton's method converges as without friction, and a point at rest stays where it is.
CURRENT, NOTED, FIXED = 0, 1, 2


@kernel(inline=True)
def set_at(out, i, n, fx, fy, fz):
    out[i], out[i + n], out[i + 2 * n] = fx, fy, fz


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
        on_sphere, o = surface == 1, 3 * n * surface
        if not touches(x, t, p, on_sphere):
            if p.load_is[0] == NOTED:
                p.load[o : o + 3 * n] = 0.0
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            w = p.inverse_masses[j]
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0 or w == 0.0:
                set_at(p.held, o + j, n, 0.0, 0.0, 0.0)
                if p.load_is[0] == NOTED:
                    set_at(p.load, o + j, n, 0.0, 0.0, 0.0)
                continue
            ax, ay, az = a[j], a[n + j], a[2 * n + j]
            if p.load_is[0] == NOTED:
                set_at(p.load, o + j, n, ax, ay, az)
            elif p.load_is[0] == FIXED:
                ax, ay, az = p.load[o + j], p.load[o + n + j], p.load[o + 2 * n + j]
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            most = grip(depth, ru * nx + rv * ny + rw * nz, w, p)
            sx, sy, sz, part = stopping(nx, ny, nz, ru, rv, rw, ax, ay, az, most, p.stop_rate)
            a[j] -= part * sx
            a[n + j] -= part * sy
            a[2 * n + j] -= part * sz
            set_at(p.held, o + j, n, -part * sx, -part * sy, -part * sz)


@kernel(allocates=False)
def foresee(x, v, t, p):
    """Set p.held to the friction of points that slide at v, before a kick that `hold` ends."""
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere, o = surface == 1, 3 * n * surface
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            vn = ru * nx + rv * ny + rw * nz
            tx, ty, tz = ru - vn * nx, rv - vn * ny, rw - vn * nz
            over = -grip(depth, vn, p.inverse_masses[j], p) / math.sqrt(tx * tx + ty * ty + tz * tz + TINY)
            set_at(p.held, o + j, n, over * tx, over * ty, over * tz)


@kernel(allocates=False)
def hold_on(x, v, t, s, p, on_sphere, foreseen):
    """Friction for a time s, last in a kick, which stops points that it can stop. Returns the sphere's work [J].

    foreseen: of other points, the friction that `foresee` has set, for a kick that mirrors one without.
    """
    work = 0.0
    if not touches(x, t, p, on_sphere):
        return work
    n = p.rows * p.cols
    o = 3 * n if on_sphere else 0
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
        fx, fy, fz = s * p.held[o + j], s * p.held[o + n + j], s * p.held[o + 2 * n + j]
        if speed <= slow:
            fx, fy, fz = -tx, -ty, -tz
        elif not foreseen or (fx == 0.0 and fy == 0.0 and fz == 0.0):
            fx, fy, fz = -slow / speed * tx, -slow / speed * ty, -slow / speed * tz
        v[j] += fx
        v[n + j] += fy
        v[2 * n + j] += fz
        if moves:
            work += (fx * su + fy * sv + fz * sw) / w
    return work


@kernel(inline=True)
def hold(x, v, t, s, p, foreseen):
    """The floor's and the sphere's, each with its surface as a constant, which LLVM makes use of."""
    work = 0.0
    if p.has_floor:
        work += hold_on(x, v, t, s, p, False, foreseen)
    if p.has_sphere:
        work += hold_on(x, v, t, s, p, True, foreseen)
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
    """The secant of the force over the sliding speed, of each touching point, as against noted accelerations."""
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere, o = surface == 1, 3 * n * surface
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0:
                continue
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            most = grip(depth, ru * nx + rv * ny + rw * nz, p.inverse_masses[j], p)
            ax, ay, az = p.load[o + j], p.load[o + n + j], p.load[o + 2 * n + j]
            _, _, _, part = stopping(nx, ny, nz, ru, rv, rw, ax, ay, az, most, p.stop_rate)
            add_block(points, j, n, 0.0, g * mass_at(p, j) * p.stop_rate * part, nx, ny, nz)


FORCE = Force(
    "friction", rank=1000, nets=SPRING_NETS,
    acts="p.friction > 0.0 and not p.lab_contact and (p.has_floor or p.has_sphere)",
    accelerate=accelerate, foresee=foresee, hold=hold, power=power, tangent=tangent, blocks=blocks,
)  # fmt: skip
