"""Closed triangle meshes: their volume, centre of mass and inertia as exact integrals, and the checks of a mesh.

A closed mesh is the sum of the signed tetrahedra that its triangles span with any one point. A polynomial is
integrated exactly over each of them (Tonon 2005, J. Math. Stat. 1:8, eq. 1 and 2).
"""

import dataclasses
from typing import NamedTuple

import numpy as np

from sim.validation import argument_error, as_array, check_kind, check_number

MAX_SAMPLES = 400  # places on a mesh of several parts where it is checked that they do not overlap
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
    """Mass properties of the solid inside a closed mesh, at unit density."""

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
    allowed = "vertices (n, 3) [m], faces (m, 3) of whole numbers, m at least 4"
    vertices, corners = as_array(name, vertices, allowed), as_array(name, faces, allowed)
    if not (corners == np.rint(corners)).all():
        raise argument_error(name, float(corners[corners != np.rint(corners)][0]), allowed)
    faces = corners.astype(np.int64)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3 or len(faces) < 4:
        raise argument_error(name, f"{vertices.shape} vertices, {faces.shape} faces", "(n, 3), (m, 3), m at least 4")
    if faces.min() < 0 or faces.max() >= len(vertices):
        wrong = faces.min() if faces.min() < 0 else faces.max()
        raise argument_error(name, f"vertex {wrong}", f"faces of vertices 0 to {len(vertices) - 1}")
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], faces.reshape(-1, 3)
    if not np.isfinite(vertices).all():
        raise argument_error(name, "a coordinate that is not finite", "finite coordinates")
    gaps = open_edges(faces)
    if gaps:
        raise argument_error(
            name, f"{gaps} edges without exactly one opposite", "a closed mesh, all faces turned outward or all inward"
        )
    size = np.ptp(vertices, axis=0)
    if not (size >= MIN_LENGTH).all() or not (size <= MAX_LENGTH).all():
        raise argument_error(name, tuple(size.tolist()), f"extents of {MIN_LENGTH:g} to {MAX_LENGTH:g} m")
    volume = enclosed_volume(vertices - vertices.mean(axis=0), faces)
    if abs(volume) < 1e-9 * size.prod():
        raise argument_error(name, f"volume {volume:g} m3", "a mesh that encloses a volume")
    if volume < 0:
        faces = faces[:, ::-1]
    faces = np.ascontiguousarray(faces)
    check_parts(vertices, faces, name)
    return closed_mesh(vertices, faces)


def check_hull(name: str, hull: object) -> None:
    """Raises ValueError if `hull` is no hull."""
    check_kind(name, hull, ClosedMesh, "a Hull")


def check_parts(vertices: np.ndarray, faces: np.ndarray, name: str) -> None:
    """Raises ValueError if a part of a mesh is inside out or overlaps another one, which would count twice.

    Close to each face inside it the mesh encloses a point once, outside not at all, or once where another part
    touches. Looked at are up to MAX_SAMPLES places on the faces of a mesh of several parts, except faces without area,
    which have no two sides.
    """
    part = parts_of(faces, len(vertices))
    if len(np.unique(part)) < 2:
        return
    triangles = vertices[faces]
    centre = triangles.mean(axis=1)
    places = np.concatenate([centre, *(0.05 * centre + 0.95 * triangles[:, i] for i in range(3))])
    normal, size = np.tile(area_vectors(vertices, faces), (4, 1)), np.ptp(vertices, axis=0).max()
    area = np.linalg.norm(normal, axis=1)
    sided = np.flatnonzero(area > 1e-12 * size**2)
    chosen = sided[np.unique(np.linspace(0, len(sided) - 1, MAX_SAMPLES).astype(int))]
    steps = 1e-6 * size * normal[chosen] / area[chosen, None]
    for place, step in zip(places[chosen], steps, strict=True):
        inside, outside = enclosed(triangles, place - step), enclosed(triangles, place + step)
        if inside != 1 or outside not in (0, 1):
            where = tuple(round(float(x), 6) for x in place)
            raise argument_error(
                name, f"parts that overlap, or one inside out, at {where}", "separate parts, all turned outward"
            )


def parts_of(faces: np.ndarray, count: int) -> np.ndarray:
    """For each of `count` vertices the least vertex that faces (m, 3) join it with."""
    label = np.arange(count)
    while True:
        least = label[faces].min(axis=1)
        new = label.copy()
        for corner in range(3):
            np.minimum.at(new, faces[:, corner], least)
        new = new[new]
        if (new == label).all():
            return label
        label = new


def enclosed(triangles: np.ndarray, point: np.ndarray) -> int:
    """Number of times that triangles (m, 3, 3), outward, enclose a point: the sum of their solid angles over 4 pi.

    Van Oosterom and Strackee 1983, IEEE Trans. Biomed. Eng. 30:125, eq. 8.
    """
    a, b, c = (triangles[:, i] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    det = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = [np.einsum("ij,ij->i", x, y) * length for x, y, length in ((a, b, lc), (b, c, la), (c, a, lb))]
    return round(float(2 * np.arctan2(det, la * lb * lc + sum(dots)).sum()) / (4 * np.pi))


def check_length(name: str, value: float) -> float:
    """`value` if it is a length that a hull may have. Raises ValueError otherwise."""
    return check_number(name, value, "m", MIN_LENGTH, MAX_LENGTH)


def open_edges(faces: np.ndarray) -> int:
    """Number of directed edges of faces (m, 3) without exactly one opposite: 0 for a closed, oriented mesh."""
    if not len(faces):
        return 0
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    width = int(faces.max()) + 1
    forward, count = np.unique(edges[:, 0] * width + edges[:, 1], return_counts=True)
    backward = np.unique(edges[:, 1] * width + edges[:, 0])
    single = forward[count == 1]
    return len(forward) - int(np.isin(single, backward, assume_unique=True).sum())


def enclosed_volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Volume [m3] of the closed mesh of vertices (n, 3) [m] and faces (m, 3); negative where they face inward."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


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
