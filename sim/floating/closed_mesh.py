"""Closed triangle meshes: their volume, centre of mass and inertia as exact integrals, and the checks of a mesh.

A closed mesh is the sum of the signed tetrahedra that its triangles span with any one point. A polynomial is
integrated exactly over each of them (Tonon 2005, J. Math. Stat. 1:8, eq. 1 and 2).
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from sim.validation import argument_error, check_within

MIN_LENGTH, MAX_LENGTH = 1e-3, 1e4  # [m] of an edge, a radius or an extent


@dataclasses.dataclass(frozen=True, eq=False)
class ClosedMesh:
    """A closed mesh about its own centre of mass, z up. It stands for a shape that may be round: see `extents`."""

    vertices: np.ndarray  # (n, 3) [m] relative to the centre of mass
    faces: np.ndarray  # (m, 3) int, counterclockwise seen from outside
    volume: float  # [m3]
    centre: np.ndarray  # (3,) [m]: centre of mass in the coordinates that the mesh was given in
    inertia: np.ndarray  # (3, 3) [m5] about the centre of mass, at unit density
    extents: np.ndarray  # (3, 2) [m]: lowest and highest x, y, z of the shape that the mesh stands for

    @property
    def size(self) -> np.ndarray:
        """Extent (3,) [m] of the shape along x, y, z."""
        return self.extents[:, 1] - self.extents[:, 0]


class Solid(NamedTuple):
    """What a closed mesh encloses, at unit density."""

    volume: float  # [m3]
    centre: np.ndarray  # (3,) [m]
    inertia: np.ndarray  # (3, 3) [m5] about the centre


def closed_mesh(vertices: np.ndarray, faces: np.ndarray, extents: np.ndarray | None = None) -> ClosedMesh:
    """The record of vertices (n, 3) [m] and faces (m, 3) that are known to be closed and oriented outward.

    extents (3, 2) [m]: those of the true shape where it is round; None for those of the mesh.
    """
    volume, centre, inertia = solid(vertices, faces)
    vertices = vertices - centre
    if extents is None:
        extents = np.stack([vertices.min(axis=0), vertices.max(axis=0)], axis=1)
    return ClosedMesh(vertices, faces.astype(np.int64), volume, centre, inertia, extents)


def checked_mesh(vertices: np.ndarray, faces: np.ndarray, name: str = "faces") -> ClosedMesh:
    """The record of vertices (n, 3) [m] and faces (m, 3) from outside. A mesh with all faces inward is turned.

    Raises ValueError, which begins with `name`, where the mesh is not closed, oriented and finite.
    """
    vertices, faces = np.array(vertices, dtype=float), np.array(faces, dtype=np.int64)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3 or len(faces) < 4:
        raise argument_error(name, f"{vertices.shape} vertices, {faces.shape} faces", "(n, 3), (m, 3), m at least 4")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise argument_error(name, f"vertex {faces.max()}", f"faces of vertices 0 to {len(vertices) - 1}")
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], faces.reshape(-1, 3)
    if not np.isfinite(vertices).all():
        raise argument_error(name, "a coordinate that is not finite", "finite coordinates")
    gaps = open_edges(faces)
    if gaps:
        raise argument_error(name, f"{gaps} edges without their one opposite", "a closed mesh, faces turned one way")
    size = np.ptp(vertices, axis=0)
    if not (size >= MIN_LENGTH).all() or not (size <= MAX_LENGTH).all():
        raise argument_error(name, tuple(size.tolist()), f"extents of {MIN_LENGTH:g} to {MAX_LENGTH:g} m")
    volume = solid(vertices, faces).volume
    if abs(volume) < 1e-9 * size.prod():
        raise argument_error(name, f"volume {volume:g} m3", "a mesh that encloses a volume")
    if volume < 0:
        faces = faces[:, ::-1]
    return closed_mesh(vertices, np.ascontiguousarray(faces))


def check_length(name: str, value: float) -> float:
    """`value` if it is a length that a hull may have. Raises ValueError otherwise."""
    return check_within(name, value, MIN_LENGTH, MAX_LENGTH, "m")


def open_edges(faces: np.ndarray) -> int:
    """How many of the directed edges of faces (m, 3) lack their one opposite: 0 for a closed, oriented mesh."""
    if not len(faces):
        return 0
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    width = int(faces.max()) + 1
    forward, count = np.unique(edges[:, 0] * width + edges[:, 1], return_counts=True)
    backward = np.unique(edges[:, 1] * width + edges[:, 0])
    single = forward[count == 1]
    return len(forward) - int(np.isin(single, backward, assume_unique=True).sum())


def solid(vertices: np.ndarray, faces: np.ndarray) -> Solid:
    """Volume, centre and inertia of the closed mesh of vertices (n, 3) [m] and outward faces (m, 3)."""
    origin = vertices.mean(axis=0)
    a, b, c = (vertices[faces[:, i]] - origin for i in range(3))
    # det = 6 V of the tetrahedron (0, a, b, c); its integral of x is det/24 (a + b + c), of x x^T
    # det/120 (a a^T + b b^T + c c^T + s s^T) with s = a + b + c
    det = np.einsum("ij,ij->i", a, np.cross(b, c))
    s = a + b + c
    volume = det.sum() / 6
    centre = (det @ s) / 24 / volume
    second = sum(np.einsum("i,ij,ik->jk", det, p, p) for p in (a, b, c, s)) / 120
    second = second - volume * np.outer(centre, centre)
    return Solid(float(volume), origin + centre, np.trace(second) * np.eye(3) - second)


def area_vectors(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Outward normal times area of each triangle, (m, 3) [m2], of vertices (n, 3) [m] and faces (m, 3)."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2
