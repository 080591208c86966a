"""Aerodynamic drag and lift on a cloth's cells.

A cell is the two triangles between four particles; whichever diagonal splits it, their area vectors add up to half
the cross product of its diagonals, so the force keeps the symmetries of a square. Each corner takes a quarter.
"""

import math

import numpy as np

from sim.jit import kernel

STILL = 1e-300  # under the roots: no air or no area gives no force instead of 0/0


@kernel(inline=True)
def wind_scratch_size(cols):
    """Numbers that a row of cells takes at the end of the scratch."""
    return 3 * (cols + 1)


@kernel(inline=True)
def cell_areas(x, a, c, n):
    """Area vector [m^2] of the cell that begins with the particles a and, a row on, c."""
    one = np.uint64(1)
    b, d = a + one, c + one
    px, py, pz = x[d] - x[a], x[n + d] - x[n + a], x[n + n + d] - x[n + n + a]
    qx, qy, qz = x[c] - x[b], x[n + c] - x[n + b], x[n + n + c] - x[n + n + b]
    return 0.5 * (py * qz - pz * qy), 0.5 * (pz * qx - px * qz), 0.5 * (px * qy - py * qx)


@kernel(noalias=True, inline=True)
def set_cell_forces(x, v, ia, ic, count, n, m, wind_x, wind_y, wind_z, drag, lift, f, of):
    """Force [N] on the cells between two rows: rho/2 A s [C_D u + C_L (|u| n - s u/|u|)], with s = |u . n|.

    ia, ic: first particles of the rows; f (3, m) from `of`.
    """
    one = np.uint64(1)
    for j in range(count):
        a, c = ia + j, ic + j
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
        f[of + j] = along * ux + normal * ax
        f[of + m + j] = along * uy + normal * ay
        f[of + m + m + j] = along * uz + normal * az


@kernel(noalias=True, inline=True)
def add_quarter(f, of, count, w, ow, a, o):
    for j in range(count):
        a[o + j] += 0.25 * w[ow + j] * f[of + j]


@kernel(noalias=True, allocates=False)
def add_wind(x, v, p, f, a):
    """Add the accelerations by the air; f: scratch; its last (wind_scratch_size,) are free."""
    n, m, cols = np.uint64(p.rows * p.cols), np.uint64(p.cols + 1), np.uint64(p.cols)
    count = np.uint64(p.cols - 1)
    start = np.uint64(f.shape[0] - wind_scratch_size(p.cols))
    for i in range(p.rows - 1):
        ia = np.uint64(i * p.cols)
        set_cell_forces(
            x, v, ia, ia + cols, count, n, m, p.wind_x, p.wind_y, p.wind_z, p.air_drag, p.air_lift, f, start
        )  # fmt: skip
        for e in range(3):
            of, o = start + np.uint64(e) * m, np.uint64(e) * n
            for corner in range(4):
                at = ia + np.uint64(corner % 2) + np.uint64(corner // 2) * cols
                add_quarter(f, of, count, p.inverse_masses, at, a, o + at)


@kernel
def wind_power(x, v, p):
    """(dissipated, put in) [W] by the air on the free particles: the wind does the work of its force at its own speed.

    The difference is what the particles get. In still air all is dissipated.
    """
    n = p.rows * p.cols
    a = np.zeros(v.shape[0])
    add_wind(x, v, p, np.zeros(wind_scratch_size(p.cols)), a)
    work = 0.0
    gained = 0.0
    for j in range(n):
        work += p.mass * (a[j] * p.wind_x + a[n + j] * p.wind_y + a[2 * n + j] * p.wind_z)
        gained += p.mass * (a[j] * v[j] + a[n + j] * v[n + j] + a[2 * n + j] * v[2 * n + j])
    return work - gained, work
