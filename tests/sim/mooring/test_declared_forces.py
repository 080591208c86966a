"""Forces with an energy that a mooring declares in `System.forces`: each at its defaults, on lines that hold a body."""

import dataclasses

import numpy as np
import pytest

from sim.mooring import Line, LineType, Point, State, System, simulate
from sim.mooring.rest.balance import what_is_left
from sim.mooring.tangent import declared_stiffness, is_declared
from sim.springs.analysis.energy import energies
from sim.springs.forces import OWN
from sim.springs.forces.record import Absent
from sim.springs.points.acceleration import set_rest_forces
from sim.springs.points.line_arrays import LineArrays
from sim.water import Water
from tests.sim.mooring.dense import stiffness_matrix
from tests.sim.mooring.systems import floating_body

WIRE = LineType("wire", 0.02, 1.0, 5e3, 0.0)
ON_LINES = {one: force for one, force in OWN.items() if LineArrays in force.nets and force.energy}
OF_EACH = pytest.mark.parametrize("numbers", [one() for one in ON_LINES], ids=[one.name for one in ON_LINES.values()])
D = 1e-5  # [m] of the differences


def line() -> System:
    """Two wires in a row below the origin without water, from a fixed point by a free one to a body."""
    points = (
        Point(1, "fixed", (-1.0, 0.1, -1.5)), Point(2, "free", (0.1, 0.0, -2.0)),
        Point(3, "body", (1.0, 0.0, -1.0), body=1),
    )  # fmt: skip
    lines = Line(1, WIRE, 1, 2, 1.2, 3), Line(2, WIRE, 2, 3, 1.3, 3)
    return System(lines, points, Water(5.0, density=0.0), (floating_body(1e4),))


def with_and_without(numbers: object) -> tuple[System, System]:
    return dataclasses.replace(line(), forces=(numbers,)), line()


def force(numbers: object, x: np.ndarray) -> np.ndarray:
    """The force [N] alone on the nodes (3, nodes)."""
    found = np.zeros((2, x.size))
    for row, system in zip(found, with_and_without(numbers), strict=True):
        set_rest_forces(x.reshape(-1).copy(), system.kernel_view(1.0), row)
    return (found[0] - found[1]).reshape(x.shape)[:, : line().node_count]


@OF_EACH
def test_force_energy_and_tangent_of_each_agree_on_lines(numbers):
    x = line().at_rest().nodes
    own = force(numbers, x)
    assert np.any(own)
    for j in range(1, own.shape[1]):  # the first is fixed, and has no energy
        for e in range(3):
            stored = []
            for sign in (1.0, -1.0):
                near = x.copy()
                near[e, j] += sign * D
                one, other = (
                    sum(energies(near.reshape(-1), np.zeros(x.size), 0.0, system.kernel_view(1.0)))
                    for system in with_and_without(numbers)
                )
                stored.append(one - other)
            assert own[e, j] == pytest.approx((stored[1] - stored[0]) / (2.0 * D), abs=1e-6)
    one, other = (stiffness_matrix(x, system.kernel_view(1.0)) for system in with_and_without(numbers))
    free = np.array([1, 3, 4, 5, 6])  # the third carries the body
    step = 1e-4 * np.random.default_rng(1).standard_normal((3, len(free)))
    moved = x.copy()
    moved[:, free] += step
    change = (force(numbers, moved) - own)[:, free].reshape(-1)
    # The blocks of single nodes, by which a state of rest is found.
    with_it, without = (declared_stiffness(x, system.kernel_view(1.0)) for system in with_and_without(numbers))
    assert not np.any(without)
    for j in free:
        for e in range(3):
            near = x.copy()
            near[e, j] += D
            slope = (force(numbers, near) - own)[:, j] / D
            assert slope == pytest.approx(-with_it[j, :, e], abs=1e-3 * max(1.0, np.abs(with_it).max()))
    count = change.size
    assert change == pytest.approx(-((one - other)[:count, :count] @ step.reshape(-1)), abs=1e-6)


@OF_EACH
def test_a_line_rests_and_keeps_its_energy_with_each(numbers):
    system, without = with_and_without(numbers)
    rest = system.at_rest()
    assert what_is_left(rest.nodes, system.kernel_view(1.0))[1]
    assert np.abs(rest.nodes - without.at_rest().nodes).max() > 1e-4
    run = simulate(system, duration=0.5, frames=6, step=2e-4, start=State.at_rest(without), with_account=True)
    moved = np.abs(run.x[1][-1] - run.x[1][0]).max()
    assert moved > 1e-4
    assert np.abs(run.energy.error).max() < 1e-4 * np.ptp(run.energy.kinetic)


def test_a_mooring_declares_a_force_if_one_of_its_forces_has_numbers():
    p, there = line().kernel_view(1.0), (2.0,)
    assert not is_declared(p)
    for forces in ((), (Absent(),), (Absent(), Absent())):
        assert not is_declared(p._replace(forces=forces))
    for forces in ((there,), (Absent(), there), (there, Absent())):
        assert is_declared(p._replace(forces=forces))
