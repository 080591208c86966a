"""Penalty contact of points with floor and sphere; `sim.springs.forces.friction` has its friction.

A rope's links touch the sphere instead of its points, if they touch it (`sim.springs.forces.link_contact`).
"""

import math

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block, add_product
from sim.springs.forces.record import SPRING_NETS, Force
from sim.springs.kicks.formula import relaxed, shares
from sim.springs.points.arrays import push
from sim.springs.points.each_contact import each_contact, points_meet_sphere, slip, surface_velocity
from sim.springs.points.link_places import contact_force, touching


@each_contact(noalias=True)
def accelerate(touch, x, v, t, p, with_damping, f, a):
    u, q, r = slip(v, p.rows * p.cols, touch)
    fx, fy, fz = contact_force(
        touch.depth, touch.nx, touch.ny, touch.nz, u, q, r, p, touch.on_sphere, with_damping
    )  # fmt: skip
    push(p, a, touch.j, fx, fy, fz)


@kernel(inline=True)
def clipped_flow(u, pull, free_pull, damped_rate, free_rate, edge, s):
    """Normal velocity after a time s [s] of u' = pull - damped_rate u, or free_pull - free_rate u above `edge`.

    Also its mean. Above, contact takes no more than its whole push. Both are one acceleration at the edge, so that the
    velocity crosses it once at most.
    """
    below = u < edge
    first_pull, first_rate = (pull, damped_rate) if below else (free_pull, free_rate)
    after, mean = relaxed(u, first_pull, first_rate, s)
    if below != (after < edge):
        w = first_pull - first_rate * u
        part = first_rate * (edge - u) / w
        time = (edge - u) / w if abs(part) < 1e-8 else -math.log1p(-part) / first_rate
        _, before = relaxed(u, first_pull, first_rate, time)
        second_pull, second_rate = (free_pull, free_rate) if below else (pull, damped_rate)
        after, mean = relaxed(edge, second_pull, second_rate, s - time)
        mean = (time * before + (s - time) * mean) / s
    return after, mean


@kernel(inline=True)
def push_point(v, mean, j, depth, nx, ny, nz, ax, ay, az, drag, s, p, on_sphere):
    """Move the velocity of a touching point by its acceleration, the damping of contact along its normal, and drag.

    Sets its mean too, if there is room. Returns the work [J] that a moving sphere did by its damping.
    """
    n, w = p.rows * p.cols, p.inverse_masses[j]
    su, sv, sw = surface_velocity(p, on_sphere)
    c, b = drag * w, p.contact_b * w
    ax, ay, az = ax - c * su, ay - c * sv, az - c * sw  # drag is that of the whole velocity
    ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
    if p.lab_contact:
        b *= depth if on_sphere else 1.0
        (u, mu), (q, mv), (r, mw) = relaxed(ru, ax, b + c, s), relaxed(rv, ay, b + c, s), relaxed(rw, az, b + c, s)
    else:
        push = p.contact_k * depth * w
        pull, vn = ax * nx + ay * ny + az * nz, ru * nx + rv * ny + rw * nz
        edge = push / b if b > 0.0 else math.inf
        after, normal = clipped_flow(vn, pull, pull - push, b + c, c, edge, s)
        first, second = shares(c, s)
        wx, wy, wz = ax - pull * nx, ay - pull * ny, az - pull * nz
        wx, wy, wz = wx - c * (ru - vn * nx), wy - c * (rv - vn * ny), wz - c * (rw - vn * nz)
        u, q, r = ru + first * wx, rv + first * wy, rw + first * wz
        mu, mv, mw = ru + second * wx, rv + second * wy, rw + second * wz
        u, q, r = u + (after - vn) * nx, q + (after - vn) * ny, r + (after - vn) * nz
        mu, mv, mw = mu + (normal - vn) * nx, mv + (normal - vn) * ny, mw + (normal - vn) * nz
    if mean.shape[0] > 0:
        mean[j], mean[n + j], mean[2 * n + j] = mu + su, mv + sv, mw + sw
    v[j], v[n + j], v[2 * n + j] = u + su, q + sv, r + sw
    # The damping gave the rest of the change of momentum.
    du, dv, dw = u - ru - s * (ax - c * mu), q - rv - s * (ay - c * mv), r - rw - s * (az - c * mw)
    return (du * su + dv * sv + dw * sw) / w


@kernel(allocates=False)
def kick_touching(x, v, a, drag, t, s, p, mean):
    """Move each point's velocity for a time s [s] by its acceleration, the normal damping of contact, and drag: exact.

    a: accelerations (3 points,) [m/s2] by all forces of position. drag: [N s/m]. mean: set to mean velocities, or
    empty. Of a point that touches both surfaces the damping of the sphere follows alone. Returns the work [J] that a
    moving sphere did by its damping.
    """
    n, work = p.rows * p.cols, 0.0
    for j in range(n):
        w, kicked = p.inverse_masses[j], False
        if w == 0.0:
            continue
        ax, ay, az = a[j], a[n + j], a[2 * n + j]
        if p.has_floor:
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, False)
            if depth > 0.0:
                work += push_point(v, mean, j, depth, nx, ny, nz, ax, ay, az, drag, s, p, False)
                kicked = True
        if points_meet_sphere(p):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, True)
            if depth > 0.0 and not kicked:
                work += push_point(v, mean, j, depth, nx, ny, nz, ax, ay, az, drag, s, p, True)
                kicked = True
            elif depth > 0.0:
                work += push_point(v, mean[:0], j, depth, nx, ny, nz, 0.0, 0.0, 0.0, 0.0, s, p, True)
        if not kicked:
            first, second = shares(drag * w, s)
            for e in range(3):
                i = e * n + j
                change = a[i] - drag * w * v[i]
                if mean.shape[0] > 0:
                    mean[i] = v[i] + second * change
                v[i] += first * change
    return work


@each_contact("sum")
def damp(touch, x, v, t, s, p, reverse):
    """Normal damping alone for a time s [s]: exact. Returns the work [J] that a moving sphere did."""
    if p.inverse_masses[touch.j] == 0.0:
        return 0.0
    depth, nx, ny, nz = touch.depth, touch.nx, touch.ny, touch.nz
    return push_point(v, v[:0], touch.j, depth, nx, ny, nz, 0.0, 0.0, 0.0, 0.0, s, p, touch.on_sphere)


@each_contact("sum")
def energy(touch, x, t, p):
    """1/2 k depth^2 over the touching points [J]."""
    return 0.5 * p.contact_k * touch.depth * touch.depth if p.inverse_masses[touch.j] > 0.0 else 0.0


@each_contact("two sums")
def power(touch, x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere) [W] through contact."""
    depth, nx, ny, nz = touch.depth, touch.nx, touch.ny, touch.nz
    if p.inverse_masses[touch.j] == 0.0:
        return 0.0, 0.0
    u, q, r = slip(v, p.rows * p.cols, touch)
    fx, fy, fz = contact_force(depth, nx, ny, nz, u, q, r, p, touch.on_sphere, with_damping)
    spring = p.contact_k * depth
    dissipated = -((fx - spring * nx) * u + (fy - spring * ny) * q + (fz - spring * nz) * r)
    return dissipated, fx * touch.su + fy * touch.sv + fz * touch.sw


@each_contact(noalias=True)
def tangent(touch, x, u, t, p, part, longest, out):
    """Every touching point: K = k [n n^T - depth/r (I - n n^T)] with r the distance to the sphere's centre."""
    if part in (TRANSVERSE, FRICTION):
        return
    depth, nx, ny, nz = touch.depth, touch.nx, touch.ny, touch.nz
    along = p.contact_k
    across = -p.contact_k * depth / max(p.sr - depth, depth) if touch.on_sphere else 0.0
    if part == DAMPING:
        along = p.contact_b
        if p.lab_contact and touch.on_sphere:
            along *= depth
        across = along if p.lab_contact else 0.0
    add_product(out, u, touch.j, p.rows * p.cols, along, across, nx, ny, nz)


@each_contact()
def blocks(touch, x, v, t, g, p, points):
    """g^2 k n n^T of touching points, and their damping."""
    depth, nx, ny, nz = touch.depth, touch.nx, touch.ny, touch.nz
    b, n = p.contact_b, p.rows * p.cols
    u, q, r = slip(v, n, touch)
    vn = u * nx + q * ny + r * nz
    along, across = g * g * p.contact_k, 0.0
    if p.lab_contact:
        across = g * b * (depth if touch.on_sphere else 1.0)
        along += across
    else:
        if p.contact_k * depth <= b * vn:
            return
        along += g * b
    add_block(points, touch.j, n, along, across, nx, ny, nz)


FORCE = Force(
    "contact", rank=40, nets=SPRING_NETS, acts="p.has_floor or p.has_sphere", accelerate=accelerate, damp=damp,
    energy=energy, power=power, tangent=tangent, blocks=blocks, stores="contact",
)  # fmt: skip
