"""The energy ledger: kinetic, elastic, gravity, contact; damping losses; work of pins, pull, sphere and wind.

energy - initial + dissipated - work is numerical error: the exact motion keeps it at 0.
Potential of gravity and kinetic energy are those of the free particles; pins trade through `work`.
"""

from typing import NamedTuple

import numpy as np

from sim.jit import kernel
from sim.springs.forces import FORCES, each
from sim.springs.forces.under_water.water import inertia_power
from sim.springs.points.acceleration import accelerate, make_scratch
from sim.springs.points.arrays import by_net, mass_at, point_count
from sim.springs.points.line_arrays import BODY_MASS
from sim.springs.points.line_points import half_form, six


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
    for j in range(point_count(p)):
        if p.inverse_masses[j] > 0.0:
            total += mass_at(p, j) * (v[j] ** 2 + v[n + j] ** 2 + v[2 * n + j] ** 2)
    return 0.5 * total


@kernel(allocates=False)
def lines_kinetic_energy(v, p):
    """With that of the bodies, which have the masses of the nodes that they carry; the water's belongs to the water."""
    total = net_kinetic_energy(v, p)
    for b in range(p.bodies.shape[0]):
        total += half_form(p, b, BODY_MASS, six(v, p.cols, p.nodes + 2 * b))
    return total


# Kinetic energy [J].
kinetic_energy = by_net(rope=net_kinetic_energy, grid=net_kinetic_energy, lines=lines_kinetic_energy)


power_of_forces = each("power", "x, v, t, p, with_damping", "two sums")


@kernel
def net_power(x, v, t, p, with_damping):
    if with_damping and p.held.shape[0] > 0:  # friction holds against the sum of the other forces
        accelerate(x, v, t, p, True, make_scratch(p), np.empty(v.shape[0]))
    return power_of_forces(x, v, t, p, with_damping)


@kernel
def lines_power(x, v, t, p, with_damping):
    a = np.empty(v.shape[0])
    accelerate(x, v, t, p, with_damping, make_scratch(p), a)
    lost, work = power_of_forces(x, v, t, p, with_damping)
    return lost, work - inertia_power(x, v, a, p)


# (dissipated, put in) [W]. with_damping False: without every force that depends on v.
power = by_net(rope=net_power, grid=net_power, lines=lines_power)


@kernel(allocates=False)
def add_power(x, v, t, p, with_damping, weight, ledger):
    """Add weight [s] times the power dissipated to ledger[0] [J], and times the power supplied to ledger[1]."""
    dissipated, work = power(x, v, t, p, with_damping)
    ledger[0] += weight * dissipated
    ledger[1] += weight * work


# Power [W] that moving pins put in through all damping.
pins_damping_power = each("pins_power", "x, v, t, p", "sum")
# The same without that of the links' damping.
pins_contact_power = each("pins_power", "x, v, t, p", "sum", [force for force in FORCES if force.name != "links"])


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
def close_damping(x, v, t, p, s, kinetic, by_sphere, with_links, before, ledger):
    """Book the work of damping in a time s [s] since `open_damping`, which returned `kinetic`.

    The particles' loss is exact, and so is the work of a moving sphere, `by_sphere` [J]. What moving pins put in
    through damping forces is that at the mean velocity. All that is put in so is dissipated too. with_links: True if
    the links were damped, too.
    """
    put_in = by_sphere
    if p.pins.shape[0] > 0:
        for j in range(v.shape[0]):
            before[j] = 0.5 * (before[j] + v[j])
        put_in += s * (pins_damping_power(x, before, t, p) if with_links else pins_contact_power(x, before, t, p))
    ledger[0] += kinetic - kinetic_energy(v, p) + put_in
    ledger[1] += put_in


# (elastic, gravity, contact) [J].
stored_energies = each("energy", "x, t, p", "stores", allocates=False)


@kernel(allocates=False)
def energies(x, v, t, p):
    """(kinetic, elastic, gravity, contact) [J]."""
    elastic, gravity, contact = stored_energies(x, t, p)
    return kinetic_energy(v, p), elastic, gravity, contact
