"""Water around lines: buoyancy, drag, and the push of waves and current, by Morison's law on each part.

As lumped-mass programs have it (Hall & Goupee 2015, Ocean Eng. 104:590), with q the unit tangent, along
r_{i+1} - r_{i-1}, u and du/dt the water's velocity and acceleration, and w = u - v:

  F = m_w g upwards + D_n |w_n| w_n + D_t |w_t| w_t
      + m_w [(1 + C_an) (du/dt - (du/dt . q) q) + (1 + C_at) (du/dt . q) q]
  D_n = rho/2 C_dn d l, D_t = rho/2 C_dt pi d l

The added mass is in the masses of `sim.springs.line_points`. Of a part at the surface the water pushes the submerged
fraction of its volume: from 1 to 0 over its HEIGHT about the elevation. Its added mass stays.

Buoyancy stores energy about still water. What waves, current and the elevation give or take is work, and so is the
inertia of the water that moves with the lines: kinetic energy is that of lines and bodies alone.
"""

import math

from sim.jit import kernel
from sim.springs.arrays import is_moving, push
from sim.springs.forces.matrices import STIFFEST, STIFFNESS
from sim.springs.forces.record import LINES, Force
from sim.springs.line_points import kick, mobility, tangent_at
from sim.springs.order import in_turn
from sim.waves import AMPLITUDE, sums_at


@kernel(inline=True)
def water_at(x, t, p, j):
    """Velocity [m/s] and acceleration [m/s^2] of the water at node j, and the node's height [m] over its surface."""
    u, v, w, du, dv, dw, z = p.current[0], p.current[1], p.current[2], 0.0, 0.0, 0.0, x[2 * p.cols + j]
    if p.waves.shape[1] > 0:
        n = p.cols
        sums = sums_at(x[j], x[n + j], z, t, p.waves, p.waves, AMPLITUDE, None, 0, p.depth)
        (wu, wv, ww), (du, dv, dw) = sums.velocity, sums.acceleration
        u, v, w, z = u + wu, v + wv, w + ww, z - sums.elevation
    return u, v, w, du, dv, dw, z


@kernel(inline=True)
def submerged(p, i, z):
    """Submerged fraction of part i, of which the middle is z [m] over the water's surface."""
    return min(max(0.5 - z / p.parts[i].height, 0.0), 1.0)


@kernel(inline=True)
def push_of(x, v, t, p, i, j, with_damping):
    """Force (3) [N] of the water on part i at node j, and the power [W] that its drag takes."""
    n = p.cols
    qx, qy, qz = tangent_at(x, p, i)
    u, w, s, du, dw, ds, z = water_at(x, t, p, j)
    wet, lost = submerged(p, i, z), 0.0
    m = wet * p.parts[i].displaced
    along = du * qx + dw * qy + ds * qz
    c, d = m * (1.0 + p.parts[i].added_across), m * (p.parts[i].added_along - p.parts[i].added_across) * along
    fx, fy, fz = c * du + d * qx, c * dw + d * qy, c * ds + d * qz - m * p.gz
    if with_damping:
        u, w, s = u - v[j], w - v[n + j], s - v[2 * n + j]
        along = u * qx + w * qy + s * qz
        nx, ny, nz = u - along * qx, w - along * qy, s - along * qz
        across = math.sqrt(nx * nx + ny * ny + nz * nz)
        c, d = wet * p.parts[i].drag_across * across, wet * p.parts[i].drag_along * abs(along) * along
        fx, fy, fz = fx + c * nx + d * qx, fy + c * ny + d * qy, fz + c * nz + d * qz
        lost = c * across * across + d * along
    return fx, fy, fz, lost


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        fx, fy, fz, _ = push_of(x, v, t, p, i, j, with_damping)
        push(p, a, j, fx, fy, fz)


@kernel(allocates=False)
def drag_along(v, s, p, j, drag, x, y, z):
    """Quadratic drag against the relative velocity (x, y, z) of node j for a time s: |w| falls as w/(1 + D w s/m)."""
    speed = math.sqrt(x * x + y * y + z * z)
    if speed == 0.0 or drag == 0.0:
        return
    x, y, z = x / speed, y / speed, z / speed
    over = mobility(p, j, x, y, z)
    impulse = drag * speed * speed * s / (1.0 + drag * over * speed * s)
    kick(p, v, j, impulse * x, impulse * y, impulse * z)


@kernel(allocates=False)
def damp_part(x, v, t, s, p, i, reverse):
    """Drag across and along part i."""
    n, j = p.cols, p.places[i, 0]
    qx, qy, qz = tangent_at(x, p, i)
    u, w, c, _, _, _, z = water_at(x, t, p, j)
    wet = submerged(p, i, z)
    for turn in range(2):
        rx, ry, rz = u - v[j], w - v[n + j], c - v[2 * n + j]
        along = rx * qx + ry * qy + rz * qz
        if in_turn(turn, 2, reverse) == 0:
            drag_along(v, s, p, j, wet * p.parts[i].drag_across, rx - along * qx, ry - along * qy, rz - along * qz)
        else:
            drag_along(v, s, p, j, wet * p.parts[i].drag_along, along * qx, along * qy, along * qz)


@kernel(allocates=False)
def damp(x, v, t, s, p, reverse):
    count = p.places.shape[0]
    for turn in range(count):
        damp_part(x, v, t, s, p, in_turn(turn, count, reverse), reverse)
    return 0.0


@kernel(allocates=False)
def energy(x, t, p):
    """Of buoyancy in still water [J]: its force times the integral of the submerged fraction over the height."""
    total = 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if is_moving(p, j):
            z = x[2 * p.cols + j]
            wet = submerged(p, i, z)
            total += p.gz * p.parts[i].displaced * (z if wet == 1.0 else -0.5 * p.parts[i].height * wet * wet)
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The drag takes, and the water puts in what it does beyond buoyancy in still water."""
    n, lost, work = p.cols, 0.0, 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        fx, fy, fz, taken = push_of(x, v, t, p, i, j, with_damping)
        lost += taken
        if is_moving(p, j):
            fz += submerged(p, i, x[2 * n + j]) * p.parts[i].displaced * p.gz
            work += fx * v[j] + fy * v[n + j] + fz * v[2 * n + j]
    return lost, lost + work


@kernel(allocates=False)
def inertia_power(x, v, a, p):
    """Power [W] that goes into the water which moves with the free nodes, at their accelerations a."""
    n, total = p.cols, 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if p.inverse_masses[j] > 0.0:
            qx, qy, qz = tangent_at(x, p, i)
            of_v = v[j] * qx + v[n + j] * qy + v[2 * n + j] * qz
            of_a = a[j] * qx + a[n + j] * qy + a[2 * n + j] * qz
            both = v[j] * a[j] + v[n + j] * a[n + j] + v[2 * n + j] * a[2 * n + j]
            across, along = p.parts[i].added_across, p.parts[i].added_along
            total += p.parts[i].displaced * (across * both + (along - across) * of_v * of_a)
    return total


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """K of buoyancy at the surface of still water, upright; no drag acts at rest."""
    n = p.cols
    for i in range(p.places.shape[0] if part in (STIFFNESS, STIFFEST) else 0):
        j, height = p.places[i, 0], p.parts[i].height
        if abs(x[2 * n + j]) < 0.5 * height:
            out[2 * n + j] -= p.gz * p.parts[i].displaced / height * u[2 * n + j]


FORCE = Force(
    "water", rank=60, nets=LINES, accelerate=accelerate, damp=damp, energy=energy, power=power, tangent=tangent,
)  # fmt: skip
