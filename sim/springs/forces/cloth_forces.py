"""The forces of a cloth's six families, structural, shear and bend, row by row.

The links of a row go into a buffer of the last three rows, padded with zeros to its sides, and each particle then sums
its twelve in one loop: every link is computed once, written once and read twice, all within the fastest cache.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel, prange
from sim.springs.forces.links import link_forces, scale_ends

PAD = 2  # zeros on either side of a row: no link reaches further
REACH = 2  # rows on, where a link of the bend family ends
RING = REACH + 1  # rows kept


@kernel(inline=True)
def cloth_scratch_size(cols):
    """Numbers in the buffer."""
    return 6 * RING * 3 * (cols + 2 * PAD)


@kernel(inline=True)
def place(q, i, m):
    """Start of row i of family q, with its padding behind it."""
    return np.uint64(((q * RING + i % RING) * 3) * m + PAD)


@kernel(noalias=True, inline=True)
def clear(f, o, n):
    for j in range(n):
        f[o + j] = 0.0


@kernel(noalias=True, inline=True)
def sum_row(f, links, w, mass, v, a, o, ow, n, g, c):
    """a = w (m g - c v + pull of the links that begin here - pull of those that end here).

    links: where in f the rows of the families (0, 1), (1, 0), (1, 1), (1, -1), (0, 2) and (2, 0) begin, f.., and for
    those that reach other rows the rows of the links that end here, g...
    """
    f01, (f10, g10), (f11, g11), (f1m, g1m), f02, (f20, g20) = links
    one, two = np.uint64(1), np.uint64(2)
    for j in range(n):
        along = f[f01 + j] - f[f01 + j - one] + f[f10 + j] - f[g10 + j]
        across = f[f11 + j] - f[g11 + j - one] + f[f1m + j] - f[g1m + j + one]
        far = f[f02 + j] - f[f02 + j - two] + f[f20 + j] - f[g20 + j]
        a[o + j] = w[ow + j] * (mass[ow + j] * g - c * v[o + j] + along + across + far)


class Sheet(NamedTuple):
    """The kernel data that rows need: a parallel loop takes no record within a record, as the law is in a net's."""

    rows: int
    cols: int
    offsets: NDArray[np.int64]
    families: NDArray[np.float64]
    inverse_masses: NDArray[np.float64]
    mass: NDArray[np.float64]
    gx: float
    gy: float
    gz: float
    side: float
    axial: bool


@kernel(inline=True)
def sheet_of(p):
    return Sheet(
        p.rows, p.cols, p.offsets, p.families, p.inverse_masses, p.mass, p.gx, p.gy, p.gz, p.side, p.axial
    )  # fmt: skip


@kernel(noalias=True, allocates=False)
def accelerate_rows(x, v, p, law, b, c, f, o, a, start, stop):
    """Accelerations of the rows from `start` up to `stop`; p: a `Sheet`; f: the buffer, from index o.

    The links that reach in from up to two rows before are computed here too.
    """
    n = np.uint64(p.rows * p.cols)
    width = p.cols + 2 * PAD
    m = np.uint64(width)
    cols = np.uint64(p.cols)
    axial = p.axial and b > 0.0
    if start == 0:
        for q in (1, 2, 3, 5):
            for before in (1, 2):
                clear(f, o + place(q, before, width) - np.uint64(PAD), np.uint64(3) * m)
    for i in range(max(0, start - REACH), stop):
        for q in range(6):
            di, dj = p.offsets[q, 0], p.offsets[q, 1]
            if i + di < start:
                continue
            first = max(0, -dj)
            count = np.uint64(max(0, p.cols - abs(dj)))
            of = o + place(q, i, width)
            if i + di < p.rows:
                ia = np.uint64(i * p.cols + first)
                ib = np.uint64((i + di) * p.cols + first + dj)
                ratio = p.side if di == 0 and (i == 0 or i == p.rows - 1) else 1.0
                link_forces(
                    x, v, f, ia, ib, of + np.uint64(first), count, n, m,
                    law, ratio * p.families[q, 1], ratio * b * p.families[q, 2], p.families[q, 0], axial,
                )  # fmt: skip
                if dj == 0 and p.side != 1.0:
                    scale_ends(f, of, count, m, p.side)
            else:
                clear(f, of - np.uint64(PAD), np.uint64(3) * m)
        if i < start:
            continue
        row = np.uint64(i * p.cols)
        for e in range(3):
            g = p.gx if e == 0 else p.gy if e == 1 else p.gz
            s = o + np.uint64(e) * m
            links = (  # the row before is two later in the ring, and the one before that is the next
                place(0, i, width) + s,
                (place(1, i, width) + s, place(1, i + 2, width) + s),
                (place(2, i, width) + s, place(2, i + 2, width) + s),
                (place(3, i, width) + s, place(3, i + 2, width) + s),
                place(4, i, width) + s,
                (place(5, i, width) + s, place(5, i + 1, width) + s),
            )
            sum_row(f, links, p.inverse_masses, p.mass, v, a, np.uint64(e) * n + row, row, cols, g, c)


@kernel(parallel=True)
def accelerate_bands(x, v, p, law, bands, b, c, f, a):
    """`accelerate_rows` in bands of rows at once, each on a thread and in a buffer of its own."""
    for k in prange(bands):
        accelerate_rows(
            x, v, p, law, b, c, f, np.uint64(k * cloth_scratch_size(p.cols)), a,
            p.rows * k // bands, p.rows * (k + 1) // bands,
        )  # fmt: skip


@kernel(allocates=False)
def accelerate_cloth(x, v, p, b, c, f, a):
    """Accelerations of the six families, gravity and drag; f: the buffers, (p.bands cloth_scratch_size,)."""
    if p.bands > 1:
        accelerate_bands(x, v, sheet_of(p), p.law, p.bands, b, c, f, a)
    else:
        accelerate_rows(x, v, sheet_of(p), p.law, b, c, f, np.uint64(0), a, 0, p.rows)
