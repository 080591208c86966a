"""BiCGSTAB for an implicit step of a net with a nonsymmetric matrix (van der Vorst 1992), with block Jacobi."""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.integrators.implicit.conjugate_gradients import MOST, UNASKED, precondition, set_general_product
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.vector_ops import add_scaled


@kernel(noalias=True, inline=True)
def set_turned(d, beta, omega, q, r):
    """d = r + beta (d - omega q)"""
    for j in range(d.shape[0]):
        d[j] = r[j] + beta * (d[j] - omega * q[j])


@kernel(noalias=True, allocates=False)
def solve_stabilised_gradients(points, links, own, air, factors, r, reduction, p, f, z, d, q, s, shadow, u):
    """Solve A u = r until r has shrunk to `reduction` of itself; r is overwritten.

    factors: `factorise` of the symmetric part of A's diagonal; from f to shadow: scratch.
    """
    n = np.uint64(p.rows * p.cols)
    for j in range(u.shape[0]):
        u[j], d[j], q[j], shadow[j] = 0.0, 0.0, 0.0, r[j]
    goal = reduction * math.sqrt(dot(r, r))
    rho, alpha, omega = 1.0, 1.0, 1.0
    for count in range(MOST // 2):
        before, rho = rho, dot(shadow, r)
        if rho == 0.0 or omega == 0.0 or (count % UNASKED == UNASKED - 1 and is_stopped(p.stop)):
            return count
        set_turned(d, rho / before * alpha / omega, omega, q, r)
        precondition(factors, d, n, z)
        set_general_product(points, links, own, air, z, p, f, q)
        alpha = rho / dot(shadow, q)
        add_scaled(u, alpha, z)
        add_scaled(r, -alpha, q)
        if not math.sqrt(dot(r, r)) > goal:
            return count
        precondition(factors, r, n, z)
        set_general_product(points, links, own, air, z, p, f, s)
        omega = dot(s, r) / dot(s, s)
        add_scaled(u, omega, z)
        add_scaled(r, -omega, s)
        if not math.sqrt(dot(r, r)) > goal:
            return count
    return MOST // 2
