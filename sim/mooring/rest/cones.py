"""Second-order cones for interior-point methods: rows u = (u0, u1) of four numbers with u0 >= |u1|.

Source: L. Vandenberghe, "The CVXOPT linear and quadratic cone program solvers" (2010), sections 4 and 5.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNIT, MIRROR = np.array([1.0, 0.0, 0.0, 0.0]), np.array([1.0, -1.0, -1.0, -1.0])


def dot(u: Array, v: Array) -> Array:
    """Inner products (n,) of rows."""
    return np.einsum("ij,ij->i", u, v)


def determinant(u: Array) -> Array:
    """u0^2 - |u1|^2 (n,) of rows (n, 4), above 0 inside the cone."""
    size = np.sqrt(dot(u[:, 1:], u[:, 1:]))
    return (u[:, 0] - size) * (u[:, 0] + size)


def product(u: Array, v: Array) -> Array:
    """Product (n, 4) of the cones' algebra: (u . v, u0 v1 + v0 u1)."""
    return np.concatenate((dot(u, v)[:, None], u[:, :1] * v[:, 1:] + v[:, :1] * u[:, 1:]), axis=1)


def quotient(r: Array, u: Array) -> Array:
    """The v (n, 4) whose product with u is r."""
    first = (u[:, 0] * r[:, 0] - dot(u[:, 1:], r[:, 1:])) / determinant(u)
    return np.concatenate((first[:, None], (r[:, 1:] - first[:, None] * u[:, 1:]) / u[:, :1]), axis=1)


def longest_in_cones(u: Array, step: Array) -> float:
    """Largest multiple of a step from u, inside the cones, that does not leave them."""
    a, b, c = determinant(step), dot(u, MIRROR * step), determinant(u)
    root = b * b - a * c
    divisor = np.sqrt(np.maximum(root, 0.0)) - b
    leaves = (root >= 0.0) & (divisor > 0.0)
    return float((c[leaves] / divisor[leaves]).min(initial=np.inf))


def longest_above_zero(u: Array, step: Array) -> float:
    """Largest multiple of a step from u > 0 after which no number is below 0."""
    falls = step < 0.0
    return float((-u[falls] / step[falls]).min(initial=np.inf))


class Scaling:
    """The symmetric matrices W (4, 4) of Nesterov and Todd with W^-1 s = W z, of rows s and z inside the cones.

    W^2 = beta^2 (2 w w' - J), with J = diag(1, -1, -1, -1) and w of determinant 1.
    """

    def __init__(self, s: Array, z: Array) -> None:
        of_s, of_z = np.sqrt(determinant(s)), np.sqrt(determinant(z))
        a, b = s / of_s[:, None], z / of_z[:, None]
        self.w = (a + MIRROR * b) / np.sqrt(2.0 * (1.0 + dot(a, b)))[:, None]
        self.w[:, 0] = np.sqrt(1.0 + dot(self.w[:, 1:], self.w[:, 1:]))  # else round-off near the edge adds up
        self.beta = np.sqrt(of_s / of_z)
        self.root = (self.w + UNIT) / np.sqrt(2.0 * (self.w[:, :1] + 1.0))

    def times(self, u: Array) -> Array:
        """W u (n, 4)."""
        return self.beta[:, None] * (2.0 * self.root * dot(self.root, u)[:, None] - MIRROR * u)

    def over(self, u: Array) -> Array:
        """W^-1 u (n, 4)."""
        root = MIRROR * self.root
        return (2.0 * root * dot(root, u)[:, None] - MIRROR * u) / self.beta[:, None]
