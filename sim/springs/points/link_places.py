"""Places of a rope's links that are nearest to the sphere: there they touch it, as capsules of the rope's radius."""

import math
from typing import NamedTuple

import numpy as np

from sim import point_laws
from sim.jit import kernel
from sim.springs.points.arrays import span
from sim.springs.points.each_link import TINY

touching = kernel(inline=True)(point_laws.touching)
contact_force = kernel(inline=True)(point_laws.contact_force)


class LinkPlace(NamedTuple):
    """The place of a link that is nearest to the sphere's centre."""

    a: int  # the link's first point; its second is the next one
    s: float  # part of the link before the place, from 0 to 1
    depth: float  # [m], above 0 in contact
    nx: float  # normal of the sphere
    ny: float
    nz: float


@kernel(noalias=True, inline=True)
def sphere_gap(x, n, t, p):
    """Least squared distance of any point from the sphere's centre, less that at which it touches."""
    least, s = math.inf, t - p.epoch
    cx, cy, cz = p.sx + s * p.svx, p.sy + s * p.svy, p.sz + s * p.svz
    for j in range(n):
        dx, dy, dz = x[j] - cx, x[n + j] - cy, x[n + n + j] - cz
        least = min(least, dx * dx + dy * dy + dz * dz)
    return least - p.sr * p.sr


@kernel(noalias=True, inline=True)
def longest(x, n):
    """Largest squared length of a link of a rope."""
    most, one = 0.0, np.uint64(1)
    for j in range(n - one):
        i = j + one
        dx, dy, dz = x[i] - x[j], x[n + i] - x[n + j], x[n + n + i] - x[n + n + j]
        most = max(most, dx * dx + dy * dy + dz * dz)
    return most


@kernel(noalias=True, allocates=False)
def links_near(x, t, p):
    """False if no link of a rope can touch the sphere, as each comes nearer to it than its ends by half its length."""
    if not p.links_touch:
        return False
    n = np.uint64(p.cols)
    gap = sphere_gap(x, n, t, p)
    return gap < 0.0 or gap < 0.25 * longest(x, n)


@kernel(inline=True)
def place_on_link(x, t, p, a):
    """The `LinkPlace` of the link from point a of a rope to the next."""
    n, s = p.cols, t - p.epoch
    rx, ry, rz = span(x, n, a, a + 1)
    ax, ay, az = x[a], x[n + a], x[2 * n + a]
    dx, dy, dz = p.sx + s * p.svx - ax, p.sy + s * p.svy - ay, p.sz + s * p.svz - az
    part = min(1.0, max(0.0, (dx * rx + dy * ry + dz * rz) / (rx * rx + ry * ry + rz * rz + TINY)))
    depth, nx, ny, nz = touching(ax + part * rx, ay + part * ry, az + part * rz, t, p, True)
    return LinkPlace(a, part, depth, nx, ny, nz)


@kernel(inline=True)
def place_motion(v, p, place):
    """Velocity or acceleration of a place of a link."""
    n, a, s = p.cols, place.a, place.s
    du, dv, dw = span(v, n, a, a + 1)
    return v[a] + s * du, v[n + a] + s * dv, v[2 * n + a] + s * dw


@kernel(inline=True)
def place_slip(v, p, place):
    """Velocity [m/s] of a place of a link relative to the sphere."""
    u, q, r = place_motion(v, p, place)
    return u - p.svx, q - p.svy, r - p.svz


@kernel(inline=True)
def push_on_link(v, p, place, with_damping):
    """Normal force (3,) [N] of the sphere on a touching link."""
    u, q, r = place_slip(v, p, place)
    return contact_force(place.depth, place.nx, place.ny, place.nz, u, q, r, p, True, with_damping)
