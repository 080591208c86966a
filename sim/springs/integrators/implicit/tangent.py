"""The linearised forces of a net: products with its stiffness and damping matrices, and their extreme vectors.

About a state x the free particles obey M u'' + D u' + K u = 0. Neither matrix is ever formed. Products are those of
M^-1/2 K M^-1/2, with zeros where pinned: symmetric, its eigenvalues squared frequencies [1/s^2] or damping rates [1/s],
its vectors M^1/2 u.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.arrays import link_at, link_count, span
from sim.springs.forces import each
from sim.springs.forces.links import tangent as add_link_tangent
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST
from sim.springs.laws import TAUT


@kernel(allocates=False)
def longest_strain(x, p):
    """Largest l/l0 - 1 of any link, at least that of a link which is just taut: what another may soon come to."""
    n, longest = p.rows * p.cols, TAUT
    for q in range(link_count(p)):
        a, b, rest, _, _ = link_at(p, q)
        if rest > 0.0:
            rx, ry, rz = span(x, n, a, b)
            longest = max(longest, math.sqrt(rx * rx + ry * ry + rz * rz) / rest - 1.0)
    return longest


@kernel(noalias=True, inline=True)
def set_over_root_mass(y, p, out):
    """out = M^-1/2 y, 0 where pinned."""
    n = p.rows * p.cols
    for e in range(3):
        for j in range(n):
            out[e * n + j] = math.sqrt(p.inverse_masses[j]) * y[e * n + j]


add_tangents = each("tangent", "x, u, t, p, part, longest, out", "none", noalias=True, allocates=False)


@kernel(noalias=True)
def set_tangent(x, y, t, p, part, longest, out):
    """out = M^-1/2 K M^-1/2 y, or with D for K (part DAMPING), about x at time t; all flat (3 rows cols,).

    longest: strain to which links count as stretched, of part STIFFEST.

    Friction is apart, as its strongest damping is 1/h by construction: h D of it is part FRICTION. Air is left out.
    """
    u = np.empty_like(y)
    set_over_root_mass(y, p, u)
    for j in range(y.shape[0]):
        out[j] = 0.0
    add_tangents(x, u, t, p, part, longest, out)
    set_over_root_mass(out, p, out)


@kernel(noalias=True, inline=True)
def dot(a, b):
    total = 0.0
    for j in range(a.shape[0]):
        total += a[j] * b[j]
    return total


@kernel(noalias=True, inline=True)
def add_multiple(y, s, x):
    for j in range(y.shape[0]):
        y[j] += s * x[j]


@kernel(noalias=True)
def set_lanczos(x, t, p, part, stiff, basis, diagonal, beside):
    """Lanczos from the unit vector in basis[0]: the tridiagonal T = Q^T A Q, and how many rows of Q were filled.

    A is `part` of the tangent and `stiff` times part STIFFEST. basis (count, 3 rows cols); diagonal, beside (count,).
    Every new vector is made orthogonal to all before it: counts are small, and without that the largest eigenvalue
    comes back as false copies (Golub & Van Loan, 10.3).
    """
    count = basis.shape[0]
    w, other = np.empty_like(x), np.empty_like(x)
    largest = 0.0
    longest = longest_strain(x, p)
    for s in range(count):
        set_tangent(x, basis[s], t, p, part, longest, w)
        if stiff != 0.0:
            set_tangent(x, basis[s], t, p, STIFFEST, longest, other)
            add_multiple(w, stiff, other)
        diagonal[s] = dot(w, basis[s])
        for _ in range(2):
            for r in range(s + 1):
                add_multiple(w, -dot(w, basis[r]), basis[r])
        beside[s] = math.sqrt(dot(w, w))
        largest = max(largest, abs(diagonal[s]), beside[s])
        if s + 1 == count or beside[s] <= 1e-9 * largest:
            return s + 1
        for j in range(x.shape[0]):
            basis[s + 1, j] = w[j] / beside[s]
    return count


@kernel(noalias=True)
def quotients(x, y, t, p):
    """(u K u, u K u of the links alone, u D u) over u M u [1/s^2, 1/s^2, 1/s], of a unit vector y = M^1/2 u, 0 where
    pinned.

    The fourth is the share of u M u that slides on floor or sphere, 0 without friction.
    """
    u, w = np.empty_like(x), np.empty_like(x)
    longest = longest_strain(x, p)
    set_tangent(x, y, t, p, STIFFEST, longest, w)
    stiffness = dot(y, w)
    for j in range(w.shape[0]):
        w[j] = 0.0
    set_over_root_mass(y, p, u)
    add_link_tangent(x, u, t, p, STIFFEST, longest, w)
    links = dot(u, w)
    set_tangent(x, y, t, p, DAMPING, longest, w)
    rate = dot(y, w)
    sliding = 0.0
    if p.friction > 0.0 and not p.lab_contact and (p.has_floor or p.has_sphere):
        set_tangent(x, y, t, p, FRICTION, longest, w)
        sliding = dot(y, w)
    return stiffness, links, rate, sliding
