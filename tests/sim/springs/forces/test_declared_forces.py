"""Forces that a net declares in `Net.forces`: each at its defaults, against differences of its energy and its force.

A force stores energy, or damps, or does both. Each test takes those that it is about.
"""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pytest

from sim.springs import Net, cloth, rope, simulate
from sim.springs.forces import OWN, Force
from sim.springs.forces.matrices import STIFFNESS
from sim.springs.integrators.implicit.blocks import set_point_blocks
from sim.springs.integrators.implicit.tangent import products
from sim.springs.points.acceleration import set_acceleration
from sim.springs.stability import gershgorin
from sim.springs.state import State, energy

NETS = {"rope": rope(4, 1.0, drag=0.0, damping=0.0), "cloth": cloth(3, 4, damping=0.0)}
D = 1e-6  # [m], [m/s] of the differences


def of_each(condition: Callable[[Force], object], names: Sequence[str] = tuple(NETS)) -> pytest.MarkDecorator:
    """The defaults of each force that meets the condition, with each of the named nets on which it acts."""
    return pytest.mark.parametrize(
        ("numbers", "net"),
        [
            pytest.param(one(), NETS[name], id=f"{force.name}-{name}")
            for one, force in OWN.items()
            for name in names
            if type(NETS[name].kernel_view(1.0)) in force.nets and condition(force)
        ],
    )


def shaken(net: Net) -> np.ndarray:
    """Positions (3, rows, cols) [m] off any symmetry."""
    return net.x0 + 0.05 * np.random.default_rng(1).standard_normal(net.x0.shape)


def in_motion(net: Net) -> np.ndarray:
    """Velocities (3, rows, cols) [m/s], 0 where pinned."""
    v = np.random.default_rng(2).standard_normal(net.x0.shape)
    return v * (net.inverse_masses() > 0.0).reshape(net.shape)


def moved(x: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray]:
    """x with its number i a little less and a little more."""
    step = np.zeros(x.size)
    step[i] = D
    return x - step.reshape(x.shape), x + step.reshape(x.shape)


def with_and_without(numbers: object, net: Net) -> tuple[Net, Net]:
    return dataclasses.replace(net, forces=(numbers,)), net


def force(numbers: object, net: Net, x: np.ndarray, v: np.ndarray | None = None) -> np.ndarray:
    """The force [N] alone, (3 rows cols,), 0 on pinned points. v: velocities, None: at rest."""
    a = np.zeros((2, x.size))
    v = np.zeros(x.size) if v is None else v.reshape(-1).copy()
    for row, each in zip(a, with_and_without(numbers, net), strict=True):
        set_acceleration(x.reshape(-1).copy(), v, 0.0, each.kernel_view(1.0), row)
    return (a[0] - a[1]) * np.tile(net.masses.ravel(), 3)


@of_each(lambda force: force.energy)
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


@of_each(lambda force: force.energy)
def test_the_tangent_is_the_slope_of_the_force_and_the_blocks_hold_it(numbers, net):
    x = shaken(net)
    n, free = x[0].size, np.tile(net.inverse_masses() > 0.0, 3)
    root = np.sqrt(np.tile(net.masses.ravel(), 3))
    expected = np.empty((x.size, x.size))
    found, blocks = [], np.zeros((2, 6 * n))
    for i in range(x.size):
        low, high = moved(x, i)
        expected[i] = (force(numbers, net, low) - force(numbers, net, high)) / (2.0 * D)
    for k, each in enumerate(with_and_without(numbers, net)):
        p = each.kernel_view(1.0)
        found.append(products(x.reshape(-1), np.diag(root), 0.0, p, STIFFNESS))
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


@of_each(lambda force: True)
def test_what_depends_on_velocity_is_left_out_without_damping_and_has_its_facets(numbers, net):
    """Leapfrog and the energy account know damping by `damp` and `power` alone."""
    x, v, f = shaken(net), in_motion(net), OWN[type(numbers)]
    moving, still = force(numbers, net, x, v), force(numbers, net, x)
    p, a = with_and_without(numbers, net)[0].kernel_view(1.0), np.zeros(x.size)
    f.facet("accelerate", type(p))(numbers, x.reshape(-1).copy(), v.reshape(-1).copy(), 0.0, p, False, np.zeros(99), a)
    assert a * np.tile(net.masses.ravel(), 3) == pytest.approx(still, abs=1e-12)
    is_damping = not np.allclose(moving, still, rtol=0.0, atol=1e-12)
    assert is_damping == bool(f.damp)
    assert not (is_damping and f.power is None)


@of_each(lambda force: force.damp)
def test_damping_loses_its_power_and_changes_velocities_as_its_force(numbers, net):
    x, v = shaken(net), in_motion(net)
    damping = force(numbers, net, x, v) - force(numbers, net, x)
    f, p = OWN[type(numbers)], with_and_without(numbers, net)[0].kernel_view(1.0)
    flat, rate = x.reshape(-1), v.reshape(-1)
    lost, given = f.facet("power", type(p))(numbers, flat, rate, 0.0, p, True)
    assert given - lost == pytest.approx(damping @ rate, rel=1e-9)
    assert f.facet("power", type(p))(numbers, flat, rate, 0.0, p, False)[0] == 0.0
    for reverse in (False, True):
        after = rate.copy()
        f.facet("damp", type(p))(numbers, flat, after, 0.0, D, p, reverse)
        assert (after - rate) * np.tile(net.masses.ravel(), 3) == pytest.approx(D * damping, abs=1e-4 * D)


@of_each(lambda force: force.damp)
def test_the_blocks_hold_the_damping_of_each_point(numbers, net):
    x, v = shaken(net), in_motion(net)
    n, (damped, without) = x[0].size, with_and_without(numbers, net)
    blocks = np.zeros((2, 6 * n))
    for row, each in zip(blocks, (damped, without), strict=True):
        set_point_blocks(x.reshape(-1), v.reshape(-1), 0.0, 1.0, each.kernel_view(1.0), row)
    xx, xy, xz, yy, yz, zz = (blocks[0] - blocks[1]).reshape(6, n)
    of_points = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    for j in np.flatnonzero(net.inverse_masses() > 0.0).tolist():
        own = np.zeros((3, 3))
        for e, i in enumerate((j, n + j, 2 * n + j)):
            at_x = [force(numbers, net, one, v) for one in moved(x, i)]
            at_v = [force(numbers, net, x, one) for one in moved(v, i)]
            own[e] = sum((low - high)[[j, n + j, 2 * n + j]] / (2.0 * D) for low, high in (at_x, at_v))
        assert np.linalg.eigvalsh(of_points[:, :, j] - 0.5 * (own + own.T)).min() > -1e-5


@of_each(lambda force: True, ["rope"])
def test_a_run_keeps_its_energy_account_and_no_mode_is_beyond_the_bound(numbers, net):
    net, without = with_and_without(numbers, net)
    errors = [
        np.abs(simulate(net, duration=0.5, step=h, integrator="leapfrog", with_account=True).energy.error).max()
        for h in (1e-3, 5e-4)
    ]
    assert errors[1] < 0.3 * errors[0] < 0.1
    assert (gershgorin(net)[0] > gershgorin(without)[0]) == (OWN[type(numbers)].bound(numbers)[0] > 0.0)


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
