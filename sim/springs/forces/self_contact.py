"""A net against itself: particles nearer than the thickness push each other apart, neighbours on the grid excepted.

Pairs and neighbours are those of `sim.springs.near.near_pairs`, so that a flat net that is thick beside its spacing
does not push itself apart. Below a thickness of 0.71 of the spacing a particle in the middle of a cell feels no force;
that it does not pass, `sim.springs.kicks.apart` achieves. Of a chain the links touch
(`sim.springs.forces.strand_contact`).
"""

import math

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import WIDE_NETS, Force
from sim.springs.near.near_pairs import pairs_at_hand, refresh_pairs
from sim.springs.points.each_link import TINY
from sim.springs.points.order import in_turn


@kernel(inline=True)
def push_apart(out, i, j, n, wi, wj, dx, dy, dz):
    """out -= wi d at particle i and += wj d at j; d = (dx, dy, dz) from i to j."""
    out[i] -= wi * dx
    out[n + i] -= wi * dy
    out[2 * n + i] -= wi * dz
    out[j] += wj * dx
    out[n + j] += wj * dy
    out[2 * n + j] += wj * dz


@kernel(allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    """Add the accelerations of touching pairs, max(0, k depth - b v_n) each way."""
    n = p.rows * p.cols
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        rr = dx * dx + dy * dy + dz * dz
        if rr >= p.thickness * p.thickness or rr == 0.0:
            continue
        r = math.sqrt(rr)
        push = p.contact_k * (p.thickness - r)
        if with_damping:
            opening = (v[j] - v[i]) * dx + (v[n + j] - v[n + i]) * dy + (v[2 * n + j] - v[2 * n + i]) * dz
            push = max(0.0, push - p.contact_b * opening / r)
        push /= r
        push_apart(a, i, j, n, p.inverse_masses[i] * push, p.inverse_masses[j] * push, dx, dy, dz)


@kernel(allocates=False)
def damp(x, v, t, s, p, reverse):
    """Damping of touching pairs alone for a time s [s]: exact, except that separating pairs get at most their push.

    A kick comes after the accelerations at its x, so that the list of pairs is that of x.
    """
    n = p.rows * p.cols
    count = pairs_at_hand(x, p)
    for turn in range(count):
        pair = in_turn(turn, count, reverse)
        i, j = p.pairs[pair, 0], p.pairs[pair, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        rr = dx * dx + dy * dy + dz * dz
        both = p.inverse_masses[i] + p.inverse_masses[j]
        if rr >= p.thickness * p.thickness or rr == 0.0 or both == 0.0:
            continue
        r = math.sqrt(rr)
        opening = ((v[j] - v[i]) * dx + (v[n + j] - v[n + i]) * dy + (v[2 * n + j] - v[2 * n + i]) * dz) / r
        after = max(opening * math.exp(-p.contact_b * both * s), opening - p.contact_k * (p.thickness - r) * both * s)
        change = (after - opening) / (both * r)
        push_apart(v, i, j, n, p.inverse_masses[i] * change, p.inverse_masses[j] * change, dx, dy, dz)
    return 0.0


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """(dissipated, put in by moving pins) [W] through the touching pairs."""
    n = p.rows * p.cols
    dissipated = work = 0.0
    if not with_damping and p.pins.shape[0] == 0:
        return dissipated, work
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        rr = dx * dx + dy * dy + dz * dz
        if rr >= p.thickness * p.thickness or rr == 0.0:
            continue
        r = math.sqrt(rr)
        of_i = (v[i] * dx + v[n + i] * dy + v[2 * n + i] * dz) / r
        of_j = (v[j] * dx + v[n + j] * dy + v[2 * n + j] * dz) / r
        spring = p.contact_k * (p.thickness - r)
        push = max(0.0, spring - p.contact_b * (of_j - of_i)) if with_damping else spring
        dissipated -= (push - spring) * (of_j - of_i)
        work += push * ((of_i if p.inverse_masses[i] == 0.0 else 0.0) - (of_j if p.inverse_masses[j] == 0.0 else 0.0))
    return dissipated, work


@kernel(allocates=False)
def energy(x, t, p):
    """1/2 k depth^2 over the touching pairs [J]."""
    n = p.rows * p.cols
    total = 0.0
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        total += 0.5 * p.contact_k * max(0.0, p.thickness - math.sqrt(dx * dx + dy * dy + dz * dz)) ** 2
    return total


@kernel
def pins_power(x, v, t, p):
    return power(x, v, t, p, True)[1] - power(x, v, t, p, False)[1]


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """The net's touching pairs: K = k [n n^T - depth/r (I - n n^T)] between the two, D = b n n^T."""
    if part in (TRANSVERSE, FRICTION):
        return
    n = p.rows * p.cols
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        rx, ry, rz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        rr = rx * rx + ry * ry + rz * rz
        if rr >= p.thickness * p.thickness or rr == 0.0:
            continue
        along, across = p.contact_b, 0.0
        if part != DAMPING:
            along, across = p.contact_k, p.contact_k * max(-1.0, 1.0 - p.thickness / math.sqrt(rr))
        du, dv, dw = u[j] - u[i], u[n + j] - u[n + i], u[2 * n + j] - u[2 * n + i]
        q = (along - across) * (rx * du + ry * dv + rz * dw) / rr
        fx, fy, fz = across * du + q * rx, across * dv + q * ry, across * dw + q * rz
        out[i] -= fx
        out[n + i] -= fy
        out[2 * n + i] -= fz
        out[j] += fx
        out[n + j] += fy
        out[2 * n + j] += fz


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """(g b + g^2 k) n n^T of each pair that pushes, twice at each of two free particles: they may move apart."""
    n = p.rows * p.cols
    stiffness = g * p.contact_b + g * g * p.contact_k
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        r = math.sqrt(dx * dx + dy * dy + dz * dz + TINY)
        opening = ((v[j] - v[i]) * dx + (v[n + j] - v[n + i]) * dy + (v[2 * n + j] - v[2 * n + i]) * dz) / r
        if r < p.thickness and p.contact_k * (p.thickness - r) > p.contact_b * opening:
            along = stiffness if p.inverse_masses[i] == 0.0 or p.inverse_masses[j] == 0.0 else 2.0 * stiffness
            add_block(points, i, n, along, 0.0, dx / r, dy / r, dz / r)
            add_block(points, j, n, along, 0.0, dx / r, dy / r, dz / r)


FORCE = Force(
    "self_contact", rank=30, nets=WIDE_NETS, acts="p.thickness > 0.0", accelerate=accelerate, damp=damp,
    energy=energy, power=power, pins_power=pins_power, tangent=tangent, stores="contact",
    blocks=blocks,
)  # fmt: skip
