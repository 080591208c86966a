"""A box."""

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh, check_length, closed_mesh
from sim.floating.shapes.record import Appearance, Immersed, Shape


def box(x: float, y: float, z: float) -> ClosedMesh:
    """A box of edges x, y, z [m]. Raises ValueError for an edge that is not 0.001 to 10000 m."""
    edges = np.array([check_length(name, value) for name, value in (("x", x), ("y", y), ("z", z))])
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) / 2 * edges
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return closed_mesh(corners, faces, np.stack([-edges / 2, edges / 2], axis=1))


def immersed(mesh: ClosedMesh, height: float) -> Immersed:
    """The lowest `height` [m] of the box: the integrals of its rectangle."""
    x, y = mesh.extents[0, 1] * 2, mesh.extents[1, 1] * 2
    return Immersed(x * y * height, height / 2, x * y, (x**3 * y / 12, x * y**3 / 12))


SHAPE = Shape(
    "box",
    box,
    lengths=(1.2, 1.2, 0.7),  # stable upright at any density
    appearances=(Appearance("crate", "Box", model="crate"),),
    order=2,
    linear="box",
    immersed=immersed,
    collision="box",
)
