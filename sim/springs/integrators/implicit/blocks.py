"""The matrix of an implicit step, M + g D + g^2 K, as 3 x 3 blocks: one a link and one a particle.

A particle's block is its six numbers xx, xy, xz, yy, yz, zz. A link's block H, which stands for [H -H; -H H], is
c I + p q^T in the numbers c, q and, of a rope where it is not symmetric, p. Number e of point j is at index j + e n.
Where links are pressed the geometric part of K is negative; it is kept while the whole stays positive definite by
Gershgorin's discs, so that Newton's method is exact for short steps, and cut off there for long ones.
"""

import math

from sim.jit import kernel
from sim.springs.arrays import mass_at
from sim.springs.each_link import acting_damping, each_link, stretch
from sim.springs.forces import each
from sim.springs.forces.links import linearised

KEPT = 0.4  # part of the mass that pressed links may take from a particle


SYMMETRIC, GENERAL = 4, 7  # numbers of a link's block


@kernel(inline=True)
def least_across(p, a, b):
    """Lower bound of the c of a compressed link from a to b [kg], without its damping."""
    return -KEPT * min(mass_at(p, a), mass_at(p, b)) / (2.0 * p.offsets.shape[0])


@each_link()
def set_link_blocks(link, x, g, p, links):
    """H = g b (I or n n^T) + g^2 [T' n n^T + T/l (I - n n^T)] of every link, at its first end."""
    rx, ry, rz, length = stretch(x, p, link)
    damping = g * acting_damping(link, length)
    along, turning = linearised(link.law, link.stiffness, link.rest, length)
    across = max(g * g * turning, least_across(p, link.a, link.b))
    if not p.axial:
        across += damping
    s = math.sqrt(max(0.0, g * g * along + damping - across)) / length
    n = p.rows * p.cols
    at = SYMMETRIC * n * link.family + link.a
    links[at], links[at + n], links[at + 2 * n], links[at + 3 * n] = across, s * rx, s * ry, s * rz


coupled_size = each("coupled_size", "p", "count", inline=True)
set_coupled = each("set_coupled", "x, v, g, p, coupled", "placed", allocates=False)
add_coupled = each("add_coupled", "p, coupled, points", "placed", allocates=False)
multiply_coupled = each("multiply_coupled", "p, coupled, u, q", "placed", allocates=False)
add_blocks = each("blocks", "x, v, t, g, p, points", "none", allocates=False)


@kernel(allocates=False)
def set_point_blocks(x, v, t, g, p, points):
    """M + g D + g^2 K about x, v, less the share of links, of pairs that touch and of air."""
    n = p.rows * p.cols
    for j in range(points.shape[0]):
        points[j] = 0.0
    for j in range(n):
        for e in (0, 3, 5):
            points[j + e * n] = mass_at(p, j)
    add_blocks(x, v, t, g, p, points)


@each_link(noalias=True)
def add_links_to_points(link, p, links, points):
    """Each link's block onto the blocks of both its ends: the matrix's own diagonal, of a net."""
    n = p.rows * p.cols
    at = SYMMETRIC * n * link.family + link.a
    qx, qy, qz = links[at + n], links[at + 2 * n], links[at + 3 * n]
    xx, yy, zz = links[at] + qx * qx, links[at] + qy * qy, links[at] + qz * qz
    xy, xz, yz = qx * qy, qx * qz, qy * qz
    for m in (link.a, link.b):
        points[m] += xx
        points[n + m] += xy
        points[2 * n + m] += xz
        points[3 * n + m] += yy
        points[4 * n + m] += yz
        points[5 * n + m] += zz
