"""The estimated error of a step, from the rows of a tableau beyond its new state."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.integrators.embedded.stages import add_four

CHUNK = 256  # numbers at a time, which stay in the fastest cache


@kernel(noalias=True, inline=True)
def clear(xs, vs, n):
    for j in range(n):
        xs[j] = 0.0
        vs[j] = 0.0


@kernel(noalias=True, inline=True)
def squares(x, v, xn, vn, o, n, xs, vs, rtol, atol):
    """Sum of the squares of the errors in xs and vs over atol + rtol |value|."""
    total = 0.0
    for j in range(n):
        ex = xs[j] / (atol + rtol * max(abs(x[o + j]), abs(xn[o + j])))
        ev = vs[j] / (atol + rtol * max(abs(v[o + j]), abs(vn[o + j])))
        total += ex * ex + ev * ev
    return total


@kernel(noalias=True, allocates=False)
def estimate(method, i, x, v, h, stages, xn, vn, rtol, atol):
    """The sum of squares of row i, divided by h^2."""
    m, zero = np.uint64(stages.stride), np.uint64(0)
    k, xs, vs = stages.k, stages.xs, stages.vs
    t, a, g = method.terms, method.a, method.g
    total = 0.0
    for start in range(0, x.shape[0], CHUNK):
        o = np.uint64(start)
        n = np.uint64(min(CHUNK, x.shape[0] - start))
        clear(xs, vs, n)
        for q in range(0, method.counts[i], 4):
            add_four(
                k, t[i, q] * m + o, t[i, q + 1] * m + o, t[i, q + 2] * m + o, t[i, q + 3] * m + o,
                a[i, q], a[i, q + 1], a[i, q + 2], a[i, q + 3],
                h * g[i, q], h * g[i, q + 1], h * g[i, q + 2], h * g[i, q + 3],
                n, zero, xs, vs,
            )  # fmt: skip
        total += squares(x, v, xn, vn, o, n, xs, vs, rtol, atol)
    return total


@kernel(allocates=False)
def error_of(method, x, v, h, stages, xn, vn, rtol, atol):
    """The step's error over what is allowed, root mean square over positions and velocities.

    Where there are two estimates the second, of third order, goes in the denominator (Solving ODEs I, II.10.17).
    """
    first = method.stages + 1
    two = method.counts.shape[0] > first + 1
    sum0 = estimate(method, first, x, v, h, stages, xn, vn, rtol, atol)
    if not two:
        return abs(h) * math.sqrt(sum0 / (2 * x.shape[0]))
    sum1 = estimate(method, first + 1, x, v, h, stages, xn, vn, rtol, atol)
    both = sum0 + 0.01 * sum1
    # Written so that a NaN stays one.
    return 0.0 if both == 0.0 else abs(h) * sum0 / math.sqrt(both * 2 * x.shape[0])
