"""Vectors (x, y, z) and unit quaternions (w, x, y, z) from body to world axes, as tuples that kernels inline.

The axes of a body are three vectors in the world: the columns of the matrix that takes body axes to world axes.
"""

import math
from typing import Any

import numpy as np

from sim.jit import kernel

STEEP = 0.25  # square of a level length: of an axis within 30 degrees of the vertical


def axes_by_quaternion(q: Any) -> Any:
    """The axes of a body by its unit quaternion (w, x, y, z), four numbers or four arrays of one shape."""
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def heading_by_axes(axes: Any) -> Any:
    """Cosine and sine of the heading of a body with these axes, whichever side of it is up.

    It is that of the body's x axis, seen from above. If that is within 30 degrees of the vertical, its y axis is
    a quarter turn to the left of the heading.
    """
    cosine, sine = axes[0][0], axes[0][1]
    if cosine * cosine + sine * sine < STEEP:
        cosine, sine = axes[1][1], -axes[1][0]
    size = math.sqrt(cosine * cosine + sine * sine)
    return cosine / size, sine / size


def product(a: Any, b: Any) -> Any:
    """The quaternion of the rotation b followed by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def quaternion_by_vector(u: Any) -> Any:
    """The quaternion of a rotation vector (x, y, z) [rad]: its direction is the axis, its length the angle."""
    half = 0.5 * math.sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2])
    ratio = math.sin(half) / (2.0 * half) if half > 0.0 else 0.5
    return math.cos(half), ratio * u[0], ratio * u[1], ratio * u[2]


# The same functions for kernels.
axes_of, heading_of, quaternion_of, product_of = (
    kernel(inline=True)(one) for one in (axes_by_quaternion, heading_by_axes, quaternion_by_vector, product)
)


def rotation_matrix(rotation: np.ndarray) -> np.ndarray:
    """Matrix (3, 3) from body to world axes of a quaternion (w, x, y, z), normalised first."""
    return np.array(axes_by_quaternion(np.asarray(rotation, dtype=float) / np.linalg.norm(rotation))).T


def body_z_axes(rotations: np.ndarray) -> np.ndarray:
    """The z axes of many bodies in the world, (n, 3), of unit quaternions (n, 4)."""
    return np.stack(axes_by_quaternion(rotations.T)[2], axis=1)


def heading_angle(rotation: np.ndarray) -> float:
    """Heading [rad] of a body with a quaternion (w, x, y, z), normalised first: see `heading_by_axes`."""
    cosine, sine = heading_by_axes(rotation_matrix(rotation).T)
    return math.atan2(sine, cosine)


@kernel(inline=True)
def three(array, i):
    """Row i of (n, 3)."""
    return array[i, 0], array[i, 1], array[i, 2]


@kernel(inline=True)
def four(array, i):
    """Row i of (n, 4)."""
    return array[i, 0], array[i, 1], array[i, 2], array[i, 3]


@kernel(inline=True)
def set_three(array, i, u):
    """Set row i of (n, 3)."""
    array[i, 0], array[i, 1], array[i, 2] = u


@kernel(inline=True)
def columns(array, i):
    """The columns of matrix i of (n, 3, 3)."""
    return (
        (array[i, 0, 0], array[i, 1, 0], array[i, 2, 0]),
        (array[i, 0, 1], array[i, 1, 1], array[i, 2, 1]),
        (array[i, 0, 2], array[i, 1, 2], array[i, 2, 2]),
    )


@kernel(inline=True)
def scaled(a, u):
    """a u."""
    return a * u[0], a * u[1], a * u[2]


@kernel(inline=True)
def plus(u, a, v):
    """u + a v."""
    return u[0] + a * v[0], u[1] + a * v[1], u[2] + a * v[2]


@kernel(inline=True)
def squares(u):
    """The squares of its three numbers."""
    return u[0] * u[0], u[1] * u[1], u[2] * u[2]


@kernel(inline=True)
def dot(u, v):
    """Inner product."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@kernel(inline=True)
def cross(u, v):
    """Vector product."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@kernel(inline=True)
def turn(axes, v):
    """v from the axes' coordinates to those in which the axes are: the matrix of these columns times v."""
    return plus(plus(scaled(v[0], axes[0]), v[1], axes[1]), v[2], axes[2])


@kernel(inline=True)
def turn_back(axes, v):
    """v in coordinates along the axes: the transposed matrix times v."""
    return dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)


@kernel(inline=True)
def turn_matrix(axes, m):
    """R M R^T, with R of these columns and M a matrix by its columns."""
    a, b, c = axes
    by_columns = turn(axes, m[0]), turn(axes, m[1]), turn(axes, m[2])
    return (
        turn(by_columns, (a[0], b[0], c[0])),
        turn(by_columns, (a[1], b[1], c[1])),
        turn(by_columns, (a[2], b[2], c[2])),
    )


@kernel(inline=True)
def solve_three(m, v):
    """The solution u of M u = v, with M a matrix by its columns, by cofactors."""
    rows = cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])
    return scaled(1.0 / dot(m[0], rows[0]), turn_back(rows, v))


@kernel(inline=True)
def to_heading(heading, v):
    """A vector in the world in the axes of a heading (cosine, sine): x and y level, turned about z, which is up."""
    c, s = heading
    return c * v[0] + s * v[1], c * v[1] - s * v[0], v[2]


@kernel(inline=True)
def from_heading(heading, v):
    """A vector in the axes of a heading in those of the world."""
    c, s = heading
    return c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]


@kernel(inline=True)
def rotated(q, spin, h):
    """The quaternion q after a rotation by spin [rad/s] for h [s]: exp(h spin/2) q."""
    w, x, y, z = product_of(quaternion_of(scaled(h, spin)), q)
    size = math.sqrt(w * w + x * x + y * y + z * z)
    return w / size, x / size, y / size, z / size
