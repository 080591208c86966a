"""Coulomb's law: what can rest does not creep, what slides has mu N, and both at every step that is stable."""

import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, PinPath, rope
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, energy, velocities
from tests.sim.springs.nets import DAMPABLE

G = 9.81  # [m/s^2]
SURFACE = Contact(8000.0, 50.0, 0.4)
LONE = rope(2, stiffness=0.0, damping=0.0, drag=0.0, gravity=G, root=(0.0, 0.0, 50.0), contact=SURFACE)
STEPS = [
    (name, h) for name in DAMPABLE for h in (1 / 60, 1 / 480, 1 / 5000) if h < 1 / 60 or INTEGRATORS[name].implicit
]


def placed(net, position, velocity=(0.0, 0.0, 0.0)):
    state = State.at_rest(net)
    state.x[:, 0, 1], state.v[:, 0, 1] = position, velocity
    return state


def on_sphere(angle, normal_force, centre=(0.0, 0.0, 0.0)):
    """Place at an angle from the top of a sphere of 1.3 m, pressed in by a force [N]."""
    r = 1.3 - normal_force / SURFACE.stiffness
    return np.array(centre) + (r * math.sin(angle), 0.0, r * math.cos(angle))


@pytest.mark.parametrize(("name", "h"), STEPS)
def test_a_point_on_a_sphere_stays_where_friction_holds_it(name, h):
    """17 degrees below the top, tan 17 = 0.31 < 0.4: for a minute, to a micrometre."""
    net = dataclasses.replace(LONE, sphere=(0.0, 0.0, 0.0, 1.3))
    state = placed(net, on_sphere(math.radians(17.0), G * math.cos(math.radians(17.0))))
    start = state.x.copy()
    advance(net, state, INTEGRATORS[name], h, round(60.0 / h))
    assert np.abs(state.x - start)[:, 0, 1].max() < 1e-6


@pytest.mark.parametrize("name", DAMPABLE)
@pytest.mark.parametrize(("pull", "slides"), [(0.39, 0.0), (0.5, 0.1)])
def test_a_pull_above_mu_n_moves_a_point_and_one_below_does_not(name, pull, slides):
    """On a slope: a = g (sin alpha - mu cos alpha), or none; here of gravity (pull, 0, -1) g."""
    net = dataclasses.replace(LONE, floor=0.0, gravity=(pull * G, 0.0, -G))
    state = placed(net, (0.0, 0.0, -G / SURFACE.stiffness))
    advance(net, state, INTEGRATORS[name], 1e-3, 1000)
    assert state.x[0, 0, 1] == pytest.approx(0.5 * slides * G, rel=2e-3, abs=1e-9)
    assert abs(state.x[1, 0, 1]) < 1e-12


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_thrown_point_stops_after_its_way(name):
    """v^2 / (2 mu g), with an error of first order in the step."""
    net = dataclasses.replace(LONE, floor=0.0)
    errors = []
    for h in (1 / 480, 1 / 1920):
        state = placed(net, (0.0, 0.0, -G / SURFACE.stiffness), (1.2, 1.6, 0.0))
        advance(net, state, INTEGRATORS[name], h, round(1.0 / h))
        assert np.abs(velocities(net, state)[:2, 0, 1]).max() < 1e-9
        errors.append(abs(np.hypot(*state.x[:2, 0, 1]) / (4.0 / (2 * 0.4 * G)) - 1.0))
    assert errors[0] < 5e-3
    assert errors[1] < max(0.5 * errors[0], 1e-4)


@pytest.mark.parametrize("name", DAMPABLE)
def test_friction_of_a_cross_pull_acts_against_the_motion(name):
    """A point that slides at 3 m/s is hardly turned by a pull across: friction has only a small part of it."""
    net = dataclasses.replace(LONE, floor=0.0, gravity=(0.0, 0.5, -G))
    state = placed(net, (0.0, 0.0, -G / SURFACE.stiffness), (3.0, 0.0, 0.0))
    h = 1 / 5000
    advance(net, state, INTEGRATORS[name], h, 1000)
    fine = placed(net, (0.0, 0.0, -G / SURFACE.stiffness), (3.0, 0.0, 0.0))
    advance(net, fine, INTEGRATORS["rk4"], 1e-5, 20_000)
    assert velocities(net, state)[:, 0, 1] == pytest.approx(fine.v[:, 0, 1], rel=1e-3, abs=1e-4)


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_moving_sphere_carries_what_lies_on_it_and_the_account_has_its_work(name):
    """The sphere moves at 0.2 m/s from the start: the point slides until it has its speed, then rests on it."""
    net = dataclasses.replace(LONE, sphere=(0.0, 0.0, 0.0, 1.3), sphere_velocity=(0.2, 0.0, 0.0))
    state = placed(net, on_sphere(0.0, G))
    before = energy(net, state)
    advance(net, state, INTEGRATORS[name], 1 / 2000, 2000, with_account=True)
    slip = 0.2**2 / (2 * 0.4 * G)
    assert state.x[0, 0, 1] == pytest.approx(0.2 - slip, abs=3e-4)
    assert velocities(net, state)[0, 0, 1] == pytest.approx(0.2, abs=2e-3)
    change = energy(net, state).total - before.total
    assert change + state.dissipated - state.work == pytest.approx(0.0, abs=1e-3 * 0.5 * 0.2**2 + 2e-4)
    assert state.dissipated == pytest.approx(0.4 * G * slip, rel=0.1)


RADIUS = 1.0  # [m] of the capstan


def over_sphere(friction, turn, links):
    """A weightless stretched rope on a great circle, over the angle `turn`; its pins pull it along at 0.05 m/s."""
    ends = 0.3
    s = np.linspace(-ends, RADIUS * turn + ends, links + 1)
    angle = np.clip(s / RADIUS, 0.0, turn)
    out = s - angle * RADIUS  # beyond the arc, along the tangent
    x = np.zeros((3, 1, links + 1))
    x[0, 0] = RADIUS * np.sin(angle) + out * np.cos(angle)
    x[2, 0] = RADIUS * np.cos(angle) - out * np.sin(angle)
    net = rope(
        links + 1, 0.99 * (s[-1] - s[0]), mass=1e-3, stiffness=400.0 * links, damping=3.0, drag=0.0, gravity=0.0,
        sphere=(0.0, 0.0, 0.0, RADIUS), contact=Contact(4e5, 2.0, friction), end=(1.0, 0.0, 0.0), damping_model="axial",
    )  # fmt: skip
    paths = []
    for end, along in ((0, (0.05, 0.0, 0.0)), (links, (0.05 * math.cos(turn), 0.0, -0.05 * math.sin(turn)))):
        begin = tuple(map(float, x[:, 0, end]))
        paths.append(((0, end), PinPath(0.0, (begin, along, (0.0,) * 3, (0.0,) * 3))))
    return dataclasses.replace(net, x0=x, pin_paths=tuple(paths))


def capstan_ratio(friction, turn, links):
    """Mean tension beyond the sphere over that before it, once the whole rope slides."""
    net = over_sphere(friction, turn, links)
    state = State.at_rest(net)
    h = 0.5 * critical_step(net, "leapfrog", state)
    advance(net, state, INTEGRATORS["leapfrog"], h, int(0.7 / h))
    pulls = np.zeros(links)
    for _ in range(200):
        advance(net, state, INTEGRATORS["leapfrog"], h, int(0.002 / h))
        pulls += np.linalg.norm(np.diff(state.x[:, 0], axis=1), axis=0) - net.families[0].rest
    return pulls[-1] / pulls[0]


@pytest.mark.parametrize("turn", [math.pi / 2, math.pi])
@pytest.mark.parametrize("friction", [0.1, 0.3, 0.5])
def test_a_rope_that_slips_over_a_round_has_the_tensions_of_the_capstan(friction, turn):
    """T1 / T2 = exp(mu theta) (Euler, Eytelwein)."""
    assert capstan_ratio(friction, turn, 100) == pytest.approx(math.exp(friction * turn), rel=3e-3)


def test_the_capstan_s_error_falls_with_the_square_of_the_spacing():
    """A polygon has (1 + mu tan(theta/2)) / (1 - mu tan(theta/2)) at each point. How its ends lie on the round matters
    as much, so that the errors are those of several ropes."""
    coarse, fine = (
        np.abs([capstan_ratio(0.5, math.pi, links) / math.exp(0.5 * math.pi) - 1.0 for links in counts]).mean()
        for counts in ((8, 10, 12), (32, 40, 48))
    )
    assert 0.01 < coarse < 0.05
    assert fine < coarse / 10.0


@pytest.mark.parametrize("seed", range(8))
def test_friction_of_a_point_that_is_torn_loose_acts_against_its_motion(seed):
    """It rests on a moving sphere at the start of a step, where its slip is round-off, and is pulled loose within."""
    rng = np.random.default_rng(seed)
    normal, along = np.linalg.qr(rng.standard_normal((3, 2)))[0].T
    velocity, push, h = rng.uniform(-1.0, 1.0, 3), 10.0, 1e-3
    x = np.zeros((3, 1, 2))
    x[:, 0, 1] = (1.3 - push / SURFACE.stiffness) * normal
    x[:, 0, 0] = x[:, 0, 1] + along
    # The root moves with the sphere, and after a step further by what stretches the link to 30 N.
    path = PinPath(0.0, (tuple(x[:, 0, 0]), tuple(velocity), (0.0,) * 3, tuple(30.0 / 500.0 / h**3 * along)))
    net = dataclasses.replace(
        rope(2, 1.0, 1.0, 500.0, damping=0.0, drag=0.0, contact=SURFACE), gravity=tuple(-push * normal),
        x0=x, sphere=(0.0, 0.0, 0.0, 1.3), sphere_velocity=tuple(velocity), pin_paths=(((0, 0), path),),
    )  # fmt: skip
    state = State.at_rest(net)
    state.v[:, 0, 1] = velocity
    advance(net, state, INTEGRATORS["leapfrog"], h, 1)
    slide = state.v[:, 0, 1] - velocity
    assert slide @ along == pytest.approx(0.5 * h * (30.0 - SURFACE.friction * push), rel=1e-3)
    assert np.linalg.norm(slide - (slide @ along) * along) < 1e-3 * (slide @ along)
