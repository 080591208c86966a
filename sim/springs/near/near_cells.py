"""The list of a cloth's edges, and of its points and faces, that may meet: `sim.springs.kicks.apart` looks at these.

Blocks of cells are found by the spatial hash of `near_balls`, with the whole straight motion of the step in which
the list is made; blocks that are near to each other are compared cell by cell. The list is kept while the cloth moves
little. What lies on different parts of the cloth comes nearer by at most twice the motion of a point about the mean of
all. Neighbours come nearer by at most what the links between them turn and stretch, so that a cloth that flies or
swings keeps its list. Seen along its normal, a window of the cloth that is no sharp fold is nearly a grid of
parallelograms: no neighbours in it are near to each other.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.near.near_balls import balls_meet, balls_near, sort_balls
from sim.springs.near.near_pairs import farthest, mean_shift, spacing_of
from sim.springs.near.windows import are_beside, block_at, blocks_in, region, window, window_place
from sim.springs.points.cells import (
    EDGES,
    FACES,
    cell_at,
    cell_number,
    has_edge,
    point_and_face,
    two_edges,
)
from sim.springs.points.places import closing_bound, places_at

# Kinds of pairs: on different parts of the cloth; of cells with a common point; of cells with one cell between them.
FAR, JOINED, NEXT = 0, 1, 2
NEIGHBOURS = 2  # rows and columns apart, within which cells are JOINED or NEXT
SMALL, LARGE = 3, 4  # rows and columns of particles in a window of JOINED cells, and of NEXT ones
# Reaches of the search in parts of the spacing: of FAR pairs beyond the least distance, and of neighbours. Of a flat
# cloth JOINED pairs are at least 0.71 of it away from each other, and NEXT ones all of it.
FAR_SKIN, JOINED_REACH, NEXT_REACH = 1.0, 0.42, 0.6
NEARLY_FLAT = 0.6  # of the spacing: distance of JOINED pairs beyond which a large window's bound is taken
SHRINK = 0.3  # of what is beyond the least distance, where the list is full
SHRINKS = 3
TURNED = 0.1  # of the reach: motion in a step beyond which the direction across that motion may part two things


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
def is_flat(p, width, off, kind, reach):
    """True if a window lets no neighbours of a kind come within `reach` [m]."""
    least = (math.sqrt(0.5) if kind == JOINED else 1.0) * width - 2.0 * off
    if not least >= reach:
        return False
    p.clear[kind] = min(p.clear[kind], least)
    return True


@kernel(allocates=False)
def is_small_window_flat(x, y, p, i, j):
    """True if the window of JOINED cells from cell (i, j) on lets none come within reach."""
    if min(p.rows, p.cols) < SMALL:
        return False
    first = window_place(i, p.rows, SMALL) * p.cols + window_place(j, p.cols, SMALL)
    width, off = window(x, y, np.uint64(p.rows * p.cols), np.uint64(p.cols), np.uint64(first), SMALL)
    return is_flat(p, width, off, JOINED, p.reach[JOINED])


@kernel(allocates=False)
def list_neighbours(x, y, p, i, j, windows, count):
    """List the pairs of a cell and of the neighbours after it, unless the windows after it and beside it are flat.

    windows: width and off of each, (2, particles).
    """
    a, n = cell_at(p, i, j), p.rows * p.cols
    flat = wide = False
    if min(p.rows, p.cols) >= LARGE:
        first = window_place(i, p.rows, LARGE) * p.cols
        here, there = first + window_place(j, p.cols, LARGE), first + window_place(j - LARGE + 2, p.cols, LARGE)
        width, off = min(windows[0, here], windows[0, there]), max(windows[1, here], windows[1, there])
        # A small window bounds a bent cloth's distances better.
        flat = is_flat(p, width, off, JOINED, max(p.reach[JOINED], NEARLY_FLAT * spacing_of(p)))
        wide = is_flat(p, width, off, NEXT, p.reach[NEXT])
    if not flat:
        flat = is_small_window_flat(x, y, p, i, j) and is_small_window_flat(x, y, p, i, j - SMALL + 2)
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


@kernel(noalias=True, allocates=False)
def set_windows(x, y, rows, cols, width, off):
    """Set width and off (particles,) of each `window` of NEXT cells at its first particle."""
    n, across = np.uint64(rows * cols), np.uint64(cols)
    if cols < LARGE:
        return
    for i in range(rows - LARGE + 1):
        for j in range(np.uint64(cols - LARGE + 1)):
            first = np.uint64(i) * across + j
            width[first], off[first] = window(x, y, n, across, first, LARGE)


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


@kernel(allocates=False)
def set_block_balls(p, balls, blocks):
    """Set middle and radius (4, blocks) [m] of a ball about the balls of each block."""
    for block in range(blocks.shape[1]):
        top, bottom, left, right = block_at(p, block)
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


@kernel(allocates=False)
def list_blocks(x, y, p, first, second, balls, blocks, reach, count):
    """List the pairs of the cells of two blocks that are no neighbours."""
    n = p.rows * p.cols
    top, bottom, left, right = block_at(p, first)
    low, high, near, far = block_at(p, second)
    for i in range(top, bottom):
        for j in range(left, right):
            a = i * p.cols + j
            if not balls_meet(balls, a, blocks, second, reach):
                continue
            for k in range(low, high):
                for m in range(near, far):
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
def fill_neighbours(x, y, p, joined_reach, next_reach):
    """Put the JOINED and NEXT pairs that come nearer than these [m] in the straight motion from x to y after the FAR
    ones of p.near. Returns and sets what `fill_far` does."""
    n, last = p.rows * p.cols, p.near.shape[0] - 1
    p.reach[JOINED], p.reach[NEXT] = joined_reach, next_reach
    p.clear[JOINED] = p.clear[NEXT] = math.inf
    count = p.near[last, 1]
    windows = np.empty((2, n))
    set_windows(x, y, p.rows, p.cols, windows[0], windows[1])
    for i in range(p.rows):
        if is_stopped(p.stop):
            p.near[last, 0] = p.near[last, 1] = 0
            return True
        for j in range(p.cols):
            count = list_neighbours(x, y, p, i, j, windows, count)
    p.near[last, 0] = min(count, last)
    for j in range(3 * n):
        p.joined[j] = y[j]
    return count <= last


@kernel
def fill_far(x, y, p, reach):
    """Fill p.near with the FAR pairs that come nearer than `reach` [m] in the straight motion from x to y.

    Returns False if the list was full.

    Sets p.clear to a lower bound of the distance of all such pairs. No pairs if p.stop cancels.
    """
    n, last, count = p.rows * p.cols, p.near.shape[0] - 1, 0
    p.reach[FAR] = p.clear[FAR] = reach
    balls, blocks = np.empty((4, n)), np.empty((4, blocks_in(p.rows) * blocks_in(p.cols)))
    set_balls(x, y, p, balls)
    set_block_balls(p, balls, blocks)
    buckets, beside = sort_balls(blocks, reach), np.empty(blocks.shape[1], np.int64)
    for a in range(blocks.shape[1]):
        if count > last:
            break
        if is_stopped(p.stop):
            p.near[last, 0] = p.near[last, 1] = 0
            return True
        width, off = region(x, y, p, a)
        is_flat = NEIGHBOURS * width - 2.0 * off >= reach
        for s in range(balls_near(blocks, buckets, a, reach, beside)):
            if not (is_flat and are_beside(p, a, beside[s])):
                count = list_blocks(x, y, p, a, beside[s], balls, blocks, reach, count)
    p.near[last, 0] = p.near[last, 1] = min(count, last)
    for j in range(3 * n):
        p.listed[j] = y[j]
    return count <= last


@kernel
def about_mean(x, y, p):
    """y (3 points,) without the motion from x that all points share, as it brings nothing together."""
    n, o = p.rows * p.cols, np.uint64(p.rows * p.cols)
    seen = np.empty(3 * n)
    for e in range(3):
        shift = mean_shift(y, x, np.uint64(e) * o, o)
        for j in range(n):
            seen[e * n + j] = y[e * n + j] - shift
    return seen


@kernel
def find_near(x, y, p, least):
    """Make the list for the straight motion from x to y; returns False if there is no room for all in it.

    least: distance [m] below which everything has to be listed.
    """
    seen, spacing, part = about_mean(x, y, p), spacing_of(p), 1.0
    p.moved[0] = p.moved[1] = 0.0
    far, joined, nexts = FAR_SKIN * spacing, JOINED_REACH * spacing - least, NEXT_REACH * spacing - least
    for _ in range(SHRINKS):
        has_room = fill_far(x, seen, p, least + part * far)
        if has_room and fill_neighbours(x, seen, p, least + part * joined, least + part * nexts):
            return True
        part *= SHRINK
    return False


@kernel
def find_neighbours(x, y, p):
    """Make the list of neighbours anew, with the same reach; returns False if there is no room for all in it."""
    p.moved[1] = 0.0
    return fill_neighbours(x, about_mean(x, y, p), p, p.reach[JOINED], p.reach[NEXT])


@kernel
def note_left_out(p):
    """Note that cells are left out of a list that is full, and that it tells nothing about them."""
    p.clear[:] = 0.0
    p.pairs[p.pairs.shape[0] - 1, 1] = max(p.pairs[p.pairs.shape[0] - 1, 1], 1)


@kernel(noalias=True, inline=True)
def set_moves(x, listed, o, count, n, moves):
    """Set the motion (3 count,) of as many particles, from o on, since the list was made."""
    for q in range(count):
        j = o + q
        moves[q] = x[j] - listed[j]
        moves[count + q] = x[n + j] - listed[n + j]
        moves[count + count + q] = x[n + n + j] - listed[n + n + j]


@kernel(noalias=True, inline=True)
def add_changes(first, second, gap, count, cols, most):
    """Raise `most` (count,) to the squared differences of the motions of as many particles and those `gap` on."""
    for q in range(count):
        k = q + gap
        dx = second[k] - first[q]
        dy = second[cols + k] - first[cols + q]
        dz = second[cols + cols + k] - first[cols + cols + q]
        change = dx * dx + dy * dy + dz * dz
        most[q] = change if change > most[q] else most[q]


@kernel(noalias=True, allocates=False)
def add_rows(x, listed, rows, cols, moves, down, across):
    """moves: (2, 3 cols), for those of a row and of the one before."""
    n, one, width = np.uint64(rows * cols), np.uint64(1), np.uint64(cols)
    for i in range(rows):
        here, before = moves[i % 2], moves[1 - i % 2]
        set_moves(x, listed, np.uint64(i) * width, width, n, here)
        add_changes(here, here, one, width - one, width, across)
        if i > 0:
            add_changes(before, here, np.uint64(0), width, width, down)


@kernel
def motion_since(x, p):
    """Largest motion [m] of a particle about the mean since the list was made, NaN if any is, and largest relative
    motion along a column and along a row, from one to the next, since that of neighbours was made."""
    down, across = np.zeros(p.cols), np.zeros(p.cols)
    add_rows(x, p.joined, p.rows, p.cols, np.empty((2, 3 * p.cols)), down, across)
    far = math.sqrt(farthest(x, p.listed, np.uint64(p.rows * p.cols)))
    return far, math.sqrt(down.max()) + math.sqrt(across.max())


@kernel(allocates=False)
def start_motion(x, p, follows):
    """Set the motion since the list was made, up to the start of a step: that up to the end of the last one, if x
    follows it and that is known."""
    if follows and p.pins.shape[0] == 0 and p.moved[2] < math.inf:
        p.moved[0], p.moved[1] = p.moved[2], p.moved[3]
    else:
        p.moved[0], p.moved[1] = motion_since(x, p)


@kernel(allocates=False)
def set_closing(x, p):
    """Set p.closing to bounds of how much nearer pairs of each kind have come [m] since the list was made.

    x: the end of the step.
    """
    p.moved[2], p.moved[3] = motion_since(x, p)
    far, near = max(p.moved[0], p.moved[2]), max(p.moved[1], p.moved[3])
    p.closing[FAR], p.closing[JOINED], p.closing[NEXT] = 2.0 * far, 2.0 * near, 3.0 * near


@kernel(inline=True)
def closing_since_list(x, p, four, kind):
    """Bound of how much nearer a pair has come [m] since the list was made, up to anywhere in the straight step."""
    n, seen = p.rows * p.cols, p.listed if kind == FAR else p.joined
    return max(closing_bound(x, seen, n, four), closing_bound(p.last, seen, n, four))


@kernel(inline=True)
def has_far(p, least):
    """True if no FAR pair that is not in the list can have come nearer than `least` [m]; False if a motion is NaN."""
    return p.closing[FAR] <= max(p.reach[FAR], p.clear[FAR]) - least


@kernel(inline=True)
def has_neighbours(p, least):
    """As `has_far`, for JOINED and NEXT pairs."""
    joined, nexts = max(p.reach[JOINED], p.clear[JOINED]), max(p.reach[NEXT], p.clear[NEXT])
    return p.closing[JOINED] <= joined - least and p.closing[NEXT] <= nexts - least


@kernel(inline=True)
def stays_clear(p, least):
    """True if no pair at all can have come nearer than `least` [m]; False if a motion is NaN."""
    far, joined = p.closing[FAR] <= p.clear[FAR] - least, p.closing[JOINED] <= p.clear[JOINED] - least
    return far and joined and p.closing[NEXT] <= p.clear[NEXT] - least
