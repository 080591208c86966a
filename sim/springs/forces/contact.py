"""Penalty contact with floor and sphere; `sim.springs.forces.friction` has its friction."""

import math

import numpy as np

from sim import point_laws
from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block, add_product
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.points.arrays import push
from sim.springs.points.order import in_turn

touching = kernel(inline=True)(point_laws.touching)
contact_force = kernel(inline=True)(point_laws.contact_force)


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
def accelerate(x, v, t, p, with_damping, f, a):
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
                fx, fy, fz = contact_force(depth, nx, ny, nz, ru, rv, rw, p, on_sphere, with_damping)
                push(p, a, j, fx, fy, fz)


@kernel(allocates=False)
def damp_on(x, v, t, s, p, on_sphere, reverse):
    """Contact damping of every touching point, exact, except that separating points get at most their push."""
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
        b = p.contact_b
        if p.lab_contact:
            keep = math.exp(-(b * depth if on_sphere else b) * w * s)
            ru, rv, rw = ru * keep, rv * keep, rw * keep
        else:
            vn = ru * nx + rv * ny + rw * nz
            # The whole normal force, k depth - b v_n, never pulls: separating, damping takes at most k depth.
            change = max(vn * math.exp(-b * w * s), vn - p.contact_k * depth * w * s) - vn
            ru, rv, rw = ru + change * nx, rv + change * ny, rw + change * nz
        if moves:
            work += ((ru + su - v[j]) * su + (rv + sv - v[n + j]) * sv + (rw + sw - v[2 * n + j]) * sw) / w
        v[j], v[n + j], v[2 * n + j] = ru + su, rv + sv, rw + sw
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
def energy(x, t, p):
    """1/2 k depth^2 over the touching points [J]."""
    total = 0.0
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if p.has_sphere if on_sphere else p.has_floor:
            for j in range(n):
                depth, _, _, _ = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
                if depth > 0.0 and p.inverse_masses[j] > 0.0:
                    total += 0.5 * p.contact_k * depth * depth
    return total


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere) [W] through contact."""
    dissipated = 0.0
    work = 0.0
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        if not with_damping and su == 0.0 and sv == 0.0 and sw == 0.0:
            continue
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth > 0.0 and p.inverse_masses[j] > 0.0:
                ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
                fx, fy, fz = contact_force(depth, nx, ny, nz, ru, rv, rw, p, on_sphere, with_damping)
                push = p.contact_k * depth
                dissipated -= (fx - push * nx) * ru + (fy - push * ny) * rv + (fz - push * nz) * rw
                work += fx * su + fy * sv + fz * sw
    return dissipated, work


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """Every touching point: K = k [n n^T - depth/r (I - n n^T)] with r the distance to the sphere's centre."""
    n = p.rows * p.cols
    if part in (TRANSVERSE, FRICTION):
        return
    for surface in range(2):
        on_sphere = surface == 1
        if not (p.has_sphere if on_sphere else p.has_floor):
            continue
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0:
                continue
            along = p.contact_k
            across = -p.contact_k * depth / max(p.sr - depth, depth) if on_sphere else 0.0
            if part == DAMPING:
                along = p.contact_b
                if p.lab_contact and on_sphere:
                    along *= depth
                across = along if p.lab_contact else 0.0
            add_product(out, u, j, n, along, across, nx, ny, nz)


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """g^2 k n n^T of touching points, and their damping."""
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not (p.has_sphere if on_sphere else p.has_floor):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth <= 0.0:
                continue
            b = p.contact_b
            ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
            vn = ru * nx + rv * ny + rw * nz
            along, across = g * g * p.contact_k, 0.0
            if p.lab_contact:
                across = g * b * (depth if on_sphere else 1.0)
                along += across
            else:
                if p.contact_k * depth <= b * vn:
                    continue
                along += g * b
            add_block(points, j, n, along, across, nx, ny, nz)


FORCE = Force(
    "contact", rank=40, nets=SPRING_NETS, acts="p.has_floor or p.has_sphere", accelerate=accelerate, damp=damp,
    energy=energy, power=power, tangent=tangent, blocks=blocks, stores="contact",
)  # fmt: skip
