"""The drawn mesh of a tile: every stride-th point, with slopes and Jacobian by differences over the whole circle."""

import numpy as np
import pytest

from app.scenes.square_sea.tile_mesh import set_mesh

SIZE, CELL = 16, 2.0


def difference(field: np.ndarray, axis: int) -> np.ndarray:
    """(8 (f1 - f-1) - (f2 - f-2))/12 per cell along an axis of a periodic field, in double."""
    moved = {k: np.roll(field.astype(np.float64), -k, axis) for k in (-2, -1, 1, 2)}
    return (8.0 * (moved[1] - moved[-1]) - (moved[2] - moved[-2])) / (12.0 * CELL)


@pytest.mark.parametrize("stride", [1, 2, 4])
@pytest.mark.parametrize("choppy", [True, False])
def test_the_mesh_is_that_of_differences_in_double(stride: int, choppy: bool) -> None:
    random = np.random.default_rng(2)
    height, dx, dy = random.normal(0.0, 0.8, (3, SIZE, SIZE)).astype(np.float32)
    n, scale, threshold, soft, fade = SIZE // stride, 1.5, 0.9, 0.5, 0.6
    before = random.uniform(0.0, 1.0, (n, n)).astype(np.float32)
    vertices, slopes, foam = np.empty((n, n, 3), np.float32), np.empty((n, n, 2), np.float32), before.copy()
    cover, strain = set_mesh(
        height, dx, dy, choppy, scale, stride, CELL, threshold, soft, fade, vertices, slopes, foam
    )  # fmt: skip

    x, y = np.meshgrid(np.arange(SIZE) * CELL, np.arange(SIZE) * CELL, indexing="ij")
    a, b, d = 1.0, 0.0, 1.0
    if choppy:
        x, y = x + dx, y + dy
        a, b, d = 1.0 + difference(dx, 0), difference(dx, 1), 1.0 + difference(dy, 1)
    J = a * d - b * b + np.zeros((SIZE, SIZE))
    zx, zy = scale * difference(height, 0), scale * difference(height, 1)
    slope = np.stack([d * zx - b * zy, a * zy - b * zx], axis=-1) / np.maximum(J, 0.15)[..., None]
    slope /= np.maximum(np.linalg.norm(slope, axis=-1, keepdims=True) / 1.5, 1.0)
    white = np.clip((threshold - J) / soft, 0.0, 1.0)[::stride, ::stride]
    expected = np.maximum(before * fade, white)

    np.testing.assert_allclose(vertices, np.stack([x, y, scale * height], axis=-1)[::stride, ::stride], atol=1e-5)
    np.testing.assert_allclose(slopes, slope[::stride, ::stride], atol=2e-5)
    np.testing.assert_allclose(foam, expected, atol=1e-5)
    assert cover == pytest.approx(float(expected.mean()), rel=1e-5)
    assert strain == pytest.approx(float(np.sqrt(np.square(J[::stride, ::stride] - 1.0).mean())), rel=1e-5, abs=1e-7)
