"""Edges and faces of a cloth: each cell between four particles is two triangles, which are also those that are drawn.

Diagonals alternate, so that no direction of folds is preferred. A cell has the number of its first particle. There is
one for each particle: those of the last row and column have only some of the edges, and no face.
"""

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.points.places import Four

EDGES = 3  # that begin at a particle: along its row, along its column, and the diagonal of its cell
FACES = 2


class Cell(NamedTuple):
    """The particles of a cell. Beyond the last row and column others stand for those that do not exist."""

    a: int
    b: int  # next in the row
    c: int  # next in the column
    d: int
    has_right: bool
    has_down: bool
    is_odd: bool  # its diagonal goes from a to d


@functools.lru_cache(maxsize=4)
def faces(rows: int, cols: int) -> NDArray[np.uint32]:
    """(2 (rows - 1) (cols - 1), 3): the particles of the two triangles of each cell."""
    i, j = (index.ravel() for index in np.meshgrid(np.arange(rows - 1), np.arange(cols - 1), indexing="ij"))
    a = i * cols + j
    b, c, d = a + 1, a + cols, a + cols + 1
    odd = ((i + j) % 2).astype(bool)[:, None]
    first = np.where(odd, np.stack([a, b, d], 1), np.stack([a, b, c], 1))
    second = np.where(odd, np.stack([a, d, c], 1), np.stack([b, d, c], 1))
    return np.concatenate([first, second]).astype(np.uint32)


@kernel(inline=True)
def cell_at(p, i, j):
    """The `Cell` in row i and column j."""
    has_right, has_down = j < p.cols - 1, i < p.rows - 1
    a = i * p.cols + j
    b, c = a + (1 if has_right else 0), a + (p.cols if has_down else 0)
    return Cell(a, b, c, b + c - a, has_right, has_down, (i + j) % 2 == 1)


@kernel(inline=True)
def cell_number(p, a):
    return cell_at(p, a // p.cols, a % p.cols)


@kernel(inline=True)
def has_edge(cell, e):
    """True if edge e of a cell exists."""
    return (e == 1 or cell.has_right) and (e == 0 or cell.has_down)


@kernel(inline=True)
def edge_ends(cell, e):
    """The particles of edge e."""
    if e == 2:
        return (cell.a, cell.d) if cell.is_odd else (cell.b, cell.c)
    return cell.a, cell.b if e == 0 else cell.c


@kernel(inline=True)
def two_edges(first, e, second, f):
    """The `Four` of edge e of one cell and edge f of another."""
    a, b = edge_ends(first, e)
    c, d = edge_ends(second, f)
    return Four(False, a, b, c, d)


@kernel(inline=True)
def face_corners(cell, f):
    """The particles of face f of a cell, as `faces` has it."""
    if cell.is_odd:
        return cell.a, cell.b if f == 0 else cell.d, cell.d if f == 0 else cell.c
    return cell.a if f == 0 else cell.b, cell.b if f == 0 else cell.d, cell.c


@kernel(inline=True)
def point_and_face(point, cell, f):
    """The `Four` of a particle and face f of a cell."""
    b, c, d = face_corners(cell, f)
    return Four(True, point, b, c, d)
