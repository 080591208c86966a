"""No part of a cloth passes another in a step, at any thickness: by a slow look at each step."""

import dataclasses

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, simulate
from sim.springs.state import State, advance, energy
from sim.validation import ApproximationWarning
from tests.sim.springs.kicks.cloths import all_crossings, thrown_layers

QUICK = "symplectic_euler", "leapfrog"
EXPLICIT = [name for name, record in INTEGRATORS.items() if not record.implicit]
METHODS = [pytest.param(name, marks=[] if name in QUICK else pytest.mark.long) for name in EXPLICIT]


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
@pytest.mark.parametrize("name", EXPLICIT)
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


def test_a_run_says_that_layers_were_slowed_down():
    net, v = thrown_layers(0, 1.0, 10.0)
    with pytest.warns(ApproximationWarning, match="[0-9]+ steps of .* parts of the net that touch were slowed down"):
        simulate(net, 0.4, 3, 1 / 60, "symplectic_euler", v=np.moveaxis(v, 0, -1))
