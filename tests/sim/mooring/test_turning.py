"""Stiffness that lines add to the rotation of a body, against an inverted double pendulum in closed form."""

from pathlib import Path

import numpy as np
import pytest

from sim.mooring import Line, LineType, MooredBody, Point, System, read_moordyn
from sim.mooring.turning import stiffness_of_turning, with_turning
from sim.water import Water
from tests.sim.mooring.dense import frequencies_squared

LENGTH, ARM, MASS, INERTIA, LIFT = 30.0, 2.0, 5e3, 1.2e4, 6e4
FILES = Path(__file__).with_name("moordyn") / "files"


def tethered(lift: float = LIFT) -> System:
    """A body that a tether holds down below its middle."""
    kind = LineType("tether", 1e-3, 1e-3, 1e9, 0.0)
    points = (Point(1, "fixed", (0.0, 0.0, -50.0)), Point(2, "body", (0.0, 0.0, LENGTH - 50.0), body=1))
    mass = np.diag([MASS] * 3 + [INERTIA] * 3)
    body = MooredBody(
        1, (0.0, 0.0, LENGTH + ARM - 50.0), mass, np.diag([0.0] * 3 + [1.0] * 3), steady=(0, 0, lift, 0, 0, 0)
    )
    return System((Line(1, kind, 1, 2, LENGTH, 1),), points, Water(60.0, density=0.0), (body,))


def test_a_tethered_body_swings_as_the_double_pendulum_does():
    """Angles p of the tether, q of the body: potential F (L p^2 + b q^2)/2, kinetic m (L p' + b q')^2/2 + I q'^2/2."""
    mass = np.array([[MASS * LENGTH**2, MASS * LENGTH * ARM], [MASS * LENGTH * ARM, MASS * ARM**2 + INERTIA]])
    exact = np.sort(np.linalg.eigvals(np.linalg.solve(mass, LIFT * np.diag([LENGTH, ARM]))))
    system = tethered()
    found = frequencies_squared(with_turning(system, system.at_rest()))
    assert found[1:5] == pytest.approx(np.repeat(exact, 2), rel=1e-3)  # the first is the yaw, held by 1 N m


def test_a_force_is_the_gradient_of_its_potential_about_any_axis():
    rng = np.random.default_rng(2)
    arm, force, turn = rng.normal(size=(3, 3))
    cross = np.cross(np.eye(3), turn)  # cross @ v = turn x v
    second = 0.5 * force @ cross @ cross @ arm  # of -F . R(turn) arm, with the sign changed
    assert 0.5 * turn @ stiffness_of_turning(arm, force) @ turn == pytest.approx(-second)


def test_a_body_that_its_lines_turn_over_gets_no_negative_stiffness():
    system = tethered(-LIFT)
    rest = system.at_rest()
    upside_down = with_turning(system, rest)  # the tether hangs, and pulls on nothing
    values = np.linalg.eigvalsh(np.asarray(upside_down.bodies[0].stiffness))
    assert values.min() >= 0.0


def test_the_ropes_of_a_buoy_from_a_file_keep_it_upright():
    """Each pulls at its arm: with the buoyancy at its centre they give 3 F . a, less the half of that in the plane."""
    system = read_moordyn(FILES / "buoy.txt")
    stiffness = np.asarray(system.bodies[0].stiffness)
    rest, lift = system.at_rest(), (12.0 * 1025.0 - 4000.0) * 9.81
    total = np.zeros((3, 3))
    for i in (1, 2, 3):
        arm = rest.x[i][-1] - [0.0, 0.0, -20.0] - rest.bodies[1][:3]
        way = rest.x[i][-2] - rest.x[i][-1]
        pull = rest.tension[i][-1] * way / np.linalg.norm(way)
        pull[2] -= 0.5 * 5.4 * 9.81 * (5.0 - 1025.0 * np.pi / 4.0 * 0.05**2)  # half a segment hangs on the fairlead
        total += stiffness_of_turning(arm, pull)
    assert stiffness[3:, 3:] == pytest.approx(total + np.diag([0.5 * lift, 0.5 * lift, 0.0]), rel=1e-4, abs=1.0)
    assert stiffness[3, 3] > 1.5 * 0.5 * lift
