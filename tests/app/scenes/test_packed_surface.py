"""A recording keeps the surface that browsers were sent, where that is fine enough."""

import numpy as np
import pytest

from app.formats.surface_fields import pack_fields, set_surface_fields
from app.scenes.packed_surface import DISPLACEMENT_STEP, MAX_SENT_STEP, SentSurface
from app.scenes.square_sea.frame import SeaFrame, pack_frame, unpack_frame
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.scene import SquareSeaScene

SIDE = 64


@pytest.fixture(scope="module")
def frame() -> SeaFrame:
    scene = SquareSeaScene(SquareSeaParams(size="64", mesh="64", length=100.0))
    scene.advance(100)
    return scene.frame()


def sent(frame: SeaFrame, step: float) -> np.ndarray:
    """As the page's mesh is: with the row and the column that close the tile."""
    along = np.arange(SIDE + 1) * (frame.params.length / SIDE)
    rest = np.stack(np.meshgrid(along, along, indexing="ij")).reshape(2, -1).astype(np.float32)
    fields = np.empty((6, (SIDE + 1) ** 2), np.float32)
    surface = set_surface_fields(fields, frame.vertices, frame.slopes, frame.foam, rest)
    return pack_fields(fields, surface, step, SIDE + 1)


@pytest.mark.parametrize("step", [3e-4, MAX_SENT_STEP])
def test_what_was_sent_is_not_packed_again(frame: SeaFrame, step: float) -> None:
    numbers = sent(frame, step)
    cell = SentSurface()
    cell.numbers = numbers
    packed = pack_frame(frame._replace(sent=cell))
    np.testing.assert_array_equal(packed.surface.view(np.uint32), numbers.view(np.uint32))
    back = unpack_frame(packed)
    assert np.abs(back.vertices - frame.vertices).max() <= 0.5 * step + 1e-5
    assert np.abs(back.slopes - frame.slopes).max() <= 0.5 / 512 + 1e-6
    assert np.abs(back.foam - frame.foam).max() <= 0.5 / 255 + 1e-6


def test_what_was_sent_for_a_far_camera_is_packed_anew(frame: SeaFrame) -> None:
    cell = SentSurface()
    cell.numbers = sent(frame, 1.1 * MAX_SENT_STEP)
    back = unpack_frame(pack_frame(frame._replace(sent=cell)))
    assert np.abs(back.vertices - frame.vertices).max() <= 0.5 * DISPLACEMENT_STEP + 1e-5
