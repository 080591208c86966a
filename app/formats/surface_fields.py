"""The surface of a sea as fields that can be packed: displacement from rest, slopes and foam, one after the other."""

from typing import NamedTuple

import numpy as np

from app.formats.packing import FOAM_STEP, SLOPE_STEP, pack
from sim.jit import kernel


class SurfaceNumbers(NamedTuple):
    """Moments and maximum of a surface, from one pass over it."""

    shift: tuple[float, float, float]  # [m] mean displacement
    highest: float  # [m]
    height_variance: float  # [m2]
    square_slope: float  # mean


def set_surface_fields(
    fields: np.ndarray, vertices: np.ndarray, slopes: np.ndarray, foam: np.ndarray, rest: np.ndarray
) -> SurfaceNumbers:
    """Set fields (6, n) from vertices (rows, cols, 3) [m], slopes (rows, cols, 2) and foam (rows, cols).

    rest (2, n) [m]: where points are level when the water rests; its height is 0. n is rows cols, or (rows + 1) (cols
    + 1): then the first row and column come again behind the last, and close a tile that repeats.
    """
    numbers = set_fields(
        *(np.ascontiguousarray(array, np.float32) for array in (vertices, slopes, foam)), rest, fields
    )  # fmt: skip
    count = foam.size
    x, y, z, square, steep, highest = numbers
    shift = x / count, y / count, z / count
    return SurfaceNumbers(shift, highest, max(square / count - shift[2] ** 2, 0.0), steep / count)


def pack_fields(fields: np.ndarray, surface: SurfaceNumbers, displacement_step: float, columns: int) -> np.ndarray:
    """Pack the fields (6, n) of a surface (`packing.py`); a mesh that has moved as a whole is moved back first.

    displacement_step [m]: to which displacements are rounded. columns: points in a row of neighbours.
    """
    centre = [round(shift) for shift in surface.shift]
    for field, shift in enumerate(centre):
        if shift:
            fields[field] -= np.float32(shift)
    steps = (*[displacement_step] * 3, SLOPE_STEP, SLOPE_STEP, FOAM_STEP)
    return pack(fields, steps, columns, (*centre, 0.0, 0.0, 0.0))


@kernel(noalias=True)
def set_fields(vertices, slopes, foam, rest, fields):
    """`set_surface_fields`; returns sums of the displacements, of squared heights and slopes, and the highest point."""
    rows, cols = foam.shape
    n = fields.shape[1]
    stride = cols if n == rows * cols else cols + 1
    x, y, z, square, steep, highest = 0.0, 0.0, 0.0, 0.0, 0.0, -np.inf
    for i in range(rows):
        for j in range(cols):
            k = i * stride + j
            dx, dy, height = vertices[i, j, 0] - rest[0, k], vertices[i, j, 1] - rest[1, k], vertices[i, j, 2]
            sx, sy = slopes[i, j, 0], slopes[i, j, 1]
            fields[0, k], fields[1, k], fields[2, k] = dx, dy, height
            fields[3, k], fields[4, k], fields[5, k] = sx, sy, foam[i, j]
            x += dx
            y += dy
            z += height
            square += np.float64(height) * height
            steep += np.float64(sx) * sx + np.float64(sy) * sy
            highest = max(highest, np.float64(height))
    if stride > cols:
        for f in range(6):
            for i in range(rows):
                fields[f, i * stride + cols] = fields[f, i * stride]
            for j in range(stride):
                fields[f, rows * stride + j] = fields[f, j]
    return x, y, z, square, steep, highest


def compile_surface_fields() -> None:
    """Set the fields of one point."""
    point = np.zeros((1, 1, 3), np.float32)
    set_surface_fields(np.empty((6, 1), np.float32), point, point[..., :2], point[..., 2], np.zeros((2, 1), np.float32))
