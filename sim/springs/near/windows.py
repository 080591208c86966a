"""Square windows of a wide net that are nearly flat: no neighbours in one are near to each other."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.points.each_link import TINY

BLOCK = 4  # rows and columns of particles or cells in a block
REGION = 3 * BLOCK + 1  # rows and columns of particles in the window of a block and of those after it


@kernel(inline=True)
def blocks_in(count):
    return (count + BLOCK - 1) // BLOCK


@kernel(inline=True)
def row_of(j, cols):
    """The row of a particle or block. A division of whole numbers would take most of a search's time."""
    return np.int64((j + 0.5) * (1.0 / cols))


@kernel(inline=True)
def block_at(p, block):
    """First row of a block and that after its last, and so its columns."""
    across = blocks_in(p.cols)
    row = row_of(block, across)
    top, left = BLOCK * row, BLOCK * (block - across * row)
    return top, min(top + BLOCK, p.rows), left, min(left + BLOCK, p.cols)


@kernel(inline=True)
def are_beside(p, first, second):
    """True if a block is the other one, or borders on it."""
    across = blocks_in(p.cols)
    row, other = row_of(first, across), row_of(second, across)
    return abs(other - row) <= 1 and abs(second - first - (other - row) * across) <= 1


@kernel(inline=True)
def squared_aside(dx, dy, dz, nx, ny, nz):
    """Squared length of the part of a vector across a unit vector."""
    along = dx * nx + dy * ny + dz * nz
    return dx * dx + dy * dy + dz * dz - along * along


@kernel(noalias=True, inline=True)
def window(x, y, n, cols, first, size):
    """(width, off) [m] of a square window, `size` particles a side, from particle `first` on.

    E and F are the mean ways along a row and a column, and `width` is the least singular value of (E, F). Seen along
    their normal, the particles are at most `off` from a grid of these in the motion from x to y. So two places are as
    far apart as on that grid less 2 `off`: at least their distance on a grid of unit squares times `width`, less 2
    `off`.
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
    return math.sqrt(max(0.0, least)), math.sqrt(off) + math.sqrt(moved)


@kernel(inline=True)
def window_place(i, rows, size):
    """The first row of a window that holds the cells from row i on, as far as there are any; of columns the same."""
    return max(0, min(i, rows - size))


@kernel(allocates=False)
def region(x, y, p, block):
    """`window` of a block, those beside it and those after it; (0, 0) if the net is too small for one."""
    if min(p.rows, p.cols) < REGION:
        return 0.0, 0.0
    top, _, left, _ = block_at(p, block)
    first = window_place(top, p.rows, REGION) * p.cols + window_place(left - BLOCK, p.cols, REGION)
    return window(x, y, np.uint64(p.rows * p.cols), np.uint64(p.cols), np.uint64(first), REGION)
