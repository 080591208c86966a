"""Newton's method for a stage of an implicit step: v = v0 + g a(x0 + g v, v, t).

Every diagonally implicit method here asks for such stages: implicit Euler with g = h, the midpoint with g = h/2,
TR-BDF2 with g = (1 - 1/sqrt 2) h. A correction solves (M + g D + g^2 K) d = M (v0 + g a - v): directly for a rope,
by conjugate gradients for a net.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.block_tridiagonal import solve_block_tridiagonal
from sim.springs.blocks import add_links_to_points, set_blocks
from sim.springs.conjugate_gradients import factorise, solve_conjugate_gradients
from sim.springs.forces import accelerate, make_scratch, set_pins
from sim.springs.rows import set_sum

MOST = 25  # corrections a stage: a stage that has not settled by then is taken as it is
SETTLED = 1e-11  # size of the last correction, relative to the fastest velocity
ROUND_OFF = 4e-15  # and to the farthest position over g, below which corrections are noise


class Work(NamedTuple):
    """Arrays of a Newton solver."""

    a: NDArray[np.float64]  # (3 rows cols,)
    f: NDArray[np.float64]  # scratch of `accelerate`
    points: NDArray[np.float64]  # (6 rows cols,) blocks of the particles
    links: NDArray[np.float64]  # (families 6 rows cols,) blocks of the links
    factors: NDArray[np.float64]  # (6 rows cols,)
    r: NDArray[np.float64]  # (3 rows cols,), and so on
    z: NDArray[np.float64]
    d: NDArray[np.float64]
    q: NDArray[np.float64]
    u: NDArray[np.float64]


@kernel
def make_work(p):
    size = p.rows * p.cols
    m = 0 if p.is_rope else size
    return Work(
        np.zeros(3 * size),
        make_scratch(p),
        np.zeros(6 * size),
        np.zeros(6 * size * p.offsets.shape[0]),
        np.zeros(6 * m),
        np.zeros(3 * size),
        np.zeros(3 * m),
        np.zeros(3 * m),
        np.zeros(3 * m),
        np.zeros(3 * size),
    )


@kernel(allocates=False)
def tie_pinned(p, points, links):
    """Rows of pinned points out of a rope's matrix; links take the sign they have off the diagonal."""
    n = p.cols
    for j in range(n):
        free = p.weights[j] > 0.0 and (j + 1 < n and p.weights[j + 1] > 0.0)
        for e in range(6):
            links[6 * j + e] = -links[6 * j + e] if free else 0.0
            if p.weights[j] == 0.0:
                points[6 * j + e] = p.mass if e == 0 or e == 3 or e == 5 else 0.0


@kernel
def correct_rope(x, v, t, g, p, work):
    """The correction of a rope's velocities into work.u, (points, 3) flat, from the residual in work.r."""
    n = p.cols
    set_blocks(x, v, t, g, p, 6, 1, work.points, work.links)
    add_links_to_points(p, 6, 1, work.points, work.links)
    tie_pinned(p, work.points, work.links)
    u = work.u.reshape(n, 3)
    for e in range(3):
        for j in range(n):
            u[j, e] = work.r[e * n + j]
    solve_block_tridiagonal(work.points.reshape(n, 6), work.links.reshape(n, 6), u)
    for e in range(3):
        for j in range(n):
            work.r[e * n + j] = u[j, e]
    for j in range(3 * n):
        work.u[j] = work.r[j]


@kernel(allocates=False)
def correct_net(x, v, t, g, p, work):
    """The correction of any net's velocities into work.u, from the residual in work.r."""
    n = p.rows * p.cols
    set_blocks(x, v, t, g, p, 1, n, work.points, work.links)
    for j in range(6 * n):
        work.factors[j] = work.points[j]
    add_links_to_points(p, 1, n, work.factors, work.links)
    factorise(work.factors, n)
    solve_conjugate_gradients(
        work.points, work.links, work.factors, work.r, p, work.f, work.z, work.d, work.q, work.u
    )  # fmt: skip
    # The scratch of forces is zero at its ends for whoever relies on it.
    for j in range(work.f.shape[0]):
        work.f[j] = 0.0


@kernel(inline=True)
def largest(u):
    """Largest magnitude, NaN where there is one."""
    found = 0.0
    for j in range(u.shape[0]):
        size = abs(u[j])
        if not size <= found:
            found = size
    return found


@kernel
def solve_stage(x0, v0, g, t, p, x, v, work):
    """Solve for v, from the guess in v, with x = x0 + g v; returns the corrections taken, each one force evaluation."""
    n = p.rows * p.cols
    taken = 0
    while taken < MOST:
        set_sum(x, x0, g, v)
        set_pins(x, v, t, p)
        accelerate(x, v, t, p, True, work.f, work.a)
        for e in range(3):
            for j in range(n):
                i = e * n + j
                work.r[i] = p.mass * (v0[i] + g * work.a[i] - v[i]) if p.weights[j] > 0.0 else 0.0
        if p.is_rope:
            correct_rope(x, v, t, g, p, work)
        else:
            correct_net(x, v, t, g, p, work)
        for i in range(3 * n):
            v[i] += work.u[i]
        taken += 1
        size = largest(work.u)
        # A NaN ends the search too: it only spreads.
        if not size > SETTLED * largest(v) + ROUND_OFF * largest(x) / g:
            break
    set_sum(x, x0, g, v)
    set_pins(x, v, t, p)
    return taken
