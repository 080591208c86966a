"""The matrix of an implicit step, M + g D + g^2 K, as 3 x 3 blocks: one a link and one a particle.

A particle's block is its six numbers xx, xy, xz, yy, yz, zz. A link's block H, which stands for [H -H; -H H], is
c I + p q^T in the numbers c, q and, of a rope where it is not symmetric, p. Number e of point j is at index j + e n.
Where links are pressed the geometric part of K is negative; it is kept while the whole stays positive definite by
Gershgorin's discs, so that Newton's method is exact for short steps, and cut off there for long ones.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces.contact import surface_velocity, touching
from sim.springs.forces.links import TINY, linearised
from sim.springs.forces.self_contact import refresh_pairs
from sim.springs.forces.wind import cell_areas
from sim.springs.laws import damps
from sim.springs.net import by_net, link_ratio, mass_at

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
def least_across(p, a, b):
    """Lower bound of the c of a compressed link from a to b [kg], without its damping."""
    return -KEPT * min(mass_at(p, a), mass_at(p, b)) / (2.0 * p.offsets.shape[0])


@kernel(allocates=False)
def set_link_blocks(x, g, p, links):
    """H = g b (I or n n^T) + g^2 [T' n n^T + T/l (I - n n^T)] of every link, at its first end."""
    n = p.rows * p.cols
    for j in range(links.shape[0]):
        links[j] = 0.0
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        rest = p.links[r, 0]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                rx, ry, rz = x[c] - x[a], x[n + c] - x[n + a], x[2 * n + c] - x[2 * n + a]
                length = math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
                ratio = link_ratio(p, r, i, j)
                b = ratio * p.links[r, 2] if damps(p.law, rest, length) else 0.0
                along, turning = linearised(p.law, ratio * p.links[r, 1], rest, length)
                across = max(g * g * turning, least_across(p, a, c))
                if not p.axial:
                    across += g * b
                s = math.sqrt(max(0.0, g * g * along + g * b - across)) / length
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
                across = g * min(mass_at(p, j) * p.stop_rate, p.friction * normal / (speed + TINY))
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


# A rope has no cells that catch air, and does not push itself.
no_numbers = kernel(lambda p: 0, inline=True)
set_no_blocks = kernel(lambda x, v, g, p, blocks: None, inline=True)

air_numbers = by_net(rope=no_numbers, grid=kernel(lambda p: 6 * p.rows * p.cols if p.has_air else 0, inline=True))


@kernel(allocates=False)
def set_cell_blocks(x, v, g, p, air):
    """Air: g times the symmetric part of the derivative of a cell's force by its velocity, with n fixed.

    rho/2 A [C_D |s| (I + n n^T) + C_L |u| (1 - s^2/u^2)^2 n n^T], s = u . n, at the cell's first particle. What turns
    the force is left out: it is not symmetric.
    """
    if not p.has_air:
        return
    n = p.rows * p.cols
    for j in range(air.shape[0]):
        air[j] = 0.0
    for i in range(p.rows - 1):
        for j in range(p.cols - 1):
            a = i * p.cols + j
            c = a + p.cols
            ax, ay, az = cell_areas(x, np.uint64(a), np.uint64(c), np.uint64(n))
            ux = p.wind_x - 0.25 * (v[a] + v[a + 1] + v[c] + v[c + 1])
            uy = p.wind_y - 0.25 * (v[n + a] + v[n + a + 1] + v[n + c] + v[n + c + 1])
            uz = p.wind_z - 0.25 * (v[2 * n + a] + v[2 * n + a + 1] + v[2 * n + c] + v[2 * n + c + 1])
            area = math.sqrt(ax * ax + ay * ay + az * az + TINY)
            speed = math.sqrt(ux * ux + uy * uy + uz * uz + TINY)
            head_on = abs(ux * ax + uy * ay + uz * az) / (area * speed)
            across = g * p.air_drag * area * speed * head_on
            along = 2.0 * across + g * p.air_lift * area * speed * (1.0 - head_on * head_on) ** 2
            add_block(air, a, n, along, across, ax / area, ay / area, az / area)


set_air_blocks = by_net(rope=set_no_blocks, grid=set_cell_blocks)


@kernel(allocates=False)
def add_air_to_points(p, air, points):
    """A sixteenth of each cell's block onto those of its corners.

    A corner moves the cell by a quarter of its own motion, and takes a quarter of the cell's force.
    """
    if not p.has_air:
        return
    n = p.rows * p.cols
    for i in range(p.rows - 1):
        for j in range(p.cols - 1):
            a = i * p.cols + j
            for m in (a, a + 1, a + p.cols, a + p.cols + 1):
                for e in range(6):
                    points[e * n + m] += air[e * n + a] / 16.0


@kernel(allocates=False)
def add_air_products(p, air, u, q):
    """q += the air's part of the matrix times u."""
    if not p.has_air:
        return
    n = p.rows * p.cols
    for i in range(p.rows - 1):
        for j in range(p.cols - 1):
            a = i * p.cols + j
            c = a + p.cols
            x = u[a] + u[a + 1] + u[c] + u[c + 1]
            y = u[n + a] + u[n + a + 1] + u[n + c] + u[n + c + 1]
            z = u[2 * n + a] + u[2 * n + a + 1] + u[2 * n + c] + u[2 * n + c + 1]
            fx = (air[a] * x + air[n + a] * y + air[2 * n + a] * z) / 16.0
            fy = (air[n + a] * x + air[3 * n + a] * y + air[4 * n + a] * z) / 16.0
            fz = (air[2 * n + a] * x + air[4 * n + a] * y + air[5 * n + a] * z) / 16.0
            for m in (a, a + 1, c, c + 1):
                q[m] += fx
                q[n + m] += fy
                q[2 * n + m] += fz


pair_numbers = by_net(rope=no_numbers, grid=kernel(lambda p: 3 * (p.pairs.shape[0] - 1), inline=True))


@kernel(allocates=False)
def set_touching_blocks(x, v, g, p, own):
    """Contact with itself: q of each pair's block q q^T = (g b + g^2 k) n n^T, 0 of those that do not push."""
    if p.thickness == 0.0:
        return
    n = p.rows * p.cols
    stiff = math.sqrt(g * p.contact_b + g * g * p.contact_k)
    for s in range(refresh_pairs(x, p)):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        dx, dy, dz = x[j] - x[i], x[n + j] - x[n + i], x[2 * n + j] - x[2 * n + i]
        r = math.sqrt(dx * dx + dy * dy + dz * dz + TINY)
        opening = ((v[j] - v[i]) * dx + (v[n + j] - v[n + i]) * dy + (v[2 * n + j] - v[2 * n + i]) * dz) / r
        pushes = r < p.thickness and p.contact_k * (p.thickness - r) > p.contact_b * opening
        q = stiff / r if pushes else 0.0
        own[3 * s], own[3 * s + 1], own[3 * s + 2] = q * dx, q * dy, q * dz


set_pair_blocks = by_net(rope=set_no_blocks, grid=set_touching_blocks)


@kernel(allocates=False)
def add_pairs_to_points(p, own, points):
    """Each pair's block onto the blocks of both its particles."""
    if p.thickness == 0.0:
        return
    n = p.rows * p.cols
    for s in range(p.pairs[p.pairs.shape[0] - 1, 0]):
        for e in range(2):
            add_block(points, p.pairs[s, e], n, 1.0, 0.0, own[3 * s], own[3 * s + 1], own[3 * s + 2])


@kernel(allocates=False)
def add_pair_products(p, own, u, q):
    """q += the pairs' part of the matrix times u."""
    if p.thickness == 0.0:
        return
    n = p.rows * p.cols
    for s in range(p.pairs[p.pairs.shape[0] - 1, 0]):
        i, j = p.pairs[s, 0], p.pairs[s, 1]
        qx, qy, qz = own[3 * s], own[3 * s + 1], own[3 * s + 2]
        closing = qx * (u[i] - u[j]) + qy * (u[n + i] - u[n + j]) + qz * (u[2 * n + i] - u[2 * n + j])
        q[i] += closing * qx
        q[n + i] += closing * qy
        q[2 * n + i] += closing * qz
        q[j] -= closing * qx
        q[n + j] -= closing * qy
        q[2 * n + j] -= closing * qz


@kernel(allocates=False)
def set_point_blocks(x, v, t, g, p, points):
    """M + g D + g^2 K about x, v, less the share of links, of pairs that touch and of air."""
    n = p.rows * p.cols
    for j in range(points.shape[0]):
        points[j] = 0.0
    for j in range(n):
        alone = mass_at(p, j) + g * p.drag
        for e in (0, 3, 5):
            points[j + e * n] = alone
    if p.has_floor:
        add_surface_blocks(x, v, t, g, p, False, points)
    if p.has_sphere:
        add_surface_blocks(x, v, t, g, p, True, points)
    if p.grabbed >= 0:
        add_pull_block(x, g, p, points)


@kernel(noalias=True, allocates=False)
def add_links_to_points(p, links, points):
    """Each link's block onto the blocks of both its ends: the matrix's own diagonal, of a net."""
    n = p.rows * p.cols
    for r in range(p.offsets.shape[0]):
        di, dj = p.offsets[r, 0], p.offsets[r, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                c = a + di * p.cols + dj
                at = SYMMETRIC * n * r + a
                qx, qy, qz = links[at + n], links[at + 2 * n], links[at + 3 * n]
                xx, yy, zz = links[at] + qx * qx, links[at] + qy * qy, links[at] + qz * qz
                xy, xz, yz = qx * qy, qx * qz, qy * qz
                for m in (a, c):
                    points[m] += xx
                    points[n + m] += xy
                    points[2 * n + m] += xz
                    points[3 * n + m] += yy
                    points[4 * n + m] += yz
                    points[5 * n + m] += zz
