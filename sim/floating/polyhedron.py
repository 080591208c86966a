"""Exact integrals over closed triangle meshes: volume, centre, second moments; and the test that a mesh is closed.

A closed mesh is the sum of the signed tetrahedra its triangles span with any one point, and a polynomial
integrates exactly over each of them (Tonon 2005, J. Math. Stat. 1:8, eq. 1 and 2).
"""

from typing import NamedTuple

import numpy as np


class Solid(NamedTuple):
    """What a closed mesh encloses, at unit density."""

    volume: float  # [m3]
    centre: np.ndarray  # (3,) [m]
    inertia: np.ndarray  # (3, 3) [m5] about the centre


def open_edges(faces: np.ndarray) -> int:
    """How many of the directed edges of faces (m, 3) lack their one opposite: 0 for a closed, oriented mesh."""
    if not len(faces):
        return 0
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    width = int(faces.max()) + 1
    forth, count = np.unique(edges[:, 0] * width + edges[:, 1], return_counts=True)
    back = np.unique(edges[:, 1] * width + edges[:, 0])
    single = forth[count == 1]
    return len(forth) - int(np.isin(single, back, assume_unique=True).sum())


def solid(vertices: np.ndarray, faces: np.ndarray) -> Solid:
    """Volume, centre and inertia of the closed mesh of vertices (n, 3) [m] and outward faces (m, 3)."""
    foot = vertices.mean(axis=0)
    a, b, c = (vertices[faces[:, i]] - foot for i in range(3))
    # det = 6 V of the tetrahedron (0, a, b, c); its integral of x is det/24 (a + b + c), of x x^T
    # det/120 (a a^T + b b^T + c c^T + s s^T) with s = a + b + c
    det = np.einsum("ij,ij->i", a, np.cross(b, c))
    s = a + b + c
    volume = det.sum() / 6
    centre = (det @ s) / 24 / volume
    second = sum(np.einsum("i,ij,ik->jk", det, p, p) for p in (a, b, c, s)) / 120
    second = second - volume * np.outer(centre, centre)
    return Solid(float(volume), foot + centre, np.trace(second) * np.eye(3) - second)


def area_vectors(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Outward normal times area of each triangle, (m, 3) [m2]."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2
