"""The wet surface of a hull as panels for boundary elements: its triangles cut at the waterline, then bisected."""

import math

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh
from sim.validation import argument_error

WANTED_PANELS = 450  # a wet surface is divided into about as many; a solution takes 1 to 3 s a frequency
MAX_PANELS = 3000  # of the mesh itself; a solution then takes minutes per frequency
MIN_SHARE = 1e-9  # of the wet area, below which a cut triangle is left out


def wet_panels(mesh: ClosedMesh, draft: float, wanted: int = WANTED_PANELS) -> np.ndarray:
    """Triangles (t, 3, 3) [m] of the wet surface at a draft, the waterline at z = 0 over the centre of mass.

    Each edge is about equally long; neighbours need not share whole edges. Raises ValueError for a mesh with more than
    MAX_PANELS wet triangles.
    """
    corners = mesh.vertices[mesh.faces] - [0.0, 0.0, mesh.extents[2, 0] + draft]
    wet = below_surface(corners)
    if len(wet) > MAX_PANELS:
        raise argument_error("hull", f"{len(wet)} wet triangles", f"at most {MAX_PANELS}: simplify the mesh")
    edge = math.sqrt(2.0 * float(areas_of(wet).sum()) / wanted)
    while len(divided := bisected(wet, edge)) > max(1.3 * wanted, len(wet)):
        edge *= 1.08
    return divided


def areas_of(triangles: np.ndarray) -> np.ndarray:
    """Areas (t,) of triangles (t, 3, 3)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def below_surface(triangles: np.ndarray) -> np.ndarray:
    """The parts of triangles (t, 3, 3) below z = 0, as triangles turned the same way."""
    parts = [triangles[(triangles[:, :, 2] <= 0.0).all(axis=1)]]
    for triangle in triangles[(triangles[:, :, 2] > 0.0).any(axis=1) & (triangles[:, :, 2] < 0.0).any(axis=1)]:
        polygon = []
        for p, q in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            if p[2] <= 0.0:
                polygon.append(p)
            if (p[2] > 0.0) != (q[2] > 0.0):
                point = p + p[2] / (p[2] - q[2]) * (q - p)
                point[2] = 0.0
                polygon.append(point)
        parts.append(np.array([[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)]))
    wet = np.concatenate([part.reshape(-1, 3, 3) for part in parts])
    area = areas_of(wet)
    dry_deck = (wet[:, :, 2] >= 0.0).all(axis=1)
    return wet[(area > MIN_SHARE * area.sum()) & ~dry_deck]


def bisected(triangles: np.ndarray, edge: float) -> np.ndarray:
    """Triangles (t, 3, 3) halved at the middle of the longest edge until none is longer than `edge`."""
    done = []
    while len(triangles):
        lengths = np.linalg.norm(np.roll(triangles, -1, axis=1) - triangles, axis=2)
        longest, which = lengths.max(axis=1), lengths.argmax(axis=1)
        done.append(triangles[longest <= edge])
        parts, first = triangles[longest > edge], which[longest > edge]
        row = np.arange(len(parts))
        a, b, c = parts[row, first], parts[row, (first + 1) % 3], parts[row, (first + 2) % 3]
        middle = 0.5 * (a + b)
        triangles = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)
