"""The surface of a sea in a quarter of its memory, for recordings: rounded, and packed by `app/formats/packing.py`."""

import numpy as np
from numpy.typing import NDArray

from app.formats.packing import unpack
from app.formats.surface_fields import pack_fields, set_surface_fields

DISPLACEMENT_STEP = 1e-3  # [m] to which displacements are rounded
MAX_SENT_STEP = 2e-3  # [m] up to which a recording keeps what browsers were sent, and rounds nothing itself


class SentSurface:
    """Packed surface of a frame as sent: set by the view, read by the recording, both on the viewer's thread."""

    numbers: NDArray[np.float32] | None = None  # as `app/formats/packing.py` packs; None if it was not sent packed


def pack_surface(
    vertices: NDArray[np.float32],
    slopes: NDArray[np.float32],
    foam: NDArray[np.float32],
    rest: NDArray[np.float32],
    columns: int,
    sent: SentSurface,
) -> NDArray[np.float32]:
    """The surface as an array (rows, 3), for `unpack_surface`.

    vertices (..., 3) [m], slopes (..., 2) and foam (...), each in the same order of points as rest, (2, n) [m]: where
    they are level when the water rests. columns: points in a row of neighbours. What was sent is taken as it is where
    its displacements are fine enough: then the recording shows what was seen. A tile's has one more row and column.
    """
    numbers = sent.numbers
    if numbers is not None and numbers.reshape(-1)[3:12:3].max() <= MAX_SENT_STEP:
        return numbers.copy()  # without the room for longer ones
    fields = np.empty((6, rest.shape[1]), np.float32)
    n = rest.shape[1]
    surface = set_surface_fields(
        fields, vertices.reshape(1, n, 3), slopes.reshape(1, n, 2), foam.reshape(1, n), rest
    )  # fmt: skip
    return pack_fields(fields, surface, DISPLACEMENT_STEP, columns).copy()


def unpack_surface(
    numbers: NDArray[np.float32], rest: NDArray[np.float32], shape: tuple[int, ...]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """(vertices, slopes, foam) of a surface packed by `pack_surface`; shape: of the foam."""
    fields, columns = unpack(numbers), int(numbers.reshape(-1)[1])
    if fields.shape[1] > rest.shape[1]:  # the row and the column that close a tile
        fields = fields.reshape(len(fields), -1, columns)[:, :-1, :-1].reshape(len(fields), -1)
    fields[:2] += rest
    vertices, slopes = np.ascontiguousarray(fields[:3].T), np.ascontiguousarray(fields[3:5].T)
    return vertices.reshape(*shape, 3), slopes.reshape(*shape, 2), fields[5].reshape(shape)
