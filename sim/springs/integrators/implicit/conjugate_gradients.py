"""Conjugate gradients for a net's implicit step, preconditioned by the factors of its links between neighbours."""

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.integrators.implicit.blocks import SYMMETRIC, multiply_coupled
from sim.springs.integrators.implicit.dissection import solve
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.points.acceleration import add_row
from sim.springs.points.vector_ops import add_scaled

UNASKED = 4  # iterations between two looks at whether the solve is to end


@kernel(noalias=True, inline=True)
def set_products(blocks, o, u, n, q):
    """q = B u, particle by particle."""
    for j in range(n):
        x, y, z = u[j], u[n + j], u[n + n + j]
        xx, xy, xz = blocks[o + j], blocks[o + n + j], blocks[o + n + n + j]
        yy, yz, zz = blocks[o + n * 3 + j], blocks[o + n * 4 + j], blocks[o + n * 5 + j]
        q[j] = xx * x + xy * y + xz * z
        q[n + j] = xy * x + yy * y + yz * z
        q[n + n + j] = xz * x + yz * y + zz * z


@kernel(noalias=True, inline=True)
def set_link_products(blocks, o, u, ia, ib, count, n, m, f):
    """f = H (u_a - u_b) = c (u_a - u_b) + q q.(u_a - u_b) of `count` links in a row."""
    q = o + n
    for j in range(count):
        a, b = ia + j, ib + j
        x, y, z = u[a] - u[b], u[n + a] - u[n + b], u[n + n + a] - u[n + n + b]
        c = blocks[o + a]
        s = blocks[q + a] * x + blocks[q + n + a] * y + blocks[q + n + n + a] * z
        f[j] = c * x + s * blocks[q + a]
        f[m + j] = c * y + s * blocks[q + n + a]
        f[m + m + j] = c * z + s * blocks[q + n + n + a]


@kernel(noalias=True, inline=True)
def hold_pinned(w, u, o, n):
    for j in range(n):
        u[o + j] = u[o + j] if w[j] > 0.0 else 0.0


@kernel(noalias=True, allocates=False)
def set_matrix_product(points, links, coupled, u, p, f, q):
    """q = (M + g D + g^2 K) u of `sim.springs.integrators.implicit.blocks`, 0 where pinned; u is 0 there."""
    n, m = np.uint64(p.rows * p.cols), np.uint64(p.cols + 1)
    set_products(points, np.uint64(0), u, n, q)
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        first = max(0, -dj)
        count = np.uint64(max(0, p.cols - abs(dj)))
        for i in range(p.rows - di):
            ia = np.uint64(i * p.cols + first)
            ib = np.uint64((i + di) * p.cols + first + dj)
            o = np.uint64(SYMMETRIC * r) * n
            set_link_products(links, o, u, ia, ib, count, n, m, f)
            for e in range(3):
                of, o = np.uint64(e) * m, np.uint64(e) * n
                add_row(f, of, count, 1.0, q, o + ia)
                add_row(f, of, count, -1.0, q, o + ib)
    multiply_coupled(p, coupled, u, q)
    for e in range(3):
        hold_pinned(p.inverse_masses, q, np.uint64(e) * n, n)


@kernel(noalias=True, inline=True)
def set_direction(d, beta, z):
    for j in range(d.shape[0]):
        d[j] = z[j] + beta * d[j]


@kernel(allocates=False)
def solve_conjugate_gradients(points, links, coupled, grid, r, reduction, most, p, f, z, d, q, u):
    """Solve A u = r until r has shrunk to `reduction` of itself in the preconditioner's norm; r is overwritten.

    grid: factors of `sim.springs.integrators.implicit.dissection`. f, z, d, q: scratch.
    Returns the iterations, at most `most`.
    """
    solve(grid, r, z)
    for j in range(u.shape[0]):
        u[j], d[j] = 0.0, z[j]
    rho = dot(r, z)
    goal = reduction * reduction * rho
    for count in range(most):
        # A NaN ends the solve too.
        if not rho > goal or (count % UNASKED == UNASKED - 1 and is_stopped(p.stop)):
            return count
        set_matrix_product(points, links, coupled, d, p, f, q)
        alpha = rho / dot(d, q)
        add_scaled(u, alpha, d)
        add_scaled(r, -alpha, q)
        solve(grid, r, z)
        before, rho = rho, dot(r, z)
        set_direction(d, rho / before, z)
    return most
