"""Cholesky factors of a matrix on a grid, by nested dissection (George 1973, SIAM J. Numer. Anal. 10:345).

The matrix couples each particle by 3 x 3 blocks to its eight neighbours on the grid and to no other. A line of
particles separates a rectangle into two that do not couple; eliminated after both, it keeps the factors small: they
hold O(n log n) numbers of n particles, and take O(n^1.5) operations. Each part of the grid, a separating line or a
rectangle of few particles, is eliminated in a dense matrix of its own, its front, which holds the particles around its
rectangle too and hands their rest, the Schur complement, to the front of the line that is eliminated next (the
multifrontal method, Duff and Reid 1983).

The factors are a preconditioner: single precision is enough, and twice as fast.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel

LEAF = 16  # most particles of a rectangle that no line separates
LANES = 16  # the length of a front's rows is a multiple of this, so that no loop over a row has a remainder
PANEL = 12  # rows of the factor that are subtracted at once
LEAST_PIVOT = 0.5  # of the least mass; smaller pivots come from round-off

# (rows, columns) to the neighbours after a particle, in the order of the blocks of `beside`
DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))


class Dissection(NamedTuple):
    """The order of elimination of a grid, and storage for its factors."""

    rows: int
    cols: int
    nodes: NDArray[np.int64]  # (parts, 5): first place in `fronts`, particles, those of the front, factor, children
    fronts: NDArray[np.int64]  # the particles of all fronts, in the order of elimination
    order: NDArray[np.int64]  # (rows cols,) when a particle is eliminated
    place: NDArray[np.int64]  # (rows cols,) in the front at hand
    held: NDArray[np.int64]  # (parts,) a stack of the parts whose rests are held
    front: NDArray[np.float32]  # the front at hand
    rests: NDArray[np.float32]  # a stack of the rests of fronts
    factors: NDArray[np.float32]  # rows of all factors, with the reciprocals of their diagonals
    vector: NDArray[np.float32]  # (3 rows cols,) x, y, z of each particle in turn
    part: NDArray[np.float32]  # of a front


@kernel(inline=True)
def padded(count):
    """Length of a row of a front of `count` particles."""
    return (3 * count + LANES - 1) // LANES * LANES


@kernel(inline=True)
def around(r0, r1, c0, c1, rows, cols):
    """The rectangle with the particles around it."""
    return max(0, r0 - 1), min(rows, r1 + 1), max(0, c0 - 1), min(cols, c1 + 1)


@kernel(inline=True)
def rest_size(count):
    """Numbers in the rest of a front with `count` particles not yet eliminated."""
    return 9 * count * count


@kernel
def stack_size(nodes):
    """Greatest size of the stack of rests: each part pops its children's rests and pushes its own."""
    parts = nodes.shape[0]
    depth, deepest, held, top = 0, 0, np.zeros(parts, np.int64), 0
    for q in range(parts - 1, -1, -1):
        for _ in range(nodes[q, 4]):
            top -= 1
            depth -= held[top]
        held[top] = rest_size(nodes[q, 2] - nodes[q, 1])
        depth += held[top]
        top += 1
        deepest = max(deepest, depth)
    return deepest


@kernel
def list_fronts(nodes, rectangles, order, sequence, rows, cols):
    """Particles of all fronts, numbers in all factors, in the largest front, and in its longest row.

    Sets in `nodes` where a part's front and factor begin. sequence: the particles in the order of elimination.
    """
    fronts = np.zeros(np.sum(nodes[:, 2]), np.int64)
    at, size, largest, longest, left = 0, 0, 0, 0, sequence.shape[0]
    for q in range(nodes.shape[0]):
        count, whole = nodes[q, 1], nodes[q, 2]
        nodes[q, 0], nodes[q, 3] = at, size
        left -= count
        for k in range(count):
            fronts[at + k] = left + k
        r0, r1, c0, c1 = rectangles[q, 0], rectangles[q, 1], rectangles[q, 2], rectangles[q, 3]
        a0, a1, b0, b1 = around(r0, r1, c0, c1, rows, cols)
        k = at + count
        for i in range(a0, a1):
            for j in range(b0, b1):
                if not (r0 <= i < r1 and c0 <= j < c1):
                    fronts[k] = order[i * cols + j]
                    k += 1
        fronts[at + count : k].sort()
        for e in range(at, k):
            fronts[e] = sequence[fronts[e]]
        at = k
        longest = max(longest, padded(whole))
        largest = max(largest, 3 * whole * padded(whole))
        size += 3 * count * padded(whole)
    return fronts, size, largest, longest


@kernel
def dissect(rows, cols):
    """The `Dissection` of a grid.

    Parts are numbered from the whole grid to its smallest rectangles, so that elimination goes from the last to the
    first; a part's two children come after it.
    """
    n = rows * cols
    rectangles = np.zeros((2 * n + 1, 4), np.int64)
    nodes = np.zeros((2 * n + 1, 5), np.int64)
    waiting = np.zeros((64, 4), np.int64)
    order, sequence = np.zeros(n, np.int64), np.zeros(n, np.int64)
    waiting[0] = np.array([0, rows, 0, cols])
    top, parts, left = 1, 0, n
    while top > 0:
        top -= 1
        r0, r1, c0, c1 = waiting[top, 0], waiting[top, 1], waiting[top, 2], waiting[top, 3]
        height, width = r1 - r0, c1 - c0
        s0, s1, t0, t1 = r0, r1, c0, c1  # the particles of this part
        if height * width > LEAF and max(height, width) > 2:
            if height >= width:
                s0 = (r0 + r1) // 2
                s1 = s0 + 1
                waiting[top], waiting[top + 1] = np.array([r0, s0, c0, c1]), np.array([s1, r1, c0, c1])
            else:
                t0 = (c0 + c1) // 2
                t1 = t0 + 1
                waiting[top], waiting[top + 1] = np.array([r0, r1, c0, t0]), np.array([r0, r1, t1, c1])
            top += 2
            nodes[parts, 4] = 2
        count = (s1 - s0) * (t1 - t0)
        left -= count
        for i in range(s0, s1):
            for j in range(t0, t1):
                k = left + (i - s0) * (t1 - t0) + j - t0
                sequence[k], order[i * cols + j] = i * cols + j, k
        a0, a1, b0, b1 = around(r0, r1, c0, c1, rows, cols)
        rectangles[parts] = np.array([r0, r1, c0, c1])
        nodes[parts, 1] = count
        nodes[parts, 2] = count + (a1 - a0) * (b1 - b0) - height * width
        parts += 1
    fronts, size, largest, longest = list_fronts(nodes[:parts], rectangles, order, sequence, rows, cols)
    deepest = stack_size(nodes[:parts])
    return Dissection(
        rows, cols, nodes[:parts].copy(), fronts, order, np.zeros(n, np.int64), np.zeros(parts, np.int64),
        np.empty(largest, np.float32), np.empty(deepest, np.float32), np.empty(size, np.float32),
        np.empty(3 * n, np.float32), np.empty(longest, np.float32),
    )  # fmt: skip


# Indices are unsigned throughout the loops over rows, sums of them included: with a signed one each could be negative,
# and the loop would gather its numbers one by one.


@kernel(noalias=True, inline=True)
def subtract_three(u, w, k, o, i, row, m):
    """Row i of w -= three rows of u from o, each times its number in column k."""
    k1, o1 = k + row, o + row
    k2, o2 = k1 + row, o1 + row
    a0, a1, a2 = u[k], u[k1], u[k2]
    for j in range(m):
        w[i + j] -= a0 * u[o + j] + a1 * u[o1 + j] + a2 * u[o2 + j]


@kernel(noalias=True, inline=True)
def subtract_panel(u, w, k, o, i, row, m):
    """`subtract_three` with twelve rows: w is read and written once for all of them."""
    k1, k2, k3 = k + row, k + row + row, k + row + row + row
    k4, k5, k6 = k1 + row + row + row, k2 + row + row + row, k3 + row + row + row
    k7, k8, k9 = k4 + row + row + row, k5 + row + row + row, k6 + row + row + row
    k10, k11 = k7 + row + row + row, k8 + row + row + row
    a0, a1, a2, a3, a4, a5 = u[k], u[k1], u[k2], u[k3], u[k4], u[k5]
    a6, a7, a8, a9, a10, a11 = u[k6], u[k7], u[k8], u[k9], u[k10], u[k11]
    d = o - k
    o1, o2, o3, o4, o5, o6 = d + k1, d + k2, d + k3, d + k4, d + k5, d + k6
    o7, o8, o9, o10, o11 = d + k7, d + k8, d + k9, d + k10, d + k11
    for j in range(m):
        w[i + j] -= (
            a0 * u[o + j] + a1 * u[o1 + j] + a2 * u[o2 + j] + a3 * u[o3 + j] + a4 * u[o4 + j] + a5 * u[o5 + j]
            + a6 * u[o6 + j] + a7 * u[o7 + j] + a8 * u[o8 + j] + a9 * u[o9 + j] + a10 * u[o10 + j] + a11 * u[o11 + j]
        )  # fmt: skip


@kernel(noalias=True, inline=True)
def set_scaled_row(w, u, i, o, s, m):
    for j in range(m):
        u[o + j] = s * w[i + j]


@kernel(noalias=True, inline=True)
def subtract_row(w, u, i, o, s, m):
    for j in range(m):
        w[i + j] -= s * u[o + j]


@kernel(inline=True)
def pivot_root(pivot, least):
    return np.float32(1.0) / np.sqrt(max(pivot, least))


@kernel(noalias=True, inline=True)
def set_factor_rows(w, u, i, o, k, row, m, least):
    """Three rows of the factor, in u from o, of those of w from i; their pivots begin at column k of both."""
    one, two = np.uint64(1), np.uint64(2)
    q = i + k
    r0 = pivot_root(w[q], least)
    xy, xz = w[q + one] * r0, w[q + two] * r0
    r1 = pivot_root(w[q + row + one] - xy * xy, least)
    yz = (w[q + row + two] - xy * xz) * r1
    r2 = pivot_root(w[q + row + row + two] - xz * xz - yz * yz, least)
    set_scaled_row(w, u, i, o, r0, m)
    subtract_row(w, u, i + row, o, xy, m)
    set_scaled_row(w, u, i + row, o + row, r1, m)
    subtract_row(w, u, i + row + row, o, xz, m)
    subtract_row(w, u, i + row + row, o + row, yz, m)
    set_scaled_row(w, u, i + row + row, o + row + row, r2, m)
    q = o + k
    u[q], u[q + row + one], u[q + row + row + two] = r0, r1, r2


@kernel(noalias=True, allocates=False)
def factorise_panel(u, w, o, first, width, row, least):
    """Rows `first` to first + width of a factor, in u from o."""
    o, row, lanes, three = np.uint64(o), np.uint64(row), np.uint64(LANES), np.uint64(3)
    first, end = np.uint64(first), np.uint64(first + width)
    for step in range((end - first) // three):
        k = first + step * three
        c = k - k % lanes
        for before in range(step):
            p = o + (first + before * three) * row
            for e in range(three):
                subtract_three(u, w, p + k + e, p + c, (k + e) * row + c, row, row - c)
        set_factor_rows(w, u, k * row + c, o + k * row + c, k - c, row, row - c, least)


@kernel(noalias=True, allocates=False)
def subtract_rows(u, w, o, first, width, count, row):
    """Subtract the products of a factor's `width` rows from `first` on from the rows of w after them, up to `count`."""
    row, lanes, three = np.uint64(row), np.uint64(LANES), np.uint64(3)
    p = np.uint64(o) + np.uint64(first) * row
    for i in range(np.uint64(first + width), np.uint64(count)):
        c = i - i % lanes
        if width == PANEL:
            subtract_panel(u, w, p + i, p + c, i * row + c, row, row - c)
        else:
            for step in range(np.uint64(width) // three):
                q = p + step * three * row
                subtract_three(u, w, q + i, q + c, i * row + c, row, row - c)


@kernel(noalias=True, allocates=False)
def add_rest(rests, o, fronts, at, end, place, w, row):
    """Add the rest of a child's front, in `rests` from o, at the particles of `fronts` from `at` on."""
    one, two = np.uint64(1), np.uint64(2)
    count, row = end - at, np.uint64(row)
    for p in range(count):
        i = np.uint64(3 * place[fronts[at + p]]) * row
        for e in range(3):
            source = np.uint64(o + (3 * p + e) * 3 * count)
            for q in range(p, count):
                a, b = i + np.uint64(3 * place[fronts[at + q]]), source + np.uint64(3 * q)
                w[a] += rests[b]
                w[a + one] += rests[b + one]
                w[a + two] += rests[b + two]
            i += row


@kernel(noalias=True, allocates=False)
def keep_rest(w, rests, o, first, count, row):
    """Copy the rest of a front, rows and columns `first` to `count`, to `rests` from o."""
    row, left = np.uint64(row), np.uint64(count - first)
    for i in range(left):
        source, target = (np.uint64(first) + i) * row + np.uint64(first), np.uint64(o) + i * left
        for j in range(i, left):
            rests[target + j] = w[source + j]


@kernel(noalias=True, inline=True)
def add_block_to(w, i, row, s, blocks, o):
    """Add s times the symmetric block of six numbers from o to w, from i on."""
    xx, xy, xz, yy, yz, zz = blocks[o], blocks[o + 1], blocks[o + 2], blocks[o + 3], blocks[o + 4], blocks[o + 5]
    w[i] += s * xx
    w[i + 1] += s * xy
    w[i + 2] += s * xz
    w[i + row] += s * xy
    w[i + row + 1] += s * yy
    w[i + row + 2] += s * yz
    w[i + 2 * row] += s * xz
    w[i + 2 * row + 1] += s * yz
    w[i + 2 * row + 2] += s * zz


@kernel(noalias=True, allocates=False)
def add_matrix(diagonal, beside, inverse_masses, q, grid, w, row):
    """Add the rows of the matrix of the particles that part q eliminates to its front."""
    rows, cols, order = grid.rows, grid.cols, grid.order
    at = grid.nodes[q, 0]
    for j in range(grid.nodes[q, 1]):
        a, i = grid.fronts[at + j], 3 * j * (row + 1)
        if inverse_masses[a] == 0.0:
            w[i] += 1.0
            w[i + row + 1] += 1.0
            w[i + 2 * row + 2] += 1.0
            continue
        add_block_to(w, i, row, 1.0, diagonal, 6 * a)
        r, c = a // cols, a % cols
        for e in range(8):
            dr, dc = 0 if e % 4 == 0 else 1, -1 if e % 4 == 3 else 0 if e % 4 == 1 else 1
            if e >= 4:
                dr, dc = -dr, -dc
            s, t = r + dr, c + dc
            b = s * cols + t
            if not (0 <= s < rows and 0 <= t < cols):
                continue
            if order[b] > order[a] and inverse_masses[b] > 0.0:
                k = 6 * (4 * (a if e < 4 else b) + e % 4)
                add_block_to(w, 3 * j * row + 3 * grid.place[b], row, -1.0, beside, k)


@kernel(allocates=False)
def factorise(diagonal, beside, inverse_masses, grid):
    """Set the factors of a matrix on the grid.

    diagonal: (n, 6) flat, the blocks xx, xy, xz, yy, yz, zz of particles. beside: (n, 4, 6) flat, those whose
    negative couples a particle to its neighbours in DIRECTIONS. Rows of pinned particles are those of the unit matrix.
    """
    nodes, fronts, w = grid.nodes, grid.fronts, grid.front
    heaviest = 0.0
    for j in range(inverse_masses.shape[0]):
        heaviest = max(heaviest, inverse_masses[j])
    least = np.float32(LEAST_PIVOT / heaviest if heaviest > 0.0 else LEAST_PIVOT)
    top, depth = 0, 0
    for q in range(nodes.shape[0] - 1, -1, -1):
        at, count, whole, o, children = nodes[q, 0], nodes[q, 1], nodes[q, 2], nodes[q, 3], nodes[q, 4]
        row = padded(whole)
        for j in range(3 * whole * row):
            w[j] = 0.0
        for j in range(whole):
            grid.place[fronts[at + j]] = j
        for _ in range(children):
            top -= 1
            child = grid.held[top]
            first, end = nodes[child, 0] + nodes[child, 1], nodes[child, 0] + nodes[child, 2]
            depth -= rest_size(end - first)
            add_rest(grid.rests, depth, fronts, first, end, grid.place, w, row)
        add_matrix(diagonal, beside, inverse_masses, q, grid, w, row)
        for first in range(0, 3 * count, PANEL):
            width = min(PANEL, 3 * count - first)
            factorise_panel(grid.factors, w, o, first, width, row, least)
            subtract_rows(grid.factors, w, o, first, width, 3 * whole, row)
        keep_rest(w, grid.rests, depth, 3 * count, 3 * whole, row)
        grid.held[top] = q
        top, depth = top + 1, depth + rest_size(whole - count)


@kernel(noalias=True, inline=True)
def subtract_products(u, o, row, x, y, z, m, t, i):
    """t -= three rows of u from o, times x, y and z."""
    o1, o2 = o + row, o + row + row
    for j in range(m):
        t[i + j] -= x * u[o + j] + y * u[o1 + j] + z * u[o2 + j]


@kernel(noalias=True, inline=True)
def products(u, o, row, m, t, i):
    """The products of three rows of u from o with t."""
    o1, o2 = o + row, o + row + row
    x = y = z = np.float32(0.0)
    for j in range(m):
        x += u[o + j] * t[i + j]
        y += u[o1 + j] * t[i + j]
        z += u[o2 + j] * t[i + j]
    return x, y, z


@kernel(noalias=True, allocates=False)
def solve_down(nodes, fronts, u, b, t):
    """Solve U^T y = b in place, b (3 n,), from the first part that was eliminated to the last."""
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    for q in range(nodes.shape[0] - 1, -1, -1):
        at, count, whole = nodes[q, 0], nodes[q, 1], nodes[q, 2]
        row, end = np.uint64(padded(whole)), np.uint64(3 * whole)
        for j in range(3 * count, 3 * whole):
            t[j] = 0.0
        for j in range(count):
            for e in range(3):
                t[3 * j + e] = b[3 * fronts[at + j] + e]
        for j in range(np.uint64(count)):
            i = three * j
            k = np.uint64(nodes[q, 3]) + i * row + i
            k1, k2 = k + row, k + row + row
            x = t[i] * u[k]
            y = (t[i + one] - u[k + one] * x) * u[k1 + one]
            z = (t[i + two] - u[k + two] * x - u[k1 + two] * y) * u[k2 + two]
            t[i], t[i + one], t[i + two] = x, y, z
            subtract_products(u, k + three, row, x, y, z, end - i - three, t, i + three)
        for j in range(count):
            for e in range(3):
                b[3 * fronts[at + j] + e] = t[3 * j + e]
        for j in range(count, whole):
            for e in range(3):
                b[3 * fronts[at + j] + e] += t[3 * j + e]


@kernel(noalias=True, allocates=False)
def solve_up(nodes, fronts, u, b, t):
    """Solve U x = b in place, from the last part to the first."""
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    for q in range(nodes.shape[0]):
        at, count, whole = nodes[q, 0], nodes[q, 1], nodes[q, 2]
        row, end = np.uint64(padded(whole)), np.uint64(3 * whole)
        for j in range(whole):
            for e in range(3):
                t[3 * j + e] = b[3 * fronts[at + j] + e]
        for step in range(np.uint64(count)):
            i = three * (np.uint64(count) - one - step)
            k = np.uint64(nodes[q, 3]) + i * row + i
            k1, k2 = k + row, k + row + row
            x, y, z = products(u, k + three, row, end - i - three, t, i + three)
            z = (t[i + two] - z) * u[k2 + two]
            y = (t[i + one] - y - u[k1 + two] * z) * u[k1 + one]
            x = (t[i] - x - u[k + one] * y - u[k + two] * z) * u[k]
            t[i], t[i + one], t[i + two] = x, y, z
        for j in range(count):
            for e in range(3):
                b[3 * fronts[at + j] + e] = t[3 * j + e]


@kernel(allocates=False)
def solve(grid, r, z):
    """Solve A z = r by the factors; r, z: (3 n,), all x, then all y, then all z. z is 0 at pins with r = 0."""
    n, b = grid.rows * grid.cols, grid.vector
    for j in range(n):
        for e in range(3):
            b[3 * j + e] = r[e * n + j]
    solve_down(grid.nodes, grid.fronts, grid.factors, b, grid.part)
    solve_up(grid.nodes, grid.fronts, grid.factors, b, grid.part)
    for j in range(n):
        for e in range(3):
            z[e * n + j] = b[3 * j + e]
