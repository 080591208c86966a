"""Quaternions (w, x, y, z) from body to world axes, as matrices."""

import numpy as np


def rotation_matrix(rotation: np.ndarray) -> np.ndarray:
    """Matrix (3, 3) from body to world axes of a quaternion (w, x, y, z), normalised first."""
    w, x, y, z = np.asarray(rotation, dtype=float) / np.linalg.norm(rotation)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def body_z_axes(rotations: np.ndarray) -> np.ndarray:
    """The z axes of many bodies in the world, (n, 3), of unit quaternions (n, 4): the last column of each matrix."""
    w, x, y, z = rotations.T
    return np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)], axis=1)
