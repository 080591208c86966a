"""Coulomb's law between points and the surfaces that press them, solved in each step.

In a step of h a point gets the tangential force that stops it against the sum of all other forces, -m (v_t/h + a_t), at
most mu N. So a point that can rest does: its velocity is exactly the surface's, and where it rests is its position,
without a memory of its own. A sliding point gets mu N against its velocity. Each impulse is the one of Moreau's
time-stepping (J. J. Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics, section 10).

Where a rope's links touch the sphere, N is the share of the force on its links that each point takes.
"""

import math

from sim import point_laws
from sim.jit import kernel
from sim.springs.forces.matrices import FRICTION, add_block, add_product
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.points.arrays import mass_at
from sim.springs.points.each_contact import each_load, slip

stopping = kernel(inline=True)(point_laws.stopping)

# The accelerations that friction holds against: those of the state at hand; the same, noted for later; those noted.
# Implicit methods hold against those at the start of a step, so that friction depends on velocities alone in the step,
# as its blocks say. Then Newton's method converges as without friction, and a point at rest stays where it is.
CURRENT, NOTED, FIXED = 0, 1, 2


@kernel(inline=True)
def set_at(out, i, n, fx, fy, fz):
    out[i], out[i + n], out[i + 2 * n] = fx, fy, fz


@each_load(noalias=True)
def hold_against_others(load, x, v, t, p, a):
    w, n = p.inverse_masses[load.j], p.rows * p.cols
    i, o = load.j, load.j + (3 * n if load.on_sphere else 0)
    if w == 0.0:
        set_at(p.held, o, n, 0.0, 0.0, 0.0)
        return
    ax, ay, az = a[i], a[n + i], a[2 * n + i]
    if p.load_is[0] == NOTED:
        set_at(p.load, o, n, ax, ay, az)
    elif p.load_is[0] == FIXED:
        ax, ay, az = p.load[o], p.load[o + n], p.load[o + 2 * n]
    nx, ny, nz = load.nx, load.ny, load.nz
    ru, rv, rw = slip(v, n, load)
    most = p.friction * load.push * w
    sx, sy, sz, part = stopping(nx, ny, nz, ru, rv, rw, ax, ay, az, most, p.stop_rate)
    a[i] -= part * sx
    a[n + i] -= part * sy
    a[2 * n + i] -= part * sz
    set_at(p.held, o, n, -part * sx, -part * sy, -part * sz)


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    if not with_damping:
        return
    if p.load_is[0] == NOTED:
        for i in range(p.load.shape[0]):
            p.load[i] = 0.0
    hold_against_others(x, v, t, p, a)


@each_load()
def foresee(load, x, v, t, p):
    """Set p.held to the friction of points that slide at v, before a kick that `hold` ends."""
    n = p.rows * p.cols
    nx, ny, nz = load.nx, load.ny, load.nz
    ru, rv, rw = slip(v, n, load)
    vn = ru * nx + rv * ny + rw * nz
    tx, ty, tz = ru - vn * nx, rv - vn * ny, rw - vn * nz
    most, speed = p.friction * load.push * p.inverse_masses[load.j], math.sqrt(tx * tx + ty * ty + tz * tz)
    # A point that friction could stop in the kick may be at rest, where the direction of its motion is round-off.
    over = -most / speed if p.stop_rate * speed > 0.5 * most else 0.0
    set_at(p.held, load.j + (3 * n if load.on_sphere else 0), n, over * tx, over * ty, over * tz)


@each_load("sum")
def hold(load, x, v, t, s, p, foreseen):
    """Friction for a time s, last in a kick, which stops points that it can stop. Returns the sphere's work [J].

    foreseen: of other points, the friction that `foresee` has set, for a kick that mirrors one without.
    """
    j, n, w = load.j, p.rows * p.cols, p.inverse_masses[load.j]
    if w == 0.0:
        return 0.0
    o = j + (3 * n if load.on_sphere else 0)
    nx, ny, nz = load.nx, load.ny, load.nz
    ru, rv, rw = slip(v, n, load)
    vn = ru * nx + rv * ny + rw * nz
    tx, ty, tz = ru - vn * nx, rv - vn * ny, rw - vn * nz
    slow, speed = p.friction * load.push * w * s, math.sqrt(tx * tx + ty * ty + tz * tz)
    fx, fy, fz = s * p.held[o], s * p.held[o + n], s * p.held[o + 2 * n]
    if speed <= slow:
        fx, fy, fz = -tx, -ty, -tz
    elif not foreseen or (fx == 0.0 and fy == 0.0 and fz == 0.0):
        fx, fy, fz = -slow / speed * tx, -slow / speed * ty, -slow / speed * tz
    v[j] += fx
    v[n + j] += fy
    v[2 * n + j] += fz
    return (fx * load.su + fy * load.sv + fz * load.sw) / w


@each_load("two sums")
def power_of_held(load, x, v, t, p):
    """(dissipated, put in by a moving sphere) [W] by the accelerations that `accelerate` has last written to p.held."""
    n = p.rows * p.cols
    m, o = mass_at(p, load.j), load.j + (3 * n if load.on_sphere else 0)
    u, q, r = slip(v, n, load)
    fx, fy, fz = m * p.held[o], m * p.held[o + n], m * p.held[o + 2 * n]
    return -(fx * u + fy * q + fz * r), fx * load.su + fy * load.sv + fz * load.sw


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    return power_of_held(x, v, t, p) if with_damping else (0.0, 0.0)


@each_load(noalias=True)
def tangent(load, x, u, t, p, part, longest, out):
    """M across the normals of the loaded points, as part FRICTION."""
    if part == FRICTION:
        add_product(out, u, load.j, p.rows * p.cols, 0.0, mass_at(p, load.j), load.nx, load.ny, load.nz)


@each_load()
def blocks(load, x, v, t, g, p, points):
    """The secant of the force over the sliding speed, of each loaded point, as against noted accelerations."""
    n = p.rows * p.cols
    o = load.j + (3 * n if load.on_sphere else 0)
    nx, ny, nz = load.nx, load.ny, load.nz
    ru, rv, rw = slip(v, n, load)
    most = p.friction * load.push * p.inverse_masses[load.j]
    ax, ay, az = p.load[o], p.load[o + n], p.load[o + 2 * n]
    _, _, _, part = stopping(nx, ny, nz, ru, rv, rw, ax, ay, az, most, p.stop_rate)
    add_block(points, load.j, n, 0.0, g * mass_at(p, load.j) * p.stop_rate * part, nx, ny, nz)


FORCE = Force(
    "friction", rank=1000, nets=SPRING_NETS,
    acts="p.friction > 0.0 and not p.lab_contact and (p.has_floor or p.has_sphere)",
    accelerate=accelerate, foresee=foresee, hold=hold, power=power, tangent=tangent, blocks=blocks,
)  # fmt: skip
