"""Slow, obvious references for floating bodies."""

import itertools
import math

import numpy as np


def sliced(vertices: np.ndarray, faces: np.ndarray, depth: np.ndarray) -> tuple[float, np.ndarray, float]:
    """Volume below the surface, its integrals of x and y over that volume, and the waterplane area, by slicing.

    The mesh is sheared so that its surface lies at height 0 (z = -depth, which keeps volumes and x, y), cut by
    horizontal planes into segments, and the area of each slice is the shoelace sum over them. Between the heights
    of vertices area and moments are polynomials of degree 2 and 3 of z, which two Gauss points integrate exactly.
    """
    corners = np.column_stack([vertices[:, :2], -depth])[faces]
    levels = np.unique(np.append(corners[..., 2], 0.0))
    levels = levels[levels <= 0.0]
    volume, moment = 0.0, np.zeros(2)
    for low, high in itertools.pairwise(levels):
        for side in (-1, 1):
            z = (low + high) / 2 + side * (high - low) / 2 / math.sqrt(3)
            area, first = slice_at(corners, z)
            volume += (high - low) / 2 * area
            moment += (high - low) / 2 * first
    below = float(levels[-2]) if len(levels) > 1 else 0.0
    return volume, moment, slice_at(corners, below * 1e-9)[0] if len(levels) > 1 else 0.0


def slice_at(corners: np.ndarray, z: float) -> tuple[float, np.ndarray]:
    """Area and first moments of the slice at height z of triangles (m, 3, 3): sums over its outline."""
    area, first = 0.0, np.zeros(2)
    for triangle in corners[(corners[..., 2].min(axis=1) < z) & (corners[..., 2].max(axis=1) > z)]:
        up = down = np.zeros(2)
        for p, q in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
            if (p[2] < z) != (q[2] < z):
                crossing = p[:2] + (z - p[2]) / (q[2] - p[2]) * (q[:2] - p[:2])
                if p[2] < z:
                    up = crossing
                else:
                    down = crossing
        # faces counterclockwise seen from outside: seen from above, the outline runs from `down` to `up`
        cross = down[0] * up[1] - down[1] * up[0]
        area += cross / 2
        first += cross * (up + down) / 6
    return area, first


def pressure_by_points(
    vertices: np.ndarray, faces: np.ndarray, depth: np.ndarray, parts: int
) -> tuple[np.ndarray, np.ndarray]:
    """Integrals of max(d, 0) n and its moment about the origin: each triangle in parts^2, the middle of each."""
    force, moment = np.zeros(3), np.zeros(3)
    weights = []
    for i in range(parts):
        for j in range(parts - i):
            weights.append(((i + 1 / 3) / parts, (j + 1 / 3) / parts))
            if i + j < parts - 1:
                weights.append(((i + 2 / 3) / parts, (j + 2 / 3) / parts))
    u, v = np.array(weights).T
    share = np.stack([1 - u - v, u, v])
    for face in faces:
        a, b, c = vertices[face]
        area = np.cross(b - a, c - a) / 2 / parts**2
        points = share.T @ vertices[face]
        d = np.maximum(share.T @ depth[face], 0.0)
        force += d.sum() * area
        moment += np.cross(d @ points, area)
    return force, moment


def quaternion(rng: np.random.Generator) -> np.ndarray:
    """A rotation drawn uniformly."""
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)


def lumpy(rng: np.random.Generator, vertices: np.ndarray) -> np.ndarray:
    """Vertices of a mesh moved along their radius at random: closed, star-shaped, not convex."""
    return vertices * rng.uniform(0.6, 1.4, size=(len(vertices), 1))
