"""Conservation in spite of the solver's error: momentum of a free net, energy of a midpoint step.

Links pull with equal and opposite forces, so the exact solution of a stage keeps the momentum of a net on which nothing
else acts, and its angular momentum about the positions of the stage if its forces point along the links. An approximate
solution is moved as a rigid body to where it does; no force between its points changes by that.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.integrators.implicit.tangent import dot
from sim.springs.points.arrays import by_net, mass_at

TURNS = 3  # repeated turns of a rigid body; each leaves about g |a| / |x| of the error
FLAT = 1e-12  # of the trace of the tensor of inertia, added to it: points on a line do not resist a turn about it


@kernel(inline=True)
def norm(u, p):
    """Root of twice the kinetic energy at velocities u, of the free particles."""
    n, total = p.rows * p.cols, 0.0
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total += mass_at(p, j) * (u[j] * u[j] + u[n + j] * u[n + j] + u[2 * n + j] * u[2 * n + j])
    return math.sqrt(total)


@kernel(inline=True)
def change_norm(v, v0, a0, g, p):
    """`norm` of v - v0 - g a0."""
    n, total = p.rows * p.cols, 0.0
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            for e in range(3):
                s = v[e * n + j] - v0[e * n + j] - g * a0[e * n + j]
                total += mass_at(p, j) * s * s
    return math.sqrt(total)


@kernel(inline=True)
def total_mass(p):
    total = 0.0
    for j in range(p.rows * p.cols):
        total += mass_at(p, j)
    return total


@kernel
def mean_of(u, p):
    """Mean (3,) of u (3 rows cols,) over the mass."""
    n, mean, mass = p.rows * p.cols, np.zeros(3), total_mass(p)
    for e in range(3):
        for j in range(n):
            mean[e] += mass_at(p, j) * u[e * n + j]
        mean[e] /= mass
    return mean


@kernel
def rotation(x, u, p):
    """Angular velocity (3,) of a rigid body at x (3 rows cols,) with the angular momentum of u about its centre c.

    Returns it and c (3,).
    """
    n, c, drift = p.rows * p.cols, mean_of(x, p), mean_of(u, p)
    spin, inertia = np.zeros(3), np.zeros((3, 3))
    for j in range(n):
        m = mass_at(p, j)
        rx, ry, rz = x[j] - c[0], x[n + j] - c[1], x[2 * n + j] - c[2]
        ux, uy, uz = u[j] - drift[0], u[n + j] - drift[1], u[2 * n + j] - drift[2]
        spin[0] += m * (ry * uz - rz * uy)
        spin[1] += m * (rz * ux - rx * uz)
        spin[2] += m * (rx * uy - ry * ux)
        inertia[0, 0] += m * (ry * ry + rz * rz)
        inertia[1, 1] += m * (rz * rz + rx * rx)
        inertia[2, 2] += m * (rx * rx + ry * ry)
        inertia[0, 1] -= m * rx * ry
        inertia[1, 2] -= m * ry * rz
        inertia[2, 0] -= m * rz * rx
    xy, yz, zx = inertia[0, 1], inertia[1, 2], inertia[2, 0]
    more = FLAT * (inertia[0, 0] + inertia[1, 1] + inertia[2, 2])
    xx, yy, zz = inertia[0, 0] + more, inertia[1, 1] + more, inertia[2, 2] + more
    # By the adjugate matrix.
    a, b, d = yy * zz - yz * yz, zx * yz - xy * zz, xy * yz - zx * yy
    e, f, i = xx * zz - zx * zx, xy * zx - xx * yz, xx * yy - xy * xy
    whole = xx * a + xy * b + zx * d
    turn = np.zeros(3)
    if whole > 0.0:
        turn[0] = (a * spin[0] + b * spin[1] + d * spin[2]) / whole
        turn[1] = (b * spin[0] + e * spin[1] + f * spin[2]) / whole
        turn[2] = (d * spin[0] + f * spin[1] + i * spin[2]) / whole
    return turn, c


@kernel(inline=True)
def turned(turn, c, x, n, j):
    """Velocity of point j of a rigid body at x that turns about c."""
    rx, ry, rz = x[j] - c[0], x[n + j] - c[1], x[2 * n + j] - c[2]
    return turn[1] * rz - turn[2] * ry, turn[2] * rx - turn[0] * rz, turn[0] * ry - turn[1] * rx


@kernel
def conserve_momentum(x0, v0, g, p, x, v):
    """Move the solution v of a stage, x = x0 + g v, as a rigid body, so that the momenta of a free net stay."""
    n = p.rows * p.cols
    u = np.empty_like(v)
    for e in range(3):
        weight = g * (p.gx if e == 0 else p.gy if e == 1 else p.gz)
        for j in range(n):
            u[e * n + j] = v0[e * n + j] + weight - v[e * n + j]
    mean = mean_of(u, p)
    for e in range(3):
        for j in range(n):
            v[e * n + j] += mean[e]
    if not p.conserves_spin:
        return
    for _ in range(TURNS):
        for j in range(3 * n):
            x[j] = x0[j] + g * v[j]
            u[j] = v0[j] - v[j]
        turn, c = rotation(x, u, p)
        for j in range(n):
            ux, uy, uz = turned(turn, c, x, n, j)
            for e in range(3):
                s = ux if e == 0 else uy if e == 1 else uz
                v[e * n + j] += s


@kernel
def internal_motion(x, v, p):
    """Velocities v less those that the energy correction must leave: of the pins, or of a free net as a rigid body."""
    n, pins, w = p.rows * p.cols, 0, v.copy()
    mean = np.zeros(3)
    for j in range(n):
        if p.inverse_masses[j] == 0.0:
            pins += 1
            for e in range(3):
                mean[e] += v[e * n + j]
    if pins > 0:
        mean /= pins
    else:
        mean = mean_of(v, p)
    for e in range(3):
        for j in range(n):
            w[e * n + j] = v[e * n + j] - mean[e] if p.inverse_masses[j] > 0.0 else 0.0
    if pins == 0:
        turn, c = rotation(x, v, p)
        for j in range(n):
            ux, uy, uz = turned(turn, c, x, n, j)
            w[j] -= ux
            w[n + j] -= uy
            w[2 * n + j] -= uz
    return w


@kernel
def energy_correction_of_net(x1, v1, vm, p, work):
    w = internal_motion(x1, v1, p)
    twice = norm(w, p) ** 2
    return math.sqrt(max(0.0, 1.0 + 4.0 * dot(work.r, vm) / twice)) if twice > 0.0 else 1.0


@kernel
def scale_motion_of_net(scale, x1, v1, p):
    w = internal_motion(x1, v1, p)
    for j in range(v1.shape[0]):
        v1[j] += (scale - 1.0) * w[j]


# Factor of the internal motion at the end x1, v1 of a midpoint step, of velocity vm in its middle, that gives it the
# energy of the work of the forces: the residual r took 2 r.vm of it. 0 if no factor does. Chains are solved to
# round-off.
energy_correction = by_net(rope=kernel(lambda x1, v1, vm, p, work: 1.0, inline=True), grid=energy_correction_of_net)
scale_motion = by_net(rope=kernel(lambda scale, x1, v1, p: None, inline=True), grid=scale_motion_of_net)
