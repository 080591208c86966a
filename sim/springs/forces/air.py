"""Aerodynamic drag and lift on a cloth's cells.

A cell is the two triangles between four particles; whichever diagonal splits it, their area vectors add up to half
the cross product of its diagonals, so the force keeps the symmetries of a square. Each corner takes a quarter.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.forces.matrices import add_block
from sim.springs.forces.record import WIDE_NETS, Force
from sim.springs.points.arrays import by_net
from sim.springs.points.vector_ops import add_scaled, set_sum

STILL = 1e-300  # under the roots: no air or no area gives no force instead of 0/0


@kernel(inline=True)
def cell_room(p):
    """Numbers of one component of the forces on the cells: one a particle, and zeros before and after."""
    return p.rows * p.cols + p.cols + 1


@kernel(inline=True)
def wind_scratch_size(p):
    """Numbers that the forces on the cells take at the end of the scratch."""
    return 3 * cell_room(p) if p.has_air else 0


@kernel(inline=True)
def cell_areas(x, a, c, n):
    """Area vector [m^2] of the cell that begins with the particles a and, a row on, c."""
    one = np.uint64(1)
    b, d = a + one, c + one
    px, py, pz = x[d] - x[a], x[n + d] - x[n + a], x[n + n + d] - x[n + n + a]
    qx, qy, qz = x[c] - x[b], x[n + c] - x[n + b], x[n + n + c] - x[n + n + b]
    return 0.5 * (py * qz - pz * qy), 0.5 * (pz * qx - px * qz), 0.5 * (px * qy - py * qx)


@kernel(noalias=True, inline=True)
def set_cell_forces(x, v, cols, count, n, m, wind_x, wind_y, wind_z, drag, lift, f, of):
    """Force [N] on the cells of the first `count` particles: rho/2 A s [C_D u + C_L (|u| n - s u/|u|)], s = |u . n|.

    To f (3, m) from `of`. What begins at the last particle of a row is no cell: the caller clears it.
    """
    one = np.uint64(1)
    for a in range(count):
        c = a + cols
        b, d = a + one, c + one
        ax, ay, az = cell_areas(x, a, c, n)
        ux = wind_x - 0.25 * (v[a] + v[b] + v[c] + v[d])
        uy = wind_y - 0.25 * (v[n + a] + v[n + b] + v[n + c] + v[n + d])
        uz = wind_z - 0.25 * (v[n + n + a] + v[n + n + b] + v[n + n + c] + v[n + n + d])
        flow = ux * ax + uy * ay + uz * az  # A u . n
        area = math.sqrt(ax * ax + ay * ay + az * az + STILL)
        speed = math.sqrt(ux * ux + uy * uy + uz * uz + STILL)
        s = abs(flow) / area
        along = abs(flow) * (drag - lift * s / speed)
        normal = flow / area * lift * speed
        f[of + a] = along * ux + normal * ax
        f[of + m + a] = along * uy + normal * ay
        f[of + m + m + a] = along * uz + normal * az


@kernel(noalias=True, inline=True)
def add_quarters(f, of, cols, n, w, a, o):
    """Give each of n particles a quarter of the force on each of its four cells."""
    one = np.uint64(1)
    for j in range(n):
        i = of + j
        a[o + j] += 0.25 * w[j] * (f[i] + f[i - one] + f[i - cols] + f[i - cols - one])


@kernel(noalias=True, allocates=False)
def accelerate(x, v, t, p, with_damping, f, a):
    """All of it is damping. f: scratch; its last (wind_scratch_size,) are free, but 0 where no cell is.

    All cells are computed in one loop, as the rows of most cloths are short.
    """
    if not with_damping:
        return
    n, m, cols = np.uint64(p.rows * p.cols), np.uint64(cell_room(p)), np.uint64(p.cols)
    first = np.uint64(f.shape[0] - wind_scratch_size(p) + p.cols + 1)
    count = np.uint64((p.rows - 1) * p.cols - 1)
    set_cell_forces(x, v, cols, count, n, m, p.wind_x, p.wind_y, p.wind_z, p.air_drag, p.air_lift, f, first)
    for e in range(3):
        of = first + np.uint64(e) * m
        for i in range(1, p.rows - 1):
            f[of + np.uint64(i * p.cols - 1)] = 0.0
        add_quarters(f, of, cols, n, p.inverse_masses, a, np.uint64(e) * n)


@kernel
def power(x, v, t, p, with_damping):
    """(dissipated, put in) [W] by the air on the free particles: the wind does the work of its force at its own speed.

    The difference is what the particles get. In still air all is dissipated.
    """
    work = gained = 0.0
    if not with_damping:
        return gained, work
    n = p.rows * p.cols
    a = np.zeros(v.shape[0])
    accelerate(x, v, t, p, True, np.zeros(wind_scratch_size(p)), a)
    for j in range(n):
        work += p.mass[j] * (a[j] * p.wind_x + a[n + j] * p.wind_y + a[2 * n + j] * p.wind_z)
        gained += p.mass[j] * (a[j] * v[j] + a[n + j] * v[n + j] + a[2 * n + j] * v[2 * n + j])
    return work - gained, work


@kernel(noalias=True, allocates=False)
def blow(x, v, s, p, f, a, middle, with_account, ledger):
    """The air's push for a time s [s], by the explicit midpoint rule; books its work and dissipation.

    The wind does the work of its force at its own speed; what the particles do not get of it is dissipated.
    a, middle: scratch (3 rows cols,); f: of `make_scratch`.
    """
    if not p.has_air:
        return
    for j in range(v.shape[0]):
        a[j] = 0.0
    accelerate(x, v, 0.0, p, True, f, a)
    set_sum(middle, v, 0.5 * s, a)
    for j in range(v.shape[0]):
        a[j] = 0.0
    accelerate(x, middle, 0.0, p, True, f, a)
    if not with_account:
        add_scaled(v, s, a)
        return
    n = p.rows * p.cols
    work = gained = 0.0
    for e in range(3):
        wind = p.wind_x if e == 0 else p.wind_y if e == 1 else p.wind_z
        for j in range(n):
            i = e * n + j
            change = s * a[i]  # 0 where pinned
            work += p.mass[j] * change * wind
            gained += p.mass[j] * change * (v[i] + 0.5 * change)
            v[i] += change
    ledger[0] += work - gained
    ledger[1] += work


drift_rope = kernel(lambda x, v, h, p, f, a, middle, with_account, ledger: add_scaled(x, h, v), inline=True)


@kernel(noalias=True, inline=True)
def drift_wide(x, v, h, p, f, a, middle, with_account, ledger):
    if p.has_air:
        add_scaled(x, 0.5 * h, v)
        blow(x, v, h, p, f, a, middle, with_account, ledger)
        add_scaled(x, 0.5 * h, v)
    else:
        add_scaled(x, h, v)


# x += h v; where there is air, it pushes in the middle.
drift = by_net(rope=drift_rope, grid=drift_wide, lines=drift_rope, strand=drift_rope)

no_size = kernel(lambda x, p: 0, inline=True)
wide_size = kernel(lambda x, p: x.shape[0] if p.has_air else 0, inline=True)
air_scratch_size = by_net(rope=no_size, grid=wide_size, lines=no_size, strand=no_size)


@kernel(allocates=False)
def blocks(x, v, t, g, p, points):
    """g times the symmetric part of the derivative of each cell's force by its velocity, with n fixed, at its corners.

    rho/2 A [C_D |s| (I + n n^T) + C_L |u| (1 - s^2/u^2)^2 n n^T], s = u . n, a quarter at each corner: where all four
    move alike they resist as much as the cell does, else more. What turns the force is left out: it is not symmetric.
    """
    n = p.rows * p.cols
    for i in range(p.rows - 1):
        for j in range(p.cols - 1):
            a = i * p.cols + j
            c = a + p.cols
            ax, ay, az = cell_areas(x, np.uint64(a), np.uint64(c), np.uint64(n))
            ux = p.wind_x - 0.25 * (v[a] + v[a + 1] + v[c] + v[c + 1])
            uy = p.wind_y - 0.25 * (v[n + a] + v[n + a + 1] + v[n + c] + v[n + c + 1])
            uz = p.wind_z - 0.25 * (v[2 * n + a] + v[2 * n + a + 1] + v[2 * n + c] + v[2 * n + c + 1])
            area = math.sqrt(ax * ax + ay * ay + az * az + STILL)
            speed = math.sqrt(ux * ux + uy * uy + uz * uz + STILL)
            head_on = abs(ux * ax + uy * ay + uz * az) / (area * speed)
            across = g * p.air_drag * area * speed * head_on / 4.0
            along = 2.0 * across + g * p.air_lift * area * speed * (1.0 - head_on * head_on) ** 2 / 4.0
            for m in (a, a + 1, c, c + 1):
                add_block(points, m, n, along, across, ax / area, ay / area, az / area)


FORCE = Force(
    "air", rank=20, nets=WIDE_NETS, acts="p.has_air", accelerate=accelerate, power=power, is_smooth=True,
    blocks=blocks,
)  # fmt: skip
