"""Penalty contact of a rope's links with the sphere, as capsules of the rope's radius.

A link stores k/2 depth^2 at its place that is nearest to the sphere's centre, a part s of it from its first point, 0 to
1. The force goes to the ends by (1 - s, s): momentum and angular momentum stay. It is continuous as s leaves 0 or 1.
The points of such a rope do not touch the sphere themselves; where two links touch it at their common point, both
push that. A flat floor touches a capsule at its ends, so that there the contact of points is that of links. Friction
acts at the points (`sim.springs.forces.friction`).
"""

import math

from sim.jit import kernel
from sim.springs.forces.contact import clipped_flow
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import CHAINS, Force
from sim.springs.points.arrays import push, span
from sim.springs.points.each_link import each_link, stretch
from sim.springs.points.link_places import links_near, place_motion, place_on_link, place_slip, push_on_link


@kernel(inline=True)
def mobility(p, a, s):
    """Inverse mass [1/kg] of the place of a link from point a that is a part s of it away."""
    return (1.0 - s) * (1.0 - s) * p.inverse_masses[a] + s * s * p.inverse_masses[a + 1]


@kernel(inline=True)
def is_free(p, link):
    """True if an end of a link is not pinned."""
    return p.inverse_masses[link.a] > 0.0 or p.inverse_masses[link.b] > 0.0


@kernel(inline=True)
def add_at(out, j, n, s, nx, ny, nz):
    out[j] += s * nx
    out[n + j] += s * ny
    out[2 * n + j] += s * nz


@each_link(noalias=True)
def push_links(link, x, v, t, p, with_damping, a):
    place = place_on_link(x, t, p, link.a)
    if place.depth > 0.0:
        fx, fy, fz = push_on_link(v, p, place, with_damping)
        s = place.s
        push(p, a, link.a, (1.0 - s) * fx, (1.0 - s) * fy, (1.0 - s) * fz)
        push(p, a, link.b, s * fx, s * fy, s * fz)


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    if links_near(x, t, p):
        push_links(x, v, t, p, with_damping, a)


@each_link("sum")
def damp_links(link, x, v, a, mean, t, s, p, reverse):
    place = place_on_link(x, t, p, link.a)
    if not (place.depth > 0.0 and is_free(p, link)):
        return 0.0
    nx, ny, nz, n, w = place.nx, place.ny, place.nz, p.cols, mobility(p, place.a, place.s)
    u, q, r = place_slip(v, p, place)
    kicked, most, pull = u * nx + q * ny + r * nz, p.contact_k * place.depth, 0.0
    if a.shape[0] > 0:
        u, q, r = place_motion(a, p, place)
        pull = u * nx + q * ny + r * nz
    if w > 0.0:
        edge, before = most / p.contact_b if p.contact_b > 0.0 else math.inf, kicked - s * pull
        after, normal = clipped_flow(before, pull, pull - most * w, p.contact_b * w, 0.0, edge, s)
        impulse, share = (after - kicked) / w, (normal - before - 0.5 * s * pull) / w
    else:  # the place is that of a pin
        impulse, share = -s * min(most, p.contact_b * kicked), 0.0
    wa, wb = (1.0 - place.s) * p.inverse_masses[link.a], place.s * p.inverse_masses[link.b]
    add_at(v, link.a, n, wa * impulse, nx, ny, nz)
    add_at(v, link.b, n, wb * impulse, nx, ny, nz)
    if mean.shape[0] > 0:
        add_at(mean, link.a, n, wa * share, nx, ny, nz)
        add_at(mean, link.b, n, wb * share, nx, ny, nz)
    return impulse * (nx * p.svx + ny * p.svy + nz * p.svz)


@kernel(inline=True)
def damp_kicked(x, v, a, mean, t, s, p, reverse):
    """Normal damping in a kick for a time s [s] by the accelerations a, after these have changed v: link by link.

    For one link kick and damping together are exact at its depth, and so is the mean velocity, if there is room for it:
    the place of contact follows v' = pull - b w v from its velocity before the kick, w its mobility. One order of the
    links and its reverse are adjoint to each other. Returns the work [J] of a moving sphere.
    """
    return damp_links(x, v, a, mean, t, s, p, reverse) if links_near(x, t, p) else 0.0


@kernel(noalias=True, allocates=False)
def damp(x, v, t, s, p, reverse):
    """Normal damping alone for a time s [s], link by link, exact for one. Returns the work [J] of a moving sphere."""
    return damp_kicked(x, v, v[:0], v[:0], t, s, p, reverse)


@each_link("sum")
def energy_of_links(link, x, t, p):
    depth = place_on_link(x, t, p, link.a).depth
    return 0.5 * p.contact_k * depth * depth if depth > 0.0 and is_free(p, link) else 0.0


@kernel(noalias=True, allocates=False)
def energy(x, t, p):
    """1/2 k depth^2 over the touching links that are not pinned at both ends [J]."""
    return energy_of_links(x, t, p) if links_near(x, t, p) else 0.0


@each_link("two sums")
def power_of_links(link, x, v, t, p, with_damping, by_sphere):
    place = place_on_link(x, t, p, link.a)
    if not (place.depth > 0.0 and is_free(p, link)):
        return 0.0, 0.0
    n, s = p.cols, place.s
    u, q, r = place_slip(v, p, place)
    fx, fy, fz = push_on_link(v, p, place, with_damping)
    spring = p.contact_k * place.depth
    dissipated = -((fx - spring * place.nx) * u + (fy - spring * place.ny) * q + (fz - spring * place.nz) * r)
    work = by_sphere * (fx * p.svx + fy * p.svy + fz * p.svz)
    if p.inverse_masses[link.a] == 0.0:
        work -= (1.0 - s) * (fx * v[link.a] + fy * v[n + link.a] + fz * v[2 * n + link.a])
    if p.inverse_masses[link.b] == 0.0:
        work -= s * (fx * v[link.b] + fy * v[n + link.b] + fz * v[2 * n + link.b])
    return dissipated, work


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere and by moving pins) [W] through the touching links."""
    return power_of_links(x, v, t, p, with_damping, 1.0) if links_near(x, t, p) else (0.0, 0.0)


@kernel(allocates=False)
def pins_power(x, v, t, p):
    """Power [W] that moving pins put in through the damping of the touching links."""
    if p.pins.shape[0] == 0 or not links_near(x, t, p):
        return 0.0
    return power_of_links(x, v, t, p, True, 0.0)[1] - power_of_links(x, v, t, p, False, 0.0)[1]


@each_link(noalias=True)
def tangent(link, x, u, t, p, part, longest, out):
    """Every touching link: K and D = b n n^T of its place of contact, with the change of the place in K.

    With w the motion of the place, r that of the second end relative to the first, T the link's direction, l its length
    and R the distance from the sphere's centre, K is the second derivative of the energy

        (k (n w)^2 - k depth/R (|w|^2 - (n w)^2 - q^2)) / 2,  q = T w + R/l n r between the ends, 0 at one.
    """
    if part in (TRANSVERSE, FRICTION):
        return
    place = place_on_link(x, t, p, link.a)
    if not place.depth > 0.0:
        return
    n, s, nx, ny, nz = p.cols, place.s, place.nx, place.ny, place.nz
    du, dv, dw = span(u, n, link.a, link.b)
    wx, wy, wz = u[link.a] + s * du, u[n + link.a] + s * dv, u[2 * n + link.a] + s * dw
    along = nx * wx + ny * wy + nz * wz
    stiffness, across, turn = p.contact_k, 0.0, 0.0
    tx, ty, tz, length = stretch(x, p, link)
    tx, ty, tz = tx / length, ty / length, tz / length
    if part == DAMPING:
        stiffness = p.contact_b
    else:
        distance = max(p.sr - place.depth, place.depth)
        across = -p.contact_k * place.depth / distance
        if 0.0 < s < 1.0:
            turn = tx * wx + ty * wy + tz * wz + distance / length * (nx * du + ny * dv + nz * dw)
    fx = stiffness * along * nx + across * (wx - along * nx - turn * tx)
    fy = stiffness * along * ny + across * (wy - along * ny - turn * ty)
    fz = stiffness * along * nz + across * (wz - along * nz - turn * tz)
    g = p.contact_k * place.depth * turn / length
    add_at(out, link.a, n, 1.0, (1.0 - s) * fx - g * nx, (1.0 - s) * fy - g * ny, (1.0 - s) * fz - g * nz)
    add_at(out, link.b, n, 1.0, s * fx + g * nx, s * fy + g * ny, s * fz + g * nz)


@kernel(inline=True)
def block_size(v, g, p, place):
    """g b + g^2 k of a link that the sphere pushes, else 0."""
    u, q, r = place_slip(v, p, place)
    leaving = p.contact_b * (u * place.nx + q * place.ny + r * place.nz)
    pushes = place.depth > 0.0 and p.contact_k * place.depth > leaving
    return g * p.contact_b + g * g * p.contact_k if pushes else 0.0


@each_link()
def blocks(link, x, v, t, g, p, points):
    place = place_on_link(x, t, p, link.a)
    size, s, n = block_size(v, g, p, place), place.s, p.cols
    add_block(points, link.a, n, (1.0 - s) * (1.0 - s) * size, 0.0, place.nx, place.ny, place.nz)
    add_block(points, link.b, n, s * s * size, 0.0, place.nx, place.ny, place.nz)


@each_link()
def pair_blocks(link, x, v, t, g, p, pairs):
    place = place_on_link(x, t, p, link.a)
    size = (1.0 - place.s) * place.s * block_size(v, g, p, place)
    add_block(pairs, link.a, p.cols, size, 0.0, place.nx, place.ny, place.nz)


FORCE = Force(
    "link_contact", rank=41, nets=CHAINS, acts="p.links_touch", accelerate=accelerate, damp=damp, energy=energy,
    power=power, pins_power=pins_power, tangent=tangent, blocks=blocks, pair_blocks=pair_blocks, stores="contact",
)  # fmt: skip
