"""Hulls: closed triangle meshes with their volume, centre and inertia, from primitives or from a mesh file.

A hull is immutable and has no density: that belongs to the body. Its vertices are relative to its centre of mass,
with z up in the pose it is launched in. A round primitive is a polyhedron scaled to the true volume of the shape
(sphere: the whole mesh; cylinder: its cross-section), so that weight and buoyancy of the mesh are those of the
shape; what is asked of the shape itself (`equilibrium_draft`) uses its closed form and `extents`. A sphere of 1280
triangles floats within 1.5e-4 of its radius of where the true one does, in any pose; one of 500 within 4e-4.
"""

import dataclasses
import math
from pathlib import Path

import numpy as np

from sim.floating.polyhedron import open_edges, solid
from sim.validation import argument_error

SMALLEST, LARGEST = 1e-3, 1e4  # [m]
CYLINDER_SIDES = 32  # the second moments of the cross-section are within 2e-5 of the circle's


@dataclasses.dataclass(frozen=True, eq=False)
class Hull:
    """A closed mesh about its centre of mass."""

    kind: str  # box, sphere, cylinder or mesh
    vertices: np.ndarray  # (n, 3) [m]
    faces: np.ndarray  # (m, 3) int, counterclockwise seen from outside
    volume: float  # [m3]
    centre: np.ndarray  # (3,) [m]: where the centre of mass was in the coordinates the hull was given in
    inertia: np.ndarray  # (3, 3) [m5]: about the centre of mass, at unit density
    extents: np.ndarray  # (3, 2) [m]: lowest and highest x, y, z of the true shape

    @staticmethod
    def box(x: float, y: float, z: float) -> "Hull":
        """A box of edges x, y, z [m]. Raises ValueError for what is not 0.001 to 10000 m."""
        edges = np.array([check_length(name, value) for name, value in (("x", x), ("y", y), ("z", z))])
        corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) / 2 * edges
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
        return from_mesh("box", corners, faces, np.stack([-edges / 2, edges / 2], axis=1))

    @staticmethod
    def sphere(radius: float, frequency: int = 8) -> "Hull":
        """A sphere [m] as an icosahedron whose edges are divided by `frequency`: 20 frequency^2 triangles.

        Raises ValueError for a radius that is not 0.001 to 10000 m or a frequency that is not 1 to 64.
        """
        radius = check_length("radius", radius)
        if not isinstance(frequency, int) or not 1 <= frequency <= 64:
            raise argument_error("frequency", frequency, "a whole number from 1 to 64")
        vertices, faces = geodesic(frequency)
        true = 4 / 3 * math.pi
        vertices = vertices * radius * (true / solid(vertices, faces).volume) ** (1 / 3)
        return from_mesh("sphere", vertices, faces, np.array([[-radius, radius]] * 3))

    @staticmethod
    def cylinder(radius: float, height: float) -> "Hull":
        """A cylinder [m] with its axis along z, as a prism. Raises ValueError for what is not 0.001 to 10000 m."""
        radius, height = check_length("radius", radius), check_length("height", height)
        n = CYLINDER_SIDES
        angle = 2 * math.pi / n * np.arange(n)
        r = radius * math.sqrt(2 * math.pi / n / math.sin(2 * math.pi / n))  # n/2 r^2 sin(2 pi/n) = pi radius^2
        ring = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
        low = np.column_stack([ring, np.full(n, -height / 2)])
        high = np.column_stack([ring, np.full(n, height / 2)])
        i, j = np.arange(n), (np.arange(n) + 1) % n
        faces = np.concatenate([
            np.stack([i, j, j + n], axis=1), np.stack([i, j + n, i + n], axis=1),
            np.stack([j, i, np.full(n, 2 * n)], axis=1), np.stack([i + n, j + n, np.full(n, 2 * n + 1)], axis=1),
        ])  # fmt: skip
        vertices = np.concatenate([low, high, [[0, 0, -height / 2], [0, 0, height / 2]]])
        half = np.array([radius, radius, height / 2])
        return from_mesh("cylinder", vertices, faces, np.stack([-half, half], axis=1))

    @staticmethod
    def load(path: str | Path) -> "Hull":
        """A hull from a mesh file (STL, OBJ, PLY, GLB...), all of its parts in one, units read as metres.

        Raises ValueError where the file cannot be read, or its mesh is not closed, oriented and finite.
        """
        import trimesh  # reading meshes is rare and the import is slow

        try:
            loaded = trimesh.load(str(path), force="mesh", process=True)
            vertices = np.asarray(loaded.vertices, dtype=float).reshape(-1, 3)  # type: ignore[union-attr]
            faces = np.asarray(loaded.faces, dtype=np.int64).reshape(-1, 3)  # type: ignore[union-attr]
        except Exception as error:  # the readers of trimesh raise whatever their format leads them to
            raise argument_error("path", str(path), f"a mesh file that can be read ({error})") from error
        return Hull.from_arrays(vertices, faces, name=str(path))

    @staticmethod
    def from_arrays(vertices: np.ndarray, faces: np.ndarray, name: str = "faces") -> "Hull":
        """A hull from vertices (n, 3) [m] and faces (m, 3). A mesh that is inside out everywhere is turned.

        Raises ValueError where the mesh is not closed, oriented and finite.
        """
        vertices, faces = np.array(vertices, dtype=float), np.array(faces, dtype=np.int64)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3 or len(faces) < 4:
            raise argument_error(
                name, f"{vertices.shape} vertices, {faces.shape} faces", "(n, 3), (m, 3), m at least 4"
            )
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise argument_error(name, f"vertex {faces.max()}", f"faces of vertices 0 to {len(vertices) - 1}")
        used, faces = np.unique(faces, return_inverse=True)
        vertices, faces = vertices[used], faces.reshape(-1, 3)
        if not np.isfinite(vertices).all():
            raise argument_error(name, "a coordinate that is not finite", "finite coordinates")
        gaps = open_edges(faces)
        if gaps:
            raise argument_error(
                name, f"{gaps} edges without their one opposite", "a closed mesh, faces turned one way"
            )
        size = np.ptp(vertices, axis=0)
        if not (size >= SMALLEST).all() or not (size <= LARGEST).all():
            raise argument_error(name, tuple(size.tolist()), f"extents of {SMALLEST:g} to {LARGEST:g} m")
        volume = solid(vertices, faces).volume
        if abs(volume) < 1e-9 * size.prod():
            raise argument_error(name, f"volume {volume:g} m3", "a mesh that encloses a volume")
        if volume < 0:
            faces = faces[:, ::-1]
        return from_mesh("mesh", vertices, np.ascontiguousarray(faces))


def from_mesh(kind: str, vertices: np.ndarray, faces: np.ndarray, extents: np.ndarray | None = None) -> Hull:
    """The record of a mesh known to be closed and oriented; extents (3, 2) [m] of the true shape if it is round."""
    volume, centre, inertia = solid(vertices, faces)
    vertices = vertices - centre
    if extents is None:
        extents = np.stack([vertices.min(axis=0), vertices.max(axis=0)], axis=1)
    return Hull(kind, vertices, faces.astype(np.int64), volume, centre, inertia, extents)


def check_length(name: str, value: float) -> float:
    """`value` if it is a length a hull may have. Raises ValueError otherwise."""
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not number or not SMALLEST <= value <= LARGEST:
        raise argument_error(name, value, f"{SMALLEST:g} to {LARGEST:g} m")
    return float(value)


def geodesic(frequency: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (10 f^2 + 2, 3) and faces (20 f^2, 3) of the icosahedron divided by f and blown up to radius 1."""
    golden = (1 + math.sqrt(5)) / 2
    corner = np.array([
        (-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0), (0, -1, golden), (0, 1, golden),
        (0, -1, -golden), (0, 1, -golden), (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1),
    ])  # fmt: skip
    triangles = [
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
        (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
        (8, 6, 7), (9, 8, 1),
    ]  # fmt: skip
    f = frequency
    number: dict[tuple[tuple[int, int], ...], int] = {}  # a point by the corners it lies between and their weights
    points: list[np.ndarray] = []

    def point(weights: tuple[tuple[int, int], ...]) -> int:
        key = tuple(sorted((c, w) for c, w in weights if w))
        if key not in number:
            number[key] = len(points)
            points.append(sum((w * corner[c] for c, w in key), np.zeros(3)))
        return number[key]

    faces = []
    for a, b, c in triangles:
        grid = {(i, j): point(((a, f - i - j), (b, i), (c, j))) for i in range(f + 1) for j in range(f + 1 - i)}
        for i, j in grid:
            if i + j < f:
                faces.append((grid[i, j], grid[i + 1, j], grid[i, j + 1]))
            if i + j < f - 1:
                faces.append((grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]))
    vertices = np.array(points)
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), np.array(faces)
