"""The estimate of the largest stable step where a net touches floor or sphere, before it does."""

import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, rope
from sim.springs.stability import critical_step, gauge
from sim.springs.state import State, advance, energy

POINTS, LENGTH, RADIUS = 30, 3.0, 0.02
# Explicit Euler's limit is that of the least damped of all modes, and only a guide.
METHODS = [name for name, record in INTEGRATORS.items() if math.isfinite(record.limit(0.0)) and record.limit(0.0) > 0.0]


def hanging(stiffness, damping, contact, model="isotropic", **more):
    return rope(POINTS, LENGTH, 0.1, stiffness, damping, 0.0, root=(0.0, 0.0, 3.5), damping_model=model,
                contact=contact, radius=RADIUS, **more)  # fmt: skip


def at(points):
    return State.still(np.ascontiguousarray(points.T[:, None]))


def landings(net):
    """States in which different parts of a rope touch: all, every second point, the last one, or links on a sphere."""
    along, none = np.linspace(0.0, LENGTH, POINTS), np.zeros(POINTS)
    if net.sphere is not None:
        angle = np.linspace(-0.5 * LENGTH, 0.5 * LENGTH, POINTS) / (net.sphere[3] + RADIUS)
        return [at((net.sphere[3] + RADIUS - 1e-4) * np.column_stack([np.sin(angle), none, np.cos(angle)]))]
    deep = np.full(POINTS, RADIUS - 1e-4)
    second = deep + 0.02 * (np.arange(POINTS) % 2)
    lines = [np.column_stack([along, none, z]) for z in (deep, second)]
    return [*map(at, lines), at(np.column_stack([none, none, along[::-1] + RADIUS - 1e-4]))]


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize(
    ("stiffness", "damping", "contact", "model"),
    [
        (800.0, 0.1, Contact(1000.0, 1.0, 0.3), "isotropic"),
        (800.0, 0.1, Contact(1e5, 1.0, 0.3), "axial"),
        (5e4, 1.0, Contact(1000.0, 10.0, 0.3), "isotropic"),
        (800.0, 1.0, Contact(1000.0, 30.0, 0.3), "isotropic"),
        (100.0, 0.0, Contact(3000.0, 5.0, 0.5), "isotropic"),
        (800.0, 0.0, Contact(1e4, 0.0), "isotropic"),
    ],
)
@pytest.mark.parametrize("surface", [{"floor": 0.0}, {"sphere": (0.0, 0.0, 0.0, 1.0)}])
def test_no_landing_needs_a_shorter_step_than_the_estimate(name, stiffness, damping, contact, model, surface):
    """And the worst of them no step that is much longer."""
    if INTEGRATORS[name].undamped_only:
        damping, contact = 0.0, Contact(contact.stiffness, 0.0)
    net = hanging(stiffness, damping, contact, model, **surface)
    estimate, limits = critical_step(net, name, landed=True), [critical_step(net, name, each) for each in landings(net)]
    assert 0.35 * min(limits) < estimate < 1.02 * min(limits)


@pytest.mark.parametrize("stiffness", [100.0, 1e4, 1e6])
def test_of_a_rope_that_lies_on_the_floor_contact_counts_once(stiffness):
    net = hanging(800.0, 0.0, Contact(stiffness, 0.0), floor=0.0)
    for state in landings(net):
        limit = critical_step(net, "leapfrog", state)
        assert 0.85 * limit < critical_step(net, "leapfrog", state, landed=True) < 1.001 * limit


def test_where_contact_is_far_stiffer_than_the_links_the_estimate_is_that_of_the_contact():
    net = hanging(800.0, 0.0, Contact(1e6, 0.0), floor=0.0)
    exact = 2.0 / math.sqrt(1e6 / net.mass)
    assert critical_step(net, "leapfrog", landed=True) == pytest.approx(exact, rel=2e-3)
    assert critical_step(net, "leapfrog") > 15.0 * exact


@pytest.mark.parametrize("name", ["leapfrog", "symplectic_euler", "rk4"])
def test_a_step_that_is_stable_in_the_air_throws_a_rope_up_and_one_of_the_estimate_does_not(name):
    """A rope that falls on the floor. Within the estimate an impact gains little, and less the shorter the step is."""
    net = dataclasses.replace(hanging(800.0, 0.1, Contact(1e5, 5.0), floor=0.0), pinned=frozenset())
    landed, largest = critical_step(net, name, landed=True), []
    for h in (2.5 * landed, 0.2 * landed):
        assert h < 0.9 * critical_step(net, name)
        state, most = State.at_rest(net), 0.0
        before = energy(net, state).total
        for _ in range(40):
            advance(net, state, name, h, round(0.05 / h))
            most = max(most, energy(net, state).total / before)
        largest.append(most)
    assert largest[0] > 5.0
    assert largest[1] < 1.05


def test_the_gauge_estimates_nothing_for_explicit_euler():
    net = hanging(800.0, 0.1, Contact(1e5, 5.0), floor=0.0)
    state = State.at_rest(net)
    assert math.isinf(gauge(net, "explicit_euler", 1e-3, state).landed_step)
    assert math.isfinite(gauge(net, "symplectic_euler", 1e-3, state).landed_step)


def test_the_gauge_tells_a_step_that_is_too_long_only_in_contact():
    net = hanging(800.0, 0.0, Contact(1e5, 0.0), floor=0.0)
    limit, landed = critical_step(net, "leapfrog"), critical_step(net, "leapfrog", landed=True)
    for step, too_long in ((0.9 * landed, False), (1.1 * landed, True), (0.9 * limit, True), (1.1 * limit, False)):
        reading = gauge(net, "leapfrog", step, State.at_rest(net))
        assert (reading.critical_step, reading.landed_step) == (limit, landed)
        assert reading.is_too_long_landed is too_long  # beyond both it is too long anyway


def test_without_floor_and_sphere_there_is_no_landing():
    net = hanging(800.0, 0.1, Contact(1e5, 5.0))
    assert gauge(net, "leapfrog", 1e-3, State.at_rest(net)).landed_step == math.inf
    assert critical_step(net, "leapfrog", landed=True) == critical_step(net, "leapfrog")
    with pytest.raises(ValueError, match="landed: 1 is not allowed"):
        critical_step(net, "leapfrog", landed=1)  # type: ignore[arg-type]
