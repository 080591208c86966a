"""The list of a cloth's edges, and of its points and faces, that may meet: `sim.springs.kicks.apart` looks at these.

Blocks of cells are looked for by the spatial hash of `near_pairs`, with the whole straight motion of the step in which
the list is made; blocks that are near to each other are compared cell by cell. The list is kept while the cloth moves
little. What lies on different parts of the cloth comes nearer by at most twice the motion of a point about the mean of
all. Neighbours come nearer by at most what the links between them turn and stretch, so that a cloth that flies or
swings keeps its list. Seen along its normal, a window of the cloth that is no sharp fold is nearly a grid of
parallelograms: no neighbours in it are near to each other.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.points.cells import (
    EDGES,
    FACES,
    cell_at,
    cell_number,
    has_edge,
    point_and_face,
    two_edges,
)
from sim.springs.points.each_link import TINY
from sim.springs.points.near_pairs import bucket, cell, mean_shift, sort_into_buckets
from sim.springs.points.places import closing_bound, places_at

# Kinds of pairs: on different parts of the cloth; of cells with a common point; of cells with one cell between them.
FAR, JOINED, NEXT = 0, 1, 2
NEIGHBOURS = 2  # rows and columns apart, within which cells are JOINED or NEXT
BLOCK = 4  # rows and columns of cells in a block
# Reaches of the search in parts of the spacing: of FAR pairs beyond the least distance, and of neighbours. Of a flat
# cloth JOINED pairs are at least 0.71 of it away from each other, and NEXT ones all of it.
FAR_SKIN, JOINED_REACH, NEXT_REACH = 1.0, 0.6, 0.8
SHRINK = 0.3  # of what is beyond the least distance, where the list is full
SHRINKS = 3
TURNED = 0.1  # of the reach: motion in a step beyond which the direction across that motion may part two things


@kernel(inline=True)
def spacing_of(p):
    return min(p.row_spacing, p.col_spacing)


@kernel(inline=True)
def four_in_list(p, q):
    """The `Four` of row q of the list: two edges, or -1 - point and a face."""
    first, second = p.near[q, 0], p.near[q, 1]
    if first < 0:
        return point_and_face(-1 - first, cell_number(p, second // FACES), second % FACES)
    return two_edges(
        cell_number(p, first // EDGES), first % EDGES, cell_number(p, second // EDGES), second % EDGES
    )  # fmt: skip


@kernel(inline=True)
def is_beyond(square, along, reach):
    """True if a distance `along` a direction, times its length, is at least `reach`, by the squared length."""
    return along >= 0.0 and along * along >= reach * reach * square


@kernel(inline=True)
def along_at(x, n, j, dx, dy, dz):
    return dx * x[j] + dy * x[n + j] + dz * x[2 * n + j]


@kernel(inline=True)
def gap_of_four(x, n, four, dx, dy, dz):
    """The gap between both along a direction, negative if they overlap."""
    a, b = along_at(x, n, four.a, dx, dy, dz), along_at(x, n, four.b, dx, dy, dz)
    c, d = along_at(x, n, four.c, dx, dy, dz), along_at(x, n, four.d, dx, dy, dz)
    return min(b, c, d) - a if four.is_face else min(c, d) - max(a, b)


@kernel(inline=True)
def way_of_four(x, four, o):
    """One component, from o on, of the way from the middle of the first to that of the second."""
    if four.is_face:
        return (x[o + four.b] + x[o + four.c] + x[o + four.d]) / 3.0 - x[o + four.a]
    return 0.5 * (x[o + four.c] + x[o + four.d] - x[o + four.a] - x[o + four.b])


@kernel(inline=True)
def are_parted(x, y, n, four, dx, dy, dz, reach):
    """True if a plane across a direction keeps both apart by `reach` in the whole straight motion from x to y."""
    square = dx * dx + dy * dy + dz * dz
    if not is_beyond(square, gap_of_four(x, n, four, dx, dy, dz), reach):
        return False
    return is_beyond(square, gap_of_four(y, n, four, dx, dy, dz), reach)


@kernel(allocates=False)
def least_gap(x, y, n, four, reach):
    """Lower bound of the distance [m] in the straight motion from x to y, or `reach` if it stays beyond that."""
    dx, dy, dz = way_of_four(x, four, 0), way_of_four(x, four, n), way_of_four(x, four, 2 * n)
    if are_parted(x, y, n, four, dx, dy, dz, reach):
        return reach
    rx, ry, rz = way_of_four(y, four, 0) - dx, way_of_four(y, four, n) - dy, way_of_four(y, four, 2 * n) - dz
    rr = rx * rx + ry * ry + rz * rz
    if rr > (TURNED * reach) ** 2:
        part = (rx * dx + ry * dy + rz * dz) / rr
        if are_parted(x, y, n, four, dx - part * rx, dy - part * ry, dz - part * rz, reach):
            return reach
    return max(0.0, min(reach, places_at(x, n, four).distance - closing_bound(y, x, n, four)))


@kernel(inline=True)
def gap_of_cells(x, n, a, b, dx, dy, dz):
    """The gap between two cells along a direction, negative if they overlap."""
    first = max(
        along_at(x, n, a.a, dx, dy, dz), along_at(x, n, a.b, dx, dy, dz), along_at(x, n, a.c, dx, dy, dz),
        along_at(x, n, a.d, dx, dy, dz),
    )  # fmt: skip
    second = min(
        along_at(x, n, b.a, dx, dy, dz), along_at(x, n, b.b, dx, dy, dz), along_at(x, n, b.c, dx, dy, dz),
        along_at(x, n, b.d, dx, dy, dz),
    )  # fmt: skip
    return second - first


@kernel(inline=True)
def are_cells_parted(x, y, n, a, b, dx, dy, dz, reach):
    square = dx * dx + dy * dy + dz * dz
    if not is_beyond(square, gap_of_cells(x, n, a, b, dx, dy, dz), reach):
        return False
    return is_beyond(square, gap_of_cells(y, n, a, b, dx, dy, dz), reach)


@kernel(inline=True)
def way_of_cells(x, a, b, o):
    """One component of the way from the middle of cell a to that of cell b."""
    first = x[o + a.a] + x[o + a.b] + x[o + a.c] + x[o + a.d]
    return 0.25 * (x[o + b.a] + x[o + b.b] + x[o + b.c] + x[o + b.d] - first)


@kernel(allocates=False)
def may_cells_meet(x, y, n, a, b, reach):
    """False if two cells stay apart by `reach` in the straight motion from x to y, as a plane between them shows."""
    dx, dy, dz = way_of_cells(x, a, b, 0), way_of_cells(x, a, b, n), way_of_cells(x, a, b, 2 * n)
    if are_cells_parted(x, y, n, a, b, dx, dy, dz, reach):
        return False
    rx, ry = way_of_cells(y, a, b, 0) - dx, way_of_cells(y, a, b, n) - dy
    rz = way_of_cells(y, a, b, 2 * n) - dz
    rr = rx * rx + ry * ry + rz * rz
    if rr < (TURNED * reach) ** 2:
        return True
    part = (rx * dx + ry * dy + rz * dz) / rr
    return not are_cells_parted(x, y, n, a, b, dx - part * rx, dy - part * ry, dz - part * rz, reach)


@kernel(allocates=False)
def list_four(x, y, p, four, first, second, kind, reach, count):
    """List a pair if it comes nearer than `reach` and has no common point; returns the number in the list."""
    of_first = four.a == four.b if four.is_face else four.b == four.c or four.b == four.d
    if of_first or four.a == four.c or four.a == four.d:
        return count
    gap = least_gap(x, y, p.rows * p.cols, four, reach)
    p.clear[kind] = min(p.clear[kind], gap)
    if gap >= reach:
        return count
    if count < p.near.shape[0] - 1:
        p.near[count, 0], p.near[count, 1], p.near[count, 2] = first, second, kind
        p.near_gaps[count] = gap
    return count + 1


@kernel(allocates=False)
def list_point(x, y, p, a, b, kind, reach, count):
    """List the first particle of cell a with the faces of cell b."""
    if has_edge(b, 2):
        for f in range(FACES):
            four = point_and_face(a.a, b, f)
            count = list_four(x, y, p, four, -1 - a.a, FACES * b.a + f, kind, reach, count)
    return count


@kernel(allocates=False)
def list_cells(x, y, p, a, b, kind, reach, count):
    """List the pairs of two cells that may meet; returns the number in the list."""
    count = list_point(x, y, p, a, b, kind, reach, count)
    if a.a == b.a:
        return count
    count = list_point(x, y, p, b, a, kind, reach, count)
    for e in range(EDGES):
        if not has_edge(a, e):
            continue
        for f in range(EDGES):
            if has_edge(b, f):
                four = two_edges(a, e, b, f)
                count = list_four(x, y, p, four, EDGES * a.a + e, EDGES * b.a + f, kind, reach, count)
    return count


@kernel(inline=True)
def squared_aside(dx, dy, dz, nx, ny, nz):
    """Squared length of the part of a vector across a unit vector."""
    along = dx * nx + dy * ny + dz * nz
    return dx * dx + dy * dy + dz * dz - along * along


@kernel(noalias=True, inline=True)
def clearance(x, y, n, cols, first, size, between):
    """Lower bound of the distance [m] of things in a square window, `size` particles a side, from particle `first` on.

    E and F are the mean ways along a row and a column. Seen along their normal, the particles are at most `off` from a
    grid of these. So two places are as far apart as on that grid less 2 `off`: at least `between`, their distance on a
    grid of unit squares, times the least singular value of (E, F). A motion from x to y takes twice that of a particle.
    """
    middle = 0.5 * (size - 1.0)
    across = mx = my = mz = ex = ey = ez = fx = fy = fz = ux = uy = uz = 0.0
    for r in range(size):
        for s in range(size):
            k, c, d = first + np.uint64(r) * cols + np.uint64(s), s - middle, r - middle
            px, py, pz = x[k], x[n + k], x[n + n + k]
            mx, my, mz = mx + px, my + py, mz + pz
            ux, uy, uz = ux + y[k] - px, uy + y[n + k] - py, uz + y[n + n + k] - pz
            ex, ey, ez = ex + c * px, ey + c * py, ez + c * pz
            fx, fy, fz = fx + d * px, fy + d * py, fz + d * pz
            across += c * c
    part = 1.0 / (size * size)
    mx, my, mz, ux, uy, uz = part * mx, part * my, part * mz, part * ux, part * uy, part * uz
    ex, ey, ez, fx, fy, fz = ex / across, ey / across, ez / across, fx / across, fy / across, fz / across
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    length = math.sqrt(nx * nx + ny * ny + nz * nz) + TINY
    nx, ny, nz = nx / length, ny / length, nz / length
    off = moved = 0.0
    for r in range(size):
        for s in range(size):
            k, c, d = first + np.uint64(r) * cols + np.uint64(s), s - middle, r - middle
            px, py, pz = x[k], x[n + k], x[n + n + k]
            dx, dy, dz = px - mx - c * ex - d * fx, py - my - c * ey - d * fy, pz - mz - c * ez - d * fz
            off = max(off, squared_aside(dx, dy, dz, nx, ny, nz))
            dx, dy, dz = y[k] - px - ux, y[n + k] - py - uy, y[n + n + k] - pz - uz
            moved = max(moved, squared_aside(dx, dy, dz, nx, ny, nz))
    ee, ff, ef = ex * ex + ey * ey + ez * ez, fx * fx + fy * fy + fz * fz, ex * fx + ey * fy + ez * fz
    least = 0.5 * (ee + ff) - math.sqrt(0.25 * (ee - ff) ** 2 + ef * ef)
    return between * math.sqrt(max(0.0, least)) - 2.0 * (math.sqrt(off) + math.sqrt(moved))


@kernel(inline=True)
def window_place(i, rows, size):
    """The row of the first particle of a window that holds the cells from row i on, as far as there are any."""
    return max(0, min(i, rows - size))


@kernel(inline=True)
def is_flat(windows, p, i, j, size, kind):
    """True if neither window with the neighbours of a cell, after it and beside it, lets them come within reach."""
    first, back = window_place(i, p.rows, size), window_place(j - size + 2, p.cols, size)
    here = windows[first * p.cols + window_place(j, p.cols, size)]
    there = windows[first * p.cols + back]
    least = min(here, there)
    if not least >= p.reach[kind]:
        return False
    p.clear[kind] = min(p.clear[kind], least)
    return True


@kernel(allocates=False)
def list_neighbours(x, y, p, i, j, joined, nexts, count):
    """List the pairs of a cell and of the neighbours after it. joined, nexts: `clearance` of windows."""
    a, n = cell_at(p, i, j), p.rows * p.cols
    flat, wide = is_flat(joined, p, i, j, 3, JOINED), is_flat(nexts, p, i, j, 4, NEXT)
    if flat and wide:
        return count
    for down in range(min(NEIGHBOURS, p.rows - 1 - i) + 1):
        for across in range(-min(NEIGHBOURS, j), min(NEIGHBOURS, p.cols - 1 - j) + 1):
            if down == 0 and across < 0:
                continue
            kind = JOINED if down < 2 and abs(across) < 2 else NEXT
            if flat if kind == JOINED else wide:
                continue
            b, reach = cell_at(p, i + down, j + across), p.reach[kind]
            if kind == JOINED or may_cells_meet(x, y, n, a, b, reach):
                count = list_cells(x, y, p, a, b, kind, reach, count)
            else:
                p.clear[NEXT] = min(p.clear[NEXT], reach)
    return count


@kernel(noalias=True, inline=True)
def set_windows(x, y, rows, cols, windows, size, between):
    """Set `clearance` at the first particle of each window; 0 if the cloth is too small to have any."""
    n, width = np.uint64(rows * cols), np.uint64(cols)
    for k in range(n):
        windows[k] = 0.0
    if cols < size:
        return
    for i in range(rows - size + 1):
        for j in range(np.uint64(cols - size + 1)):
            first = np.uint64(i) * width + j
            windows[first] = clearance(x, y, n, width, first, size, between)


@kernel(noalias=True, allocates=False)
def set_joined_windows(x, y, p, windows):
    set_windows(x, y, p.rows, p.cols, windows, 3, math.sqrt(0.5))


@kernel(noalias=True, allocates=False)
def set_next_windows(x, y, p, windows):
    set_windows(x, y, p.rows, p.cols, windows, 4, 1.0)


@kernel(allocates=False)
def set_balls(x, y, p, balls):
    """Set middle and radius (4, cells) [m] of a ball about each cell in its straight motion from x to y."""
    n = p.rows * p.cols
    for i in range(p.rows):
        for j in range(p.cols):
            c = cell_at(p, i, j)
            k = c.a
            square = 0.0
            for e in range(3):
                o = e * n
                balls[e, k] = 0.125 * (
                    x[o + k] + x[o + c.b] + x[o + c.c] + x[o + c.d] + y[o + k] + y[o + c.b] + y[o + c.c] + y[o + c.d]
                )
            for e in range(8):
                q = k if e % 4 == 0 else c.b if e % 4 == 1 else c.c if e % 4 == 2 else c.d
                z = x if e < 4 else y
                dx, dy, dz = z[q] - balls[0, k], z[n + q] - balls[1, k], z[2 * n + q] - balls[2, k]
                square = max(square, dx * dx + dy * dy + dz * dz)
            balls[3, k] = math.sqrt(square)


@kernel(inline=True)
def blocks_in(count):
    return (count + BLOCK - 1) // BLOCK


@kernel(allocates=False)
def set_block_balls(p, balls, blocks):
    """Set middle and radius (4, blocks) [m] of a ball about the balls of each block; returns the largest radius."""
    most, across = 0.0, blocks_in(p.cols)
    for block in range(blocks.shape[1]):
        top, left = BLOCK * (block // across), BLOCK * (block % across)
        bottom, right = min(top + BLOCK, p.rows), min(left + BLOCK, p.cols)
        mx = my = mz = radius = 0.0
        part = 1.0 / ((bottom - top) * (right - left))
        for i in range(top, bottom):
            for a in range(i * p.cols + left, i * p.cols + right):
                mx, my, mz = mx + part * balls[0, a], my + part * balls[1, a], mz + part * balls[2, a]
        for i in range(top, bottom):
            for a in range(i * p.cols + left, i * p.cols + right):
                dx, dy, dz = balls[0, a] - mx, balls[1, a] - my, balls[2, a] - mz
                radius = max(radius, balls[3, a] + math.sqrt(dx * dx + dy * dy + dz * dz))
        blocks[0, block], blocks[1, block], blocks[2, block], blocks[3, block] = mx, my, mz, radius
        most = max(most, radius)
    return most


@kernel(inline=True)
def balls_meet(first, a, second, b, reach):
    dx, dy, dz = second[0, b] - first[0, a], second[1, b] - first[1, a], second[2, b] - first[2, a]
    most = first[3, a] + second[3, b] + reach
    return dx * dx + dy * dy + dz * dz < most * most


@kernel(allocates=False)
def list_blocks(x, y, p, first, second, balls, blocks, reach, count):
    """List the pairs of the cells of two blocks that are no neighbours."""
    across, n = blocks_in(p.cols), p.rows * p.cols
    top, left = BLOCK * (first // across), BLOCK * (first % across)
    low, near = BLOCK * (second // across), BLOCK * (second % across)
    for i in range(top, min(top + BLOCK, p.rows)):
        for j in range(left, min(left + BLOCK, p.cols)):
            a = i * p.cols + j
            if not balls_meet(balls, a, blocks, second, reach):
                continue
            for k in range(low, min(low + BLOCK, p.rows)):
                for m in range(near, min(near + BLOCK, p.cols)):
                    b = k * p.cols + m
                    if (first == second and b <= a) or not balls_meet(balls, a, balls, b, reach):
                        continue
                    if abs(i - k) <= NEIGHBOURS and abs(j - m) <= NEIGHBOURS:
                        continue
                    one, other = cell_at(p, i, j), cell_at(p, k, m)
                    if may_cells_meet(x, y, n, one, other, reach):
                        count = list_cells(x, y, p, one, other, FAR, reach, count)
    return count


@kernel
def fill_list(x, y, p, reach, joined_reach, next_reach):
    """Fill p.near with the pairs that come nearer than the reach [m] of their kind in the straight motion from x to y.

    Returns False if the list was full.

    Sets p.clear to a lower bound of the distance of all pairs of each kind. No pairs if p.stop cancels.
    """
    n, last = p.rows * p.cols, p.near.shape[0] - 1
    p.reach[FAR], p.reach[JOINED], p.reach[NEXT] = reach, joined_reach, next_reach
    p.clear[FAR], p.clear[JOINED], p.clear[NEXT] = reach, math.inf, math.inf
    count = 0
    joined, nexts = np.empty(n), np.empty(n)
    set_joined_windows(x, y, p, joined)
    set_next_windows(x, y, p, nexts)
    for i in range(p.rows):
        if is_stopped(p.stop):
            p.near[last, 0] = 0
            return True
        for j in range(p.cols):
            count = list_neighbours(x, y, p, i, j, joined, nexts, count)
    balls, blocks = np.empty((4, n)), np.empty((4, blocks_in(p.rows) * blocks_in(p.cols)))
    set_balls(x, y, p, balls)
    inverse = 1.0 / (2.0 * set_block_balls(p, balls, blocks) + reach)
    mask = 1
    while mask < blocks.shape[1]:
        mask *= 2
    mask -= 1
    where, order = np.empty(blocks.shape[1], np.int64), np.empty(blocks.shape[1], np.int64)
    for a in range(blocks.shape[1]):
        cx, cy, cz = cell(blocks[0, a], inverse), cell(blocks[1, a], inverse), cell(blocks[2, a], inverse)
        where[a] = bucket(cx, cy, cz, mask)
    starts = sort_into_buckets(where, order, mask)
    for a in range(blocks.shape[1]):
        if count > last:
            break
        if is_stopped(p.stop):
            p.near[last, 0] = 0
            return True
        ca, cb, cc = cell(blocks[0, a], inverse), cell(blocks[1, a], inverse), cell(blocks[2, a], inverse)
        for near in range(27):
            cx, cy, cz = ca + near // 9 - 1, cb + near // 3 % 3 - 1, cc + near % 3 - 1
            q = bucket(cx, cy, cz, mask)
            for s in range(starts[q + 1], starts[q + 2] if q < mask else blocks.shape[1]):
                b = order[s]
                if b < a or not balls_meet(blocks, a, blocks, b, reach):
                    continue
                # Two cells of the 27 may share a bucket: take the pair from the one that b is in.
                if cell(blocks[0, b], inverse) != cx or cell(blocks[1, b], inverse) != cy:
                    continue
                if cell(blocks[2, b], inverse) == cz:
                    count = list_blocks(x, y, p, a, b, balls, blocks, reach, count)
    p.near[last, 0] = min(count, last)
    for j in range(3 * n):
        p.listed[j] = y[j]
    return count <= last


@kernel
def find_near(x, y, p, least):
    """Make the list for the straight motion from x to y; returns False if there is no room for all in it.

    least: distance [m] below which everything has to be listed.
    """
    n, o = p.rows * p.cols, np.uint64(p.rows * p.cols)
    seen = np.empty(3 * n)
    # The motion that all share brings nothing together.
    for e in range(3):
        shift = mean_shift(y, x, np.uint64(e) * o, o)
        for j in range(n):
            seen[e * n + j] = y[e * n + j] - shift
    p.moved[0] = p.moved[1] = 0.0
    spacing, part = spacing_of(p), 1.0
    far, joined, nexts = FAR_SKIN * spacing, JOINED_REACH * spacing - least, NEXT_REACH * spacing - least
    for _ in range(SHRINKS):
        if fill_list(x, seen, p, least + part * far, least + part * joined, least + part * nexts):
            return True
        part *= SHRINK
    return False


@kernel
def note_left_out(p):
    """Note that cells are left out of a list that is full, and that it tells nothing about them."""
    p.clear[:] = 0.0
    p.pairs[p.pairs.shape[0] - 1, 1] = max(p.pairs[p.pairs.shape[0] - 1, 1], 1)


@kernel(noalias=True, inline=True)
def most_changed(x, listed, first, gap, count, n):
    """Largest squared change, since the list was made, of the way from each of `count` particles to one `gap` on."""
    most = 0.0
    for q in range(count):
        j = first + q
        k = j + gap
        dx = (x[k] - listed[k]) - (x[j] - listed[j])
        dy = (x[n + k] - listed[n + k]) - (x[n + j] - listed[n + j])
        dz = (x[n + n + k] - listed[n + n + k]) - (x[n + n + j] - listed[n + n + j])
        most = max(most, dx * dx + dy * dy + dz * dz)
    return most


@kernel(noalias=True, allocates=False)
def motion_since(x, listed, rows, cols):
    """Largest motion [m] of a particle about the mean since the list was made, and largest relative motion along a
    column and along a row from one to the next."""
    n, one, width = np.uint64(rows * cols), np.uint64(1), np.uint64(cols)
    mx, my = mean_shift(x, listed, np.uint64(0), n), mean_shift(x, listed, n, n)
    mz = mean_shift(x, listed, n + n, n)
    most = across = 0.0
    for j in range(n):
        dx, dy, dz = x[j] - listed[j] - mx, x[n + j] - listed[n + j] - my, x[n + n + j] - listed[n + n + j] - mz
        most = max(most, dx * dx + dy * dy + dz * dz)
    down = most_changed(x, listed, np.uint64(0), width, n - width, n)
    for i in range(rows):
        across = max(across, most_changed(x, listed, np.uint64(i) * width, one, width - one, n))
    return math.sqrt(most), math.sqrt(down) + math.sqrt(across)


@kernel(allocates=False)
def start_motion(x, p, follows):
    """Set the motion since the list was made, up to the start of a step: that up to the end of the last one, if x
    follows it."""
    if follows and p.pins.shape[0] == 0:
        p.moved[0], p.moved[1] = p.moved[2], p.moved[3]
    else:
        p.moved[0], p.moved[1] = motion_since(x, p.listed, p.rows, p.cols)


@kernel(allocates=False)
def set_closing(x, p):
    """Set p.closing to bounds of how much nearer pairs of each kind have come [m] since the list was made.

    x: the end of the step.
    """
    p.moved[2], p.moved[3] = motion_since(x, p.listed, p.rows, p.cols)
    far, near = max(p.moved[0], p.moved[2]), max(p.moved[1], p.moved[3])
    p.closing[FAR], p.closing[JOINED], p.closing[NEXT] = 2.0 * far, 2.0 * near, 3.0 * near


@kernel(inline=True)
def stays_beyond(p, bounds, least):
    """True if no pair that was beyond these bounds [m] has come nearer than `least`; False if a motion is NaN."""
    far, joined = p.closing[FAR] <= bounds[FAR] - least, p.closing[JOINED] <= bounds[JOINED] - least
    return far and joined and p.closing[NEXT] <= bounds[NEXT] - least
