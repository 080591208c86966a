"""A cone that stands on its base."""

import math

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh, check_length, closed_mesh
from sim.floating.shapes.record import Shape

SIDES = 24


def cone(radius: float, height: float) -> ClosedMesh:
    """A cone [m], as a pyramid of SIDES sides. Raises ValueError for a length that is not allowed."""
    radius, height = check_length("radius", radius), check_length("height", height)
    angle = 2 * math.pi / SIDES * np.arange(SIDES)
    ring = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(SIDES)])
    vertices = np.concatenate([ring, [[0, 0, 0], [0, 0, height]]])
    i, j = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
    centre, tip = np.full(SIDES, SIDES), np.full(SIDES, SIDES + 1)
    faces = np.concatenate([np.stack([j, i, centre], axis=1), np.stack([i, j, tip], axis=1)])
    return closed_mesh(vertices, faces)


SHAPE = Shape("cone", cone, lengths=(0.6, 0.7))
