"""Newton's method for a stage of an implicit step: v = v0 + g a(x0 + g v, v, t).

Every diagonally implicit method here has such stages: implicit Euler with g = h, the midpoint with g = h/2,
TR-BDF2 with g = (1 - 1/sqrt 2) h. A correction d of a rope solves (M + g D + g^2 K) d = M (v0 + g a - v) directly. A
net uses a quasi-Newton method: the factors of an earlier, simpler matrix, corrected by the changes of force along
the last corrections.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import is_stopped, kernel
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.integrators.implicit.blocks import (
    GENERAL,
    SYMMETRIC,
    set_link_blocks,
    set_near_blocks,
    set_point_blocks,
)
from sim.springs.integrators.implicit.dissection import Dissection, dissect, factorise, solve
from sim.springs.integrators.implicit.mean_length import add_mean_lengths, set_mean_blocks
from sim.springs.integrators.implicit.quasi_newton import StepMemory, make_memory, remember, set_step
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.arrays import by_net, mass_at
from sim.springs.points.vector_ops import add_scaled, set_sum

SETTLED = 1e-11  # size of corrections not taken, relative to the fastest velocity
SETTLED_NET = 1e-10  # of a net: its corrections cost so much more
# A net's correction is cut or prolonged until less than this part of the forces along it is left, in at most TRIES
# tries, to at most this multiple of its length.
NEARLY, TRIES, FARTHEST = 0.7, 6, 3.0
FEW = 12  # corrections of a net, after which new factors are quicker than more of them
USABLE = 1e-3  # the last correction, relative to the fastest velocity, of a stage that may be taken unsettled
ROUND_OFF = 4e-15  # and to the farthest position over g, below which corrections are noise


class Exactness(NamedTuple):
    """Exactness of the solution of a method's stages. Those of a rope are solved to round-off at little cost."""

    share: float  # of the change of velocity in a stage that corrections may leave, apart from round-off
    usable: float  # the last correction, relative to velocity and its change, of a stage that may be taken unsettled
    most: int  # corrections of a net
    most_of_rope: int = 0


class RopeSolver(NamedTuple):
    """Arrays of a rope's direct solver."""

    numbers: int  # of a link's block
    diagonal: NDArray[np.float64]  # (cols, 9)
    beside: NDArray[np.float64]  # (cols, 9)


class NetSolver(NamedTuple):
    """Arrays of a net's quasi-Newton method."""

    numbers: int  # of a link's block
    grid: Dissection
    diagonal: NDArray[np.float64]  # (rows cols, 6) flat
    beside: NDArray[np.float64]  # (rows cols, 4, 6) flat
    kept: NDArray[np.float64]  # (1,): g [s] of the factors, 0 without any
    memory: StepMemory
    before: NDArray[np.float64]  # (3 rows cols,) residual before a correction


class NewtonArrays(NamedTuple):
    """Arrays of Newton's method."""

    mean: bool  # links take the tension of their mean length
    a: NDArray[np.float64]  # (3 rows cols,)
    f: NDArray[np.float64]  # scratch of `accelerate`
    points: NDArray[np.float64]  # (6 rows cols,) blocks of the particles
    links: NDArray[np.float64]  # (families numbers rows cols,) blocks of the links
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
        SYMMETRIC, dissect(p.rows, p.cols), np.zeros(6 * n), np.zeros(24 * n), np.zeros(1), make_memory(3 * n),
        np.zeros(3 * n),
    )  # fmt: skip


make_solver = by_net(rope=make_rope_solver, grid=make_net_solver)


@kernel
def forget_factors_of_net(solver, p):
    solver.kept[0] = 0.0


# Begin a step without factors, so that it does not depend on earlier steps in the same call.
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
                diagonal[j, e] = p.mass[j] if e % 4 == 0 else 0.0


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


@kernel
def factorise_net(g, p, work):
    """Factors of the blocks, without links that skip particles off the grid's lines."""
    solver = work.solver
    set_near_blocks(p, work.links, work.points, solver.diagonal, solver.beside)
    factorise(solver.diagonal, solver.beside, p.inverse_masses, solver.grid)
    solver.kept[0] = g


@kernel(inline=True)
def largest(u):
    """Largest magnitude, NaN if there is one."""
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
    if work.mean:
        set_mean_blocks(x0, x, g, p, work.links)
    else:
        set_link_blocks(x, g, p, work.links)


# Corrections a stage: one that has not settled by then is taken unsettled.
most_of = by_net(
    rope=kernel(lambda p, exactness: exactness.most_of_rope, inline=True),
    grid=kernel(lambda p, exactness: exactness.most, inline=True),
)


@kernel
def solve_rope_stage(x0, v0, g, t, exactness, p, x, v, work):
    """`solve_stage` of a rope, to round-off."""
    taken, settled, size = 0, False, np.inf
    while taken < most_of(p, exactness) and not is_stopped(p.stop):
        set_residual(x0, v0, g, t, p, x, v, work)
        set_blocks(x0, g, t, p, x, v, work)
        correct_rope(p, work)
        add_scaled(v, 1.0, work.u)
        taken += 1
        last, size = size, largest(work.u)
        # The remainder is the sum of further corrections, each smaller than the last by the same ratio.
        rest = size * size / (last - size) if size < last < np.inf else size
        noise = ROUND_OFF * largest(x) / g
        settled = rest <= SETTLED * largest(v) + noise or size <= noise
        # A NaN ends the search too: it only spreads.
        if settled or not size <= np.inf:
            break
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken, taken, settled, settled or size <= min(USABLE, exactness.usable) * largest(v)


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


@kernel(inline=True)
def mean_velocity(v, p, o):
    """Mean velocity, from index o on: of pinned particles, or of all where none is, so that their momentum stays."""
    momentum = mass = held = 0.0
    pins = 0
    for j in range(p.rows * p.cols):
        momentum += p.mass[j] * v[o + j]
        mass += p.mass[j]
        if p.inverse_masses[j] == 0.0:
            pins += 1
            held += v[o + j]
    return held / pins if pins > 0 else momentum / mass


@kernel
def mended_speed_of_net(vm, v0, p, work):
    n, twice = p.rows * p.cols, 0.0
    for e in range(3):
        mean = 2.0 * mean_velocity(vm, p, e * n) - mean_velocity(v0, p, e * n)
        for j in range(n):
            if p.inverse_masses[j] > 0.0:
                twice += p.mass[j] * (2.0 * vm[e * n + j] - v0[e * n + j] - mean) ** 2
    return math.sqrt(max(0.0, 1.0 + 4.0 * dot(work.r, vm) / twice)) if twice > 0.0 else 1.0


@kernel
def scale_speeds_of_net(scale, v, p):
    n = p.rows * p.cols
    for e in range(3):
        mean = mean_velocity(v, p, e * n)
        for j in range(n):
            if p.inverse_masses[j] > 0.0:
                v[e * n + j] = mean + scale * (v[e * n + j] - mean)


# Factor of the velocities about their mean after a midpoint step from v0, of velocity vm in its middle, that gives them
# the energy of the work of the forces: what is left of the residual r took 2 r.vm of it. 0 where no factor does. The
# momentum stays. A rope is solved to round-off.
mended_speed = by_net(rope=kernel(lambda vm, v0, p, work: 1.0, inline=True), grid=mended_speed_of_net)
scale_speeds = by_net(rope=kernel(lambda scale, v, p: None, inline=True), grid=scale_speeds_of_net)


@kernel(inline=True)
def remaining(size, last, before):
    """Sum of the corrections to come, as the last ones shrank: `size` after `last` and `before`."""
    rate = size / last if before == np.inf else math.sqrt(size / before)
    return size * rate / (1.0 - rate) if rate < 1.0 else size


@kernel
def solve_net_stage(x0, v0, g, t, exactness, p, x, v, work):
    """`solve_stage` of a net, by a quasi-Newton method: to `exactness`, in the norm of the energy.

    The factors are those of an earlier stage or of the first guess, until FEW corrections were not enough. A line
    search along each correction finds where the forces along it are nearly 0: buckling is not linear.
    """
    solver = work.solver
    taken, evals, count, settled, usable = 0, 0, 0, False, False
    size, last, before = np.inf, np.inf, np.inf
    set_residual(x0, v0, g, t, p, x, v, work)
    evals += 1
    while taken < most_of(p, exactness) and not is_stopped(p.stop):
        if solver.kept[0] != g or (taken > 0 and taken % FEW == 0):
            set_blocks(x0, g, t, p, x, v, work)
            factorise_net(g, p, work)
            count = 0
        set_step(solver.memory, count, solver.grid, work.r, work.u)
        slope = dot(work.r, work.u)
        if count > 0 and not slope > 0.0:
            count = 0
            solve(solver.grid, work.r, work.u)
            slope = dot(work.r, work.u)
        for j in range(work.r.shape[0]):
            solver.before[j] = work.r[j]
        low, low_slope, high, high_slope, length = 0.0, slope, 0.0, 0.0, 1.0
        add_scaled(v, 1.0, work.u)
        for tried in range(1, TRIES + 1):
            set_residual(x0, v0, g, t, p, x, v, work)
            evals += 1
            after = dot(work.r, work.u)
            if abs(after) <= NEARLY * slope or tried == TRIES:
                break
            part = length
            if after > 0.0:
                low, low_slope = length, after
                part = min(slope / (slope - after), FARTHEST) if after < slope else FARTHEST
            else:
                high, high_slope = length, after
            if high > 0.0:
                part = low + (high - low) * min(0.9, max(0.1, low_slope / (low_slope - high_slope)))
            elif length >= FARTHEST:
                break
            add_scaled(v, part - length, work.u)
            length = part
        taken += 1
        count = remember(solver.memory, count, work.u, length, solver.before, work.r)
        # A shortened correction says nothing about the distance to the solution.
        size, last, before = max(1.0, length) * norm(work.u, p), size, last
        noise = ROUND_OFF * largest(x) / g * math.sqrt(total_mass(p))
        change = change_norm(v, v0, p)
        settled = size <= noise
        if last < np.inf:
            rest = remaining(size, last, before)
            settled = settled or rest <= exactness.share * change + SETTLED_NET * norm(v, p) + noise
        usable = size <= exactness.usable * (change + norm(v, p))
        if settled or not size <= np.inf:
            break
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken, evals, settled, settled or usable


# Solve for v, from the guess in v, with x = x0 + g v.
#
# Returns the corrections taken, the force evaluations, whether they settled, and whether what they came
# to may be used although they did not.
solve_stage = by_net(rope=solve_rope_stage, grid=solve_net_stage)
