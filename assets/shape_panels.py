"""Wet surfaces of the shipped shapes as panels for boundary elements, closer together towards edges.

In units of half the root of length times width of a box, and of the radius of the others. Vertices (v, 3) with z = 0 at
the waterline, quadrilaterals (f, 4).
"""

import math

import numpy as np

from sim.floating.hulls.hull import Hull
from sim.floating.linear.hydrodynamics import table_length


def clustered(n: int) -> np.ndarray:
    """n + 1 numbers from 0 to 1, closer together towards 1, where a hull has its edge."""
    u = np.linspace(0.0, 1.0, n + 1)
    return 0.5 * u + 0.5 * np.sin(math.pi / 2 * u)


def symmetric(n: int) -> np.ndarray:
    """2 n + 1 numbers from -1 to 1, closer together at both ends."""
    half = clustered(n)
    return np.concatenate([-half[:0:-1], half])


def mesh_of(patches: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and quadrilaterals of patches (rows, columns, 3), each with rows cross columns pointing outward."""
    vertices, faces, start = [], [], 0
    for patch in patches:
        rows, columns = patch.shape[:2]
        i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
        a = (start + i * columns + j).ravel()
        faces.append(np.stack([a, a + columns, a + columns + 1, a + 1], axis=1))
        vertices.append(patch.reshape(-1, 3))
        start += rows * columns
    return np.concatenate(vertices), np.concatenate(faces)


def panels(size: float, least: int, most: int) -> int:
    """Panels along half an edge of this size, about one for each 0.12."""
    return int(min(max(round(size / 0.12), least), most))


def box(aspect: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of a box."""
    x, y = math.sqrt(aspect), 1 / math.sqrt(aspect)
    xs, ys = x * symmetric(panels(x, 7, 13)), y * symmetric(panels(y, 5, 8))
    zs = -draft * clustered(panels(draft, 3, 11))

    def side(points: np.ndarray, place) -> np.ndarray:
        return np.array([[place(p, z) for z in zs] for p in points])

    bottom = np.array([[(a, b, -draft) for a in xs] for b in ys])
    return mesh_of([
        bottom,
        side(ys, lambda p, z: (x, p, z))[::-1],
        side(ys, lambda p, z: (-x, p, z)),
        side(xs, lambda p, z: (p, y, z)),
        side(xs, lambda p, z: (p, -y, z))[::-1],
    ])  # fmt: skip


def turned(radius: np.ndarray, z: np.ndarray, spokes: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """The surface of a curve (radius, z), from the waterline down to the axis, turned about z."""
    angle = 2 * math.pi / spokes * np.arange(spokes + 1)
    radius = radius * math.sqrt(2 * math.pi / spokes / math.sin(2 * math.pi / spokes))  # keeps the area of the cuts
    patch = np.stack([np.outer(np.cos(angle), radius), np.outer(np.sin(angle), radius), np.tile(z, (spokes + 1, 1))], 2)
    return mesh_of([patch[::-1]])


def cylinder(_: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of an upright cylinder of radius 1."""
    wall = -draft * clustered(panels(draft, 3, 11))
    floor = clustered(9)[::-1][1:]
    return turned(np.concatenate([np.ones(len(wall)), floor]), np.concatenate([wall, np.full(len(floor), -draft)]))


def sphere(_: float, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of a sphere of radius 1."""
    waterline = math.acos(draft - 1.0)  # its angle from the top of the sphere
    polar = waterline + (math.pi - waterline) * np.linspace(0.0, 1.0, 19)
    return turned(np.sin(polar), np.cos(polar) + 1.0 - draft)


PANELS = {"box": box, "cylinder": cylinder, "sphere": sphere}  # of sides (a box) and a draft


def panels_of_shape(hull: Hull, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """The wet surface of a shipped shape at a draft [m]: the panels of its committed table."""
    return PANELS[hull.shape.linear](float(hull.size[0] / hull.size[1]), draft / table_length(hull))
