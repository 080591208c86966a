"""What water and bed do to a line, component by component, from Morison's law in closed form."""

import math

import numpy as np
import pytest

from sim.mooring import Line, LineType, MooredBody, Point, System
from sim.springs.analysis.energy import power
from sim.springs.damping import damp_lines
from sim.springs.forces.links import set_tensions
from sim.springs.forces.matrices import DAMPING, STIFFEST, STIFFNESS
from sim.springs.forces.under_water.water import tangent as buoyancy_tangent
from sim.springs.kicks.lines import kick_lines, make_lines_system
from sim.springs.points.acceleration import set_acceleration
from sim.springs.points.line_points import set_inverse_masses
from sim.water import Water
from sim.waves import Waves
from tests.sim.mooring.systems import floating_body

ROPE = LineType("rope", 0.1, 12.0, 1.0, 0.0, 0.9, 1.3, 0.4, 0.07)  # so soft that it does not pull
LENGTH, SPACING = 20.0, 10.0  # of the line and of its two links, which are slack
WAYS = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.48, 0.6, 0.64)]


def one_node(way, gravity=9.81, **more) -> tuple[System, np.ndarray]:
    """A line along `way` with one inner node, and its positions (3 points) with the node last."""
    end = tuple((8.0 * np.array(way)).tolist())
    points = (Point(1, "fixed", (0.0, 0.0, -30.0)), Point(2, "fixed", (end[0], end[1], end[2] - 30.0)))
    system = System((Line(1, ROPE, 1, 2, LENGTH, 2),), points, Water(60.0, gravity), bed_stiffness=0.0, **more)
    x = np.array([point.position for point in points] + [0.5 * np.add(points[0].position, points[1].position)]).T
    return system, np.ascontiguousarray(x).reshape(-1)


def mass_matrix(way) -> np.ndarray:
    q, displaced = np.array(way), 1025.0 * math.pi / 4.0 * 0.1**2 * SPACING
    return 12.0 * SPACING * np.eye(3) + displaced * (0.9 * (np.eye(3) - np.outer(q, q)) + 0.4 * np.outer(q, q))


def drag(way, flow) -> np.ndarray:
    q, w = np.array(way), np.array(flow)
    along = (w @ q) * q
    across = w - along
    half = 0.5 * 1025.0 * 0.1 * SPACING
    return half * (1.3 * np.linalg.norm(across) * across + math.pi * 0.07 * np.linalg.norm(along) * along)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("flow", [(0.0, 0.0, 1.5), (0.7, -0.4, 0.3)])
def test_a_current_drags_a_line_across_and_along(way, flow):
    system, x = one_node(way, current=flow, gravity=0.0)
    p, v, a = system.kernel_view(1.0), np.zeros(9), np.empty(9)
    v[2::3] = (0.2, 0.1, -0.3)
    set_acceleration(x, v, 0.0, p, a)
    relative = np.array(flow) - v[2::3]
    assert a[2::3] == pytest.approx(np.linalg.solve(mass_matrix(way), drag(way, relative)), rel=1e-9)
    own = np.array(flow)  # the ends do not move
    lost = drag(way, relative) @ relative + drag(way, own) @ own
    assert power(x, v, 0.0, p, True)[0] == pytest.approx(lost, rel=1e-9)


def damped(p, x, v, s) -> np.ndarray:
    """The velocities after damping alone for a time s [s]."""
    found = v.copy()
    set_inverse_masses(x, p)
    kick_lines(x, found, np.zeros_like(v), 0.0, s, p, True, make_lines_system(p), np.zeros(3))
    return found


@pytest.mark.parametrize("way", WAYS)
def test_drag_alone_has_the_closed_form_across_and_along(way):
    """Along each of the two directions |w| falls as w/(1 + D w s/m); of a line along an axis they do not mix."""
    system, x = one_node(way, current=(0.5, 0.2, 0.9), gravity=0.0)
    p, s = system.kernel_view(1.0), 1e-5
    v = damped(p, x, np.zeros(9), s)
    rate = np.linalg.solve(mass_matrix(way), drag(way, (0.5, 0.2, 0.9)))
    assert v[2::3] / s == pytest.approx(rate, rel=1e-3)
    again = np.zeros(9)
    for _ in range(50):
        again = damped(p, x, again, 0.01)
    q, w = np.array(way), np.array((0.5, 0.2, 0.9))
    for part, coefficient, added in (((w @ q) * q, math.pi * 0.07, 0.4), (w - (w @ q) * q, 1.3, 0.9)):
        speed = np.linalg.norm(part)
        heavy = 12.0 * SPACING + added * 1025.0 * math.pi / 4.0 * 0.1**2 * SPACING
        ratio = 0.5 * 1025.0 * 0.1 * SPACING * coefficient * speed * 0.5 / heavy
        if speed > 0.0:
            assert again[2::3] @ part / speed == pytest.approx(speed * ratio / (1.0 + ratio), rel=1e-4)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("t", [0.0, 1.7])
def test_a_wave_alone_pushes_by_its_acceleration_and_drags_by_its_velocity(way, t):
    k, omega = 0.08, math.sqrt(9.81 * 0.08 * math.tanh(0.08 * 60.0))
    one = np.ones(1)
    waves = Waves(0.8 * k * one, 0.6 * k * one, 1.2 * one, 0.9 * one, omega * one, Water(60.0))
    system, x = one_node(way, waves=waves)
    p, v, a = system.kernel_view(1.0), np.zeros(9), np.empty(9)
    place = x[2::3]
    set_acceleration(x, v, t, p, a)
    theta = k * (0.8 * place[0] + 0.6 * place[1]) - omega * t + 0.9
    level = 1.2 * omega * math.cosh(k * (place[2] + 60.0)) / math.sinh(k * 60.0)
    upward = 1.2 * omega * math.sinh(k * (place[2] + 60.0)) / math.sinh(k * 60.0)
    flow = np.array([0.8 * level * math.cos(theta), 0.6 * level * math.cos(theta), upward * math.sin(theta)])
    change = omega * np.array([0.8 * level * math.sin(theta), 0.6 * level * math.sin(theta), -upward * math.cos(theta)])
    q, displaced = np.array(way), 1025.0 * math.pi / 4.0 * 0.1**2 * SPACING
    along = (change @ q) * q
    force = displaced * (1.9 * (change - along) + 1.4 * along) + drag(way, flow)
    force[2] -= 9.81 * (12.0 * SPACING - displaced)
    assert a[2::3] == pytest.approx(np.linalg.solve(mass_matrix(way), force), rel=1e-8)


def on_bed(friction: float, damping: float) -> tuple[System, np.ndarray]:
    """One node 1 cm deep in a bed, between ends that do not pull, without water."""
    points = (Point(1, "fixed", (-8.0, 0.0, -10.0)), Point(2, "fixed", (8.0, 0.0, -10.0)))
    lines = (Line(1, ROPE._replace(diameter=0.08), 1, 2, LENGTH, 2),)
    system = System(lines, points, Water(10.0, density=0.0), bed_stiffness=1e5, bed_damping=damping, friction=friction)
    return system, np.array([-8.0, 8.0, 0.0, 0.0, 0.0, 0.0, -10.0, -10.0, -10.01])


@pytest.mark.parametrize("reverse", [False, True])
def test_a_node_slides_to_rest_by_friction_and_sinks_in_by_the_damping_of_the_bed(reverse):
    system, x = on_bed(0.6, 2e4)
    p, area, mass = system.kernel_view(1e-3), 0.08 * SPACING, 12.0 * SPACING
    slide, s = 0.6 * area * 1e5 * 0.01 / mass, 0.02  # [m/s2], [s]
    v, a = np.zeros(9), np.empty(9)
    v[2::3] = (0.3, 0.4, -0.2)
    set_acceleration(x, v, 0.0, p, a)
    lift = area * (1e5 * 0.01 + 2e4 * 0.2) / mass - 9.81
    assert a[2::3] == pytest.approx([-0.6 * slide, -0.8 * slide, lift], rel=1e-9)
    lost = mass * slide * 0.5 + area * 2e4 * 0.2**2
    assert power(x, v, 0.0, p, True)[0] == pytest.approx(lost, rel=1e-9)
    damp_lines(x, v, 0.0, s, p, reverse)
    assert np.hypot(v[2], v[5]) == pytest.approx(0.5 - slide * s, rel=1e-9)
    assert v[5] / v[2] == pytest.approx(4.0 / 3.0, rel=1e-9)
    v[2:6:3] = 0.0
    assert damped(p, x, v, 1e-4)[8] == pytest.approx(-0.2 * math.exp(-area * 2e4 * 1e-4 / mass), rel=1e-6)
    v[2::3] = (0.3, 0.4, -0.2)
    damp_lines(x, v, 0.0, 10.0, p, reverse)
    assert np.abs(v[2:6:3]).max() < 1e-15  # it stops, and does not turn back
    crawl = np.zeros(9)
    crawl[2] = 1e-6
    set_acceleration(x, crawl, 0.0, p, a)
    assert a[2] == pytest.approx(-1e-6 * 1e3, rel=1e-9)  # no more than stops it within a step of 1 ms
    x[8] = -9.99
    v[2::3] = (0.3, 0.4, -0.2)
    damp_lines(x, v, 0.0, s, p, reverse)
    assert damped(p, x, v, s)[2::3] == pytest.approx([0.3, 0.4, -0.2])  # above the bed


def test_tension_of_a_link_holds_its_damping_in_the_order_of_the_line():
    kind = LineType("wire", 0.02, 1.0, 4000.0, 50.0)
    points = (Point(1, "fixed", (0.0, 0.0, 0.0)), Point(2, "fixed", (0.0, 4.0, 0.0)))
    p = System((Line(1, kind, 1, 2, 3.0, 2),), points, Water(10.0, density=0.0), bed_stiffness=0.0).kernel_view(1.0)
    x, v, out, a = np.zeros(9), np.zeros(9), np.empty(2), np.empty(9)
    x[3:6], v[3:6] = (0.0, 4.0, 1.7), (0.0, 0.0, 0.4)  # the node at y = 1.7, moving towards the end
    set_tensions(x, v, p, out)
    first, last = 4000.0 / 1.5 * 0.2 + 50.0 / 1.5 * 0.4, 4000.0 / 1.5 * 0.8 - 50.0 / 1.5 * 0.4
    assert out == pytest.approx([first, last])
    set_acceleration(x, v, 0.0, p, a)
    assert a[2::3] == pytest.approx([0.0, (last - first) / 1.5, -9.81])
    v[3:6] = (0.0, 0.0, 0.4)
    assert damped(p, x, v, 1e-3)[5] == pytest.approx(0.4 * math.exp(-2.0 * 50.0 / 1.5 * 1e-3 / 1.5), rel=1e-5)


def test_moved_ends_work_against_the_damping_of_their_links():
    kind = LineType("wire", 0.02, 1.0, 4000.0, 50.0)
    points = (Point(1, "coupled", (0.0, 0.0, 0.0)), Point(2, "coupled", (0.0, 4.0, 0.0)))
    p = System((Line(1, kind, 1, 2, 3.0, 2),), points, Water(10.0, density=0.0), bed_stiffness=0.0).kernel_view(1.0)
    x, v = np.zeros(9), np.zeros(9)
    x[3:6], v[3:6] = (0.0, 4.0, 1.7), (-0.2, 0.3, 0.4)
    p.paths[:, 1, 1] = (-0.2, 0.3)
    expected, s = 50.0 / 1.5 * (0.6 * 0.2 - 0.1 * 0.3), 1e-6
    set_inverse_masses(x, p)
    assert kick_lines(x, v, np.zeros(9), 0.0, s, p, True, make_lines_system(p), np.zeros(3)) / s == pytest.approx(
        expected, rel=1e-3
    )


def test_the_pull_of_a_line_turns_a_body_about_its_reference_point():
    arm, pull = np.array([1.5, -0.9, 2.0]), 4000.0 / 3.0  # stretched from 3 to 4 m
    kind = LineType("wire", 1e-6, 1e-9, 4000.0, 0.0)
    mass = np.diag([10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    body = MooredBody(1, (0.0, 0.0, 0.0), mass, np.zeros((6, 6)))
    way = np.array([0.48, 0.6, 0.64])
    points = Point(1, "body", tuple(arm.tolist()), body=1), Point(2, "fixed", tuple((arm + 4.0 * way).tolist()))
    system = System((Line(1, kind, 1, 2, 3.0, 1),), points, Water(50.0, 0.0, 0.0), (body,), bed_stiffness=0.0)
    x, a = np.zeros((3, 4)), np.empty(12)
    x[:, 0], x[:, 1] = arm, arm + 4.0 * way
    set_acceleration(x.reshape(-1), np.zeros(12), 0.0, system.kernel_view(1.0), a)
    force = np.concatenate((pull * way, np.cross(arm, pull * way)))
    found = a.reshape(3, 4)
    assert found[:, 2:].T.reshape(-1) == pytest.approx(force / np.diag(mass), rel=1e-6, abs=1e-6)
    turn, shift = found[:, 3], found[:, 2]
    assert found[:, 0] == pytest.approx(shift + np.cross(turn, arm), rel=1e-6, abs=1e-6)


def test_the_node_of_a_fairlead_has_the_mobility_of_its_body_there():
    """J M^-1 J^T, with J of a displacement and a small turn about the body's reference point."""
    body, arm = floating_body(), np.array([1.0, -2.0, 3.0])
    points = Point(1, "fixed", (-8.0, 0.0, -10.0)), Point(2, "body", tuple(arm), body=1)
    light = ROPE._replace(mass=1e-9)  # half the mass of the last link adds to the body's
    system = System((Line(1, light, 1, 2, LENGTH, 3),), points, Water(20.0, density=0.0), (body,))
    p, x = system.kernel_view(1e-3), system.start().ravel()
    set_inverse_masses(x, p)
    n, j = p.cols, int(p.carried[0, 0])
    xx, xy, xz, yy, yz, zz = p.inertia[j::n]
    motion = np.hstack([np.eye(3), -np.cross(arm, np.eye(3)).T])
    expected = motion @ np.linalg.inv(np.asarray(body.mass)) @ motion.T
    assert np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_buoyancy_at_the_surface_is_a_stiffness_and_no_damping():
    system, x = one_node((1.0, 0.0, 0.0))
    x[6:] = 0.0
    p, u = system.kernel_view(1e-3), np.ones(9)
    for part, acts in ((STIFFNESS, True), (STIFFEST, True), (DAMPING, False)):
        out = np.zeros(9)
        buoyancy_tangent(x, u, 0.0, p, part, 0.0, out)
        assert np.any(out) == acts
