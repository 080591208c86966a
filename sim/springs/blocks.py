"""The matrix of an implicit step, M + g D + g^2 K, as symmetric 3 x 3 blocks: one a link and one a particle.

A block is its six numbers xx, xy, xz, yy, yz, zz; that of point j keeps number e at index j * stride + e * apart, so
that a rope has them side by side for its direct solver and a grid apart, to vectorise. A link's block H stands for
[H -H; -H H]. Where links are pressed the geometric part of K is negative; it is kept while the whole stays positive
definite by Gershgorin's discs, so that Newton's method is exact for short steps, and cut off there for long ones.
"""

import math

from sim.jit import kernel
from sim.springs.contact import surface_velocity, touching
from sim.springs.links import TINY

KEPT = 0.4  # part of the mass that pressed links may take from a particle


@kernel(inline=True)
def add_block(blocks, at, apart, along, across, nx, ny, nz):
    """blocks += across I + (along - across) n n^T."""
    s = along - across
    blocks[at] += across + s * nx * nx
    blocks[at + apart] += s * nx * ny
    blocks[at + 2 * apart] += s * nx * nz
    blocks[at + 3 * apart] += across + s * ny * ny
    blocks[at + 4 * apart] += s * ny * nz
    blocks[at + 5 * apart] += across + s * nz * nz


@kernel(allocates=False)
def set_link_blocks(x, g, p, stride, apart, links):
    """H = g b (I or n n^T) + g^2 k [n n^T + (1 - l0/l) (I - n n^T)] of every link, at its first end."""
    n = p.rows * p.cols
    families = p.offsets.shape[0]
    least = -KEPT * p.mass / (2.0 * families)
    for j in range(links.shape[0]):
        links[j] = 0.0
    for q in range(families):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, k, b = p.links[q, 0], p.links[q, 1], p.links[q, 2]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                rx, ry, rz = x[c] - x[a], x[n + c] - x[n + a], x[2 * n + c] - x[2 * n + a]
                length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
                across = max(g * g * k * (1.0 - rest / length), least)
                if not p.axial:
                    across += g * b
                at = 6 * n * q + a * stride
                add_block(
                    links, at, apart, g * g * k + g * b, across, rx / length, ry / length, rz / length
                )  # fmt: skip


@kernel(allocates=False)
def add_surface_blocks(x, v, t, g, p, on_sphere, stride, apart, points):
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
        add_block(points, j * stride, apart, along, across, nx, ny, nz)


@kernel(allocates=False)
def add_pull_block(x, g, p, stride, apart, points):
    """The grab: k I within reach, (F/r) (I - n n^T) beyond."""
    n, j = p.rows * p.cols, p.grabbed
    dx, dy, dz = p.grab_x - x[j], p.grab_y - x[n + j], p.grab_z - x[2 * n + j]
    r = math.sqrt(dx * dx + dy * dy + dz * dz) + TINY
    along = across = g * p.grab_b + g * g * p.grab_k
    if p.grab_k * r > p.grab_max:
        along = g * p.grab_b
        across = along + g * g * p.grab_max / r
    add_block(points, j * stride, apart, along, across, dx / r, dy / r, dz / r)


@kernel(allocates=False)
def set_blocks(x, v, t, g, p, stride, apart, points, links):
    """Blocks of M + g D + g^2 K about x, v: links without their share of the particles' blocks."""
    n = p.rows * p.cols
    set_link_blocks(x, g, p, stride, apart, links)
    alone = p.mass + g * p.drag
    for j in range(points.shape[0]):
        points[j] = 0.0
    for j in range(n):
        for e in (0, 3, 5):
            points[j * stride + e * apart] = alone
    if p.has_floor:
        add_surface_blocks(x, v, t, g, p, False, stride, apart, points)
    if p.has_sphere:
        add_surface_blocks(x, v, t, g, p, True, stride, apart, points)
    if p.grabbed >= 0:
        add_pull_block(x, g, p, stride, apart, points)


@kernel(noalias=True, allocates=False)
def add_links_to_points(p, stride, apart, points, links):
    """Each link's block onto the blocks of both its ends: the matrix's true diagonal."""
    n = p.rows * p.cols
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                for e in range(6):
                    h = links[6 * n * q + a * stride + e * apart]
                    points[a * stride + e * apart] += h
                    points[c * stride + e * apart] += h
