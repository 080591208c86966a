"""Aerodynamic drag and lift on a cloth's cells.

A cell is the two triangles between four particles; whichever diagonal splits it, their area vectors add up to half
the cross product of its diagonals, so the force keeps the symmetries of a square. Each corner takes a quarter.
"""

import math

from sim.jit import kernel


@kernel(inline=True)
def cell_force(x, v, p, j):
    """Force [N] on the cell with corner j, (i, j) to (i + 1, j + 1): rho/2 A s [C_D u + C_L (|u| n - s u/|u|)]."""
    n = p.rows * p.cols
    b, c, d = j + 1, j + p.cols, j + p.cols + 1
    px, py, pz = x[d] - x[j], x[n + d] - x[n + j], x[2 * n + d] - x[2 * n + j]
    qx, qy, qz = x[c] - x[b], x[n + c] - x[n + b], x[2 * n + c] - x[2 * n + b]
    ax, ay, az = 0.5 * (py * qz - pz * qy), 0.5 * (pz * qx - px * qz), 0.5 * (px * qy - py * qx)
    u = p.wind_x - 0.25 * (v[j] + v[b] + v[c] + v[d])
    k = p.wind_y - 0.25 * (v[n + j] + v[n + b] + v[n + c] + v[n + d])
    w = p.wind_z - 0.25 * (v[2 * n + j] + v[2 * n + b] + v[2 * n + c] + v[2 * n + d])
    flow = u * ax + k * ay + w * az  # A s, of the sign of n
    area = math.sqrt(ax * ax + ay * ay + az * az)
    speed = math.sqrt(u * u + k * k + w * w)
    if area == 0.0 or speed == 0.0:
        return 0.0, 0.0, 0.0
    s = abs(flow) / area
    along = abs(flow) * (p.air_drag - p.air_lift * s / speed)
    normal = flow / area * p.air_lift * speed
    return along * u + normal * ax, along * k + normal * ay, along * w + normal * az


@kernel(noalias=True, allocates=False)
def add_wind(x, v, p, a):
    """Add the accelerations by the air."""
    n = p.rows * p.cols
    for i in range(p.rows - 1):
        for j in range(i * p.cols, i * p.cols + p.cols - 1):
            fx, fy, fz = cell_force(x, v, p, j)
            for corner in (j, j + 1, j + p.cols, j + p.cols + 1):
                w = 0.25 * p.weights[corner]
                a[corner] += w * fx
                a[n + corner] += w * fy
                a[2 * n + corner] += w * fz


@kernel(allocates=False)
def wind_power(x, v, p):
    """What the air puts into the free particles [W]; negative where it takes."""
    n = p.rows * p.cols
    total = 0.0
    for i in range(p.rows - 1):
        for j in range(i * p.cols, i * p.cols + p.cols - 1):
            fx, fy, fz = cell_force(x, v, p, j)
            for c in (j, j + 1, j + p.cols, j + p.cols + 1):
                if p.weights[c] > 0.0:
                    total += 0.25 * (fx * v[c] + fy * v[n + c] + fz * v[2 * n + c])
    return total
