"""Penalty contact with floor and sphere, and Coulomb friction.

Friction is regularised by the step: a point is never given more tangential force than would stop it within one step
(stop_rate = 1/h), so its strongest damping has h gamma = 1, inside every integrator's limit. At rest on a slope a point
creeps at most h g sin(alpha).
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.net import mass_at


@kernel(inline=True)
def touching(x, y, z, t, p, on_sphere):
    """(depth, nx, ny, nz) of a point against the floor or the sphere; depth <= 0 is no contact."""
    if on_sphere:
        s = t - p.epoch
        dx, dy, dz = x - p.sx - s * p.svx, y - p.sy - s * p.svy, z - p.sz - s * p.svz
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        if distance == 0.0:
            return p.sr, 0.0, 0.0, 1.0
        return p.sr - distance, dx / distance, dy / distance, dz / distance
    return p.floor - z, 0.0, 0.0, 1.0


@kernel(inline=True)
def contact_force(depth, nx, ny, nz, u, v, w, mass, p, on_sphere, with_damping):
    """Force (fx, fy, fz) on a point of `mass` at `depth` that moves at (u, v, w) relative to the surface."""
    k, b = p.contact_k, p.contact_b
    if not with_damping:
        return k * depth * nx, k * depth * ny, k * depth * nz
    if p.lab_contact:
        if on_sphere:
            b *= depth
        return k * depth * nx - b * u, k * depth * ny - b * v, k * depth * nz - b * w
    vn = u * nx + v * ny + w * nz
    normal = max(0.0, k * depth - b * vn)
    fx, fy, fz = normal * nx, normal * ny, normal * nz
    if p.friction > 0.0:
        tx, ty, tz = u - vn * nx, v - vn * ny, w - vn * nz
        speed = math.sqrt(tx * tx + ty * ty + tz * tz)
        # F_t = -mu N t/|t|, at most what stops the point within the step
        grip = mass * p.stop_rate
        if p.friction * normal < grip * speed:
            grip = p.friction * normal / speed
        fx -= grip * tx
        fy -= grip * ty
        fz -= grip * tz
    return fx, fy, fz


@kernel(inline=True)
def surface_velocity(p, on_sphere):
    if on_sphere:
        return p.svx, p.svy, p.svz
    return 0.0, 0.0, 0.0


@kernel(noalias=True, inline=True)
def lowest(x, n):
    """Least z, so that a net above the floor costs one comparison a point."""
    least = math.inf
    for j in range(n):
        least = min(least, x[n + n + j])
    return least


@kernel(noalias=True, inline=True)
def nearest(x, n, cx, cy, cz):
    """Least squared distance of any point from (cx, cy, cz)."""
    least = math.inf
    for j in range(n):
        dx, dy, dz = x[j] - cx, x[n + j] - cy, x[n + n + j] - cz
        least = min(least, dx * dx + dy * dy + dz * dz)
    return least


@kernel(noalias=True, allocates=False)
def touches(x, t, p, on_sphere):
    """True if any point is in contact."""
    n = np.uint64(p.rows * p.cols)
    if on_sphere:
        s = t - p.epoch
        return p.has_sphere and nearest(x, n, p.sx + s * p.svx, p.sy + s * p.svy, p.sz + s * p.svz) < p.sr * p.sr
    return p.has_floor and lowest(x, n) < p.floor


@kernel(noalias=True, allocates=False)
def add_contacts(x, v, t, p, with_damping, a):
    """Add the accelerations of floor and sphere."""
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth > 0.0:
                ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
                fx, fy, fz = contact_force(depth, nx, ny, nz, ru, rv, rw, mass_at(p, j), p, on_sphere, with_damping)
                w = p.inverse_masses[j]
                a[j] += w * fx
                a[n + j] += w * fy
                a[2 * n + j] += w * fz
