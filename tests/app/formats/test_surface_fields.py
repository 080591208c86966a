"""The fields of a surface, against numpy's own way to them."""

import numpy as np
import pytest

from app.formats.packing import SLOPE_STEP, unpack
from app.formats.surface_fields import pack_fields, set_surface_fields

ROWS, COLS, CELL = 4, 6, 0.5


def surface(seed: int, shift: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(rest (rows + 1, cols + 1, 2), vertices, slopes, foam) of a tile that has moved as a whole."""
    random = np.random.default_rng(seed)
    rest = np.stack(np.meshgrid(CELL * np.arange(ROWS + 1), CELL * np.arange(COLS + 1), indexing="ij"), axis=-1)
    vertices = random.normal(size=(ROWS, COLS, 3)) + shift
    vertices[..., :2] += rest[:ROWS, :COLS]
    return rest, vertices, random.normal(size=(ROWS, COLS, 2)), random.uniform(size=(ROWS, COLS))


@pytest.mark.parametrize("closed", [True, False])
def test_fields_and_numbers_of_a_surface(closed: bool) -> None:
    rest, vertices, slopes, foam = surface(1, (0.0, 0.0, 0.0))
    rest = rest if closed else rest[:ROWS, :COLS]
    fields = np.empty((6, rest[..., 0].size), np.float32)
    found = set_surface_fields(fields, vertices, slopes, foam, rest.reshape(-1, 2).T.astype(np.float32))
    displacement = vertices - np.concatenate([rest[:ROWS, :COLS], np.zeros((ROWS, COLS, 1))], axis=-1)
    expected = np.concatenate([displacement, slopes, foam[..., None]], axis=-1)
    if closed:
        expected = np.pad(expected, ((0, 1), (0, 1), (0, 0)), mode="wrap")
    np.testing.assert_allclose(fields, expected.reshape(-1, 6).T, atol=1e-6)
    assert found.shift == pytest.approx(displacement.mean(axis=(0, 1)), abs=1e-6)
    assert found.highest == pytest.approx(vertices[..., 2].max())
    assert found.height_variance == pytest.approx(vertices[..., 2].var(), rel=1e-5)
    assert found.square_slope == pytest.approx((slopes**2).sum(axis=-1).mean(), rel=1e-5)


def test_a_packed_surface_that_has_moved_as_a_whole_comes_back() -> None:
    rest, vertices, slopes, foam = surface(2, (300.0, -40.0, 2.0))
    rest = rest[:ROWS, :COLS].reshape(-1, 2).T.astype(np.float32)
    fields = np.empty((6, ROWS * COLS), np.float32)
    found = set_surface_fields(fields, vertices, slopes, foam, rest)
    back = unpack(pack_fields(fields, found, 1e-3, COLS))
    assert np.abs(fields[:2]).max() < 10.0  # of small numbers few bits are needed
    back[:2] += rest
    np.testing.assert_allclose(back[:3].T, vertices.reshape(-1, 3), atol=6e-4)
    np.testing.assert_allclose(back[3:5].T, slopes.reshape(-1, 2), atol=0.51 * SLOPE_STEP)
