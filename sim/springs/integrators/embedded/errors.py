"""The estimated error of a step, from the rows of a tableau beyond its new state.

One pass over the state gives all estimates of a method: they sum the same stages and share the scale. It writes
nothing, so that it vectorises over many arrays.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.integrators.embedded.stages import TERMS_OF_ONE, TERMS_OF_TWO


@kernel(noalias=True, inline=True)
def scales(x, xn, v, vn, rtol, atol):
    """1 / (atol + rtol |value|) of a position and of a velocity, by one division."""
    sx, sv = atol + rtol * max(abs(x), abs(xn)), atol + rtol * max(abs(v), abs(vn))
    both = 1.0 / (sx * sv)
    return both * sv, both * sx


@kernel(noalias=True, allocates=False)
def estimate_one(method, i, x, v, h, stages, xn, vn, rtol, atol):
    """The sum of squares of the errors of row i over atol + rtol |value|, divided by h^2."""
    k, m, t, a, g = stages.k, np.uint64(stages.stride), method.terms, method.a, method.g
    total = 0.0
    for j in range(np.uint64(x.shape[0])):
        ex = ev = 0.0
        for q in range(np.uint64(TERMS_OF_ONE)):
            slope = k[t[i, q] * m + j]
            ex += g[i, q] * slope
            ev += a[i, q] * slope
        wx, wv = scales(x[j], xn[j], v[j], vn[j], rtol, atol)
        total += (h * wx * ex) ** 2 + (wv * ev) ** 2
    return total


@kernel(noalias=True, allocates=False)
def estimate_two(method, i, x, v, h, stages, xn, vn, rtol, atol):
    """The same of rows i and i + 1."""
    k, m, t, a, g = stages.k, np.uint64(stages.stride), method.terms, method.a, method.g
    one = np.uint64(1)
    first = second = 0.0
    for j in range(np.uint64(x.shape[0])):
        ex = ev = fx = fv = 0.0
        for q in range(np.uint64(TERMS_OF_TWO)):
            slope = k[t[i, q] * m + j]
            ex += g[i, q] * slope
            ev += a[i, q] * slope
            fx += g[i + one, q] * slope
            fv += a[i + one, q] * slope
        wx, wv = scales(x[j], xn[j], v[j], vn[j], rtol, atol)
        wx *= h
        first += (wx * ex) ** 2 + (wv * ev) ** 2
        second += (wx * fx) ** 2 + (wv * fv) ** 2
    return first, second


@kernel(allocates=False)
def error_of(method, x, v, h, stages, xn, vn, rtol, atol):
    """Ratio of the step's error to the tolerance, root mean square over positions and velocities.

    Where there are two estimates the second, of third order, goes in the denominator (Solving ODEs I, II.10.17).
    """
    row = np.uint64(method.stages + 1)
    two = method.counts.shape[0] > method.stages + 2
    if not two:
        return abs(h) * math.sqrt(estimate_one(method, row, x, v, h, stages, xn, vn, rtol, atol) / (2 * x.shape[0]))
    sum0, sum1 = estimate_two(method, row, x, v, h, stages, xn, vn, rtol, atol)
    both = sum0 + 0.01 * sum1
    # Written so that a NaN stays one.
    return 0.0 if both == 0.0 else abs(h) * sum0 / math.sqrt(both * 2 * x.shape[0])
