"""Water around lines: buoyancy, drag, and the push of waves and current, by Morison's law on each part.

As lumped-mass programs have it (Hall & Goupee 2015, Ocean Eng. 104:590), with q the unit tangent, along
r_{i+1} - r_{i-1}, u and du/dt the water's velocity and acceleration, and w = u - v:

  F = m_w g upwards + D_n |w_n| w_n + D_t |w_t| w_t
      + m_w [(1 + C_an) (du/dt - (du/dt . q) q) + (1 + C_at) (du/dt . q) q]
  D_n = rho/2 C_dn d l, D_t = rho/2 C_dt pi d l

The added mass is in the masses of `sim.springs.points.line_points`. At the surface the water pushes the submerged
fraction of a part's volume. A segment is straight from node to node, in PIECES of equal length. The submerged fraction
of a piece falls from 1 to 0 over the HEIGHT of the line's volume about the elevation at the node. A node takes the mean
over the pieces with the weight 1 - s, s the fraction of the way to the other node, which takes the rest. So buoyancy
is the gradient of a convex energy of the heights of the nodes, and a line that hangs from a fairlead in the surface is
wet up to there. The added mass stays.

Buoyancy stores energy about still water. What waves, current and the elevation give or take is work, and so is the
inertia of the water that moves with the lines: kinetic energy is that of lines and bodies alone.
"""

import math

from sim.jit import kernel
from sim.springs.forces.matrices import STIFFEST, STIFFNESS
from sim.springs.forces.record import LINES, Force
from sim.springs.points.arrays import is_moving, push
from sim.springs.points.line_points import tangent_at
from sim.waves import AMPLITUDE, sums_at

PIECES = 8  # of a segment at the surface


@kernel(inline=True)
def water_at(x, t, p, j):
    """Velocity [m/s] and acceleration [m/s^2] of the water at node j, and the elevation [m] of its surface there."""
    u, v, w, du, dv, dw, elevation = p.current[0], p.current[1], p.current[2], 0.0, 0.0, 0.0, 0.0
    if p.waves.shape[1] > 0:
        n = p.cols
        sums = sums_at(x[j], x[n + j], x[2 * n + j], t, p.waves, p.waves, AMPLITUDE, None, 0, p.depth)
        (wu, wv, ww), (du, dv, dw) = sums.velocity, sums.acceleration
        u, v, w, elevation = u + wu, v + wv, w + ww, sums.elevation
    return u, v, w, du, dv, dw, elevation


@kernel(inline=True)
def fraction(z, height):
    """Submerged fraction of a volume with its middle z [m] over the water's surface."""
    return min(max(0.5 - z / height, 0.0), 1.0)


@kernel(inline=True)
def wet_share(a, b, height):
    """Mean submerged fraction along a segment from a to b [m] over the surface, with the weight 2 (1 - s)."""
    if max(a, b) <= -0.5 * height:
        return 1.0
    if min(a, b) >= 0.5 * height:
        return 0.0
    total = 0.0
    for i in range(PIECES):
        s = (i + 0.5) / PIECES
        total += 2.0 / PIECES * (1.0 - s) * fraction(a + s * (b - a), height)
    return total


@kernel(inline=True)
def wet_slopes(a, b, height):
    """Derivatives [1/m] of -`wet_share` with respect to a and b."""
    own = other = 0.0
    if max(a, b) > -0.5 * height and min(a, b) < 0.5 * height:
        for i in range(PIECES):
            s = (i + 0.5) / PIECES
            if abs(a + s * (b - a)) < 0.5 * height:
                own += 2.0 / PIECES * (1.0 - s) * (1.0 - s) / height
                other += 2.0 / PIECES * (1.0 - s) * s / height
    return own, other


@kernel(inline=True)
def wet_potential(a, b, height):
    """Mean along a segment from a to b [m] of the potential of buoyancy in still water over minus its force [m]."""
    if max(a, b) <= -0.5 * height:
        return 0.5 * (a + b)
    total = 0.0
    for i in range(PIECES if min(a, b) < 0.5 * height else 0):
        z = a + (i + 0.5) / PIECES * (b - a)
        wet = fraction(z, height)
        total += (z if wet == 1.0 else -0.5 * height * wet * wet) / PIECES
    return total


@kernel(inline=True)
def neighbour(p, i, side):
    """The node next to that of part i on a side, 0 or 1; at the end of a line there is one; of a point it is itself."""
    j = p.places[i, 1 + side]
    return p.places[i, 2 - side] if j == p.places[i, 0] else j


@kernel(inline=True)
def submerged(x, p, i, elevation):
    """Submerged fraction of part i under a surface at this elevation [m]."""
    up, height, total = 2 * p.cols, p.parts[i].height, 0.0
    z = x[up + p.places[i, 0]] - elevation
    for side in range(2):
        total += 0.5 * wet_share(z, x[up + neighbour(p, i, side)] - elevation, height)
    return total


@kernel(inline=True)
def push_of(x, v, t, p, i, j, with_damping):
    """Force (3) [N] of the water on part i at node j, and the power [W] that its drag takes."""
    n = p.cols
    qx, qy, qz = tangent_at(x, p, i)
    u, w, s, du, dw, ds, elevation = water_at(x, t, p, j)
    wet, lost = submerged(x, p, i, elevation), 0.0
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
def energy(x, t, p):
    """Energy of buoyancy in still water [J], that of prescribed nodes too: it depends on the free ones beside them."""
    up, total = 2 * p.cols, 0.0
    for i in range(p.places.shape[0]):
        z = x[up + p.places[i, 0]]
        for side in range(2):
            mean = wet_potential(z, x[up + neighbour(p, i, side)], p.parts[i].height)
            total += 0.5 * p.gz * p.parts[i].displaced * mean
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """Drag takes; waves and current put in their work, and prescribed nodes that against buoyancy in still water."""
    n, lost, work = p.cols, 0.0, 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        fx, fy, fz, taken = push_of(x, v, t, p, i, j, with_damping)
        lost += taken
        if not is_moving(p, j):
            fx = fy = fz = 0.0
        fz += submerged(x, p, i, 0.0) * p.parts[i].displaced * p.gz
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
    up = 2 * p.cols
    for i in range(p.places.shape[0] if part in (STIFFNESS, STIFFEST) else 0):
        j = p.places[i, 0]
        for side in range(2):
            k = neighbour(p, i, side)
            own, other = wet_slopes(x[up + j], x[up + k], p.parts[i].height)
            out[up + j] -= 0.5 * p.gz * p.parts[i].displaced * (own * u[up + j] + other * u[up + k])


FORCE = Force(
    "water", rank=60, nets=LINES, accelerate=accelerate, energy=energy, power=power, tangent=tangent,
)  # fmt: skip
