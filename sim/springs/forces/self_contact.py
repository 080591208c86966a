"""A net against itself: particles nearer than the thickness push each other apart, neighbours on the grid excepted.

Neighbours are those that links hold, and those with less than pi/2 thicknesses of cloth between them at rest: as much
as lies between the two sides of the tightest fold, a half circle as wide as the thickness. So a flat net that is thick
beside its spacing does not push itself apart.

Pairs are found by a spatial hash and kept while nothing has moved by half of what they were looked for beyond the
thickness (Verlet's list), so that a force evaluation only runs over a short list. With a thickness of at least 0.71
of the spacing nothing fits through a cell.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.forces.matrices import DAMPING, FRICTION, TRANSVERSE, add_block
from sim.springs.forces.record import WIDE_NETS, Force
from sim.springs.points.each_link import TINY
from sim.springs.points.order import in_turn

UNASKED = 64  # particles between two looks at whether the search is to end
SKIN = 0.5  # of the thickness: how far pairs are looked for beyond it, so that the list of them lasts
NEIGHBOURS = 2  # rows and columns apart, within which a pair is held by links and never pushes


@kernel(inline=True)
def cell(x, inverse):
    return np.int64(math.floor(x * inverse))


@kernel(inline=True)
def bucket(cx, cy, cz, mask):
    """Teschner's hash of a cell (VMV 2003), to a power of two of buckets."""
    return ((cx * 73856093) ^ (cy * 19349663) ^ (cz * 83492791)) & mask


@kernel
def find_pairs(x, p):
    """Fill p.pairs with the pairs nearer than (1 + SKIN) thickness, and p.seen with the positions.

    Where p.pairs is full, the particles after that are left out; its last row keeps the largest number of them.

    No pairs if p.stop cancels: callers of a kernel that may stop here check p.stop afterwards.
    """
    n = p.rows * p.cols
    reach = (1.0 + SKIN) * p.thickness
    fold = 0.5 * math.pi * p.thickness
    inverse = 1.0 / reach
    mask = 1
    while mask < n:
        mask *= 2
    mask -= 1
    starts = np.zeros(mask + 2, np.int64)
    where = np.empty(n, np.int64)
    order = np.empty(n, np.int64)
    for j in range(n):
        where[j] = bucket(cell(x[j], inverse), cell(x[n + j], inverse), cell(x[2 * n + j], inverse), mask)
        starts[where[j] + 1] += 1
    for q in range(mask + 1):
        starts[q + 1] += starts[q]
    for j in range(n - 1, -1, -1):
        starts[where[j] + 1] -= 1
        order[starts[where[j] + 1]] = j
    most = p.pairs.shape[0] - 1
    count = 0
    for a in range(n):
        if count == most:  # of a net in one heap the search would take the square of its particles
            p.pairs[most, 1] = max(p.pairs[most, 1], n - a)
            break
        if a % UNASKED == 0 and is_stopped(p.stop):
            p.pairs[most, 0] = 0
            return
        ia, ja = a // p.cols, a % p.cols
        ca, cb, cc = cell(x[a], inverse), cell(x[n + a], inverse), cell(x[2 * n + a], inverse)
        for near in range(27):
            cx, cy, cz = ca + near // 9 - 1, cb + near // 3 % 3 - 1, cc + near % 3 - 1
            q = bucket(cx, cy, cz, mask)
            end = starts[q + 2] if q < mask else n
            for s in range(starts[q + 1], end):
                b = order[s]
                if b <= a:
                    continue
                i, j = abs(b // p.cols - ia), abs(b % p.cols - ja)
                if i <= NEIGHBOURS and j <= NEIGHBOURS:
                    continue
                if (i * p.row_spacing) ** 2 + (j * p.col_spacing) ** 2 < fold * fold:
                    continue
                dx, dy, dz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                if dx * dx + dy * dy + dz * dz >= reach * reach:
                    continue
                # Two cells of the 27 may share a bucket: take the pair from the cell that b is in.
                other = (
                    cell(x[b], inverse) == cx and cell(x[n + b], inverse) == cy and cell(x[2 * n + b], inverse) == cz
                )
                if other and count < most:
                    p.pairs[count, 0], p.pairs[count, 1] = a, b
                    count += 1
                elif other:
                    p.pairs[most, 1] = max(p.pairs[most, 1], n - a)
    p.pairs[most, 0] = count
    for j in range(3 * n):
        p.seen[j] = x[j]


@kernel(noalias=True, inline=True)
def mean_shift(x, seen, o, n):
    total = 0.0
    for j in range(n):
        total += x[o + j] - seen[o + j]
    return total / n


@kernel(noalias=True, inline=True)
def farthest(x, seen, n):
    """Largest squared displacement of a particle since the list was made, relative to the mean displacement."""
    mx, my, mz = mean_shift(x, seen, np.uint64(0), n), mean_shift(x, seen, n, n), mean_shift(x, seen, n + n, n)
    most = 0.0
    for j in range(n):
        dx, dy, dz = x[j] - seen[j] - mx, x[n + j] - seen[n + j] - my, x[n + n + j] - seen[n + n + j] - mz
        most = max(most, dx * dx + dy * dy + dz * dz)
    return most


@kernel(allocates=False)
def refresh_pairs(x, p):
    """Find the pairs again if a point has moved by half the skin; returns their number."""
    half = 0.5 * SKIN * p.thickness
    last = p.pairs.shape[0] - 1
    if p.pairs[last, 0] < 0 or not farthest(x, p.seen, np.uint64(p.rows * p.cols)) < half * half:
        find_pairs(x, p)
    return p.pairs[last, 0]


@kernel
def count_touching(x, p, touching):
    """Add to touching (rows cols,) how many others each particle touches."""
    n = p.rows * p.cols
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        if math.sqrt(dx * dx + dy * dy + dz * dz) < p.thickness:
            touching[i] += 1
            touching[j] += 1


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
    """Damping of touching pairs alone for a time s [s]: exact, except that separating pairs get at most their push."""
    n = p.rows * p.cols
    count = refresh_pairs(x, p)
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
