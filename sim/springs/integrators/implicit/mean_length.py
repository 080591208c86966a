"""The forces that keep an implicit midpoint step's energy: each link's tension is that of its mean length.

Taken at the midpoint positions, a stiff link that turns by an angle in a step is pressed, cos(angle/2) of its length,
and the work that its force does is not what its spring takes up: energy grows without bound, however exactly the step
is solved (Gonzalez & Simo 1996). With the mean l of its lengths l0' before and l1 after in place of that length,

    F = k (1 - l0/l) r_m,

its work is k/2 (l1 - l0)^2 - k/2 (l0' - l0)^2 exactly, as r_m is half the sum of r before and after
(LaBudde & Greenspan 1976, Simo & Tarnow 1992). Where a link does not turn the two are one.
"""

import math

from sim.jit import kernel
from sim.springs.forces.links import TINY
from sim.springs.integrators.implicit.blocks import least_across, set_link_blocks
from sim.springs.net import by_net, link_ratio


@kernel(inline=True)
def lengths(x0, x, n, a, c):
    """Of the link from a to c, from its start x0 and its middle x: r, its length, and its end and mean length."""
    rx, ry, rz = x[c] - x[a], x[n + c] - x[n + a], x[2 * n + c] - x[2 * n + a]
    sx, sy, sz = x0[c] - x0[a], x0[n + c] - x0[n + a], x0[2 * n + c] - x0[2 * n + a]
    ex, ey, ez = 2.0 * rx - sx, 2.0 * ry - sy, 2.0 * rz - sz
    end = math.sqrt(ex * ex + ey * ey + ez * ez + TINY)
    mean = 0.5 * (math.sqrt(sx * sx + sy * sy + sz * sz + TINY) + end)
    return rx, ry, rz, math.sqrt(rx * rx + ry * ry + rz * rz + TINY), ex / end, ey / end, ez / end, mean


@kernel(noalias=True, allocates=False)
def add_mean_lengths(x0, x, p, a):
    """a += change of the accelerations by the mean lengths at the midpoint x of a step from x0."""
    n = p.rows * p.cols
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        rest, k = p.links[r, 0], p.links[r, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                b = i * p.cols + j
                c = b + di * p.cols + dj
                rx, ry, rz, length, _, _, _, mean = lengths(x0, x, n, b, c)
                s = link_ratio(p, r, i, j) * k * rest * (mean - length) / (mean * length)
                wb, wc = s * p.inverse_masses[b], s * p.inverse_masses[c]
                a[b] += wb * rx
                a[n + b] += wb * ry
                a[2 * n + b] += wb * rz
                a[c] -= wc * rx
                a[n + c] -= wc * ry
                a[2 * n + c] -= wc * rz


@kernel(noalias=True, allocates=False)
def set_rope_mean_blocks(x0, x, g, p, links):
    """H = g b (I or n n^T) + g^2 k [(1 - l0/l) I + l0/l^2 r_m n1^T] of every link, n1 its direction at the end."""
    n = p.cols
    for j in range(n - 1):
        rest, k, b = p.links[0, 0], p.links[0, 1], p.links[0, 2]
        rx, ry, rz, length, ex, ey, ez, mean = lengths(x0, x, n, j, j + 1)
        rx, ry, rz = rx / length, ry / length, rz / length
        whole = g * g * k * (1.0 - rest / mean)
        across = max(whole, least_across(p, j, j + 1))
        # Along the link nothing is cut off.
        along = whole - across
        if p.axial:
            along += g * b
        else:
            across += g * b
        s = g * g * k * rest * length / (mean * mean)
        links[j] = across
        links[j + n], links[j + 2 * n], links[j + 3 * n] = s * ex + along * rx, s * ey + along * ry, s * ez + along * rz
        links[j + 4 * n], links[j + 5 * n], links[j + 6 * n] = rx, ry, rz


@kernel(inline=True)
def set_net_blocks(x0, x, g, p, links):
    """A net takes the symmetric blocks of the tension at the midpoint, which conjugate gradients can solve with.

    Newton's method then needs about as many corrections as with the exact blocks, each with half the products.
    """
    set_link_blocks(x, g, p, links)


set_mean_blocks = by_net(rope=set_rope_mean_blocks, grid=set_net_blocks)
