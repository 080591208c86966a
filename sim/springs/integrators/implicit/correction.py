"""The correction u of the velocities for a residual r: (M + g D + g^2 K) u = r.

A chain solves it directly, by block elimination of its own matrix. A net uses a quasi-Newton method: the factors of an
earlier, simpler matrix, corrected by the changes of force along the last corrections.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.integrators.implicit.blocks import GENERAL, SYMMETRIC, set_near_blocks, set_rope_blocks
from sim.springs.integrators.implicit.dissection import Dissection, dissect, factorise, solve
from sim.springs.integrators.implicit.quasi_newton import StepMemory, make_memory, set_step
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.points.arrays import by_net


class RopeSolver(NamedTuple):
    """Arrays of a chain's direct solver."""

    numbers: int  # of a link's block
    diagonal: NDArray[np.float64]  # (cols, 9)
    beside: NDArray[np.float64]  # (cols, 9)


class NetSolver(NamedTuple):
    """Arrays of a net's quasi-Newton method."""

    numbers: int  # of a link's block
    grid: Dissection
    diagonal: NDArray[np.float64]  # (rows cols, 6) flat
    beside: NDArray[np.float64]  # (rows cols, 4, 6) flat
    factors_of: NDArray[np.float64]  # (1,): g [s] of the factors, 0 without any
    memory: StepMemory
    before: NDArray[np.float64]  # (3 rows cols,) residual before a correction


@kernel
def make_rope_solver(p, mean):
    return RopeSolver(GENERAL if mean else SYMMETRIC, np.zeros((p.cols, 9)), np.zeros((p.cols, 9)))


@kernel
def make_net_solver(p, mean):
    n = p.rows * p.cols
    return NetSolver(
        SYMMETRIC, dissect(p.rows, p.cols), np.zeros(6 * n), np.zeros(24 * n), np.zeros(1), make_memory(3 * n),
        np.zeros(3 * n),
    )  # fmt: skip


make_solver = by_net(rope=make_rope_solver, grid=make_net_solver)


@kernel
def forget_factors_of_net(solver, p):
    solver.factors_of[0] = 0.0


# Let the next correction begin with new factors.
forget_factors = by_net(rope=kernel(lambda solver, p: None, inline=True), grid=forget_factors_of_net)


@kernel
def correct_rope(p, work):
    """Set work.u, from the blocks and the residual in work.r, which it overwrites."""
    n, solver = p.cols, work.solver
    set_rope_blocks(p, work.points, work.links, work.pairs, solver.numbers, solver.diagonal, solver.beside)
    u = work.u.reshape(n, 3)
    for e in range(3):
        for j in range(n):
            u[j, e] = work.r[e * n + j]
    solve_block_tridiagonal(solver.diagonal, solver.beside, u)
    for e in range(3):
        for j in range(n):
            work.r[e * n + j] = u[j, e]
    for j in range(3 * n):
        work.u[j] = work.r[j]


@kernel
def correct_net(g, known, p, work):
    """Set work.u for the residual work.r, by the factors and the last of `known` corrections since they were made.

    Makes new factors of the blocks if those at hand are of another g. Returns how many corrections are known: none if
    they would lead away from the solution.
    """
    solver = work.solver
    if solver.factors_of[0] != g:
        set_near_blocks(p, work.links, work.points, solver.diagonal, solver.beside)
        factorise(solver.diagonal, solver.beside, p.inverse_masses, solver.grid)
        solver.factors_of[0] = g
    set_step(solver.memory, known, solver.grid, work.r, work.u)
    if known > 0 and not dot(work.r, work.u) > 0.0:
        known = 0
        solve(solver.grid, work.r, work.u)
    return known
