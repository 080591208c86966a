import dataclasses

import numpy as np
import pytest

from sim.springs import INTEGRATORS, rope
from sim.springs.state import State, advance, velocities
from tests.sim.springs.nets import DAMPABLE, FAMILIES, patch


def flying(net, seed=3):
    """The net free in space, stretched and spinning."""
    rng = np.random.default_rng(seed)
    free = dataclasses.replace(net, pinned=frozenset(), gravity=(0.0, 0.0, 0.0), drag=0.0)
    state = State.at_rest(free)
    state.x += 0.02 * rng.standard_normal(state.x.shape)
    state.v += rng.standard_normal(state.v.shape)
    return free, state


def momentum(net, state):
    return (net.masses * velocities(net, state)).reshape(3, -1).sum(axis=1)


def angular_momentum(net, state):
    x, v = state.x.reshape(3, -1), velocities(net, state).reshape(3, -1)
    return (net.masses.reshape(-1, 1) * np.cross(x.T, v.T)).sum(axis=0)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", DAMPABLE)
@pytest.mark.parametrize("make", [rope, patch])
def test_a_free_net_keeps_its_momentum(make, name, model):
    net, state = flying(make(damping_model=model) if make is rope else make(model))
    before = momentum(net, state)
    advance(net, state, INTEGRATORS[name], 1e-3, 1000)
    scale = (net.masses * np.abs(state.v)).sum()
    assert momentum(net, state) == pytest.approx(before, abs=1e-12 * scale)


@pytest.mark.parametrize("name", [name for name in DAMPABLE if INTEGRATORS[name].implicit])
@pytest.mark.parametrize("make", [rope, patch])
def test_a_free_net_keeps_its_momentum_in_long_steps(make, name):
    """As stiff as 1e6 N/m at 1/60 s, where the solver leaves much of the forces."""
    net, state = flying(make().with_stiffness(1e6))
    before = momentum(net, state)
    scale = (net.masses * np.abs(state.v)).sum()
    advance(net, state, INTEGRATORS[name], 1 / 60, 200)
    assert momentum(net, state) == pytest.approx(before, abs=1e-12 * scale)


def test_a_free_net_falls_as_its_weight_says():
    net, state = flying(patch())
    net = dataclasses.replace(net, gravity=(3.0, 5.0, -8.0))
    before = momentum(net, state)
    advance(net, state, INTEGRATORS["tr_bdf2"], 1e-3, 1000)
    expected = before + net.masses.sum() * np.array(net.gravity)
    assert momentum(net, state) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", ["leapfrog", "symplectic_euler", "implicit_midpoint"])
@pytest.mark.parametrize("make", [rope, patch])
def test_axial_damping_keeps_the_angular_momentum(make, name):
    net, state = flying(make(damping_model="axial") if make is rope else make("axial"))
    before = angular_momentum(net, state)
    scale = (net.masses * np.linalg.norm(state.x, axis=0) * np.linalg.norm(state.v, axis=0)).sum()
    advance(net, state, INTEGRATORS[name], 1e-3, 1000)
    assert angular_momentum(net, state) == pytest.approx(before, abs=1e-12 * scale)


def test_isotropic_damping_takes_the_angular_momentum():
    net, state = flying(rope(damping_model="isotropic"))
    before = angular_momentum(net, state)
    advance(net, state, INTEGRATORS["leapfrog"], 1e-3, 1000)
    assert np.abs(angular_momentum(net, state) - before).max() > 0.1 * np.abs(before).max()


def test_undamped_leapfrog_runs_backwards_to_where_it_began():
    net = rope(10, damping=0.0, drag=0.0)
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS["leapfrog"], 1 / 240, 240)
    state.v *= -1.0
    advance(net, state, INTEGRATORS["leapfrog"], 1 / 240, 240)
    assert np.abs(state.x - net.x0).max() < 1e-10
    assert np.abs(state.v).max() < 1e-8


@pytest.mark.parametrize("name", DAMPABLE)
def test_the_motion_does_not_depend_on_where_it_happens(name):
    here, there = rope(8), rope(8, root=(1.0, -2.0, 3.0))
    a, b = State.at_rest(here), State.at_rest(there)
    for net, state in ((here, a), (there, b)):
        advance(net, state, INTEGRATORS[name], 1e-3, 500)
    assert b.x - a.x == pytest.approx(np.broadcast_to(np.array([1.0, -2.0, 3.0])[:, None, None], a.x.shape), abs=1e-10)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
@pytest.mark.parametrize("name", DAMPABLE)
def test_the_motion_turns_with_the_scene(name, model):
    """A rope and its gravity turned by a quarter about z, then about x, move as the rope did, turned."""
    net = dataclasses.replace(rope(8, damping_model=model), gravity=(1.0, 2.0, -10.0))
    turned = dataclasses.replace(net, x0=np.ascontiguousarray(net.x0[[2, 0, 1]]), gravity=(-10.0, 1.0, 2.0))
    a, b = State.at_rest(net), State.at_rest(turned)
    advance(net, a, INTEGRATORS[name], 1e-3, 500)
    advance(turned, b, INTEGRATORS[name], 1e-3, 500)
    assert b.x == pytest.approx(a.x[[2, 0, 1]], abs=1e-11)


@pytest.mark.parametrize("name", DAMPABLE)
def test_a_rope_is_a_net_of_one_row(name):
    """The rope's own fast path and the general one are the same motion."""
    line = rope(9)
    # Families without stiffness take a cloth's path.
    other = (family._replace(stiffness=0.0, damping=0.0) for family in FAMILIES[1:])
    general = dataclasses.replace(line, families=(*line.families, *other))
    a, b = State.at_rest(line), State.at_rest(general)
    advance(line, a, INTEGRATORS[name], 1e-3, 500)
    advance(general, b, INTEGRATORS[name], 1e-3, 500)
    # Of the implicit methods, a small fraction of the method's own error, which is 1e-3 m of implicit Euler.
    within = {"implicit_euler": 1e-6, "tr_bdf2": 1e-8, "implicit_midpoint": 1e-8}
    assert b.x == pytest.approx(a.x, abs=within.get(name, 1e-11))


@pytest.mark.parametrize("name", DAMPABLE)
def test_twice_the_same_is_the_same(name):
    net = patch()
    states = [State.at_rest(net), State.at_rest(net)]
    for state in states:
        advance(net, state, INTEGRATORS[name], 1e-3, 300)
    assert (states[0].x == states[1].x).all()
