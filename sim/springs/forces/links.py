"""The force of a row of links, the inner loop of every net, and its linearisation."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.arrays import link_ratio
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST, TRANSVERSE
from sim.springs.forces.record import Force
from sim.springs.laws import damps, force_density, stiffness
from sim.springs.laws import energy as link_energy

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


@kernel(allocates=False)
def energy(x, t, p):
    """Of the links [J]."""
    total = 0.0
    n = p.rows * p.cols
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, k = p.links[q, 0], p.links[q, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                b = a + di * p.cols + dj
                rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                own = link_ratio(p, q, i, j) * k
                total += link_energy(p.law, own, rest, math.sqrt(rx * rx + ry * ry + rz * rz))
    return total


@kernel(noalias=True, inline=True)
def row_damping_power(x, v, a, b, count, n, law, rest, axial):
    """Power lost to damping of 1 N s/m [W] in the links (a, b), (a + 1, b + 1), ..."""
    total = 0.0
    if axial:
        for j in range(count):
            p, q = a + j, b + j
            rx, ry, rz = x[q] - x[p], x[n + q] - x[n + p], x[n + n + q] - x[n + n + p]
            du, dv, dw = v[q] - v[p], v[n + q] - v[n + p], v[n + n + q] - v[n + n + p]
            closing, rr = du * rx + dv * ry + dw * rz, rx * rx + ry * ry + rz * rz + TINY
            total += closing * closing / rr if damps(law, rest, math.sqrt(rr)) else 0.0
    else:
        for j in range(count):
            p, q = a + j, b + j
            rx, ry, rz = x[q] - x[p], x[n + q] - x[n + p], x[n + n + q] - x[n + n + p]
            du, dv, dw = v[q] - v[p], v[n + q] - v[n + p], v[n + n + q] - v[n + n + p]
            acts = damps(law, rest, math.sqrt(rx * rx + ry * ry + rz * rz))
            total += du * du + dv * dv + dw * dw if acts else 0.0
    return total


@kernel(allocates=False)
def moving_pins_power(x, v, p, elastic, damping):
    """Power of moving pins [W] through the links' elastic forces, their damping, or both: 1.0 counts it, 0.0 not."""
    work = 0.0
    n = p.rows * p.cols
    if p.pins.shape[0] == 0:
        return work
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, k, c = p.links[q, 0], elastic * p.links[q, 1], damping * p.links[q, 2]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                b = a + di * p.cols + dj
                if p.inverse_masses[a] > 0.0 and p.inverse_masses[b] > 0.0:
                    continue
                rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                du, dv, dw = v[b] - v[a], v[n + b] - v[n + a], v[2 * n + b] - v[2 * n + a]
                rr = rx * rx + ry * ry + rz * rz + TINY
                if p.axial:
                    along = (du * rx + dv * ry + dw * rz) / rr
                    du, dv, dw = along * rx, along * ry, along * rz
                ratio = link_ratio(p, q, i, j)
                length = math.sqrt(rr)
                s = force_density(p.law, ratio * k, rest, length)
                d = ratio * c if damps(p.law, rest, length) else 0.0
                fx, fy, fz = s * rx + d * du, s * ry + d * dv, s * rz + d * dw
                if p.inverse_masses[a] == 0.0:
                    work -= fx * v[a] + fy * v[n + a] + fz * v[2 * n + a]
                if p.inverse_masses[b] == 0.0:
                    work += fx * v[b] + fy * v[n + b] + fz * v[2 * n + b]
    return work


@kernel(allocates=False)
def power(x, v, t, p, with_damping):
    """The damping takes, and moving pins put in."""
    total, work = 0.0, moving_pins_power(x, v, p, 1.0, 1.0 if with_damping else 0.0)
    if not with_damping:
        return total, work
    n = np.uint64(p.rows * p.cols)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, c = p.links[q, 0], p.links[q, 2]
        first = max(0, -dj)
        count = max(0, p.cols - abs(dj))
        if c == 0.0 or count == 0:
            continue
        for i in range(p.rows - di):
            a = np.uint64(i * p.cols + first)
            b = np.uint64((i + di) * p.cols + first + dj)
            ratio = link_ratio(p, q, i, 1)
            total += ratio * c * row_damping_power(x, v, a, b, np.uint64(count), n, p.law, rest, p.axial)
            more = link_ratio(p, q, i, 0) - ratio  # of the links in the first and the last column
            if dj == 0 and more != 0.0:
                for j in (0, count - 1):
                    o = np.uint64(j)
                    lost = row_damping_power(x, v, a + o, b + o, np.uint64(1), n, p.law, rest, p.axial)
                    total += more * c * lost
    return total, work


@kernel(inline=True)
def pins_power(x, v, p):
    return moving_pins_power(x, v, p, 0.0, 1.0)


@kernel(noalias=True, allocates=False)
def tangent(x, u, t, p, part, longest, out):
    """Links: K = T' n n^T + T/l (I - n n^T), of `linearised`; D = b I, or b n n^T where damping is axial.

    longest: strain of part STIFFEST, see `longest_strain`.
    """
    if part == FRICTION:
        return
    n = p.rows * p.cols
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest = p.links[q, 0]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                rx, ry, rz = x[c] - x[a], x[n + c] - x[n + a], x[2 * n + c] - x[2 * n + a]
                du, dv, dw = u[c] - u[a], u[n + c] - u[n + a], u[2 * n + c] - u[2 * n + a]
                rr = rx * rx + ry * ry + rz * rz
                ratio = link_ratio(p, q, i, j)
                k, b = ratio * p.links[q, 1], ratio * p.links[q, 2]
                length = math.sqrt(rr)
                along, across = linearised(p.law, k, rest, length)
                # Of a link that is pressed further only this counts: it buckles, which no step can mend.
                across = max(across, -along) if rr > 0.0 else -along
                if part == DAMPING:
                    along = b if damps(p.law, rest, length) else 0.0
                    across = 0.0 if p.axial else along
                elif part == STIFFEST:
                    along = max(along, stiffness(p.law, k, rest, (1.0 + longest) * rest))
                elif part == TRANSVERSE:
                    along = 0.0
                s = (along - across) * (rx * du + ry * dv + rz * dw) / rr if rr > 0.0 else 0.0
                fx, fy, fz = across * du + s * rx, across * dv + s * ry, across * dw + s * rz
                out[a] -= fx
                out[n + a] -= fy
                out[2 * n + a] -= fz
                out[c] += fx
                out[n + c] += fy
                out[2 * n + c] += fz


FORCE = Force(
    "links", rank=10, energy=energy, power=power, pins_power=pins_power, tangent=tangent, stores="elastic",
    is_smooth=True,
)  # fmt: skip
