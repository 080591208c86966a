"""The surface of a sea in a quarter of its memory, as a recording keeps it: rounded, and packed by `sim/packing.py`."""

import numpy as np
from numpy.typing import NDArray

from sim.ocean.surface_fields import pack_fields, set_surface_fields
from sim.packing import unpack

DISPLACEMENT_STEP = 1e-3  # [m] to which displacements are rounded


def pack_surface(
    vertices: NDArray[np.float32],
    slopes: NDArray[np.float32],
    foam: NDArray[np.float32],
    rest: NDArray[np.float32],
    columns: int,
) -> NDArray[np.float32]:
    """The surface as an array (rows, 3), for `unpack_surface`.

    vertices (..., 3) [m], slopes (..., 2) and foam (...), each in the same order of points as rest, (2, n) [m]: where
    they are level when the water rests. columns: points in a row of neighbours.
    """
    fields = np.empty((6, rest.shape[1]), np.float32)
    n = rest.shape[1]
    surface = set_surface_fields(
        fields, vertices.reshape(1, n, 3), slopes.reshape(1, n, 2), foam.reshape(1, n), rest
    )  # fmt: skip
    return pack_fields(fields, surface, DISPLACEMENT_STEP, columns).copy()  # without the room for longer ones


def unpack_surface(
    numbers: NDArray[np.float32], rest: NDArray[np.float32], shape: tuple[int, ...]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """(vertices, slopes, foam) of what `pack_surface` made; shape: of the foam."""
    fields = unpack(numbers)
    fields[:2] += rest
    vertices, slopes = np.ascontiguousarray(fields[:3].T), np.ascontiguousarray(fields[3:5].T)
    return vertices.reshape(*shape, 3), slopes.reshape(*shape, 2), fields[5].reshape(shape)
