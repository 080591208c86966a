"""The energy ledger: kinetic, elastic, gravity, contact; damping losses; work of pins, pull, sphere and wind.

energy - initial + dissipated - work is numerical error: the exact motion keeps it at 0.
Potential of gravity and kinetic energy are those of the free particles; pins trade through `work`.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.jit import kernel
from sim.springs.forces.acceleration import grab_secant
from sim.springs.forces.contact import contact_force, surface_velocity, touches, touching
from sim.springs.forces.links import TINY
from sim.springs.forces.self_contact import self_contact_energy, self_contact_power
from sim.springs.forces.wind import wind_power
from sim.springs.laws import damps, force_density
from sim.springs.laws import energy as link_energy
from sim.springs.lines.energy import lines_energies, lines_kinetic_energy, lines_pins_damping_power, lines_power
from sim.springs.net import by_net, link_ratio, mass_at


class Energy(NamedTuple):
    """Stored energies [J]."""

    kinetic: float
    elastic: float
    gravity: float
    contact: float

    @property
    def total(self) -> float:
        return self.kinetic + self.elastic + self.gravity + self.contact


@kernel(allocates=False)
def net_kinetic_energy(v, p):
    """1/2 m v^2 over the free particles."""
    total = 0.0
    n = p.rows * p.cols
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total += mass_at(p, j) * (v[j] ** 2 + v[n + j] ** 2 + v[2 * n + j] ** 2)
    return 0.5 * total


# Kinetic energy [J].
kinetic_energy = by_net(rope=net_kinetic_energy, grid=net_kinetic_energy, lines=lines_kinetic_energy)


@kernel(allocates=False)
def drag_power(v, p):
    """c v^2 over the free particles [W]."""
    total = 0.0
    n = p.rows * p.cols
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total += v[j] ** 2 + v[n + j] ** 2 + v[2 * n + j] ** 2
    return p.drag * total


@kernel(allocates=False)
def elastic_energy(x, p):
    """Of the links [J]."""
    total = 0.0
    n = p.rows * p.cols
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, k = p.links[q, 0], p.links[q, 1]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                b = a + di * p.cols + dj
                rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                own = link_ratio(p, q, i, j) * k
                total += link_energy(p.law, own, rest, math.sqrt(rx * rx + ry * ry + rz * rz))
    return total


@kernel(allocates=False)
def gravity_energy(x, p):
    """-m g . x over the free particles [J]."""
    total = 0.0
    n = p.rows * p.cols
    for j in range(n):
        if p.inverse_masses[j] > 0.0:
            total -= mass_at(p, j) * (p.gx * x[j] + p.gy * x[n + j] + p.gz * x[2 * n + j])
    return total


@kernel(allocates=False)
def contact_energy(x, t, p):
    """1/2 k depth^2 over the touching points [J]."""
    total = 0.0
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if p.has_sphere if on_sphere else p.has_floor:
            for j in range(n):
                depth, _, _, _ = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
                if depth > 0.0 and p.inverse_masses[j] > 0.0:
                    total += 0.5 * p.contact_k * depth * depth
    return total


@kernel(noalias=True, inline=True)
def row_damping_power(x, v, a, b, count, n, law, rest, axial):
    """Power lost to damping of 1 N s/m [W] in the links (a, b), (a + 1, b + 1), ..."""
    total = 0.0
    if axial:
        for j in range(count):
            p, q = a + j, b + j
            rx, ry, rz = x[q] - x[p], x[n + q] - x[n + p], x[n + n + q] - x[n + n + p]
            du, dv, dw = v[q] - v[p], v[n + q] - v[n + p], v[n + n + q] - v[n + n + p]
            closing, rr = du * rx + dv * ry + dw * rz, rx * rx + ry * ry + rz * rz + TINY
            total += closing * closing / rr if damps(law, rest, math.sqrt(rr)) else 0.0
    else:
        for j in range(count):
            p, q = a + j, b + j
            rx, ry, rz = x[q] - x[p], x[n + q] - x[n + p], x[n + n + q] - x[n + n + p]
            du, dv, dw = v[q] - v[p], v[n + q] - v[n + p], v[n + n + q] - v[n + n + p]
            acts = damps(law, rest, math.sqrt(rx * rx + ry * ry + rz * rz))
            total += du * du + dv * dv + dw * dw if acts else 0.0
    return total


@kernel(allocates=False)
def link_damping_power(x, v, p):
    """Power lost to the links' damping [W]."""
    total = 0.0
    n = np.uint64(p.rows * p.cols)
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, c = p.links[q, 0], p.links[q, 2]
        first = max(0, -dj)
        count = max(0, p.cols - abs(dj))
        if c == 0.0 or count == 0:
            continue
        for i in range(p.rows - di):
            a = np.uint64(i * p.cols + first)
            b = np.uint64((i + di) * p.cols + first + dj)
            ratio = link_ratio(p, q, i, 1)
            total += ratio * c * row_damping_power(x, v, a, b, np.uint64(count), n, p.law, rest, p.axial)
            more = link_ratio(p, q, i, 0) - ratio  # of the links in the first and the last column
            if dj == 0 and more != 0.0:
                for j in (0, count - 1):
                    o = np.uint64(j)
                    lost = row_damping_power(x, v, a + o, b + o, np.uint64(1), n, p.law, rest, p.axial)
                    total += more * c * lost
    return total


@kernel(allocates=False)
def moving_pins_power(x, v, p, elastic, damping):
    """Power of moving pins [W] through the links' elastic forces, their damping, or both: 1.0 counts it, 0.0 not."""
    work = 0.0
    n = p.rows * p.cols
    if p.pins.shape[0] == 0:
        return work
    for q in range(p.offsets.shape[0]):
        di, dj = p.offsets[q, 0], p.offsets[q, 1]
        rest, k, c = p.links[q, 0], elastic * p.links[q, 1], damping * p.links[q, 2]
        for i in range(p.rows - di):
            for j in range(max(0, -dj), p.cols - max(0, dj)):
                a = i * p.cols + j
                b = a + di * p.cols + dj
                if p.inverse_masses[a] > 0.0 and p.inverse_masses[b] > 0.0:
                    continue
                rx, ry, rz = x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]
                du, dv, dw = v[b] - v[a], v[n + b] - v[n + a], v[2 * n + b] - v[2 * n + a]
                rr = rx * rx + ry * ry + rz * rz + TINY
                if p.axial:
                    along = (du * rx + dv * ry + dw * rz) / rr
                    du, dv, dw = along * rx, along * ry, along * rz
                ratio = link_ratio(p, q, i, j)
                length = math.sqrt(rr)
                s = force_density(p.law, ratio * k, rest, length)
                d = ratio * c if damps(p.law, rest, length) else 0.0
                fx, fy, fz = s * rx + d * du, s * ry + d * dv, s * rz + d * dw
                if p.inverse_masses[a] == 0.0:
                    work -= fx * v[a] + fy * v[n + a] + fz * v[2 * n + a]
                if p.inverse_masses[b] == 0.0:
                    work += fx * v[b] + fy * v[n + b] + fz * v[2 * n + b]
    return work


@kernel(allocates=False)
def contact_power(x, v, t, p, with_damping):
    """(dissipated, put in by a moving sphere) [W] through contact."""
    dissipated = 0.0
    work = 0.0
    n = p.rows * p.cols
    for surface in range(2):
        on_sphere = surface == 1
        if not touches(x, t, p, on_sphere):
            continue
        su, sv, sw = surface_velocity(p, on_sphere)
        if not with_damping and su == 0.0 and sv == 0.0 and sw == 0.0:
            continue
        for j in range(n):
            depth, nx, ny, nz = touching(x[j], x[n + j], x[2 * n + j], t, p, on_sphere)
            if depth > 0.0 and p.inverse_masses[j] > 0.0:
                ru, rv, rw = v[j] - su, v[n + j] - sv, v[2 * n + j] - sw
                fx, fy, fz = contact_force(depth, nx, ny, nz, ru, rv, rw, mass_at(p, j), p, on_sphere, with_damping)
                push = p.contact_k * depth
                dissipated -= (fx - push * nx) * ru + (fy - push * ny) * rv + (fz - push * nz) * rw
                work += fx * su + fy * sv + fz * sw
    return dissipated, work


@kernel
def wide_power(x, v, p, with_damping):
    """(dissipated, put in) [W] by air, and through the net's contact with itself."""
    dissipated = 0.0
    work = 0.0
    if p.has_air and with_damping:
        lost, done = wind_power(x, v, p)
        dissipated += lost
        work += done
    if p.thickness > 0.0 and (with_damping or p.pins.shape[0] > 0):
        lost, done = self_contact_power(x, v, p, with_damping)
        dissipated += lost
        work += done
    return dissipated, work


power_of_width = by_net(rope=kernel(lambda x, v, p, with_damping: (0.0, 0.0), inline=True), grid=wide_power)


@kernel
def wide_damping_work(x, v, p):
    if p.thickness > 0.0:
        return self_contact_power(x, v, p, True)[1] - self_contact_power(x, v, p, False)[1]
    return 0.0


# What moving pins put in [W] through the damping of the net's contact with itself.
damping_work_of_width = by_net(rope=kernel(lambda x, v, p: 0.0, inline=True), grid=wide_damping_work)


@kernel
def wide_self_contact_energy(x, p):
    return self_contact_energy(x, p) if p.thickness > 0.0 else 0.0


energy_of_own_contacts = by_net(rope=kernel(lambda x, p: 0.0, inline=True), grid=wide_self_contact_energy)


@kernel(allocates=False)
def net_power(x, v, t, p, with_damping):
    dissipated, work = 0.0, moving_pins_power(x, v, p, 1.0, 1.0 if with_damping else 0.0)
    if with_damping:
        dissipated += link_damping_power(x, v, p)
        if p.drag > 0.0:
            dissipated += drag_power(v, p)
    lost, done = power_of_width(x, v, p, with_damping)
    dissipated += lost
    work += done
    if p.has_floor or p.has_sphere:
        lost, done = contact_power(x, v, t, p, with_damping)
        dissipated += lost
        work += done
    if p.grabbed >= 0:
        n, g = p.rows * p.cols, p.grabbed
        dx, dy, dz = p.grab_x - x[g], p.grab_y - x[n + g], p.grab_z - x[2 * n + g]
        work += grab_secant(dx, dy, dz, p) * (dx * v[g] + dy * v[n + g] + dz * v[2 * n + g])
        if with_damping:
            dissipated += p.grab_b * (v[g] ** 2 + v[n + g] ** 2 + v[2 * n + g] ** 2)
    return dissipated, work


# (dissipated, put in) [W]. with_damping False: without every force that depends on v.
power = by_net(rope=net_power, grid=net_power, lines=lines_power)


@kernel(allocates=False)
def add_power(x, v, t, p, with_damping, weight, ledger):
    """Add weight [s] times the power dissipated to ledger[0] [J], and times the power supplied to ledger[1]."""
    dissipated, work = power(x, v, t, p, with_damping)
    ledger[0] += weight * dissipated
    ledger[1] += weight * work


@kernel(allocates=False)
def net_pins_damping_power(x, v, p):
    return moving_pins_power(x, v, p, 0.0, 1.0) + damping_work_of_width(x, v, p)


# What moving pins put in [W] through all damping.
pins_damping_power = by_net(rope=net_pins_damping_power, grid=net_pins_damping_power, lines=lines_pins_damping_power)


@kernel(inline=True)
def account_size(x, with_account):
    """Numbers in the scratch of `open_damping`."""
    return x.shape[0] if with_account else 0


@kernel(allocates=False)
def open_damping(v, p, before):
    """Remember the velocities before damping is taken apart from other forces; returns their kinetic energy [J]."""
    for j in range(v.shape[0]):
        before[j] = v[j]
    return kinetic_energy(v, p)


@kernel(allocates=False)
def close_damping(x, v, p, s, kinetic, by_sphere, before, ledger):
    """Book the work of damping in a time s [s] since `open_damping`, which returned `kinetic`.

    The particles' loss is exact, and so is the work of a moving sphere, `by_sphere` [J]. What moving pins put in
    through damping forces is that at the mean velocity. All that is put in so is dissipated too.
    """
    put_in = by_sphere
    if p.pins.shape[0] > 0:
        for j in range(v.shape[0]):
            before[j] = 0.5 * (before[j] + v[j])
        put_in += s * pins_damping_power(x, before, p)
    ledger[0] += kinetic - kinetic_energy(v, p) + put_in
    ledger[1] += put_in


@kernel(allocates=False)
def net_energies(x, v, t, p):
    contact = contact_energy(x, t, p) if p.has_floor or p.has_sphere else 0.0
    contact += energy_of_own_contacts(x, p)
    return kinetic_energy(v, p), elastic_energy(x, p), gravity_energy(x, p), contact


# (kinetic, elastic, gravity, contact) [J].
energies = by_net(rope=net_energies, grid=net_energies, lines=lines_energies)
