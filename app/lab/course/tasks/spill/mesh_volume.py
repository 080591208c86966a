"""The reference solution and the check of a task."""

import numpy as np

from app.lab.checking import Mistake, require


def mesh_volume(vertices, faces):
    """The volume [m3] that a closed mesh of triangles encloses.

    V = sum over the triangles of a . (b x c)/6, a, b, c their corners, counterclockwise seen from outside.

    vertices: positions [m], shape (n, 3). faces: the numbers of the three corners of each triangle, shape (m, 3).
    """
    a, b, c = np.moveaxis(np.asarray(vertices)[np.asarray(faces)], 1, 0)
    return (a * np.cross(b, c)).sum() / 6


def inputs(rng):
    """A crooked box or a pyramid on a square, away from the origin."""
    if rng.random() < 0.4:
        corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.3, 0.6, 1)], dtype=float)
        corners += 0.1 * rng.uniform(-1.0, 1.0, corners.shape)
        faces = [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
        return corners * rng.uniform(0.5, 2.0) + rng.uniform(1.0, 3.0, 3), np.array(faces)
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
             (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    shape = np.eye(3) * rng.uniform(0.5, 2.0, 3) + 0.2 * rng.uniform(-1.0, 1.0, (3, 3))
    return corners @ shape.T + rng.uniform(1.0, 3.0, 3), np.array(faces)


def tetrahedron(away):
    """The corner of a cube of 1 m, `away` [m] from the origin."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return corners + np.array([away, 0.0, 0.0]), np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


EXAMPLES = (tetrahedron(0.0), tetrahedron(100.0))


def triple(vertices, faces):
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return (a * np.cross(b, c)).sum(axis=1)


def area(vertices, faces):
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


MISTAKES = (
    Mistake(
        "products of coordinates",
        "This adds x y z of each point. Go through the faces, with the corners vertices[face[0]] and so on.",
        lambda v, f: v.prod(axis=1).sum() / 6,
    ),
    Mistake(
        "product by components",
        "a * b * c multiplies component by component. a . (b x c) is np.dot(a, np.cross(b, c)).",
        lambda v, f: v[f].prod(axis=1).sum() / 6,
    ),
    Mistake("factor 1/6 wrong", "A tetrahedron has a sixth of the box: divide by 6.", lambda v, f: triple(v, f).sum()),
    Mistake(
        "factor 1/6 wrong", "A tetrahedron has a sixth of the box, not a third.", lambda v, f: triple(v, f).sum() / 3
    ),
    Mistake(
        "factor 1/6 wrong", "A tetrahedron has a sixth of the box, not a half.", lambda v, f: triple(v, f).sum() / 2
    ),
    Mistake(
        "absolute values added",
        "Triangles that face the origin count negatively: add with signs.",
        lambda v, f: np.abs(triple(v, f)).sum() / 6,
    ),
    Mistake(
        "sign reversed",
        "The volume is negative: the order of the corners is reversed.",
        lambda v, f: -triple(v, f).sum() / 6,
    ),
    Mistake(
        "corners counted from 1",
        "The numbers of the corners are taken as if they were counted from 1. In Python the first vertex has number 0.",
        lambda v, f: triple(v, f - 1).sum() / 6,
    ),
    Mistake("area instead of volume", "This is the area of the surface.", area),
    Mistake("bounding box", "This is the volume of the box around the mesh.", lambda v, f: np.ptp(v, axis=0).prod()),
)


def behaviour(student):
    """A tetrahedron, and the same one elsewhere."""
    x = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    for shift in (0.0, 5.0):
        require(
            abs(student(x + shift, faces) - 1 / 6) < 1e-3,
            "a corner tetrahedron of 1 m must have 1/6 m3, wherever it is",
        )
