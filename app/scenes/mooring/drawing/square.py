"""Squares of points: their places and their triangles."""

import numpy as np
from numpy.typing import NDArray


def square_points(rows: int) -> NDArray[np.float64]:
    """Points (rows rows, 2) of the square from -1 to 1."""
    axis = np.linspace(-1.0, 1.0, rows)
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


def square_faces(rows: int) -> NDArray[np.int64]:
    """Triangles (m, 3) of a square of rows by rows points."""
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(rows - 1), indexing="ij")
    a = (i * rows + j).ravel()
    return np.concatenate([np.stack([a, a + rows, a + 1], 1), np.stack([a + 1, a + rows, a + rows + 1], 1)])
