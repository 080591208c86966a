"""The matrix of an implicit step, M + g D + g^2 K, as 3 x 3 blocks: one a link and one a particle.

A particle's block is its six numbers xx, xy, xz, yy, yz, zz. A link's block H, which stands for [H -H; -H H], is
c I + p q^T in the numbers c, q and, where it is not symmetric, p. Number e of point j is at index j + e n.
Where links are pressed the geometric part of K is negative; it is kept while the whole stays positive definite by
Gershgorin's discs, so that Newton's method is exact for short steps, and cut off there for long ones.
"""

import math

from sim.jit import kernel
from sim.springs.forces.contact import surface_velocity, touching
from sim.springs.forces.links import TINY

KEPT = 0.4  # part of the mass that pressed links may take from a particle


SYMMETRIC, GENERAL = 4, 7  # numbers of a link's block


@kernel(inline=True)
def add_block(blocks, j, n, along, across, nx, ny, nz):
    """Particle j's block += across I + (along - across) n n^T."""
    s = along - across
    blocks[j] += across + s * nx * nx
    blocks[j + n] += s * nx * ny
    blocks[j + 2 * n] += s * nx * nz
    blocks[j + 3 * n] += across + s * ny * ny
    blocks[j + 4 * n] += s * ny * nz
    blocks[j + 5 * n] += across + s * nz * nz


@kernel(inline=True)
def least_across(p):
    """What a pressed link's c may fall to [kg], beside its damping."""
    return -KEPT * p.mass / (2.0 * p.offsets.shape[0])


@kernel(allocates=False)
def set_link_blocks(x, g, p, links):
    """H = g b (I or n n^T) + g^2 k [n n^T + (1 - l0/l) (I - n n^T)] of every link, at its first end."""
    n = p.rows * p.cols
    least = least_across(p)
    for j in range(links.shape[0]):
        links[j] = 0.0
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        rest, k, b = p.links[r, 0], p.links[r, 1], p.links[r, 2]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                rx, ry, rz = x[c] - x[a], x[n + c] - x[n + a], x[2 * n + c] - x[2 * n + a]
                length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
                across = max(g * g * k * (1.0 - rest / length), least)
                if not p.axial:
                    across += g * b
                s = math.sqrt(max(0.0, g * g * k + g * b - across)) / length
                at = SYMMETRIC * n * r + a
                links[at], links[at + n], links[at + 2 * n], links[at + 3 * n] = across, s * rx, s * ry, s * rz


@kernel(allocates=False)
def add_surface_blocks(x, v, t, g, p, on_sphere, points):
    """Touching points: g^2 k n n^T, their damping, and friction as the secant of its force over the sliding speed."""
    n = p.rows * p.cols
    su, sv, sw = surface_velocity(p, on_sphere)
    for j in range(n):
        depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
        if depth <= 0.0:
            continue
        b = p.contact_b
        ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
        vn = ru * nx + rv * ny + rw * nz
        along, across = g * g * p.contact_k, 0.0
        if p.lab_contact:
            across = g * b * (depth if on_sphere else 1.0)
            along += across
        else:
            normal = p.contact_k * depth - b * vn
            if normal <= 0.0:
                continue
            along += g * b
            speed = math.sqrt((ru - vn * nx) ** 2 + (rv - vn * ny) ** 2 + (rw - vn * nz) ** 2)
            if p.friction > 0.0:
                across = g * min(p.mass * p.stop_rate, p.friction * normal / (speed + TINY))
        add_block(points, j, n, along, across, nx, ny, nz)


@kernel(allocates=False)
def add_pull_block(x, g, p, points):
    """The grab: k I within reach, (F/r) (I - n n^T) beyond."""
    n, j = p.rows * p.cols, p.grabbed
    dx, dy, dz = p.grab_x - x[j], p.grab_y - x[n + j], p.grab_z - x[2 * n + j]
    r = math.sqrt(dx * dx + dy * dy + dz * dz) + TINY
    along = across = g * p.grab_b + g * g * p.grab_k
    if p.grab_k * r > p.grab_max:
        along = g * p.grab_b
        across = along + g * g * p.grab_max / r
    add_block(points, j, n, along, across, dx / r, dy / r, dz / r)


@kernel(allocates=False)
def set_point_blocks(x, v, t, g, p, points):
    """M + g D + g^2 K about x, v, less the links' share."""
    n = p.rows * p.cols
    alone = p.mass + g * p.drag
    for j in range(points.shape[0]):
        points[j] = 0.0
    for j in range(n):
        for e in (0, 3, 5):
            points[j + e * n] = alone
    if p.has_floor:
        add_surface_blocks(x, v, t, g, p, False, points)
    if p.has_sphere:
        add_surface_blocks(x, v, t, g, p, True, points)
    if p.grabbed >= 0:
        add_pull_block(x, g, p, points)


@kernel(noalias=True, allocates=False)
def add_links_to_points(p, links, numbers, points):
    """Each link's block, or its symmetric part, onto the blocks of both its ends: the matrix's own diagonal."""
    n = p.rows * p.cols
    left = numbers - 3
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                at = numbers * n * r + a
                qx, qy, qz = links[at + n], links[at + 2 * n], links[at + 3 * n]
                px, py, pz = links[at + left * n], links[at + (left + 1) * n], links[at + (left + 2) * n]
                xx, yy, zz = links[at] + px * qx, links[at] + py * qy, links[at] + pz * qz
                xy, xz, yz = 0.5 * (px * qy + py * qx), 0.5 * (px * qz + pz * qx), 0.5 * (py * qz + pz * qy)
                for m in (a, c):
                    points[m] += xx
                    points[n + m] += xy
                    points[2 * n + m] += xz
                    points[3 * n + m] += yy
                    points[4 * n + m] += yz
                    points[5 * n + m] += zz
