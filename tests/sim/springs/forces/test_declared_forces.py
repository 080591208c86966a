"""Forces that a net declares in `Net.forces`: each at its defaults, against differences of its energy and its force."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
import pytest

from sim.springs import Net, cloth, rope, simulate
from sim.springs.forces import OWN
from sim.springs.forces.matrices import STIFFNESS
from sim.springs.forces.record import Force
from sim.springs.integrators.implicit.blocks import set_point_blocks
from sim.springs.integrators.implicit.tangent import set_tangent
from sim.springs.points.acceleration import set_acceleration
from sim.springs.stability import gershgorin
from sim.springs.state import State, energy

NETS = {"rope": rope(4, 1.0, drag=0.0, damping=0.0), "cloth": cloth(3, 4, damping=0.0)}
OF_EACH = pytest.mark.parametrize(
    ("numbers", "net"),
    [pytest.param(one(), net, id=f"{force.name}-{name}") for one, force in OWN.items() for name, net in NETS.items()],
)
D = 1e-6  # [m] of the differences


def shaken(net: Net) -> np.ndarray:
    """Positions (3, rows, cols) [m] off any symmetry."""
    return net.x0 + 0.05 * np.random.default_rng(1).standard_normal(net.x0.shape)


def moved(x: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray]:
    """x with its number i a little less and a little more."""
    step = np.zeros(x.size)
    step[i] = D
    return x - step.reshape(x.shape), x + step.reshape(x.shape)


def with_and_without(numbers: object, net: Net) -> tuple[Net, Net]:
    return dataclasses.replace(net, forces=(numbers,)), net


def force(numbers: object, net: Net, x: np.ndarray) -> np.ndarray:
    """The force [N] alone, (3 rows cols,), 0 on pinned points."""
    a = np.zeros((2, x.size))
    for row, each in zip(a, with_and_without(numbers, net), strict=True):
        set_acceleration(x.reshape(-1).copy(), np.zeros(x.size), 0.0, each.kernel_view(1.0), row)
    return (a[0] - a[1]) * np.tile(net.masses.ravel(), 3)


@OF_EACH
def test_the_force_is_the_slope_of_its_energy(numbers, net):
    x = shaken(net)

    def stored(at: np.ndarray) -> float:
        one, other = (energy(each, State(at, np.zeros_like(at))).total for each in with_and_without(numbers, net))
        return one - other

    slopes = [(stored(low) - stored(high)) / (2.0 * D) for low, high in (moved(x, i) for i in range(x.size))]
    free = np.tile(net.inverse_masses() > 0.0, 3)
    found = force(numbers, net, x)
    assert np.any(found)
    assert found[free] == pytest.approx(np.array(slopes)[free], abs=1e-6)


@OF_EACH
def test_the_tangent_is_the_slope_of_the_force_and_the_blocks_hold_it(numbers, net):
    x = shaken(net)
    n, free = x[0].size, np.tile(net.inverse_masses() > 0.0, 3)
    root = np.sqrt(np.tile(net.masses.ravel(), 3))
    expected = np.empty((x.size, x.size))
    found, blocks = np.empty((2, x.size, x.size)), np.zeros((2, 6 * n))
    for i in range(x.size):
        low, high = moved(x, i)
        expected[i] = (force(numbers, net, low) - force(numbers, net, high)) / (2.0 * D)
    for k, each in enumerate(with_and_without(numbers, net)):
        p = each.kernel_view(1.0)
        for i, unit in enumerate(np.eye(x.size)):
            set_tangent(x.reshape(-1), unit * root, 0.0, p, STIFFNESS, 0.0, found[k, i])
        set_point_blocks(x.reshape(-1), np.zeros(x.size), 0.0, 1.0, p, blocks[k])
    stiffness = (found[0] - found[1]) * root
    both = np.ix_(free, free)
    assert stiffness[both] == pytest.approx(expected[both], abs=1e-5)
    # Newton's method needs no less than the stiffness at a point: with more it only takes smaller steps.
    xx, xy, xz, yy, yz, zz = (blocks[0] - blocks[1]).reshape(6, n)
    of_points = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    for j in np.flatnonzero(free[:n]):
        own = stiffness[np.ix_((j, n + j, 2 * n + j), (j, n + j, 2 * n + j))]
        assert np.linalg.eigvalsh(of_points[:, :, j] - own).min() > -1e-5


@pytest.mark.parametrize("numbers", [one() for one in OWN], ids=[force.name for force in OWN.values()])
def test_a_run_keeps_the_energy_and_no_mode_is_beyond_the_bound(numbers):
    net, without = with_and_without(numbers, NETS["rope"])
    errors = [
        np.abs(simulate(net, duration=0.5, step=h, integrator="leapfrog").energy.error).max() for h in (1e-3, 5e-4)
    ]
    assert errors[1] < 0.3 * errors[0] < 0.1
    assert gershgorin(net)[0] > gershgorin(without)[0]


@pytest.mark.parametrize("numbers", [one() for one in OWN], ids=[force.name for force in OWN.values()])
def test_a_net_refuses_numbers_that_are_not_finite_and_a_force_twice(numbers):
    for forces in ((numbers._replace(**{numbers._fields[0]: math.nan}),), (numbers, numbers)):
        with pytest.raises(ValueError, match=OWN[type(numbers)].name if len(forces) == 1 else "forces"):
            dataclasses.replace(NETS["rope"], forces=forces)


class Steady(NamedTuple):
    """A force that says nothing of its bound."""

    strength: float = 2.0


def test_a_force_without_a_bound_leaves_that_of_the_net(monkeypatch):
    monkeypatch.setitem(OWN, Steady, Force("steady", numbers=Steady))
    for net in NETS.values():
        assert gershgorin(dataclasses.replace(net, forces=(Steady(),))) == gershgorin(net)
