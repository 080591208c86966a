"""The forces that keep an implicit midpoint step's energy: each link's tension is the mean of all its lengths.

Taken at the midpoint positions, a stiff link that turns by an angle in a step is pressed, cos(angle/2) of its length,
and the work that its force does is not what its spring takes up: energy grows without bound, however exactly the step
is solved (Gonzalez & Simo 1996). With its energy U and its lengths l0 before and l1 after, the force

    F = (U(l1) - U(l0))/(l1 - l0) r_m/l,  l = (l0 + l1)/2,

does the work U(l1) - U(l0) exactly, as r_m is half the sum of r before and after (LaBudde & Greenspan 1976). Of a
spring the first factor is the tension at l, and where it does not turn F is the force at the midpoint.
"""

import math

from sim.jit import kernel
from sim.springs.arrays import by_net, link_at, link_count, span
from sim.springs.forces.links import TINY
from sim.springs.integrators.implicit.blocks import least_across, set_link_blocks
from sim.springs.laws import damps, force_density, over_step


@kernel(inline=True)
def lengths(x0, x, n, a, c):
    """Of the link from a to c, from its start x0 and its middle x: r, its length, n1, its lengths before and after."""
    rx, ry, rz = span(x, n, a, c)
    sx, sy, sz = span(x0, n, a, c)
    ex, ey, ez = 2.0 * rx - sx, 2.0 * ry - sy, 2.0 * rz - sz
    end = math.sqrt(ex * ex + ey * ey + ez * ez + TINY)
    start = math.sqrt(sx * sx + sy * sy + sz * sz + TINY)
    return rx, ry, rz, math.sqrt(rx * rx + ry * ry + rz * rz + TINY), ex / end, ey / end, ez / end, start, end


@kernel(noalias=True, allocates=False)
def add_mean_lengths(x0, x, p, a):
    """a += change of the accelerations by the mean lengths at the midpoint x of a step from x0."""
    n = p.rows * p.cols
    for q in range(link_count(p)):
        b, c, rest, k, _ = link_at(p, q)
        rx, ry, rz, length, _, _, _, before, after = lengths(x0, x, n, b, c)
        s = over_step(p.law, k, rest, before, after)[0] - force_density(p.law, k, rest, length)
        wb, wc = s * p.inverse_masses[b], s * p.inverse_masses[c]
        a[b] += wb * rx
        a[n + b] += wb * ry
        a[2 * n + b] += wb * rz
        a[c] -= wc * rx
        a[n + c] -= wc * ry
        a[2 * n + c] -= wc * rz


@kernel(noalias=True, allocates=False)
def set_rope_mean_blocks(x0, x, g, p, links):
    """H = g b (I or n n^T) + g^2 [S I + 2 dS/dl1 r_m n1^T] of every link, F = S r_m and n1 its direction at the end."""
    n = p.cols
    for j in range(link_count(p)):
        _, _, rest, k, b = link_at(p, j)
        rx, ry, rz, length, ex, ey, ez, before, after = lengths(x0, x, n, j, j + 1)
        rx, ry, rz = rx / length, ry / length, rz / length
        pull, rise = over_step(p.law, k, rest, before, after)
        whole = g * g * pull
        across = max(whole, least_across(p, j, j + 1))
        # Along the link nothing is cut off.
        along = whole - across
        if damps(p.law, rest, length):
            along += g * b if p.axial else 0.0
            across += 0.0 if p.axial else g * b
        s = g * g * rise * length
        links[j] = across
        links[j + n], links[j + 2 * n], links[j + 3 * n] = s * ex + along * rx, s * ey + along * ry, s * ez + along * rz
        links[j + 4 * n], links[j + 5 * n], links[j + 6 * n] = rx, ry, rz


# A net takes the symmetric blocks of the tension at the midpoint, which conjugate gradients can solve with. Newton's
# method then needs about as many corrections as with the exact blocks, each with half the products.
set_net_blocks = kernel(lambda x0, x, g, p, links: set_link_blocks(x, g, p, links), inline=True)
set_mean_blocks = by_net(rope=set_rope_mean_blocks, grid=set_net_blocks)
