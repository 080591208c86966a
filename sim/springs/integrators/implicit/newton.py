"""Newton's method for a stage of an implicit step: v = v0 + g a(x0 + g v, v, t).

Every diagonally implicit method here asks for such stages: implicit Euler with g = h, the midpoint with g = h/2,
TR-BDF2 with g = (1 - 1/sqrt 2) h. A correction solves (M + g D + g^2 K) d = M (v0 + g a - v): directly for a rope,
by conjugate gradients for a net.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import is_stopped, kernel
from sim.springs.acceleration import accelerate, make_scratch, set_pins
from sim.springs.arrays import by_net, mass_at
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.integrators.implicit.blocks import (
    GENERAL,
    SYMMETRIC,
    coupled_size,
    set_coupled,
    set_link_blocks,
    set_near_blocks,
    set_point_blocks,
)
from sim.springs.integrators.implicit.conjugate_gradients import solve_conjugate_gradients
from sim.springs.integrators.implicit.dissection import Dissection, dissect, factorise
from sim.springs.integrators.implicit.mean_length import add_mean_lengths, set_mean_blocks
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.vector_ops import add_scaled, set_sum

MOST = 25  # corrections a stage: a stage that has not settled by then is taken as it is
SETTLED = 1e-11  # size of corrections not taken, relative to the fastest velocity
SETTLED_NET = 1e-9  # of a net: its corrections cost so much more
# A net's correction is cut where the forces along it are turned round and more than this part as large after it, and
# prolonged where more than this part of them is left, to at most this multiple of its length.
OVERSHOT, FELL_SHORT, FARTHEST = 0.5, 0.3, 3.0
USABLE = 1e-3  # the last correction, relative to the fastest velocity, of a stage that may be taken unsettled
MOST_ITERATIONS = 500  # of conjugate gradients with new factors
FEW = 7  # iterations of conjugate gradients that are quicker than new factors
LOOSEST, TIGHTEST = 0.1, 1e-4  # reductions of the residual by conjugate gradients
ROUND_OFF = 4e-15  # and to the farthest position over g, below which corrections are noise


class Exactness(NamedTuple):
    """Exactness with which a method has the stages of a net solved."""

    share: float  # of the change of velocity in a stage that corrections may leave, apart from round-off
    usable: float  # the last correction, relative to velocity and its change, of a stage that may be taken unsettled
    most: int  # corrections


class RopeSolver(NamedTuple):
    """Arrays of a rope's direct solver."""

    numbers: int  # of a link's block
    diagonal: NDArray[np.float64]  # (cols, 9)
    beside: NDArray[np.float64]  # (cols, 9)


class NetSolver(NamedTuple):
    """Arrays of conjugate gradients and their preconditioner."""

    numbers: int  # of a link's block
    grid: Dissection
    diagonal: NDArray[np.float64]  # (rows cols, 6) flat
    beside: NDArray[np.float64]  # (rows cols, 4, 6) flat
    points: NDArray[np.float64]  # (6 rows cols,)
    kept: NDArray[np.float64]  # (2,): g [s] of the factors, 0 without any, and iterations that they last took
    left: NDArray[np.float64]  # (3 rows cols,) what is left of the residual
    z: NDArray[np.float64]  # (3 rows cols,), and so on
    d: NDArray[np.float64]
    q: NDArray[np.float64]


class NewtonArrays(NamedTuple):
    """Arrays of Newton's method."""

    mean: bool  # links take the tension of their mean length
    a: NDArray[np.float64]  # (3 rows cols,)
    f: NDArray[np.float64]  # scratch of `accelerate`
    points: NDArray[np.float64]  # (6 rows cols,) blocks of the particles
    links: NDArray[np.float64]  # (families numbers rows cols,) blocks of the links
    coupled: NDArray[np.float64]  # blocks of the forces that couple points otherwise than links do
    r: NDArray[np.float64]  # (3 rows cols,)
    u: NDArray[np.float64]  # (3 rows cols,)
    solver: Any


@kernel
def make_rope_solver(p, mean):
    return RopeSolver(GENERAL if mean else SYMMETRIC, np.zeros((p.cols, 9)), np.zeros((p.cols, 9)))


@kernel
def make_net_solver(p, mean):
    n = p.rows * p.cols
    return NetSolver(
        SYMMETRIC, dissect(p.rows, p.cols), np.zeros(6 * n), np.zeros(24 * n), np.zeros(6 * n), np.zeros(2),
        np.zeros(3 * n), np.zeros(3 * n), np.zeros(3 * n), np.zeros(3 * n),
    )  # fmt: skip


make_solver = by_net(rope=make_rope_solver, grid=make_net_solver)


@kernel
def forget_factors_of_net(solver, p):
    solver.kept[0] = 0.0


# Let a step begin without factors, so that it does not depend on the steps before it in the same call.
forget_factors = by_net(rope=kernel(lambda solver, p: None, inline=True), grid=forget_factors_of_net)


@kernel
def make_work(p, mean):
    size = p.rows * p.cols
    solver = make_solver(p, mean)
    return NewtonArrays(
        mean,
        np.zeros(3 * size),
        make_scratch(p),
        np.zeros(6 * size),
        np.zeros(solver.numbers * size * p.offsets.shape[0]),
        np.zeros(coupled_size(p)),
        np.zeros(3 * size),
        np.zeros(3 * size),
        solver,
    )


@kernel(noalias=True, allocates=False)
def set_rope_blocks(p, points, links, numbers, diagonal, beside):
    """The matrix of a rope, row by row; rows of pinned points hold them still."""
    n = p.cols
    left = numbers - 3
    for j in range(n):
        xx, xy, xz = points[j], points[n + j], points[2 * n + j]
        yy, yz, zz = points[3 * n + j], points[4 * n + j], points[5 * n + j]
        diagonal[j, 0], diagonal[j, 1], diagonal[j, 2] = xx, xy, xz
        diagonal[j, 3], diagonal[j, 4], diagonal[j, 5] = xy, yy, yz
        diagonal[j, 6], diagonal[j, 7], diagonal[j, 8] = xz, yz, zz
    for j in range(n - 1):
        free = p.inverse_masses[j] > 0.0 and p.inverse_masses[j + 1] > 0.0
        for e in range(3):
            for m in range(3):
                s = links[(left + e) * n + j] * links[(1 + m) * n + j] + (links[j] if e == m else 0.0)
                diagonal[j, 3 * e + m] += s
                diagonal[j + 1, 3 * e + m] += s
                beside[j, 3 * e + m] = -s if free else 0.0
    for j in range(n):
        if p.inverse_masses[j] == 0.0:
            for e in range(9):
                diagonal[j, e] = p.mass if e % 4 == 0 else 0.0


@kernel
def correct_rope(p, work):
    """The correction of a rope's velocities into work.u, from the blocks and the residual in work.r; solved exactly."""
    n, solver = p.cols, work.solver
    set_rope_blocks(p, work.points, work.links, solver.numbers, solver.diagonal, solver.beside)
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


@kernel(inline=True)
def forcing(found, before):
    """Tolerance of a linear solve, of squared residuals: as far as Newton goes (Eisenstat & Walker 1996)."""
    return LOOSEST if found > before else max(TIGHTEST, min(LOOSEST, 0.9 * found / before))


@kernel
def correct_net(reduction, g, p, work):
    """The correction of any net's velocities into work.u, from the blocks and the residual in work.r.

    reduction: of the residual. The factors are those of an earlier correction while few iterations are enough with
    them. Returns the iterations taken.
    """
    solver = work.solver
    taken, is_new = 0, solver.kept[0] != g or solver.kept[1] > FEW
    while True:
        if is_new:
            # The blocks of the particles alone are needed once more, in products.
            for j in range(solver.points.shape[0]):
                solver.points[j] = work.points[j]
            set_near_blocks(p, work.links, work.coupled, solver.points, solver.diagonal, solver.beside)
            factorise(solver.diagonal, solver.beside, p.inverse_masses, solver.grid)
            solver.kept[0] = g
        for j in range(work.r.shape[0]):
            solver.left[j] = work.r[j]
        most = MOST_ITERATIONS if is_new else 2 * FEW
        taken = solve_conjugate_gradients(
            work.points, work.links, work.coupled, solver.grid, solver.left, reduction, most, p, work.f, solver.z,
            solver.d, solver.q, work.u,
        )  # fmt: skip
        if is_new or taken < most:
            break
        is_new = True
    solver.kept[1] = taken
    # The scratch of forces is zero at its ends, as forces rely on it.
    for j in range(work.f.shape[0]):
        work.f[j] = 0.0
    return taken


@kernel(inline=True)
def largest(u):
    """Largest magnitude, NaN where there is one."""
    found = 0.0
    for j in range(u.shape[0]):
        size = abs(u[j])
        if size > found or size != size:
            found = size
    return found


@kernel(inline=True)
def set_residual(x0, v0, g, t, p, x, v, work):
    """work.r = M (v0 + g a(x, v, t) - v), x = x0 + g v; 0 where pinned."""
    n = p.rows * p.cols
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    accelerate(x, v, t, p, True, work.f, work.a)
    if work.mean:
        add_mean_lengths(x0, x, p, work.a)
    for e in range(3):
        for j in range(n):
            i = e * n + j
            work.r[i] = mass_at(p, j) * (v0[i] + g * work.a[i] - v[i]) if p.inverse_masses[j] > 0.0 else 0.0


@kernel(inline=True)
def set_blocks(x0, g, t, p, x, v, work):
    """The blocks of the matrix about x, v."""
    set_point_blocks(x, v, t, g, p, work.points)
    set_coupled(x, v, g, p, work.coupled)
    if work.mean:
        set_mean_blocks(x0, x, g, p, work.links)
    else:
        set_link_blocks(x, g, p, work.links)


@kernel
def solve_rope_stage(x0, v0, g, t, exactness, p, x, v, work, most):
    """`solve_stage` of a rope, to round-off: a correction costs next to nothing."""
    taken, settled, size = 0, False, np.inf
    while taken < most and not is_stopped(p.stop):
        set_residual(x0, v0, g, t, p, x, v, work)
        set_blocks(x0, g, t, p, x, v, work)
        correct_rope(p, work)
        add_scaled(v, 1.0, work.u)
        taken += 1
        last, size = size, largest(work.u)
        # The rest is the sum of further corrections, each smaller than the one before by the same ratio.
        rest = size * size / (last - size) if size < last < np.inf else size
        noise = ROUND_OFF * largest(x) / g
        settled = rest <= SETTLED * largest(v) + noise or size <= noise
        # A NaN ends the search too: it only spreads.
        if settled or not size <= np.inf:
            break
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken, taken, settled, settled or size <= USABLE * largest(v)


@kernel(inline=True)
def norm(u, p):
    """Root of twice the kinetic energy at velocities u, of the free particles."""
    n, total = p.rows * p.cols, 0.0
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total += p.mass[j] * (u[j] * u[j] + u[n + j] * u[n + j] + u[2 * n + j] * u[2 * n + j])
    return math.sqrt(total)


@kernel(inline=True)
def change_norm(v, v0, p):
    """`norm` of v - v0."""
    n, total = p.rows * p.cols, 0.0
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            for e in range(3):
                s = v[e * n + j] - v0[e * n + j]
                total += p.mass[j] * s * s
    return math.sqrt(total)


@kernel(inline=True)
def total_mass(p):
    total = 0.0
    for j in range(p.rows * p.cols):
        total += p.mass[j]
    return total


@kernel
def solve_net_stage(x0, v0, g, t, exactness, p, x, v, work, most):
    """`solve_stage` of a net: corrections are as exact as `exactness` asks, in the norm of their energy.

    A correction after which there are forces along it still, or back, is prolonged or cut to where they are 0 by linear
    interpolation: buckling is not linear.
    """
    taken, evals, settled, usable, size, before = 0, 0, False, False, np.inf, 0.0
    set_residual(x0, v0, g, t, p, x, v, work)
    evals += 1
    while taken < min(most, exactness.most) and not is_stopped(p.stop):
        set_blocks(x0, g, t, p, x, v, work)
        found = dot(work.r, work.r)
        correct_net(forcing(found, before), g, p, work)
        before = found
        slope = dot(work.r, work.u)
        add_scaled(v, 1.0, work.u)
        taken += 1
        last, size = size, norm(work.u, p)
        rest = size * size / (last - size) if size < last < np.inf else size
        noise = ROUND_OFF * largest(x) / g * math.sqrt(total_mass(p))
        change = change_norm(v, v0, p)
        settled = rest <= exactness.share * change + SETTLED_NET * norm(v, p) + noise or size <= noise
        usable = size <= exactness.usable * (change + norm(v, p))
        if settled or not size <= np.inf:
            break
        set_residual(x0, v0, g, t, p, x, v, work)
        evals += 1
        after = dot(work.r, work.u)
        if not -OVERSHOT * slope <= after <= FELL_SHORT * slope:
            part = min(slope / (slope - after), FARTHEST) if after < slope else FARTHEST
            add_scaled(v, part - 1.0, work.u)
            size *= part
            set_residual(x0, v0, g, t, p, x, v, work)
            evals += 1
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken, evals, settled, settled or usable


# Solve for v, from the guess in v, with x = x0 + g v.
#
# Returns the corrections taken, at most `most`, the force evaluations, whether they settled, and whether what they came
# to may be used although they did not.
solve_stage = by_net(rope=solve_rope_stage, grid=solve_net_stage)
