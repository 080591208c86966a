"""Forces on lines under water: tension, weight and buoyancy, added mass, waves, drag and the bed.

Morison's law on each node as lumped-mass programs have it (Hall & Goupee 2015, Ocean Eng. 104:590), with q the unit
tangent, along r_{i+1} - r_{i-1}, and u, du/dt the water's velocity and acceleration:

  (m + m_w [C_an (1 - q q^T) + C_at q q^T]) dv/dt = tension + (m - m_w) g + drag + bed
      + m_w [(1 + C_an) (du/dt - (du/dt . q) q) + (1 + C_at) (du/dt . q) q]
  drag = D_n |w_n| w_n + D_t |w_t| w_t, w = u - v; D_n = rho/2 C_dn d l, D_t = rho/2 C_dt pi d l

and the bed's d l (k_b depth - c_b dz/dt) upwards, with Coulomb friction. Of a node at the surface the water pushes the
submerged share of its volume: from 1 to 0 over the HEIGHT of a part about the elevation. Its added mass stays.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.laws import damps, energy, stiffness, tension
from sim.springs.lines.arrays import (
    ACROSS,
    ALONG,
    BED_AREA,
    DAMPING,
    DISPLACED,
    DRAG_ACROSS,
    DRAG_ALONG,
    HEIGHT,
    INVERSE_MASS,
    MASS,
    PLACE,
    STIFFNESS,
)
from sim.springs.lines.bending import add_bending
from sim.springs.lines.curves import curve_at
from sim.springs.pins import set_paths
from sim.waves import AMPLITUDE, sums_at

TINY = 1e-300  # [m^2] under the root: coincident nodes have no direction, and no force


@kernel(inline=True)
def lines_scratch_size(p):
    """Forces (3 n), then mass matrices (6 n): xx, xy, xz, yy, yz, zz, a row each."""
    return 9 * p.cols


@kernel(inline=True)
def span_of(x, p, q):
    """(x, y, z) [m] from the first end of link q to the second, and its length [m]."""
    n, a, b = p.cols, p.ends[q, 0], p.ends[q, 1]
    rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
    return rx, ry, rz, math.sqrt(rx * rx + ry * ry + rz * rz + TINY)


@kernel(inline=True)
def rate_of(v, p, q, rx, ry, rz, length):
    """Rate [m/s] at which link q grows, along its `span_of`."""
    n, a, b = p.cols, p.ends[q, 0], p.ends[q, 1]
    return ((v[b] - v[a]) * rx + (v[n + b] - v[n + a]) * ry + (v[2 * n + b] - v[2 * n + a]) * rz) / length


@kernel(inline=True)
def damping_of(p, q, length):
    """Damping [N s/m] of link q that acts at a length [m]."""
    return p.links[q, 2] if p.slack_damping or damps(p.law, p.links[q, 0], length) else 0.0


@kernel(inline=True)
def tension_of(p, q, length):
    """Tension [N] of link q at a length [m], without its damping."""
    if p.links[q, 4] > 0.0:
        return curve_at(p.curves, p.links[q, 3], p.links[q, 4], length / p.links[q, 0] - 1.0)[0]
    return tension(p.law, p.links[q, 1], p.links[q, 0], length)


@kernel(inline=True)
def stiffness_of(p, q, length):
    """Derivative [N/m] of the tension of link q at a length [m]."""
    if p.links[q, 4] > 0.0:
        return curve_at(p.curves, p.links[q, 3], p.links[q, 4], length / p.links[q, 0] - 1.0)[1] / p.links[q, 0]
    return stiffness(p.law, p.links[q, 1], p.links[q, 0], length)


@kernel(inline=True)
def link_energy_of(p, q, length):
    """Energy [J] of link q at a length [m]."""
    if p.links[q, 4] > 0.0:
        return curve_at(p.curves, p.links[q, 3], p.links[q, 4], length / p.links[q, 0] - 1.0)[2] * p.links[q, 0]
    return energy(p.law, p.links[q, 1], p.links[q, 0], length)


@kernel(inline=True)
def tangent_at(x, p, i):
    """Unit vector along the line at part i, zero where its neighbours coincide."""
    n, a, b = p.cols, p.places[i, 1], p.places[i, 2]
    rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
    over = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
    return over * rx, over * ry, over * rz


@kernel(inline=True)
def water_at(x, t, p, j):
    """Velocity [m/s] and acceleration [m/s^2] of the water at node j, and the node's height [m] over its surface."""
    u, v, w, du, dv, dw, z = p.current[0], p.current[1], p.current[2], 0.0, 0.0, 0.0, x[2 * p.cols + j]
    if p.waves.shape[1] > 0:
        n = p.cols
        sums = sums_at(x[j], x[n + j], z, t, p.waves, p.waves, AMPLITUDE, None, 0, p.depth)
        (wu, wv, ww), (du, dv, dw) = sums.velocity, sums.acceleration
        u, v, w, z = u + wu, v + wv, w + ww, z - sums.elevation
    return u, v, w, du, dv, dw, z


@kernel(inline=True)
def submerged(p, i, z):
    """Submerged share of part i, of which the middle is z [m] over the water's surface."""
    return min(max(0.5 - z / p.parts[i, HEIGHT], 0.0), 1.0)


@kernel(noalias=True, allocates=False)
def set_inverse_masses(x, p, f):
    """Set the inverse mass matrix of every node in the scratch f, that of the water included; 0 where prescribed.

    A node that a body carries has J M^-1 J^T of the body, with J its motion by the body's.
    """
    n = p.cols
    for j in range(n):
        f[3 * n + j] = f[6 * n + j] = f[8 * n + j] = p.mass[j]
        f[4 * n + j] = f[5 * n + j] = f[7 * n + j] = 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        qx, qy, qz = tangent_at(x, p, i)
        across = p.parts[i, DISPLACED] * p.parts[i, ACROSS]
        s = p.parts[i, DISPLACED] * p.parts[i, ALONG] - across
        f[3 * n + j] += across + s * qx * qx
        f[4 * n + j] += s * qx * qy
        f[5 * n + j] += s * qx * qz
        f[6 * n + j] += across + s * qy * qy
        f[7 * n + j] += s * qy * qz
        f[8 * n + j] += across + s * qz * qz
    for j in range(p.nodes):
        if p.inverse_masses[j] == 0.0:
            for e in range(3, 9):
                f[e * n + j] = 0.0
            continue
        xx, xy, xz = f[3 * n + j], f[4 * n + j], f[5 * n + j]
        yy, yz, zz = f[6 * n + j], f[7 * n + j], f[8 * n + j]
        a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        over = 1.0 / (xx * a + xy * b + xz * c)
        f[3 * n + j], f[4 * n + j], f[5 * n + j] = over * a, over * b, over * c
        f[6 * n + j], f[7 * n + j] = over * (xx * zz - xz * xz), over * (xy * xz - xx * yz)
        f[8 * n + j] = over * (xx * yy - xy * xy)
    for i in range(p.carried.shape[0]):
        set_carried_mass(p, i, f)


@kernel(allocates=False)
def set_carried_mass(p, i, f):
    """Set the inverse mass matrix of the node of fairlead i."""
    n, j = p.cols, p.carried[i, 0]
    row = 3
    for e in range(3):
        # M^-1 J^T of a unit force along axis e, then J of it.
        ux, uy, uz = 1.0 if e == 0 else 0.0, 1.0 if e == 1 else 0.0, 1.0 if e == 2 else 0.0
        moved = carried_motion(p, i, *pushed_body(p, i, ux, uy, uz))
        for d in range(e, 3):
            f[row * n + j] = moved[d]
            row += 1


@kernel(inline=True)
def carried_motion(p, i, x, y, z, a, b, c):
    """Motion of fairlead i by its body's displacement (x, y, z) and small rotation (a, b, c): r + theta x arm."""
    ax, ay, az = p.arms[i, 0], p.arms[i, 1], p.arms[i, 2]
    return x + b * az - c * ay, y + c * ax - a * az, z + a * ay - b * ax


@kernel(inline=True)
def moment_of(p, i, fx, fy, fz):
    """Moment [N m] of a force at fairlead i about its body's reference point."""
    ax, ay, az = p.arms[i, 0], p.arms[i, 1], p.arms[i, 2]
    return ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx


@kernel(inline=True)
def pushed_body(p, i, fx, fy, fz):
    """The six accelerations of a body by a force at its fairlead i."""
    return matrix_times(p.bodies, p.carried[i, 1], INVERSE_MASS, fx, fy, fz, *moment_of(p, i, fx, fy, fz))


@kernel(allocates=False)
def matrix_times(m, body, start, a, b, c, d, e, g):
    """A (6, 6) matrix of a body's row in m, from column `start`, times six numbers."""
    numbers = (a, b, c, d, e, g)
    s0 = s1 = s2 = s3 = s4 = s5 = 0.0
    for k in range(6):
        u = numbers[k]
        s0 += m[body, start + k] * u
        s1 += m[body, start + 6 + k] * u
        s2 += m[body, start + 12 + k] * u
        s3 += m[body, start + 18 + k] * u
        s4 += m[body, start + 24 + k] * u
        s5 += m[body, start + 30 + k] * u
    return s0, s1, s2, s3, s4, s5


@kernel(inline=True)
def over_mass(f, n, j, x, y, z):
    """M^-1 (x, y, z) of node j, by its inverse mass matrix in f."""
    xy, xz, yz = f[4 * n + j], f[5 * n + j], f[7 * n + j]
    return (
        f[3 * n + j] * x + xy * y + xz * z,
        xy * x + f[6 * n + j] * y + yz * z,
        xz * x + yz * y + f[8 * n + j] * z,
    )


@kernel(noalias=True, allocates=False)
def add_link_forces(x, v, p, with_damping, f):
    """Add the tensions [N] of all links, and with_damping the damping along them."""
    n = p.cols
    for q in range(p.ends.shape[0]):
        a, b = p.ends[q, 0], p.ends[q, 1]
        rx, ry, rz, length = span_of(x, p, q)
        s = tension_of(p, q, length)
        if with_damping:
            s += damping_of(p, q, length) * rate_of(v, p, q, rx, ry, rz, length)
        s /= length
        f[a] += s * rx
        f[n + a] += s * ry
        f[2 * n + a] += s * rz
        f[b] -= s * rx
        f[n + b] -= s * ry
        f[2 * n + b] -= s * rz


@kernel(inline=True)
def bed_force(x, v, p, i, j, mass, with_damping):
    """Force [N] of the bed on part i at node j: upwards, and against the sliding."""
    n = p.cols
    depth = p.bed - x[2 * n + j]
    fx = fy = fz = 0.0
    if depth > 0.0:
        area = p.parts[i, BED_AREA]
        fz = area * p.bed_stiffness * depth
        if with_damping:
            if p.friction > 0.0:
                speed = math.sqrt(v[j] * v[j] + v[n + j] * v[n + j] + TINY)
                s = min(p.friction * fz / speed, mass * p.stop_rate)
                fx, fy = -s * v[j], -s * v[n + j]
            fz -= area * p.bed_damping * v[2 * n + j]
    return fx, fy, fz


@kernel(noalias=True, allocates=False)
def add_water_and_bed(x, v, t, p, with_damping, f):
    """Add weight, buoyancy, the push of waves and the bed [N]; with_damping also drag, and what damps on the bed."""
    n = p.cols
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        qx, qy, qz = tangent_at(x, p, i)
        u, w, s, du, dw, ds, z = water_at(x, t, p, j)
        wet = submerged(p, i, z)
        m, md = p.parts[i, MASS], wet * p.parts[i, DISPLACED]
        along = du * qx + dw * qy + ds * qz
        c, d = md * (1.0 + p.parts[i, ACROSS]), md * (p.parts[i, ALONG] - p.parts[i, ACROSS]) * along
        fx, fy, fz = c * du + d * qx, c * dw + d * qy, c * ds + d * qz - (m - md) * p.gravity
        if with_damping:
            u, w, s = u - v[j], w - v[n + j], s - v[2 * n + j]
            along = u * qx + w * qy + s * qz
            nx, ny, nz = u - along * qx, w - along * qy, s - along * qz
            c = wet * p.parts[i, DRAG_ACROSS] * math.sqrt(nx * nx + ny * ny + nz * nz)
            d = wet * p.parts[i, DRAG_ALONG] * abs(along) * along
            fx, fy, fz = fx + c * nx + d * qx, fy + c * ny + d * qy, fz + c * nz + d * qz
        bx, by, bz = bed_force(x, v, p, i, j, m, with_damping)
        f[j] += fx + bx
        f[n + j] += fy + by
        f[2 * n + j] += fz + bz


@kernel(noalias=True, allocates=False)
def set_forces(x, v, t, p, with_damping, f):
    """Set the forces [N] on every node, prescribed ones too."""
    n = p.cols
    for j in range(n):
        f[j], f[n + j], f[2 * n + j] = p.loads[j, 0], p.loads[j, 1], p.loads[j, 2]
    add_bending(x, p, f)
    add_link_forces(x, v, p, with_damping, f)
    add_water_and_bed(x, v, t, p, with_damping, f)


@kernel(inline=True)
def six(y, n, j):
    """Displacement and rotation of the body whose two points begin at j."""
    k = j + 1
    return y[j], y[n + j], y[2 * n + j], y[k], y[n + k], y[2 * n + k]


@kernel(inline=True)
def set_six(y, n, j, q):
    """Set the six numbers of the body whose two points begin at j."""
    k = j + 1
    y[j], y[n + j], y[2 * n + j], y[k], y[n + k], y[2 * n + k] = q


@kernel(allocates=False)
def wave_force(x, t, p, b):
    """Steady force and that of waves on body b: a Re(X exp(i theta)) of each wave, theta where the body is now."""
    n, j = p.cols, p.nodes + 2 * b
    px, py = p.bodies[b, PLACE] + x[j], p.bodies[b, PLACE + 1] + x[n + j]
    f = p.steady[b]
    if p.excitation.shape[2] == 0:
        return f[0], f[1], f[2], f[3], f[4], f[5]
    e = sums_at(px, py, None, t, p.waves, p.waves, AMPLITUDE, p.excitation, b, p.depth).response
    return f[0] + e[0], f[1] + e[1], f[2] + e[2], f[3] + e[3], f[4] + e[4], f[5] + e[5]


@kernel(noalias=True, allocates=False)
def accelerate_bodies(x, v, t, p, with_damping, f, a):
    """Accelerations of bodies, by their lines' forces in f, waves, and their own stiffness and damping."""
    n = p.cols
    for b in range(p.bodies.shape[0]):
        j, s = p.nodes + 2 * b, 1.0 if with_damping else 0.0
        k, d = matrix_times(p.bodies, b, STIFFNESS, *six(x, n, j)), matrix_times(p.bodies, b, DAMPING, *six(v, n, j))
        e = wave_force(x, t, p, b)
        set_six(
            f, n, j,
            (
                e[0] - k[0] - s * d[0], e[1] - k[1] - s * d[1], e[2] - k[2] - s * d[2],
                e[3] - k[3] - s * d[3], e[4] - k[4] - s * d[4], e[5] - k[5] - s * d[5],
            ),
        )  # fmt: skip
    for i in range(p.carried.shape[0]):
        c, j = p.carried[i, 0], p.nodes + 2 * p.carried[i, 1]
        fx, fy, fz = f[c], f[n + c], f[2 * n + c]
        mx, my, mz = moment_of(p, i, fx, fy, fz)
        f[j] += fx
        f[n + j] += fy
        f[2 * n + j] += fz
        f[j + 1] += mx
        f[n + j + 1] += my
        f[2 * n + j + 1] += mz
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        set_six(a, n, j, matrix_times(p.bodies, b, INVERSE_MASS, *six(f, n, j)))
    set_carried(a, p)


@kernel(inline=True)
def set_carried(y, p):
    """Set what bodies carry, of velocities or accelerations y (3 n,)."""
    n = p.cols
    for i in range(p.carried.shape[0]):
        j = p.carried[i, 0]
        y[j], y[n + j], y[2 * n + j] = carried_motion(p, i, *six(y, n, p.nodes + 2 * p.carried[i, 1]))


@kernel(noalias=True, allocates=False)
def accelerate_lines(x, v, t, p, with_damping, f, a):
    """Acceleration a of every node and body at time t, 0 where prescribed. f: scratch of `make_scratch`."""
    n = p.cols
    set_inverse_masses(x, p, f)
    set_forces(x, v, t, p, with_damping, f)
    for j in range(p.nodes):
        a[j], a[n + j], a[2 * n + j] = over_mass(f, n, j, f[j], f[n + j], f[2 * n + j])
    accelerate_bodies(x, v, t, p, with_damping, f, a)


@kernel(inline=True)
def set_line_pins(x, v, t, p):
    """Put moved nodes where their paths are at time t, and carried ones where their body is."""
    set_paths(x, v, t, p)
    n = p.cols
    for i in range(p.carried.shape[0]):
        j, b = p.carried[i, 0], p.carried[i, 1]
        dx, dy, dz = carried_motion(p, i, *six(x, n, p.nodes + 2 * b))
        x[j] = p.bodies[b, PLACE] + p.arms[i, 0] + dx
        x[n + j] = p.bodies[b, PLACE + 1] + p.arms[i, 1] + dy
        x[2 * n + j] = p.bodies[b, PLACE + 2] + p.arms[i, 2] + dz
    set_carried(v, p)


@kernel
def set_rest_forces(x, p, f):
    """Set the forces [N] on every node of lines that do not move, in still or steadily moving water."""
    v = np.zeros(x.shape[0])
    set_forces(x, v, 0.0, p, True, f)


@kernel
def inverse_mass_matrices(x, p):
    """Scratch with the inverse mass matrices of lines at x."""
    f = np.zeros(lines_scratch_size(p))
    set_inverse_masses(x, p, f)
    return f


@kernel
def link_state(x, p):
    """(links, 4) of links at x: length [m], tension [N], its derivative [N/m], and the damping that acts [N s/m]."""
    found = np.empty((p.ends.shape[0], 4))
    for q in range(p.ends.shape[0]):
        _, _, _, length = span_of(x, p, q)
        found[q, 0], found[q, 1] = length, tension_of(p, q, length)
        found[q, 2] = stiffness_of(p, q, length)
        found[q, 3] = damping_of(p, q, length)
    return found
