"""No part of a cloth passes another in a step, at any thickness: by a slow look at each step."""

import dataclasses

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, simulate
from sim.springs.state import State, advance, energy
from sim.validation import ApproximationWarning
from tests.sim.springs.kicks.cloths import all_crossings, thrown_layers

QUICK = "symplectic_euler", "leapfrog"
METHODS = [pytest.param(name, marks=[] if name in QUICK else pytest.mark.long) for name in INTEGRATORS]


def crossings_of(net, v, name, step, steps):
    """Crossings in each of `steps` steps of a net that begins with velocities v."""
    state, found = State.at_rest(net), []
    state.v[:] = v
    for _ in range(steps):
        before = state.x.copy()
        advance(net, state, name, step, 1)
        found += all_crossings(before, state.x, *net.shape)
    assert np.isfinite(state.x).all()
    return found


def of_method(net, name):
    """The net, without damping if the method allows none."""
    if not INTEGRATORS[name].undamped_only:
        return net
    families = tuple(family._replace(damping=0.0) for family in net.families)
    return dataclasses.replace(net, families=families, contact=Contact(net.contact.stiffness, 0.0))


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize(("ratio", "step"), [(0.1, 1 / 300), (1.0, 1 / 60), (0.4, 1 / 1200)])
def test_layers_thrown_through_each_other_stay_on_their_sides(name, ratio, step):
    """At 10 m/s."""
    net, v = thrown_layers(1, ratio, 10.0)
    assert crossings_of(of_method(net, name), v, name, step, 25) == []


def test_without_contact_layers_pass():
    net, v = thrown_layers(1, 0.1, 10.0)
    assert len(crossings_of(dataclasses.replace(net, thickness=0.0), v, "leapfrog", 1 / 300, 25)) > 10


@pytest.mark.stress
@pytest.mark.parametrize("name", INTEGRATORS)
@pytest.mark.parametrize("ratio", [0.1, 0.2, 0.4, 0.7, 1.0])
@pytest.mark.parametrize(("speed", "step"), [(10.0, 1 / 60), (10.0, 1 / 300), (3.0, 1 / 300), (10.0, 1 / 1200)])
def test_no_layer_passes_another_at_any_thickness_tilt_speed_and_step(name, ratio, speed, step):
    for seed in range(5):
        net, v = thrown_layers(seed, ratio, speed)
        assert crossings_of(of_method(net, name), v, name, step, 40) == []


def test_momentum_stays_and_the_account_has_what_the_stop_took():
    net, v = thrown_layers(2, 0.3, 10.0, damping=0.0)
    state = State.at_rest(net)
    state.v[:] = v
    momentum, before = (net.masses * v).sum(axis=(1, 2)), energy(net, state).total
    advance(net, state, "symplectic_euler", 1 / 1200, 40, with_account=True)
    assert (net.masses * state.v).sum(axis=(1, 2)) == pytest.approx(momentum, abs=1e-12)
    assert state.dissipated > 0.1 * before
    assert energy(net, state).total + state.dissipated == pytest.approx(before, rel=0.05)


def test_a_point_in_the_middle_of_a_face_pushes_it():
    """Slowly, where the force between particles does not reach: they are 0.7 of the spacing away."""
    net, _ = thrown_layers(0, 0.3, 0.0, size=3, damping=0.0)
    x = net.x0.copy()
    x[2, 3:] += 1.0
    x[:, 5, 0] = 0.035, 0.035, 0.05  # above the first face
    net = dataclasses.replace(net, x0=x, families=tuple(f._replace(stiffness=0.0, damping=0.0) for f in net.families))
    v = np.zeros_like(x)
    v[2, 5, 0] = -0.3
    assert crossings_of(net, v, "symplectic_euler", 1e-3, 200) == []
    state = State.at_rest(net)
    state.v[:] = v
    advance(net, state, "symplectic_euler", 1e-3, 200)
    assert state.x[2, 5, 0] > state.x[2, 0, 0] - 0.2 * net.thickness
    assert state.x[2, 0, 0] < -1e-3


@pytest.mark.parametrize("name", QUICK)
def test_how_the_steps_are_shared_among_calls_changes_nothing(name):
    """Bit by bit: neither a list that lasts over calls nor a new one for a copy changes a sum."""
    net, v = thrown_layers(3, 0.6, 3.0)
    one, parts, copied = (State.at_rest(net) for _ in range(3))
    for state in (one, parts, copied):
        state.v[:] = v
    advance(net, one, name, 1 / 1200, 60)
    for _ in range(12):
        advance(net, parts, name, 1 / 1200, 5)
        advance(net, copied, name, 1 / 1200, 5)
        copied = copied.copy()
        assert copied.lists is None
    for state in (parts, copied):
        assert np.array_equal(state.x, one.x)
        assert np.array_equal(state.v, one.v)


def test_lists_are_made_anew_where_a_state_or_the_thickness_was_changed_from_outside():
    net, v = thrown_layers(3, 0.6, 3.0)
    for thickness, move in ((net.thickness, 0.3), (3.0 * net.thickness, 0.0)):
        state = State.at_rest(net)
        state.v[:] = v
        advance(net, state, "leapfrog", 1 / 1200, 20)
        state.x[2, :3] += move
        other = dataclasses.replace(net, thickness=thickness)
        fresh = state.copy()
        for each in (state, fresh):
            advance(other, each, "leapfrog", 1 / 1200, 20)
        assert np.array_equal(state.x, fresh.x)


def test_a_run_says_that_layers_were_slowed_down():
    net, v = thrown_layers(0, 1.0, 10.0)
    with pytest.warns(ApproximationWarning, match="parts of the net that touch were slowed down in [0-9]+ steps"):
        simulate(net, 0.4, 3, 1 / 60, "symplectic_euler", v=np.moveaxis(v, 0, -1))
