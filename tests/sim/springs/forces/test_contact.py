import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Grab, PinPath, rope
from sim.springs.state import State, advance, velocities
from tests.sim.springs.nets import DAMPABLE
from tests.sim.springs.reference import exact, integrated

POINT = rope(2, stiffness=0.0, damping=0.0, drag=0.0, gravity=0.0, root=(0.0, 0.0, 5.0), floor=0.0)


def lone(contact, **more):
    """One free point above, or on, the floor z = 0; its root is far away and pulls nothing."""
    return dataclasses.replace(POINT, contact=contact, **more)


def placed(net, position, velocity):
    state = State.at_rest(net)
    state.x[:, 0, 1] = position
    state.v[:, 0, 1] = velocity
    return state


def bounce(net, name, h):
    """(speed out over speed in, seconds in contact) of a point that meets the floor at 1 m/s."""
    state = placed(net, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    seconds = 0.0
    while seconds < 0.5:
        advance(net, state, INTEGRATORS[name], h, 10)
        seconds += 10 * h
        if state.x[2, 0, 1] > 0.0:
            break
    return velocities(net, state)[2, 0, 1], seconds


@pytest.mark.parametrize(
    ("damping", "lab", "clipped"),
    [(5.0, 0.756713, 0.768692), (10.7, 0.545987, 0.587519), (20.0, 0.305010, 0.400821), (45.0, 0.016176, 0.181015)],
)
@pytest.mark.parametrize("name", ["leapfrog", "rk4"])
def test_bounces_have_the_closed_forms_restitution(name, damping, lab, clipped):
    """Sticky e = exp(-pi zeta/sqrt(1 - zeta^2)); clipped e = exp(-beta/w (pi - atan(2 beta w/(w^2 - beta^2))))."""
    for law, expected in (("lab", lab), ("clipped", clipped)):
        e, _ = bounce(lone(Contact(800.0, damping, 0.0, law)), name, 1e-5)
        assert e == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize(("law", "seconds"), [("lab", 0.1115), ("clipped", 0.1115)])
def test_a_bounce_takes_as_long_as_the_point_is_below(law, seconds):
    # The clipped force ends at 0.1052 s, but the point is still below the floor then and leaves it freely.
    _, found = bounce(lone(Contact(800.0, 5.0, 0.0, law)), "rk4", 1e-5)
    assert found == pytest.approx(seconds, rel=0.02)


def test_the_clipped_law_never_pulls_and_the_lab_s_does():
    net = lone(Contact(800.0, 45.0))
    state = placed(net, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    speeds = []
    for _ in range(3000):
        advance(net, state, INTEGRATORS["rk4"], 1e-4, 1)
        speeds.append(state.v[2, 0, 1])
    assert np.diff(speeds).min() > -1e-12
    sticky = lone(Contact(800.0, 45.0, 0.0, "lab"))
    state = placed(sticky, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))
    speeds = []
    for _ in range(3000):
        advance(sticky, state, INTEGRATORS["rk4"], 1e-4, 1)
        speeds.append(state.v[2, 0, 1])
    assert np.diff(speeds).min() < -1e-4


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("name", DAMPABLE)
def test_a_point_rests_as_deep_as_its_weight_over_the_stiffness(name, law):
    net = lone(Contact(800.0, 10.7, 0.2, law), gravity=(0.0, 0.0, -10.0))
    state = placed(net, (0.0, 0.0, 0.1), (0.0, 0.0, 0.0))
    advance(net, state, INTEGRATORS[name], 1e-4, 50_000)
    assert state.x[2, 0, 1] == pytest.approx(-0.0125, abs=1e-9)


def test_points_of_a_radius_rest_that_much_higher():
    net = lone(Contact(800.0, 10.7), gravity=(0.0, 0.0, -10.0), radius=0.15)
    state = placed(net, (0.0, 0.0, 0.3), (0.0, 0.0, 0.0))
    advance(net, state, INTEGRATORS["rk4"], 1e-4, 50_000)
    assert state.x[2, 0, 1] == pytest.approx(0.15 - 0.0125, abs=1e-9)


def test_a_rope_on_the_floor_is_carried_by_it():
    """The floor bears the weight of every point: none is deeper than the others."""
    net = rope(6, drag=3.0, gravity=10.0, root=(0.0, 0.0, -0.0125), floor=0.0)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], 1e-3, 30_000)
    assert state.x[2, 0] == pytest.approx(np.full(6, -0.0125), abs=1e-9)


@pytest.mark.parametrize("name", DAMPABLE)
def test_friction_slows_a_sliding_point_by_mu_g_and_then_holds_it(name):
    net = lone(Contact(8000.0, 50.0, 0.3), gravity=(0.0, 0.0, -10.0))
    state = placed(net, (0.0, 0.0, -10.0 / 8000.0), (1.2, 1.6, 0.0))
    advance(net, state, INTEGRATORS[name], 1e-4, 5000)
    v = velocities(net, state)[:, 0, 1]
    assert v[:2] == pytest.approx([0.6 * 0.5, 0.8 * 0.5], rel=2e-3)
    advance(net, state, INTEGRATORS[name], 1e-4, 5000)
    # 2 m/s at 3 m/s^2: v^2/(2 mu g) to a stop.
    assert np.hypot(*state.x[:2, 0, 1]) == pytest.approx(2.0 / 3.0, rel=2e-3)
    assert np.abs(velocities(net, state)[:2, 0, 1]).max() < 1e-9


def test_the_lab_s_law_creeps_where_friction_holds():
    """A steady sideways pull below mu m g: Coulomb friction stops the point, the lab's viscous floor never does."""
    pull = (1.0, 0.0, -10.0)
    held, creeping = (
        lone(Contact(8000.0, 50.0, 0.3, law), gravity=pull) for law in ("clipped", "lab")
    )  # fmt: skip
    speeds = []
    for net in (held, creeping):
        state = placed(net, (0.0, 0.0, -10.0 / 8000.0), (0.0, 0.0, 0.0))
        advance(net, state, INTEGRATORS["rk4"], 1e-4, 50_000)
        speeds.append(velocities(net, state)[0, 0, 1])
    # F/b, and at most a step of the pull.
    assert abs(speeds[0]) < 1.1e-4
    assert speeds[1] == pytest.approx(1.0 / 50.0, rel=1e-6)


def wrapped(mu, nodes, pull):
    """A light rope around half a sphere, its far end pulled down with a constant force, its root drawn steadily."""
    radius, leg = 0.5, 4
    angle = math.pi / nodes
    spacing = 2.0 * radius * math.sin(angle / 2.0)
    around = angle * (np.arange(nodes) + 0.5)
    x = np.concatenate([np.full(leg, radius), radius * np.cos(around), np.full(leg, -radius)])
    down = spacing * np.arange(leg, 0, -1) - spacing / 2
    z = np.concatenate([-down, radius * np.sin(around), -down[::-1]])
    points = len(x)
    contact = Contact(2e5, 5.0, mu, links=False)
    net = rope(points, spacing * (points - 1), 0.002, 20_000.0, 1.0, 0.0, 0.0, contact=contact)
    speed = 0.1
    start = (float(x[0]), 0.0, float(z[0]))
    path = PinPath(0.0, (start, (0.0, 0.0, -speed), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    return dataclasses.replace(
        net,
        x0=np.ascontiguousarray(np.stack([x, np.zeros(points), z])[:, None]),
        sphere=(0.0, 0.0, 0.0, radius),
        pin_paths=(((0, 0), path),),
        grab=Grab(0, points - 1, (-radius, 0.0, -1e4), 1.0, 0.0, pull),
    )


@pytest.mark.parametrize("mu", [0.1, 0.3])
def test_tension_around_a_sphere_grows_as_the_capstan_polygon_s(mu):
    """T2/T1 = (1 + mu tan(theta/2))/(1 - mu tan(theta/2)) at each touching point that the rope turns by theta at."""
    net = wrapped(mu, 16, 5.0)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], 1e-5, 30_000)
    links = np.diff(state.x[:, 0], axis=1)
    lengths = np.linalg.norm(links, axis=0)
    tension = net.families[0].stiffness * (lengths - net.families[0].rest)
    inside = np.linalg.norm(state.x[:, 0], axis=0) < 0.5
    turns = np.arccos(np.clip((links[:, 1:] * links[:, :-1]).sum(axis=0) / (lengths[1:] * lengths[:-1]), -1.0, 1.0))
    ratios, expected = tension[:-1] / tension[1:], (1 + mu * np.tan(turns / 2)) / (1 - mu * np.tan(turns / 2))
    # First and last touching points are not turned evenly: there the surface's normal is not the bisector.
    middle = np.nonzero(inside[1:-1])[0][1:-1]
    assert len(middle) >= 12
    assert ratios[middle] == pytest.approx(expected[middle], rel=5e-3)
    # With links this short it is nearly e^(mu phi).
    whole = tension[middle[0]] / tension[middle[-1] + 1]
    assert whole == pytest.approx(math.exp(mu * turns[middle].sum()), rel=0.02)


def test_explicit_euler_falls_through_the_air_in_its_closed_form():
    """v_n = v_t (1 - (1 - h c/m)^n), v_t = m g/c."""
    net = dataclasses.replace(POINT, floor=None, drag=0.5, gravity=(0.0, 0.0, -10.0))
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["explicit_euler"], 0.01, 100)
    assert -state.v[2, 0, 1] == pytest.approx(20.0 * (1.0 - (1.0 - 0.005) ** 100), rel=1e-13)


@pytest.mark.parametrize(("drag", "terminal"), [(1.0, 10.0), (0.5, 20.0)])
@pytest.mark.parametrize("name", DAMPABLE)
def test_drag_holds_a_falling_point_at_its_terminal_speed(name, drag, terminal):
    net = dataclasses.replace(POINT, floor=None, drag=drag, gravity=(0.0, 0.0, -10.0))
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 1e-3, 60_000)
    assert -velocities(net, state)[2, 0, 1] == pytest.approx(terminal, rel=1e-6)


@pytest.mark.parametrize("h", [1e-3, 0.1, 5.0])
def test_leapfrog_s_drag_alone_is_exact_at_any_step(h):
    net = dataclasses.replace(POINT, floor=None, drag=0.5)
    state = placed(net, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0))
    advance(net, state, INTEGRATORS["leapfrog"], h, 10)
    assert state.v[0, 0, 1] == pytest.approx(3.0 * math.exp(-5.0 * h), rel=1e-12)


def test_a_moving_sphere_carries_what_it_touches():
    """A ball moving up pushes the point above it along, at its own speed once the bounce has died down."""
    net = lone(Contact(800.0, 20.0), sphere=(0.0, 0.0, 0.0, 0.5), sphere_velocity=(0.0, 0.0, 0.7), floor=None,
               gravity=(0.0, 0.0, -10.0))  # fmt: skip
    state = placed(net, (0.0, 0.0, 0.55), (0.0, 0.0, 0.0))
    advance(net, state, INTEGRATORS["rk4"], 1e-4, 50_000)
    assert state.v[2, 0, 1] == pytest.approx(0.7, abs=1e-9)
    assert state.x[2, 0, 1] == pytest.approx(0.7 * 5.0 + 0.5 - 0.0125, abs=1e-9)


@pytest.mark.parametrize("damping", [0.0, 5.0, 20.0])
def test_leapfrog_is_of_second_order_where_a_point_slides_and_bobs(damping):
    """Friction follows the normal force, which damping is a part of: the two are taken symmetrically."""
    net = lone(Contact(800.0, damping, 0.3), gravity=(0.0, 0.0, -10.0))
    start = net.x0.copy()
    start[:, 0, 1] = 0.0, 0.0, -0.0165
    net = dataclasses.replace(net, x0=start)
    v0 = np.zeros_like(start)
    v0[0, 0, 1] = 2.0
    x, _ = exact(net, 0.12, v0)
    errors = [np.abs(integrated(net, "leapfrog", 0.12, steps, v0).x - x).max() for steps in (60, 120, 240)]
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]
    assert errors[2] < 2e-7
