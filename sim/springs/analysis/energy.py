"""The energy ledger: kinetic, elastic, gravity, contact; damping losses; work of pins, pull, sphere and wind.

energy - initial + dissipated - work is numerical error: the exact motion keeps it at 0.
Potential of gravity and kinetic energy are those of the free particles; pins trade through `work`.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.jit import kernel
from sim.springs.arrays import by_net, link_ratio, mass_at
from sim.springs.forces import FORCES, each
from sim.springs.forces.links import TINY
from sim.springs.laws import damps, force_density
from sim.springs.laws import energy as link_energy
from sim.springs.lines.energy import lines_energies, lines_kinetic_energy, lines_pins_damping_power, lines_power


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


pins_power_of_others = each("pins_power", "x, v, p", "sum")
power_of_others = each("power", "x, v, t, p, with_damping", "two sums", allocates=False)


@kernel(allocates=False)
def net_power(x, v, t, p, with_damping):
    dissipated, work = 0.0, moving_pins_power(x, v, p, 1.0, 1.0 if with_damping else 0.0)
    if with_damping:
        dissipated += link_damping_power(x, v, p)
        if p.drag > 0.0:
            dissipated += drag_power(v, p)
    lost, done = power_of_others(x, v, t, p, with_damping)
    return dissipated + lost, work + done


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
    return moving_pins_power(x, v, p, 0.0, 1.0) + pins_power_of_others(x, v, p)


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


def stored_as(name):
    """A kernel (x, t, p) -> energy [J] of the forces that store it as this field of `Energy`."""
    return each("energy", "x, t, p", "sum", [force for force in FORCES if force.stores == name], allocates=False)


contact_energy = stored_as("contact")


@kernel(allocates=False)
def net_energies(x, v, t, p):
    return kinetic_energy(v, p), elastic_energy(x, p), gravity_energy(x, p), contact_energy(x, t, p)


# (kinetic, elastic, gravity, contact) [J].
energies = by_net(rope=net_energies, grid=net_energies, lines=lines_energies)
