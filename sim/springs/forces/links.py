"""The force of a row of links, the inner loop of every net, and its linearisation."""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.laws import damps, force_density, stiffness

TINY = 1e-300  # [m^2] under the root: coincident points get no spring force instead of 0/0


@kernel(noalias=True, inline=True)
def link_forces(x, v, f, ia, ib, of, n, N, M, law, k, b, rest, axial):
    """Force on the first end of n links, (ia, ib), (ia + 1, ib + 1), ...: F = T(|r|) r/|r| - b v_rel (lab eq. 4).

    Written to f (3 M,) from index `of` of each component. Isotropic damping acts on the whole relative velocity, as the
    lab has it; axial on its part along the link.
    """
    if axial:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            rr = rx * rx + ry * ry + rz * rz + TINY
            closing = (v[q] - v[p]) * rx + (v[N + q] - v[N + p]) * ry + (v[N + N + q] - v[N + N + p]) * rz
            length = math.sqrt(rr)
            s = force_density(law, k, rest, length) + (b * closing / rr if damps(law, rest, length) else 0.0)
            f[of + j] = s * rx
            f[M + of + j] = s * ry
            f[M + M + of + j] = s * rz
    elif b == 0.0:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            s = force_density(law, k, rest, math.sqrt(rx * rx + ry * ry + rz * rz + TINY))
            f[of + j] = s * rx
            f[M + of + j] = s * ry
            f[M + M + of + j] = s * rz
    else:
        for j in range(n):
            p, q = ia + j, ib + j
            rx, ry, rz = x[q] - x[p], x[N + q] - x[N + p], x[N + N + q] - x[N + N + p]
            length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
            s, c = force_density(law, k, rest, length), b if damps(law, rest, length) else 0.0
            f[of + j] = s * rx + c * (v[q] - v[p])
            f[M + of + j] = s * ry + c * (v[N + q] - v[N + p])
            f[M + M + of + j] = s * rz + c * (v[N + N + q] - v[N + N + p])


@kernel(inline=True)
def linearised(law, k, rest, length):
    """(along, across) [N/m] of the link's K = along n n^T + across (I - n n^T): its tension's slope, and how it turns.

    A pressed link buckles: across is negative, without bound as its ends meet. The caller limits it to what it can use.
    """
    return stiffness(law, k, rest, length), force_density(law, k, rest, length)


@kernel(noalias=True, inline=True)
def scale_ends(f, of, n, M, s):
    """Multiply the forces of the first and the last of n links, f (3 M,) from index `of` of each component."""
    last = of + n - np.uint64(1)
    for e in range(3):
        f[np.uint64(e) * M + of] *= s
        f[np.uint64(e) * M + last] *= s
