"""The account of lines under water: stored energies, and the power of damping, pins and water.

The water's inertia belongs to the water: kinetic energy is that of lines and bodies alone (a body's with its constant
added mass), and what the water's added mass, waves and current give or take is work. Buoyancy stores energy about still
water; that of the elevation of waves is work too.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.lines.arrays import (
    BED_AREA,
    BODY_MASS,
    DAMPING,
    DISPLACED,
    DRAG_ACROSS,
    DRAG_ALONG,
    HEIGHT,
    MASS,
    STIFFNESS,
)
from sim.springs.lines.bending import add_bending_tension, bending_energy, bending_rate
from sim.springs.lines.forces import (
    accelerate_lines,
    bed_force,
    damping_of,
    lines_scratch_size,
    link_energy_of,
    matrix_times,
    rate_of,
    six,
    span_of,
    submerged,
    tangent_at,
    tension_of,
    water_at,
)


@kernel(inline=True)
def half_form(p, b, start, q):
    """1/2 q M q of a body's matrix."""
    m = matrix_times(p.bodies, b, start, *q)
    return 0.5 * (q[0] * m[0] + q[1] * m[1] + q[2] * m[2] + q[3] * m[3] + q[4] * m[4] + q[5] * m[5])


@kernel(allocates=False)
def lines_kinetic_energy(v, p):
    """1/2 m v^2 over the free nodes, and that of the bodies [J]."""
    n = p.cols
    total = 0.0
    for j in range(p.nodes):
        if p.inverse_masses[j] > 0.0:
            total += 0.5 * p.mass[j] * (v[j] ** 2 + v[n + j] ** 2 + v[2 * n + j] ** 2)
    for b in range(p.bodies.shape[0]):
        total += half_form(p, b, BODY_MASS, six(v, n, p.nodes + 2 * b))
    return total


@kernel(inline=True)
def is_moving(p, j):
    """True if a node is free or carried, so that gravity on it counts."""
    found = p.inverse_masses[j] > 0.0
    for i in range(p.carried.shape[0]):
        found |= p.carried[i, 0] == j
    return found


@kernel(inline=True)
def lift_height(p, i, z):
    """Integral [m] of the submerged share of part i in still water over its height, from the surface to z [m]."""
    h = p.parts[i, HEIGHT]
    wet = submerged(p, i, z)
    return z if wet == 1.0 else -0.5 * h * wet * wet


@kernel(allocates=False)
def lines_energies(x, v, t, p):
    """(kinetic, elastic, gravity, contact) [J].

    Elastic holds bending and the stiffness of bodies, gravity buoyancy and steady forces.
    """
    n = p.cols
    elastic, gravity, contact = bending_energy(x, p), 0.0, 0.0
    for q in range(p.ends.shape[0]):
        _, _, _, length = span_of(x, p, q)
        elastic += link_energy_of(p, q, length)
    for b in range(p.bodies.shape[0]):
        elastic += half_form(p, b, STIFFNESS, six(x, n, p.nodes + 2 * b))
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if is_moving(p, j):
            z = x[2 * n + j]
            gravity += p.gravity * (p.parts[i, MASS] * z - p.parts[i, DISPLACED] * lift_height(p, i, z))
            depth = max(0.0, p.bed - x[2 * n + j])
            contact += 0.5 * p.parts[i, BED_AREA] * p.bed_stiffness * depth * depth
    for j in range(p.nodes):
        if is_moving(p, j):
            gravity -= p.loads[j, 0] * x[j] + p.loads[j, 1] * x[n + j] + p.loads[j, 2] * x[2 * n + j]
    return lines_kinetic_energy(v, p), elastic, gravity, contact


@kernel(allocates=False)
def stored_rate(x, v, a, p):
    """Rate of the stored energy [W], with the accelerations a."""
    n = p.cols
    rate = bending_rate(x, v, p)
    for j in range(p.nodes):
        if is_moving(p, j):
            rate -= p.loads[j, 0] * v[j] + p.loads[j, 1] * v[n + j] + p.loads[j, 2] * v[2 * n + j]
        if p.inverse_masses[j] > 0.0:
            rate += p.mass[j] * (v[j] * a[j] + v[n + j] * a[n + j] + v[2 * n + j] * a[2 * n + j])
    for q in range(p.ends.shape[0]):
        rx, ry, rz, length = span_of(x, p, q)
        rate += tension_of(p, q, length) * rate_of(v, p, q, rx, ry, rz, length)
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        u, k = six(v, n, j), matrix_times(p.bodies, b, STIFFNESS, *six(x, n, j))
        m = matrix_times(p.bodies, b, BODY_MASS, *six(a, n, j))
        for e in range(6):
            rate += u[e] * (m[e] + k[e])
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        if is_moving(p, j):
            depth = max(0.0, p.bed - x[2 * n + j])
            lift = p.parts[i, BED_AREA] * p.bed_stiffness * depth
            wet = submerged(p, i, x[2 * n + j])
            rate += ((p.parts[i, MASS] - wet * p.parts[i, DISPLACED]) * p.gravity - lift) * v[2 * n + j]
    return rate


@kernel(allocates=False)
def lost_in_links(x, v, p):
    """Power [W] that the links' damping takes."""
    lost = 0.0
    for q in range(p.ends.shape[0]):
        rx, ry, rz, length = span_of(x, p, q)
        lost += damping_of(p, q, length) * rate_of(v, p, q, rx, ry, rz, length) ** 2
    return lost


@kernel(allocates=False)
def lost_in_water(x, v, t, p):
    """Power [W] that drag, the bed and the damping of bodies take."""
    n = p.cols
    lost = 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        qx, qy, qz = tangent_at(x, p, i)
        u, w, s, _, _, _, z = water_at(x, t, p, j)
        wet = submerged(p, i, z)
        u, w, s = u - v[j], w - v[n + j], s - v[2 * n + j]
        along = u * qx + w * qy + s * qz
        across = math.sqrt(max(0.0, u * u + w * w + s * s - along * along))
        lost += wet * (p.parts[i, DRAG_ACROSS] * across**3 + p.parts[i, DRAG_ALONG] * abs(along) ** 3)
        if is_moving(p, j):
            bx, by, bz = bed_force(x, v, p, i, j, p.parts[i, MASS], True)
            _, _, lift = bed_force(x, v, p, i, j, p.parts[i, MASS], False)
            lost -= bx * v[j] + by * v[n + j] + (bz - lift) * v[2 * n + j]
    for b in range(p.bodies.shape[0]):
        lost += 2.0 * half_form(p, b, DAMPING, six(v, n, p.nodes + 2 * b))
    return lost


@kernel
def lines_power(x, v, t, p, with_damping):
    """(dissipated, put in) [W]. What is put in is by moved nodes, waves, current and the water's inertia."""
    a = np.empty(v.shape[0])
    accelerate_lines(x, v, t, p, with_damping, np.empty(lines_scratch_size(p)), a)
    lost = lost_in_links(x, v, p) + lost_in_water(x, v, t, p) if with_damping else 0.0
    return lost, stored_rate(x, v, a, p) + lost


@kernel(allocates=False)
def lines_pins_damping_power(x, v, p):
    """Power [W] of prescribed nodes through the damping of their links."""
    n = p.cols
    work = 0.0
    for q in range(p.ends.shape[0]):
        c, d = p.ends[q, 0], p.ends[q, 1]
        rx, ry, rz, length = span_of(x, p, q)
        s = damping_of(p, q, length) * rate_of(v, p, q, rx, ry, rz, length) / length
        if not is_moving(p, c):
            work -= s * (v[c] * rx + v[n + c] * ry + v[2 * n + c] * rz)
        if not is_moving(p, d):
            work += s * (v[d] * rx + v[n + d] * ry + v[2 * n + d] * rz)
    return work


@kernel
def set_tensions(x, v, p, out):
    """Set the tension (links,) [N] of every link, with its damping and what bending adds."""
    for q in range(p.ends.shape[0]):
        rx, ry, rz, length = span_of(x, p, q)
        out[q] = tension_of(p, q, length) + damping_of(p, q, length) * rate_of(v, p, q, rx, ry, rz, length)
    add_bending_tension(x, p, out)
