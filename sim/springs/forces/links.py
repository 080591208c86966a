"""The force of a row of links, the inner loop of every net, and its linearisation."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.arrays import (
    add_pair,
    by_net,
    is_moving,
    law_at,
    link_at,
    link_count,
    link_damping,
    push,
    span,
)
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST, TRANSVERSE
from sim.springs.forces.record import Force, of_nets
from sim.springs.laws import damps, force_density, stiffness, tension
from sim.springs.laws import energy as link_energy
from sim.springs.line_points import kick, mobility

TINY = 1e-300  # [m^2] under the root: coincident points get no spring force instead of 0/0


@kernel(noalias=True, inline=True)
def link_forces(x, v, f, ia, ib, of, n, N, M, law, k, b, rest, axial):
    """Force on the first end of n links, (ia, ib), (ia + 1, ib + 1), ...: F = T(|r|) r/|r| - b v_rel (lab eq. 4).

    Written to f (3 M,) from index `of` of each component. Isotropic damping acts on the whole relative velocity, as the
    lab has it; axial on its part along the link.
    """
    if axial:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            rr = rx * rx + ry * ry + rz * rz + TINY
            closing = (v[q] - v[p]) * rx + (v[N + q] - v[N + p]) * ry + (v[N + N + q] - v[N + N + p]) * rz
            length = math.sqrt(rr)
            s = force_density(law, k, rest, length) + (b * closing / rr if damps(law, rest, length) else 0.0)
            f[of + j] = s * rx
            f[M + of + j] = s * ry
            f[M + M + of + j] = s * rz
    elif b == 0.0:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            s = force_density(law, k, rest, math.sqrt(rx * rx + ry * ry + rz * rz + TINY))
            f[of + j] = s * rx
            f[M + of + j] = s * ry
            f[M + M + of + j] = s * rz
    else:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
            s, c = force_density(law, k, rest, length), b if damps(law, rest, length) else 0.0
            f[of + j] = s * rx + c * (v[q] - v[p])
            f[M + of + j] = s * ry + c * (v[N + q] - v[N + p])
            f[M + M + of + j] = s * rz + c * (v[N + N + q] - v[N + N + p])


@kernel(inline=True)
def linearised(law, k, rest, length):
    """(along, across) [N/m] of the link's K = along n n^T + across (I - n n^T): its tension's slope, and how it turns.

    A pressed link buckles: across is negative, without bound as its ends meet. The caller limits it to what it can use.
    """
    return stiffness(law, k, rest, length), force_density(law, k, rest, length)


@kernel(noalias=True, inline=True)
def scale_ends(f, of, n, M, s):
    """Multiply the forces of the first and the last of n links, f (3 M,) from index `of` of each component."""
    last = of + n - np.uint64(1)
    for e in range(3):
        f[np.uint64(e) * M + of] *= s
        f[np.uint64(e) * M + last] *= s


@kernel(inline=True)
def lengthening(x, v, p, n, q):
    """Length [m] of link q, the rate [m/s] at which it grows, and its damping [N s/m] if it acts."""
    (a, b, rest, _, c), law = link_at(p, q), law_at(p, q)
    rx, ry, rz = span(x, n, a, b)
    du, dv, dw = span(v, n, a, b)
    length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
    return length, (du * rx + dv * ry + dw * rz) / length, c if damps(law, rest, length) else 0.0


@kernel(allocates=False)
def set_tensions(x, v, p, out):
    """Set the tension (links,) [N] of every link, negative where it is pressed, with its damping along it."""
    n = p.rows * p.cols
    for q in range(link_count(p)):
        _, _, rest, k, _ = link_at(p, q)
        length, rate, damping = lengthening(x, v, p, n, q)
        out[q] = tension(law_at(p, q), k, rest, length) + damping * rate


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    """Of lines; those of nets are in `sim.springs.acceleration`."""
    n = p.cols
    for q in range(link_count(p)):
        i, j, rest, k, _ = link_at(p, q)
        rx, ry, rz = span(x, n, i, j)
        length, rate, damping = lengthening(x, v, p, n, q)
        s = force_density(law_at(p, q), k, rest, length)
        if with_damping:
            s += damping * rate / length
        push(p, a, i, s * rx, s * ry, s * rz)
        push(p, a, j, -s * rx, -s * ry, -s * rz)


@kernel(allocates=False)
def damp_link(x, v, s, p, q):
    """The damping of link q of a line for a time s [s]: its nodes' closing speed decays exponentially."""
    n = p.cols
    a, b, _, _, _ = link_at(p, q)
    rx, ry, rz = span(x, n, a, b)
    length, rate, damping = lengthening(x, v, p, n, q)
    rx, ry, rz = rx / length, ry / length, rz / length
    both = mobility(p, a, rx, ry, rz) + mobility(p, b, rx, ry, rz)
    if both == 0.0 or damping == 0.0:
        return
    impulse = -math.expm1(-damping * both * s) / both * rate
    kick(p, v, a, impulse * rx, impulse * ry, impulse * rz)
    kick(p, v, b, -impulse * rx, -impulse * ry, -impulse * rz)


@kernel(allocates=False)
def damp(x, v, t, s, p, reverse):
    """Of lines, one link after the other; that of nets is in `sim.springs.damping`."""
    count = link_count(p)
    for turn in range(count):
        damp_link(x, v, s, p, count - 1 - turn if reverse else turn)
    return 0.0


@kernel(allocates=False)
def energy(x, t, p):
    """Of the links [J]."""
    total, n = 0.0, p.rows * p.cols
    for q in range(link_count(p)):
        (a, b, rest, k, _), law = link_at(p, q), law_at(p, q)
        rx, ry, rz = span(x, n, a, b)
        total += link_energy(law, k, rest, math.sqrt(rx * rx + ry * ry + rz * rz))
    return total


@kernel(inline=True)
def damping_force(v, p, n, a, b, c, rx, ry, rz):
    """Force [N] on point a of a link's damping c [N s/m] that acts, along (rx, ry, rz) if it is axial."""
    du, dv, dw = span(v, n, a, b)
    if p.axial:
        s = c * (du * rx + dv * ry + dw * rz) / (rx * rx + ry * ry + rz * rz + TINY)
        return s * rx, s * ry, s * rz
    return c * du, c * dv, c * dw


@kernel(allocates=False)
def moving_pins_power(x, v, p, elastic, damping):
    """Power of moving pins [W] through the links' elastic forces, their damping, or both: 1.0 counts it, 0.0 not."""
    work, n = 0.0, p.rows * p.cols
    if p.pins.shape[0] == 0:
        return work
    for q in range(link_count(p)):
        (a, b, rest, k, c), law = link_at(p, q), law_at(p, q)
        if is_moving(p, a) and is_moving(p, b):
            continue
        rx, ry, rz = span(x, n, a, b)
        length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
        s = force_density(law, elastic * k, rest, length)
        d = damping * c if damps(law, rest, length) else 0.0
        fx, fy, fz = damping_force(v, p, n, a, b, d, rx, ry, rz)
        fx, fy, fz = fx + s * rx, fy + s * ry, fz + s * rz
        if not is_moving(p, a):
            work -= fx * v[a] + fy * v[n + a] + fz * v[2 * n + a]
        if not is_moving(p, b):
            work += fx * v[b] + fy * v[n + b] + fz * v[2 * n + b]
    return work


@kernel(noalias=True, inline=True)
def row_damping_power(x, v, p, a, b, count, n, first, rest):
    """Power [W] that damping takes in the links (a, b), (a + 1, b + 1), ..., of numbers `first` on: they vectorise."""
    total = 0.0
    if p.axial:
        for j in range(count):
            c, d = a + j, b + j
            rx, ry, rz = x[d] - x[c], x[n + d] - x[n + c], x[n + n + d] - x[n + n + c]
            du, dv, dw = v[d] - v[c], v[n + d] - v[n + c], v[n + n + d] - v[n + n + c]
            closing, rr = du * rx + dv * ry + dw * rz, rx * rx + ry * ry + rz * rz + TINY
            power = closing * closing / rr * link_damping(p, first + j)
            total += power if damps(p.law, rest, math.sqrt(rr)) else 0.0
    else:
        for j in range(count):
            c, d = a + j, b + j
            rx, ry, rz = x[d] - x[c], x[n + d] - x[n + c], x[n + n + d] - x[n + n + c]
            du, dv, dw = v[d] - v[c], v[n + d] - v[n + c], v[n + n + d] - v[n + n + c]
            power = (du * du + dv * dv + dw * dw) * link_damping(p, first + j)
            total += power if damps(p.law, rest, math.sqrt(rx * rx + ry * ry + rz * rz)) else 0.0
    return total


@kernel(allocates=False)
def damping_power_by_rows(x, v, p):
    total, first, n = 0.0, np.uint64(0), np.uint64(p.rows * p.cols)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        begin, count = max(0, -dj), np.uint64(max(0, p.cols - abs(dj)))
        for i in range(p.rows - di):
            a, b = np.uint64(i * p.cols + begin), np.uint64((i + di) * p.cols + begin + dj)
            total += row_damping_power(x, v, p, a, b, count, n, first, p.families[q, 0])
            first += count
    return total


@kernel(allocates=False)
def damping_power_by_links(x, v, p):
    total, n = 0.0, p.rows * p.cols
    for q in range(link_count(p)):
        _, rate, c = lengthening(x, v, p, n, q)
        total += c * rate * rate
    return total


# Power [W] that the links' damping takes.
damping_power = by_net(rope=damping_power_by_rows, grid=damping_power_by_rows, lines=damping_power_by_links)


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The damping takes, and moving pins put in."""
    work = moving_pins_power(x, v, p, 1.0, 1.0 if with_damping else 0.0)
    return damping_power(x, v, p) if with_damping and p.damped else 0.0, work


@kernel(inline=True)
def pins_power(x, v, p):
    return moving_pins_power(x, v, p, 0.0, 1.0)


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """Links: K = T' n n^T + T/l (I - n n^T), of `linearised`; D = b I, or b n n^T where damping is axial.

    longest: strain of part STIFFEST, see `longest_strain`.
    """
    n = p.rows * p.cols
    for q in range(link_count(p) if part != FRICTION else 0):
        (a, b, rest, k, c), law = link_at(p, q), law_at(p, q)
        rx, ry, rz = span(x, n, a, b)
        du, dv, dw = span(u, n, a, b)
        rr = rx * rx + ry * ry + rz * rz
        length = math.sqrt(rr)
        along, across = linearised(law, k, rest, length)
        # Of a link that is pressed further only this counts: it buckles, which no step can mend.
        across = max(across, -along) if rr > 0.0 else -along
        if part == DAMPING:
            along = c if damps(law, rest, length) else 0.0
            across = 0.0 if p.axial else along
        elif part == STIFFEST:
            along = max(along, stiffness(law, k, rest, (1.0 + longest) * rest))
        elif part == TRANSVERSE:
            along = 0.0
        s = (along - across) * (rx * du + ry * dv + rz * dw) / rr if rr > 0.0 else 0.0
        add_pair(out, n, b, a, across * du + s * rx, across * dv + s * ry, across * dw + s * rz)


FORCE = Force(
    "links", rank=10, accelerate=of_nets(lines=accelerate), damp=of_nets(lines=damp),
    energy=energy, power=power, pins_power=pins_power, tangent=tangent, stores="elastic",
    is_smooth=True,
)  # fmt: skip
