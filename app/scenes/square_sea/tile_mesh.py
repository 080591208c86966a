"""From the fields of a sea to the mesh that is drawn: positions, slopes and foam at every stride-th grid point.

Slopes and the Jacobian are fourth-order differences of the displaced grid, so that a frame costs the three transforms
of its positions, or one without choppiness, where exact derivatives would cost five more. A wave of eight cells is
1 % too flat in them, one of four 15 %.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from sim.jit import kernel

LEAST_STRETCH = np.float32(0.15)  # Jacobian below which slopes are those at this value: a folded surface has no slope
STEEPEST = np.float32(1.5)  # largest slope drawn, in magnitude
ZERO, ONE, EIGHT = np.float32(0.0), np.float32(1.0), np.float32(8.0)


@kernel(noalias=True)
def thin(row, stride, out):
    """out (n/stride,): every stride-th number of a row (n,)."""
    if stride == 1:
        for j in range(out.size):
            out[j] = row[j]
    elif stride == 2:  # a step that the compiler knows
        for j in range(out.size):
            out[j] = row[2 * j]
    else:
        for j in range(out.size):
            out[j] = row[stride * j]


@kernel(noalias=True)
def set_differences(f, p_2, p_1, p, p1, p2, along, across):
    """12 times the differences of a periodic field (n, n) per cell in row p, (n,) each: along its first index, from
    the rows p_2 to p2, and across, along its second.

    Of all columns: wide instructions on rows as they lie in memory are faster than numbers picked from them.
    """
    n = along.size
    before2, before, row, behind, behind2 = f[p_2], f[p_1], f[p], f[p1], f[p2]
    for j in range(n):
        along[j] = EIGHT * (behind[j] - before[j]) - (behind2[j] - before2[j])
    left2, left, right, right2 = row[: n - 4], row[1 : n - 3], row[3 : n - 1], row[4:]
    inner = across[2 : n - 2]
    for j in range(n - 4):
        inner[j] = EIGHT * (right[j] - left[j]) - (right2[j] - left2[j])
    for j in range(-2, 2):
        across[j % n] = EIGHT * (row[(j + 1) % n] - row[(j - 1) % n]) - (row[(j + 2) % n] - row[(j - 2) % n])


@kernel(noalias=True)
def set_slopes(hx, hy, xx, xy, yy, lift, inverse, limit, sharpness, decay, foam):
    """A row of slopes, in place of the differences hx, hy of the height, and its foam; sums of foam and (J - 1)^2."""
    foamy, strain = np.float32(0.0), np.float32(0.0)
    for j in range(np.uint64(hx.size)):
        a, b, d = ONE + inverse * xx[j], inverse * xy[j], ONE + inverse * yy[j]
        J = a * d - b * b
        # The slope by place: (zx, zy) by label, times the inverse of the displacement's gradient.
        by_x, by_y = lift * inverse * hx[j], lift * inverse * hy[j]
        stretch = ONE / max(J, LEAST_STRETCH)
        zx, zy = (d * by_x - b * by_y) * stretch, (a * by_y - b * by_x) * stretch
        shorter = STEEPEST / max(np.sqrt(zx * zx + zy * zy), STEEPEST)
        hx[j], hy[j] = zx * shorter, zy * shorter
        white = max(foam[j] * decay, min(max((limit - J) * sharpness, ZERO), ONE))
        foam[j] = white
        foamy += white
        strain += (J - ONE) * (J - ONE)
    return foamy, strain


@kernel(noalias=True)
def set_row(x, y_step, dx, dy, z, lift, sx, sy, points, slopes):
    """A row of the mesh that rests at x [m], its points y_step [m] apart: points (cols, 3) [m], slopes (cols, 2)."""
    for j in range(sx.size):
        slopes[j, 0], slopes[j, 1] = sx[j], sy[j]
        points[j, 0], points[j, 1], points[j, 2] = x + dx[j], j * y_step + dy[j], lift * z[j]


@kernel(noalias=True)
def set_mesh(height, dx, dy, choppy, scale, stride, cell, threshold, soft, fade, vertices, slopes, foam):
    """Set the mesh and fade its foam; returns (fraction of the mesh that is foam, rms of J - 1).

    height, dx, dy: (n, n) [m], dx and dy unread unless `choppy`; scale: factor on the height; cell [m] of the grid.
    foam: (n/stride, n/stride), 0 to 1, kept from the last frame: times `fade`, and at least (threshold - J)/soft.
    Differences are (8 (f1 - f-1) - (f2 - f-2))/12 per cell.
    """
    rows, cols = foam.shape
    n = height.shape[0]
    lift, inverse = np.float32(scale), np.float32(1.0 / (12.0 * cell))
    limit, sharpness, decay = np.float32(threshold), np.float32(1.0 / soft), np.float32(fade)
    along, across = np.empty(n, np.float32), np.empty(n, np.float32)
    z, X, Y = np.empty(cols, np.float32), np.zeros(cols, np.float32), np.zeros(cols, np.float32)
    hx, hy = np.empty(cols, np.float32), np.empty(cols, np.float32)
    xx, xy, yy = np.zeros(cols, np.float32), np.zeros(cols, np.float32), np.zeros(cols, np.float32)
    foamy, strain = 0.0, 0.0
    for i in range(rows):
        p = i * stride
        p_2, p_1, p1, p2 = (p - 2) % n, (p - 1) % n, (p + 1) % n, (p + 2) % n
        set_differences(height, p_2, p_1, p, p1, p2, along, across)
        thin(along, stride, hx)
        thin(across, stride, hy)
        thin(height[p], stride, z)
        if choppy:
            set_differences(dx, p_2, p_1, p, p1, p2, along, across)
            thin(along, stride, xx)
            thin(across, stride, xy)
            thin(dx[p], stride, X)
            set_differences(dy, p_2, p_1, p, p1, p2, along, across)
            thin(across, stride, yy)
            thin(dy[p], stride, Y)
        row_foam, row_strain = set_slopes(hx, hy, xx, xy, yy, lift, inverse, limit, sharpness, decay, foam[i])
        set_row(p * cell, stride * cell, X, Y, z, lift, hx, hy, vertices[i], slopes[i])
        foamy += row_foam
        strain += row_strain
    count = rows * cols
    return foamy / count, np.sqrt(strain / count)


@kernel(noalias=True)
def set_foam(jacobian, scale, stride, threshold, soft, fade, foam):
    """Fade the foam of the mesh and add new foam by a given Jacobian (n, n), as `set_mesh` does.

    scale: factor on the height. Returns (fraction of the mesh that is foam, rms of J - 1).
    """
    limit, sharpness, decay, lift = np.float32(threshold), np.float32(1.0 / soft), np.float32(fade), np.float32(scale)
    rows, cols = foam.shape
    foamy, strain = 0.0, 0.0
    for i in range(rows):
        for j in range(cols):
            strained = lift * (jacobian[i * stride, j * stride] - ONE)
            foam[i, j] = max(foam[i, j] * decay, min(max((limit - ONE - strained) * sharpness, ZERO), ONE))
            foamy += foam[i, j]
            strain += strained * strained
    return foamy / (rows * cols), np.sqrt(strain / (rows * cols))


class Highest(NamedTuple):
    """The highest crest since the start."""

    place: Vector  # [m]
    time: float  # [s]
    ratio: float  # over Hs then


class Fields(NamedTuple):
    """A sea on its grid."""

    height: NDArray[np.floating]  # (n, n) [m]
    displacement: NDArray[np.floating] | None = None  # (n, n, 2) [m], or None
    jacobian: NDArray[np.floating] | None = None  # (n, n) that makes foam; None: that of the displacement
    highest: Highest | None = None  # of a nonlinear sea


def set_mesh_of(
    fields: Fields,
    scale: float,
    length: float,
    threshold: float,
    soft: float,
    fade: float,
    vertices: NDArray[np.float32],
    slopes: NDArray[np.float32],
    foam: NDArray[np.float32],
) -> tuple[float, float]:
    """`set_mesh` of fields on a tile of side `length` [m], with foam by their Jacobian where they have one."""
    D = np.empty((1, 1, 2), np.float32) if fields.displacement is None else fields.displacement
    n, jacobian = len(fields.height), fields.jacobian
    stride = n // len(foam)
    limit, decay = (threshold, fade) if jacobian is None else (-math.inf, 1.0)
    cover, deviation = set_mesh(
        fields.height, D[..., 0], D[..., 1], fields.displacement is not None, scale, stride, length / n, limit, soft,
        decay, vertices, slopes, foam,
    )  # fmt: skip
    if jacobian is not None:
        cover, deviation = set_foam(jacobian, scale, stride, threshold, soft, fade, foam)
    return cover, deviation
