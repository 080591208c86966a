"""The linearised forces of a net: products with its stiffness and damping matrices, and their extreme vectors.

About a state x the free particles obey M u'' + D u' + K u = 0. Neither matrix is ever formed. Products are those of
M^-1/2 K M^-1/2, with zeros where pinned: symmetric, its eigenvalues squared frequencies [1/s^2] or damping rates [1/s],
its vectors M^1/2 u. Of lines, whose masses are matrices, M^-1/2 stands for any L with L L^T = M^-1: the products are
those of L^T K L, its vectors L^-1 u.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.forces import each
from sim.springs.forces.links import tangent as add_link_tangent
from sim.springs.forces.matrices import DAMPING, FRICTION, STIFFEST
from sim.springs.laws import TAUT
from sim.springs.points.arrays import by_net
from sim.springs.points.each_link import each_link, stretch
from sim.springs.points.line_points import set_inverse_masses, set_root_motion, turn_to_root_forces


@each_link("largest")
def largest_strain(link, x, p):
    return stretch(x, p, link)[3] / link.rest - 1.0 if link.rest > 0.0 else 0.0


longest_of_net = kernel(lambda x, p: max(TAUT, largest_strain(x, p)))
just_taut = kernel(lambda x, p: TAUT, inline=True)
# Largest l/l0 - 1 of any link, at least that of a link which is just taut: what another may soon come to. Lines of a
# mooring are of several materials, so that the strain of one tells nothing of another.
longest_strain = by_net(rope=longest_of_net, grid=longest_of_net, lines=just_taut)


@kernel(noalias=True, inline=True)
def set_over_root_mass(y, p, out):
    n = p.rows * p.cols
    for e in range(3):
        for j in range(n):
            out[e * n + j] = math.sqrt(p.inverse_masses[j]) * y[e * n + j]


@kernel(noalias=True, inline=True)
def divide_by_root_mass(f, p):
    set_over_root_mass(f, p, f)


keep_masses = kernel(lambda x, p: None, inline=True)
# Prepare the masses at x for the next two; those of lines depend on x.
set_masses = by_net(rope=keep_masses, grid=keep_masses, lines=set_inverse_masses)
# out = M^-1/2 y, 0 where pinned.
set_motion = by_net(rope=set_over_root_mass, grid=set_over_root_mass, lines=set_root_motion)
# f = (M^-1/2)^T f, in place.
turn_forces = by_net(rope=divide_by_root_mass, grid=divide_by_root_mass, lines=turn_to_root_forces)


def has_friction(p: Any) -> bool:
    """True if friction acts on a net."""
    return p.friction > 0.0 and not p.lab_contact and (p.has_floor or p.has_sphere)


net_friction_acts, line_friction_acts = kernel(has_friction, inline=True), kernel(lambda p: False, inline=True)
# True if friction acts that counts: that of the bed under lines is left out.
friction_acts = by_net(rope=net_friction_acts, grid=net_friction_acts, lines=line_friction_acts)


add_tangents = each("tangent", "x, u, t, p, part, longest, out", "none", noalias=True, allocates=False)


@kernel(noalias=True)
def set_tangent(x, y, t, p, part, longest, out):
    """out = M^-1/2 K M^-1/2 y, or with D for K (part DAMPING), about x at time t, after `set_masses`.

    All are flat (3 rows cols,). longest: strain to which links count as stretched, of part STIFFEST.

    Friction is apart, as its strongest damping is 1/h by construction: h D of it is part FRICTION. Air is left out.
    """
    u = np.empty_like(y)
    set_motion(y, p, u)
    for j in range(y.shape[0]):
        out[j] = 0.0
    add_tangents(x, u, t, p, part, longest, out)
    turn_forces(out, p)


@kernel(noalias=True)
def set_products(x, vectors, t, p, part, products):
    """The products (count, 3 rows cols) of `set_tangent`, of the vectors (count, 3 rows cols)."""
    longest = longest_strain(x, p)
    set_masses(x, p)
    for i in range(vectors.shape[0]):
        set_tangent(x, vectors[i], t, p, part, longest, products[i])


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
    set_masses(x, p)
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
def quotients_of(x, y, t, p):
    """A row of `quotients`."""
    u, w = np.empty_like(x), np.empty_like(x)
    longest = longest_strain(x, p)
    set_masses(x, p)
    set_tangent(x, y, t, p, STIFFEST, longest, w)
    stiffness = dot(y, w)
    for j in range(w.shape[0]):
        w[j] = 0.0
    set_motion(y, p, u)
    add_link_tangent(x, u, t, p, STIFFEST, longest, w)
    links = dot(u, w)
    set_tangent(x, y, t, p, DAMPING, longest, w)
    rate = dot(y, w)
    sliding = 0.0
    if friction_acts(p):
        set_tangent(x, y, t, p, FRICTION, longest, w)
        sliding = dot(y, w)
    return stiffness, links, rate, sliding


PRODUCTS, LANCZOS, QUOTIENTS = 0, 1, 2


@kernel(noalias=True)
def analyse(what, x, t, p, part, stiff, vectors, out):
    """`set_products`, `set_lanczos` with out[:2], or `quotients_of` each vector; returns how many vectors are set.

    One kernel, since what Python calls is compiled with the code of all forces.
    """
    if what == LANCZOS:
        return set_lanczos(x, t, p, part, stiff, vectors, out[0], out[1])
    if what == PRODUCTS:
        set_products(x, vectors, t, p, part, out)
    else:
        for i in range(vectors.shape[0]):
            out[i, 0], out[i, 1], out[i, 2], out[i, 3] = quotients_of(x, vectors[i], t, p)
    return vectors.shape[0]


def products(x: NDArray[np.float64], vectors: NDArray[np.float64], t: float, p: Any, part: int) -> NDArray[np.float64]:
    """The products of a part of the tangent about x (3 rows cols,) and of vectors (count, 3 rows cols)."""
    found = np.empty_like(vectors)
    analyse(PRODUCTS, x, t, p, part, 0.0, vectors, found)
    return found


def lanczos(
    x: NDArray[np.float64], start: NDArray[np.float64], t: float, p: Any, part: int, stiff: float, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Lanczos from the unit vector `start` (3 rows cols,), of at most `count` rows.

    Returns the orthonormal rows Q (m, 3 rows cols), and diagonal (m,) and side diagonal (m - 1,) of T = Q^T A Q, where
    A is `part` of the tangent about x and `stiff` times part STIFFEST.
    """
    basis, sides = np.zeros((count, x.size)), np.zeros((2, count))
    basis[0] = start
    filled = analyse(LANCZOS, x, t, p, part, stiff, basis, sides)
    return basis[:filled], sides[0, :filled], sides[1, : filled - 1]


def quotients(x: NDArray[np.float64], vectors: NDArray[np.float64], t: float, p: Any) -> NDArray[np.float64]:
    """(u K u, u K u of the links alone, u D u) over u M u [1/s^2, 1/s^2, 1/s] (count, 4), of unit vectors y = M^1/2 u
    (count, 3 rows cols), 0 where pinned.

    The fourth is the share of u M u that slides on floor or sphere, 0 without friction.
    """
    found = np.empty((len(vectors), 4))
    analyse(QUOTIENTS, x, t, p, 0, 0.0, vectors, found)
    return found
