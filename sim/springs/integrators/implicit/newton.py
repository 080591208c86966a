"""Newton's method for a stage of an implicit step: v = v0 + g a(x0 + g v, v, t).

Every diagonally implicit method here asks for such stages: implicit Euler with g = h, the midpoint with g = h/2,
TR-BDF2 with g = (1 - 1/sqrt 2) h. A correction solves (M + g D + g^2 K) d = M (v0 + g a - v): directly for a rope,
by conjugate gradients for a net.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import is_stopped, kernel
from sim.springs.acceleration import accelerate, make_scratch, set_pins
from sim.springs.arrays import by_net, mass_at
from sim.springs.integrators.implicit.block_tridiagonal import solve_block_tridiagonal
from sim.springs.integrators.implicit.blocks import (
    GENERAL,
    SYMMETRIC,
    add_coupled,
    add_links_to_points,
    coupled_size,
    set_coupled,
    set_link_blocks,
    set_point_blocks,
)
from sim.springs.integrators.implicit.conjugate_gradients import factorise, solve_conjugate_gradients
from sim.springs.integrators.implicit.mean_length import add_mean_lengths, set_mean_blocks
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.vector_ops import set_sum

MOST = 25  # corrections a stage: a stage that has not settled by then is taken as it is
SETTLED = 1e-11  # what corrections not taken would add, relative to the fastest velocity
SETTLED_NET = 1e-9  # of a net: its corrections cost so much more
USABLE = 1e-3  # the last correction, relative to the fastest velocity, of a stage that may be taken unsettled
LOOSEST, TIGHTEST = 0.1, 1e-4  # reductions of the residual by conjugate gradients
ROUND_OFF = 4e-15  # and to the farthest position over g, below which corrections are noise


class NewtonArrays(NamedTuple):
    """Arrays of a Newton solver."""

    mean: bool  # links take the tension of their mean length
    numbers: int  # of a link's block
    a: NDArray[np.float64]  # (3 rows cols,)
    f: NDArray[np.float64]  # scratch of `accelerate`
    points: NDArray[np.float64]  # (6 rows cols,) blocks of the particles
    links: NDArray[np.float64]  # (families numbers rows cols,) blocks of the links
    coupled: NDArray[np.float64]  # blocks of the forces that couple points otherwise than links do
    diagonal: NDArray[np.float64]  # (cols, 9) of a rope
    beside: NDArray[np.float64]  # (cols, 9) of a rope
    factors: NDArray[np.float64]  # (6 rows cols,) of a net
    r: NDArray[np.float64]  # (3 rows cols,), and so on
    z: NDArray[np.float64]
    d: NDArray[np.float64]
    q: NDArray[np.float64]
    u: NDArray[np.float64]


# Numbers of a link's block, rows of a rope's matrix, and numbers in a vector of conjugate gradients.
solver_sizes = by_net(
    rope=kernel(lambda p, mean: (GENERAL if mean else SYMMETRIC, p.cols, 0), inline=True),
    grid=kernel(lambda p, mean: (SYMMETRIC, 0, 3 * p.rows * p.cols), inline=True),
)


@kernel
def make_work(p, mean):
    size = p.rows * p.cols
    numbers, n, m = solver_sizes(p, mean)
    return NewtonArrays(
        mean,
        numbers,
        np.zeros(3 * size),
        make_scratch(p),
        np.zeros(6 * size),
        np.zeros(numbers * size * p.offsets.shape[0]),
        np.zeros(coupled_size(p)),
        np.zeros((n, 9)),
        np.zeros((n, 9)),
        np.zeros(2 * m),
        np.zeros(3 * size),
        np.zeros(m),
        np.zeros(m),
        np.zeros(m),
        np.zeros(3 * size),
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
def correct_rope(before, p, work):
    """The correction of a rope's velocities into work.u, from the blocks and the residual in work.r; solved exactly."""
    n = p.cols
    set_rope_blocks(p, work.points, work.links, work.numbers, work.diagonal, work.beside)
    u = work.u.reshape(n, 3)
    for e in range(3):
        for j in range(n):
            u[j, e] = work.r[e * n + j]
    solve_block_tridiagonal(work.diagonal, work.beside, u)
    for e in range(3):
        for j in range(n):
            work.r[e * n + j] = u[j, e]
    for j in range(3 * n):
        work.u[j] = work.r[j]
    return 0.0


@kernel(inline=True)
def forcing(found, before):
    """How far a linear solve is taken, of squared residuals: as far as Newton goes (Eisenstat & Walker 1996)."""
    return LOOSEST if found > before else max(TIGHTEST, min(LOOSEST, 0.9 * found / before))


@kernel
def correct_net(before, p, work):
    """The correction of any net's velocities into work.u, from the blocks and the residual in work.r.

    before: squared residual of the last correction, 0 of the first; returns that of this one.
    """
    n = p.rows * p.cols
    found = dot(work.r, work.r)
    reduction = forcing(found, before)
    for j in range(6 * n):
        work.factors[j] = work.points[j]
    add_links_to_points(p, work.links, work.factors)
    add_coupled(p, work.coupled, work.factors)
    factorise(work.factors, n)
    solve_conjugate_gradients(
        work.points, work.links, work.coupled, work.factors, work.r, reduction, p, work.f, work.z, work.d,
        work.q, work.u,
    )  # fmt: skip
    # The scratch of forces is zero at its ends for whoever relies on it.
    for j in range(work.f.shape[0]):
        work.f[j] = 0.0
    return found


correct = by_net(rope=correct_rope, grid=correct_net)


tolerance = by_net(
    rope=kernel(lambda p: SETTLED, inline=True), grid=kernel(lambda p: SETTLED_NET, inline=True)
)  # fmt: skip


@kernel(inline=True)
def largest(u):
    """Largest magnitude, NaN where there is one."""
    found = 0.0
    for j in range(u.shape[0]):
        size = abs(u[j])
        if size > found or size != size:
            found = size
    return found


@kernel
def solve_stage(x0, v0, g, t, p, x, v, work, most):
    """Solve for v, from the guess in v, with x = x0 + g v.

    Returns the corrections taken, at most `most`, each one force evaluation, whether they settled, and whether what
    they came to may be used although they did not.
    """
    n = p.rows * p.cols
    taken, settled, found, size = 0, False, 0.0, np.inf
    while taken < most and not is_stopped(p.stop):
        set_sum(x, x0, g, v)
        set_pins(x, v, t, p)
        accelerate(x, v, t, p, True, work.f, work.a)
        if work.mean:
            add_mean_lengths(x0, x, p, work.a)
        for e in range(3):
            for j in range(n):
                i = e * n + j
                work.r[i] = mass_at(p, j) * (v0[i] + g * work.a[i] - v[i]) if p.inverse_masses[j] > 0.0 else 0.0
        set_point_blocks(x, v, t, g, p, work.points)
        set_coupled(x, v, g, p, work.coupled)
        if work.mean:
            set_mean_blocks(x0, x, g, p, work.links)
        else:
            set_link_blocks(x, g, p, work.links)
        found = correct(found, p, work)
        for i in range(3 * n):
            v[i] += work.u[i]
        taken += 1
        last, size = size, largest(work.u)
        # What is left is what further corrections would add, each smaller than the one before by the same ratio.
        rest = size * size / (last - size) if size < last < np.inf else size
        noise = ROUND_OFF * largest(x) / g
        settled = rest <= tolerance(p) * largest(v) + noise or size <= noise
        # A NaN ends the search too: it only spreads.
        if settled or not size <= np.inf:
            break
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken, settled, settled or size <= USABLE * largest(v)
