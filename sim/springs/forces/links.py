"""The force of a row of links, the inner loop of every net, and its linearisation."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST, TRANSVERSE
from sim.springs.forces.record import Force, of_nets
from sim.springs.laws import damping as damping_of
from sim.springs.laws import energy as link_energy
from sim.springs.laws import force_density, stiffness, tension
from sim.springs.points.arrays import add_pair, by_net, is_moving, link_at, push, span
from sim.springs.points.each_link import TINY, acting_damping, each_link, stretch


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
            c = damping_of(law, k, b, rest, length, closing / length)
            s = force_density(law, k, rest, length) + c * closing / rr
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
            du, dv, dw = v[q] - v[p], v[N + q] - v[N + p], v[N + N + q] - v[N + N + p]
            s = force_density(law, k, rest, length)
            c = damping_of(law, k, b, rest, length, (du * rx + dv * ry + dw * rz) / length)
            f[of + j] = s * rx + c * du
            f[M + of + j] = s * ry + c * dv
            f[M + M + of + j] = s * rz + c * dw


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
def lengthening(x, v, p, link):
    """Length [m] of a link, the rate [m/s] at which it grows, and the part of its damping [N s/m] that acts."""
    rx, ry, rz, length = stretch(x, p, link)
    du, dv, dw = span(v, p.rows * p.cols, link.a, link.b)
    rate = (du * rx + dv * ry + dw * rz) / length
    return length, rate, acting_damping(link, length, rate)


@each_link()
def set_tensions(link, x, v, p, out):
    """Set the tension (links,) [N] of every link, with its damping along it; negative in a net where it is pressed."""
    length, rate, damping = lengthening(x, v, p, link)
    out[link.number] = tension(link.law, link.stiffness, link.rest, length) + damping * rate


@each_link(noalias=True)
def accelerate(link, x, v, t, p, with_damping, f, a):
    """Accelerations of lines; those of nets are in `sim.springs.points.acceleration`."""
    rx, ry, rz, length = stretch(x, p, link)
    s = force_density(link.law, link.stiffness, link.rest, length)
    if with_damping:
        _, rate, damping = lengthening(x, v, p, link)
        s += damping * rate / length
    push(p, a, link.a, s * rx, s * ry, s * rz)
    push(p, a, link.b, -s * rx, -s * ry, -s * rz)


@each_link("sum")
def energy(link, x, t, p):
    """Energy of the links [J]."""
    return link_energy(link.law, link.stiffness, link.rest, stretch(x, p, link)[3])


@kernel(inline=True)
def damping_force(v, p, n, a, b, c, rx, ry, rz):
    """Force [N] on point a of a link's damping c [N s/m] that acts, along (rx, ry, rz) if it is axial."""
    du, dv, dw = span(v, n, a, b)
    if p.axial:
        s = c * (du * rx + dv * ry + dw * rz) / (rx * rx + ry * ry + rz * rz + TINY)
        return s * rx, s * ry, s * rz
    return c * du, c * dv, c * dw


@each_link("sum")
def holders_power(link, x, v, p, elastic, damping):
    """`moving_pins_power`."""
    n, (a_moves, b_moves) = p.rows * p.cols, (is_moving(p, link.a), is_moving(p, link.b))
    if a_moves and b_moves:
        return 0.0
    rx, ry, rz, length = stretch(x, p, link)
    s = force_density(link.law, elastic * link.stiffness, link.rest, length)
    _, _, acting = lengthening(x, v, p, link)
    fx, fy, fz = damping_force(v, p, n, link.a, link.b, damping * acting, rx, ry, rz)
    fx, fy, fz, work = fx + s * rx, fy + s * ry, fz + s * rz, 0.0
    if not a_moves:
        work -= fx * v[link.a] + fy * v[n + link.a] + fz * v[2 * n + link.a]
    if not b_moves:
        work += fx * v[link.b] + fy * v[n + link.b] + fz * v[2 * n + link.b]
    return work


@kernel(allocates=False)
def moving_pins_power(x, v, p, elastic, damping):
    """Power of moving pins [W] through the links' elastic forces, their damping, or both: 1.0 counts it, 0.0 not."""
    return 0.0 if p.pins.shape[0] == 0 else holders_power(x, v, p, elastic, damping)


@kernel(noalias=True, inline=True)
def row_damping_power(x, v, p, a, b, count, n, first):
    """Power [W] that damping takes in the links (a, b), (a + 1, b + 1), ..., of numbers `first` on: they vectorise."""
    total = 0.0
    if p.axial:
        for j in range(count):
            c, d = a + j, b + j
            rx, ry, rz = x[d] - x[c], x[n + d] - x[n + c], x[n + n + d] - x[n + n + c]
            du, dv, dw = v[d] - v[c], v[n + d] - v[n + c], v[n + n + d] - v[n + n + c]
            closing, rr = du * rx + dv * ry + dw * rz, rx * rx + ry * ry + rz * rz + TINY
            length = math.sqrt(rr)
            total += closing * closing / rr * acting_damping(link_at(p, first + j), length, closing / length)
    else:
        for j in range(count):
            c, d = a + j, b + j
            rx, ry, rz = x[d] - x[c], x[n + d] - x[n + c], x[n + n + d] - x[n + n + c]
            du, dv, dw = v[d] - v[c], v[n + d] - v[n + c], v[n + n + d] - v[n + n + c]
            length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
            acting = acting_damping(link_at(p, first + j), length, (du * rx + dv * ry + dw * rz) / length)
            total += (du * du + dv * dv + dw * dw) * acting
    return total


@kernel(allocates=False)
def damping_power_by_rows(x, v, p):
    total, first, n = 0.0, np.uint64(0), np.uint64(p.rows * p.cols)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        begin, count = max(0, -dj), np.uint64(max(0, p.cols - abs(dj)))
        for i in range(p.rows - di):
            a, b = np.uint64(i * p.cols + begin), np.uint64((i + di) * p.cols + begin + dj)
            total += row_damping_power(x, v, p, a, b, count, n, first)
            first += count
    return total


@each_link("sum")
def damping_power_by_links(link, x, v, p):
    _, rate, damping = lengthening(x, v, p, link)
    return damping * rate * rate


# Power [W] that the links' damping takes.
damping_power = by_net(rope=damping_power_by_rows, grid=damping_power_by_rows, lines=damping_power_by_links)


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The damping takes, and moving pins put in."""
    work = moving_pins_power(x, v, p, 1.0, 1.0 if with_damping else 0.0)
    return damping_power(x, v, p) if with_damping and p.damped else 0.0, work


@kernel(inline=True)
def pins_power(x, v, t, p):
    return moving_pins_power(x, v, p, 0.0, 1.0)


@each_link(noalias=True)
def tangent(link, x, u, t, p, part, longest, out):
    """Links: K = T' n n^T + T/l (I - n n^T), of `linearised`; D = b I, or b n n^T where damping is axial.

    longest: strain of part STIFFEST, see `longest_strain`.
    """
    if part == FRICTION:
        return
    rx, ry, rz, length = stretch(x, p, link)
    along, across = linearised(link.law, link.stiffness, link.rest, length)
    # Of a link that is pressed further only this counts: it buckles, which no step can mend.
    across = max(across, -along)
    if part == DAMPING:
        along = acting_damping(link, length, 0.0)
        across = 0.0 if p.axial else along
    elif part == STIFFEST:
        along = max(along, stiffness(link.law, link.stiffness, link.rest, (1.0 + longest) * link.rest))
    elif part == TRANSVERSE:
        along = 0.0
    n = p.rows * p.cols
    du, dv, dw = span(u, n, link.a, link.b)
    s = (along - across) * (rx * du + ry * dv + rz * dw) / (length * length)
    add_pair(out, n, link.b, link.a, across * du + s * rx, across * dv + s * ry, across * dw + s * rz)


FORCE = Force(
    "links", rank=10, accelerate=of_nets(lines=accelerate), energy=energy, power=power,
    pins_power=of_nets(springs=pins_power), tangent=tangent, stores="elastic",
    is_smooth=True,
)  # fmt: skip
