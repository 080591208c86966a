"""A cylinder with its axis along z, as a prism."""

import math

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh, check_length, closed_mesh
from sim.floating.shapes.record import Appearance, Immersed, Shape

SIDES = 32  # of the prism: the second moments of its cross-section are within 2e-5 of the circle's


def cylinder(radius: float, height: float) -> ClosedMesh:
    """A cylinder [m], as a prism of the same volume. Raises ValueError for lengths outside 0.001 to 10000 m."""
    radius, height = check_length("radius", radius), check_length("height", height)
    n = SIDES
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
    return closed_mesh(vertices, faces, np.stack([-half, half], axis=1))


def immersed(mesh: ClosedMesh, height: float) -> Immersed:
    """The lowest `height` [m] of the cylinder: the integrals of its circle."""
    x = mesh.extents[0, 1] * 2
    area = math.pi * x * x / 4
    return Immersed(area * height, height / 2, area, (area * x * x / 16,) * 2)


SHAPE = Shape(
    "cylinder",
    cylinder,
    lengths=(0.6, 0.7),  # stable upright at any density
    appearances=(
        Appearance("buoy_red", "Red buoy", model="buoy_red"),
        Appearance("buoy_yellow", "Yellow buoy", model="buoy_yellow"),
    ),
    order=1,
    linear="cylinder",
    immersed=immersed,
    collision="cylinder",
)
