"""A sphere as a subdivided icosahedron of the sphere's volume.

A mesh of 1280 triangles floats within 1.5e-4 of its radius of where the true sphere does, in any pose; one of 500
within 4e-4.
"""

import math

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh, check_length, closed_mesh, solid
from sim.floating.shapes.record import Appearance, Immersed, Shape
from sim.validation import argument_error, is_whole_number

BODY_FREQUENCY = 5  # of a scene's bodies: 500 triangles


def sphere(radius: float, frequency: int = 8) -> ClosedMesh:
    """A sphere [m] as an icosahedron with edges divided by `frequency`: 20 frequency^2 triangles.

    Raises ValueError for a radius that is not 0.001 to 10000 m or a frequency that is not 1 to 64.
    """
    radius = check_length("radius", radius)
    if not is_whole_number(frequency) or not 1 <= frequency <= 64:
        raise argument_error("frequency", frequency, "a whole number from 1 to 64")
    vertices, faces = geodesic(int(frequency))
    true = 4 / 3 * math.pi
    vertices = vertices * radius * (true / solid(vertices, faces).volume) ** (1 / 3)
    return closed_mesh(vertices, faces, np.array([[-radius, radius]] * 3))


def immersed(mesh: ClosedMesh, height: float) -> Immersed:
    """The lowest `height` [m] of the sphere: a cap.

    V = pi h^2 (3r - h)/3; its centroid is 3 (2r - h)^2/(4 (3r - h)) from the centre of the sphere.
    """
    h, r = height, mesh.extents[0, 1]
    area = math.pi * h * (2 * r - h)
    centroid = r - 3 * (2 * r - h) ** 2 / (4 * (3 * r - h))
    return Immersed(math.pi * h * h * (3 * r - h) / 3, centroid, area, (area * area / (4 * math.pi),) * 2)


def geodesic(frequency: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (10 f^2 + 2, 3) and faces (20 f^2, 3) of the icosahedron divided by f and projected to radius 1."""
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
    number: dict[tuple[tuple[int, int], ...], int] = {}  # of a point, by the corners it lies between and their weights
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


SHAPE = Shape(
    "sphere",
    lambda radius: sphere(radius, BODY_FREQUENCY),
    lengths=(0.5,),
    appearances=(Appearance("ball", "Ball", model="ball"),),
    order=3,
    linear="sphere",
    immersed=immersed,
    is_round=True,
)
