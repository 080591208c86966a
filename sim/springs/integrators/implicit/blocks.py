"""The matrix of an implicit step, M + g D + g^2 K, as 3 x 3 blocks: one a link and one a particle.

A particle's block is its six numbers xx, xy, xz, yy, yz, zz. A link's block H, which stands for [H -H; -H H], is
c I + p q^T in the numbers c, q and, of a rope where it is not symmetric, p. Number e of point j is at index j + e n.
For compressed links the geometric part of K is negative. Of a rope it is kept while the whole stays positive
definite by Gershgorin's discs, so that Newton's method is exact for short steps, and cut off there for long ones. Of
other nets it is left out: the matrix resists no less than the forces do, and a quasi-Newton method learns the rest.
"""

import math

from sim.jit import kernel
from sim.springs.forces import each
from sim.springs.forces.links import linearised
from sim.springs.points.arrays import by_net, mass_at
from sim.springs.points.each_link import acting_damping, each_link, stretch

KEPT = 0.4  # part of the mass that compressed links may take from a particle


SYMMETRIC, GENERAL = 4, 7  # numbers of a link's block


@kernel(inline=True)
def least_of_rope(p, a, b):
    return -KEPT * min(mass_at(p, a), mass_at(p, b)) / (2.0 * p.offsets.shape[0])


# Lower bound of the c of a compressed link from a to b [kg], without its damping.
least_across = by_net(rope=least_of_rope, grid=kernel(lambda p, a, b: 0.0, inline=True))


@each_link()
def set_link_blocks(link, x, g, p, links):
    """H = g b (I or n n^T) + g^2 [T' n n^T + T/l (I - n n^T)] of every link, at its first end.

    Damping that is limited by the tension counts whole: the matrix resists no less than the forces do, and such a link
    costs a few corrections more.
    """
    rx, ry, rz, length = stretch(x, p, link)
    damping = g * acting_damping(link, length, 0.0)
    along, turning = linearised(link.law, link.stiffness, link.rest, length)
    across = max(g * g * turning, least_across(p, link.a, link.b))
    if not p.axial:
        across += damping
    s = math.sqrt(max(0.0, g * g * along + damping - across)) / length
    n = p.rows * p.cols
    at = SYMMETRIC * n * link.family + link.a
    links[at], links[at + n], links[at + 2 * n], links[at + 3 * n] = across, s * rx, s * ry, s * rz


add_blocks = each("blocks", "x, v, t, g, p, points", "none", allocates=False)


@kernel(allocates=False)
def set_point_blocks(x, v, t, g, p, points):
    """M + g D + g^2 K about x, v, less the parts of links, of pairs that touch and of air."""
    n = p.rows * p.cols
    for j in range(points.shape[0]):
        points[j] = 0.0
    for j in range(n):
        for e in (0, 3, 5):
            points[j + e * n] = mass_at(p, j)
    add_blocks(x, v, t, g, p, points)


add_pair_blocks = each("pair_blocks", "x, v, t, g, p, pairs", "none", allocates=False)


@kernel(allocates=False)
def set_pair_blocks(x, v, t, g, p, pairs):
    """g D + g^2 K between the ends of a rope's links that no link's own block holds: that of their contact."""
    if p.links_touch:
        for j in range(pairs.shape[0]):
            pairs[j] = 0.0
        add_pair_blocks(x, v, t, g, p, pairs)


@kernel(noalias=True, inline=True)
def add_pairs(p, pairs, beside):
    """Add the blocks of `set_pair_blocks` between free points to those of a rope."""
    n = p.cols
    for j in range(n - 1):
        if p.inverse_masses[j] > 0.0 and p.inverse_masses[j + 1] > 0.0:
            xx, xy, xz = pairs[j], pairs[n + j], pairs[2 * n + j]
            yy, yz, zz = pairs[3 * n + j], pairs[4 * n + j], pairs[5 * n + j]
            beside[j, 0] += xx
            beside[j, 1] += xy
            beside[j, 2] += xz
            beside[j, 3] += xy
            beside[j, 4] += yy
            beside[j, 5] += yz
            beside[j, 6] += xz
            beside[j, 7] += yz
            beside[j, 8] += zz


@kernel(noalias=True, allocates=False)
def set_rope_blocks(p, points, links, pairs, numbers, diagonal, beside):
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
    if p.links_touch:
        add_pairs(p, pairs, beside)
    for j in range(n):
        if p.inverse_masses[j] == 0.0:
            for e in range(9):
                diagonal[j, e] = p.mass[j] if e % 4 == 0 else 0.0


@kernel(inline=True)
def add_six(out, o, xx, xy, xz, yy, yz, zz):
    out[o] += xx
    out[o + 1] += xy
    out[o + 2] += xz
    out[o + 3] += yy
    out[o + 4] += yz
    out[o + 5] += zz


@kernel(allocates=False)
def set_near_blocks(p, links, points, diagonal, beside):
    """The matrix with links between neighbours on the grid alone, for `sim.springs.integrators.implicit.dissection`.

    A link that passes over particles along a line of the grid stands on each step of that line, as much stiffer as it
    has steps: together they resist no less than it does. Other links stand at their ends alone, doubled. diagonal:
    (n, 6) flat. beside: (n, 4, 6) flat.
    """
    n, cols = p.rows * p.cols, p.cols
    for j in range(beside.shape[0]):
        beside[j] = 0.0
    for j in range(n):
        for e in range(6):
            diagonal[6 * j + e] = points[e * n + j]
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        steps = max(abs(di), abs(dj))
        near = di % steps == 0 and dj % steps == 0
        si, sj = (di // steps, dj // steps) if near else (di, dj)
        times = steps if near else 2
        way = 0 if si == 0 else 1 if sj == 0 else 2 if sj > 0 else 3
        for i in range(p.rows - di):
            for j in range(max(0, -dj), cols - max(0, dj)):
                a = i * cols + j
                at = SYMMETRIC * n * r + a
                c, qx, qy, qz = times * links[at], links[at + n], links[at + 2 * n], links[at + 3 * n]
                ux, uy, uz = times * qx, times * qy, times * qz
                xx, xy, xz, yy, yz, zz = c + ux * qx, ux * qy, ux * qz, c + uy * qy, uy * qz, c + uz * qz
                for _ in range(steps if near else 1):
                    b = a + si * cols + sj
                    add_six(diagonal, 6 * a, xx, xy, xz, yy, yz, zz)
                    add_six(diagonal, 6 * b, xx, xy, xz, yy, yz, zz)
                    if near:
                        add_six(beside, 6 * (4 * a + way), xx, xy, xz, yy, yz, zz)
                    a = b
