"""The stages of any explicit Runge-Kutta method of x'' = a(x, x', t), read from its tableau.

In Nystroem form a stage's velocity is v + h sum A_ij a_j and its position x + C_i h v + h^2 sum (A A)_ij a_j, so that
only accelerations are kept. They lie in one array, a row a stage: loops over many arrays do not vectorise.

A rope on its own is taken in blocks of points that stay in the fastest cache through all stages of a step. Each stage
needs its neighbours' last one, so a block moves back by a point a stage, and no point is worked out twice.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.energy import add_power
from sim.springs.damping import other_acts
from sim.springs.forces import FORCES, each
from sim.springs.forces.links import link_forces
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.points.acceleration import accelerate, make_scratch, set_from_differences, set_pins
from sim.springs.points.arrays import by_net

WHOLE = 160  # points: a rope no longer than this is one block
BLOCK = 96  # points in a block of a longer one: the rows of their stages are 30 kB
WIDEST = 16  # terms of a row, padded
TERMS_OF_ONE = 8  # of the error estimate of a method that has one
TERMS_OF_TWO = 10  # of each of two


class Tableau(NamedTuple):
    """A method of s stages; row s of each array is the new state, rows beyond it error estimates.

    One error estimate sums at most TERMS_OF_ONE stages; two sum the same, at most TERMS_OF_TWO.
    """

    c: NDArray[np.float64]  # (rows,) times of the stages
    counts: NDArray[np.int64]  # (rows,) terms of each, even
    terms: NDArray[np.uint64]  # (rows, WIDEST) the stages that are summed
    a: NDArray[np.float64]  # (rows, WIDEST) their weights in the velocity
    g: NDArray[np.float64]  # (rows, WIDEST) and in the position
    stages: int  # s
    error_order: int  # power of the step with which the estimated error of a step shrinks


class Stages(NamedTuple):
    """Room for a step."""

    k: NDArray[np.float64]  # ((s + 1) stride,) accelerations of the stages and of the new state
    stride: int  # numbers from row to row, at least 3 rows cols
    a: NDArray[np.float64]  # (3 rows cols,) one of them
    xs: NDArray[np.float64]  # (3 rows cols,) a stage
    vs: NDArray[np.float64]
    f: NDArray[np.float64]  # scratch of `accelerate`


Rows = tuple[tuple[float, ...], ...]


def tableau(error_order: int, c: tuple[float, ...], slopes: Rows, weights: tuple[float, ...], errors: Rows) -> Tableau:
    """A method from Butcher's tableau: `slopes` below the diagonal, `weights`, and the weights of its error estimates.

    An estimate may have one weight more than there are stages, that of the new state's own acceleration.
    """
    velocity = rows_of((*slopes, weights, *errors), len(weights))
    # Entries that no path leads to are 0 there except for round-off of products with zeros, that is, exactly.
    return tableau_of_rows(error_order, c, velocity, velocity @ velocity[: len(weights) + 1])


def rows_of(rows: Rows, stages: int) -> NDArray[np.float64]:
    """Rows of a tableau of `stages` stages, filled up with zeros, the new state's column included."""
    full = np.zeros((len(rows), stages + 1))
    for i, row in enumerate(rows):
        full[i, : len(row)] = row
    return full


def tableau_of_rows(
    error_order: int, c: tuple[float, ...], velocity: NDArray[np.float64], position: NDArray[np.float64]
) -> Tableau:
    """A method from the weights (rows, stages + 1) of all rows in the velocity and in the position."""
    s = velocity.shape[1] - 1
    counts, terms = np.zeros(len(velocity), dtype=np.int64), np.zeros((len(velocity), WIDEST), dtype=np.uint64)
    a, g = np.zeros((2, len(velocity), WIDEST))
    sums = (velocity != 0.0) | (position != 0.0)
    sums[s + 1 :] = sums[s + 1 :].any(axis=0)
    for i in range(len(velocity)):
        used = np.flatnonzero(sums[i])
        counts[i] = len(used) + len(used) % 2
        terms[i, : len(used)] = used
        a[i, : len(used)], g[i, : len(used)] = velocity[i, used], position[i, used]
    times = np.array([*c, 1.0, *(0.0 for _ in velocity[s + 1 :])])
    return Tableau(times, counts, terms, a, g, s, error_order)


@kernel
def make_stages(method, x, p):
    size = x.shape[0]
    # Rows a multiple of 4 kB apart would all fight for the same few lines of the cache.
    stride = size if size < 512 else size + (40 - size) % 512
    k = np.zeros((method.stages + 1) * stride)
    return Stages(k, stride, np.zeros(size), np.zeros(size), np.zeros(size), make_scratch(p))


@kernel(inline=True)
def terms_at(method, i, q, h, m, o):
    """Four terms of row i from q on: places in k, weights in the velocity times h and in the position times h^2."""
    t, a, g, hh = method.terms, method.a, method.g, h * h
    return (
        (t[i, q] * m + o, t[i, q + 1] * m + o, t[i, q + 2] * m + o, t[i, q + 3] * m + o),
        (h * a[i, q], h * a[i, q + 1], h * a[i, q + 2], h * a[i, q + 3]),
        (hh * g[i, q], hh * g[i, q + 1], hh * g[i, q + 2], hh * g[i, q + 3]),
    )


@kernel(noalias=True, inline=True)
def set_terms(x, v, o, d, k, at, a, g, n, s, xs, vs):
    """Set the state to x + d v and v, and the sums of some terms: as many as `at` has, which LLVM unrolls."""
    for j in range(n):
        dx = dv = 0.0
        for q in range(len(at)):
            one = k[at[q] + j]
            dx += g[q] * one
            dv += a[q] * one
        xs[s + j] = x[o + j] + d * v[o + j] + dx
        vs[s + j] = v[o + j] + dv


@kernel(noalias=True, inline=True)
def add_terms(k, at, a, g, n, s, xs, vs):
    """Add the sums of four terms more."""
    for j in range(n):
        dx = dv = 0.0
        for q in range(len(at)):
            one = k[at[q] + j]
            dx += g[q] * one
            dv += a[q] * one
        xs[s + j] += dx
        vs[s + j] += dv


@kernel(noalias=True, inline=True)
def set_stage(method, i, x, v, h, k, m, o, n, s, xs, vs):
    """Row i: x + c h v + h^2 sum g k and v + h sum a k of n numbers from o on, to xs, vs from s on; m numbers a row."""
    d, count, done = method.c[i] * h, method.counts[i], 6
    at, a, g = terms_at(method, i, 0, h, m, o)
    if count == 2:
        set_terms(x, v, o, d, k, at[:2], a[:2], g[:2], n, s, xs, vs)
    elif count == 4 or count == 8:
        set_terms(x, v, o, d, k, at, a, g, n, s, xs, vs)
        done = 4
    else:
        more, b, c = terms_at(method, i, 4, h, m, o)
        set_terms(x, v, o, d, k, at + more[:2], a + b[:2], g + c[:2], n, s, xs, vs)
    while done < count:
        at, a, g = terms_at(method, i, done, h, m, o)
        add_terms(k, at, a, g, n, s, xs, vs)
        done += 4


@kernel(noalias=True, inline=True)
def copy(x, o, n, y, s):
    """y from s on = x from o on."""
    for j in range(n):
        y[s + j] = x[o + j]


@kernel(noalias=True, allocates=False)
def accelerate_all(x, v, t, p, f, a):
    """`accelerate` compiled once for all who have no need of it inline."""
    accelerate(x, v, t, p, True, f, a)


rough_acts = each("acts", "p", "truth", [force for force in FORCES if not force.is_smooth], inline=True)


@kernel(inline=True)
def is_smooth_net(p):
    return not rough_acts(p) and p.pins.shape[0] == 0


# True if all acting forces are as smooth as the estimates of the error need them.
is_smooth = by_net(rope=is_smooth_net, grid=is_smooth_net, lines=kernel(lambda p: False, inline=True))


@kernel(noalias=True, inline=True)
def accelerate_span(xs, vs, p, f, first, n, M, inner, count, k, o, N):
    """Accelerations of `count` points of a bare rope into k from o on, a component N further.

    xs, vs (3 M,): n points in a row; those from `inner` on are needed; p.inverse_masses from `first` on.
    """
    zero, one = np.uint64(0), np.uint64(1)
    F = M + one
    link_forces(
        xs, vs, f, zero, one, one, n - one, M, F, p.law, p.families[0, 1], p.families[0, 2], p.families[0, 0], p.axial
    )  # fmt: skip
    for e in range(3):
        b, of = np.uint64(e) * M + inner, np.uint64(e) * F
        # Beyond the rope's ends there is no link, and the point there is not read.
        f[of], f[of + n] = 0.0, 0.0
        g = p.gx if e == 0 else p.gy if e == 1 else p.gz
        set_from_differences(
            f, vs, p.inverse_masses, k, of + inner, b, first + inner, o + np.uint64(e) * N, count, g, p.drag
        )  # fmt: skip


@kernel(noalias=True, allocates=False)
def step_bare_rope(method, x, v, h, p, stages, xn, vn):
    """`take_step` of a bare rope, block by block."""
    k, xs, vs, f = stages.k, stages.xs, stages.vs, stages.f
    n = p.cols
    parts = 1 if n <= WHOLE else (n + BLOCK - 1) // BLOCK
    N = np.uint64(n)
    m = np.uint64(stages.stride)
    M = N if parts == 1 else np.uint64(BLOCK + method.stages + 2)
    for part in range(parts):
        start, end = n * part // parts, n * (part + 1) // parts
        for i in range(1, method.stages + 1):
            low = max(start - i, 0)
            high = n if end == n else end - i
            left, right = max(low - 1, 0), min(high + 1, n)
            first, count = np.uint64(left), np.uint64(right - left)
            inner, own = np.uint64(low - left), np.uint64(high - low)
            if parts == 1:
                set_stage(method, i, x, v, h, k, m, np.uint64(0), np.uint64(3) * N, np.uint64(0), xs, vs)
            else:
                for e in range(3):
                    set_stage(method, i, x, v, h, k, m, np.uint64(e) * N + first, count, np.uint64(e) * M, xs, vs)
            accelerate_span(xs, vs, p, f, first, count, M, inner, own, k, np.uint64(i) * m + np.uint64(low), N)
            if i == method.stages:
                for e in range(3):
                    copy(xs, np.uint64(e) * M + inner, own, xn, np.uint64(e) * N + np.uint64(low))
                    copy(vs, np.uint64(e) * M + inner, own, vn, np.uint64(e) * N + np.uint64(low))


@kernel(noalias=True, allocates=False)
def step_any(method, x, v, t, h, p, stages, xn, vn, ledger, with_account):
    """`take_step` of any net, stage by stage."""
    k, xs, vs, a = stages.k, stages.xs, stages.vs, stages.a
    last = method.stages
    zero, size, m = np.uint64(0), np.uint64(x.shape[0]), np.uint64(stages.stride)
    if with_account:
        add_power(x, v, t, p, True, weight_of(method, 0) * h, ledger)
    for i in range(1, last + 1):
        now = t + method.c[i] * h
        set_stage(method, i, x, v, h, k, m, zero, size, zero, xs, vs)
        set_pins(xs, vs, now, p)
        accelerate_all(xs, vs, now, p, stages.f, a)
        copy(a, zero, size, k, np.uint64(i) * m)
        if with_account and i < last:
            add_power(xs, vs, now, p, True, weight_of(method, i) * h, ledger)
    copy(xs, zero, size, xn, zero)
    copy(vs, zero, size, vn, zero)


@kernel(inline=True)
def weight_of(method, i):
    """Weight of stage i in the new velocity."""
    weight = 0.0
    for q in range(method.counts[method.stages]):
        if method.terms[method.stages, q] == np.uint64(i):
            weight += method.a[method.stages, q]
    return weight


@kernel(allocates=False)
def step_rope(method, x, v, t, h, p, stages, xn, vn, ledger, with_account):
    """`take_step` of a rope."""
    if not (other_acts(p) or p.pins.shape[0] > 0 or with_account):
        step_bare_rope(method, x, v, h, p, stages, xn, vn)
    else:
        step_any(method, x, v, t, h, p, stages, xn, vn, ledger, with_account)


# The state a step h after x, v at t into xn, vn, and its acceleration into the last row of stages.k. The acceleration
# at x, v is given in its first row. With `with_account`, ledger gets what was dissipated and put in [J].
take_step = by_net(rope=step_rope, grid=step_any, lines=step_any)


@kernel(inline=True)
def end_step(method, x, t, p, stages, xn, vn, with_account, ledger):
    """End a step from x to xn, vn at time t [s] before a strand passes another; returns the force evaluations."""
    remember_places(x, p, False)
    if not keep_apart(xn, vn, t, p, with_account, ledger):
        return 0
    accelerate_all(xn, vn, t, p, stages.f, stages.a)
    copy(stages.a, np.uint64(0), np.uint64(x.shape[0]), stages.k, np.uint64(method.stages * stages.stride))
    return 1


@kernel(noalias=True, allocates=False)
def accept(method, x, v, stages, xn, vn):
    """The new state becomes the old one."""
    zero, size = np.uint64(0), np.uint64(x.shape[0])
    k, last = stages.k, np.uint64(method.stages * stages.stride)
    copy(xn, zero, size, x, zero)
    copy(vn, zero, size, v, zero)
    for j in range(size):
        k[j] = k[last + j]


@kernel
def take_steps(method, x, v, ledger, t, h, steps, p, with_account):
    """`steps` steps of h [s] from t; returns the force evaluations."""
    stages = make_stages(method, x, p)
    xn, vn = np.empty_like(x), np.empty_like(x)
    set_pins(x, v, t, p)
    accelerate(x, v, t, p, True, stages.f, stages.a)
    copy(stages.a, np.uint64(0), np.uint64(x.shape[0]), stages.k, np.uint64(0))
    evals = 1 + method.stages * steps
    for s in range(steps):
        take_step(method, x, v, t + s * h, h, p, stages, xn, vn, ledger, with_account)
        evals += end_step(method, x, t + (s + 1) * h, p, stages, xn, vn, with_account, ledger)
        accept(method, x, v, stages, xn, vn)
    return evals
