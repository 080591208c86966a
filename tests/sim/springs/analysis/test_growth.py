"""Measured stability beside theory's, and nets at rest."""

import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, rope
from sim.springs.analysis import settling
from sim.springs.analysis.growth import EXPLODING, STABLE, growth, measured_limit, oscillator, outcome
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.integrators import leapfrog
from sim.springs.stability import critical_step
from sim.springs.state import State, acceleration, advance
from sim.springs.statics import hanging_chain
from sim.validation import ConvergenceError

EXPLICIT = [name for name, record in INTEGRATORS.items() if math.isfinite(record.limit(0.0))]
DAMPED = [name for name in EXPLICIT if not INTEGRATORS[name].undamped_only]


def test_the_oscillator_is_one():
    net = oscillator(0.1)
    state = State.at_rest(net)
    state.x[:, 0, 1], state.v[:] = (0.5, 0.0, -2.0), 0.0
    state.v[:, 0, 1] = 1.0, 3.0, 0.0
    expected = -state.x[:, 0, 1] - 0.2 * state.v[:, 0, 1]
    np.testing.assert_allclose(acceleration(net, state, 0.5)[:, 0, 1], expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("name", "rate"),
    [
        ("explicit_euler", lambda z, zeta: 0.5 * math.log(1.0 - 2.0 * zeta * z + z * z)),
        ("implicit_euler", lambda z, zeta: -0.5 * math.log(1.0 + 2.0 * zeta * z + z * z)),
        (
            "leapfrog",
            lambda z, zeta: math.log(np.abs(1.0 + leapfrog.changes(*np.array([[1.0], [2.0 * zeta], [z]]))).max()),
        ),
    ],
)
def test_growth_rates_are_those_of_the_step_matrix(name, rate):
    for z in (0.1, 0.5, 1.5):
        for zeta in (0.1, 0.5):
            assert growth(INTEGRATORS[name], zeta, z) == pytest.approx(rate(z, zeta), rel=0.02, abs=1e-6)


def test_what_neither_grows_nor_decays_has_no_rate():
    assert growth(INTEGRATORS["leapfrog"], 0.0, 1.9) == 0.0
    assert growth(INTEGRATORS["implicit_midpoint"], 0.0, 3.0, 4096) == 0.0
    assert growth(INTEGRATORS["leapfrog"], 0.0, 2.05) > 0.1


@pytest.mark.parametrize("name", DAMPED)
def test_measured_limits_are_the_declared_ones(name):
    record = INTEGRATORS[name]
    steps = np.linspace(0.1, 6.9, 35)
    for zeta in (0.25, 0.7, 1.0, 2.0):
        rates = np.array([growth(record, zeta, float(z)) for z in steps if z < 1.6 * record.limit(zeta)])
        measured = measured_limit(record, zeta, steps, rates)
        if name == "leapfrog":  # with damping its declared limit is a bound
            assert measured >= 0.998 * record.limit(zeta)
        else:
            assert measured == pytest.approx(record.limit(zeta), rel=2e-3)


@pytest.mark.parametrize("name", [name for name in INTEGRATORS if name not in EXPLICIT])
def test_unconditionally_stable_methods_are(name):
    record = INTEGRATORS[name]
    steps = np.array([0.3, 3.0, 30.0])
    for zeta in (0.0, 0.3, 2.0):
        rates = np.array([growth(record, zeta, float(z), 4096) for z in steps])
        assert (rates <= 0.0).all()
        assert measured_limit(record, zeta, steps, rates) == math.inf


@pytest.mark.parametrize("stiffness", [30.0, 800.0, 2e4])
@pytest.mark.parametrize("name", [name for name in DAMPED if name != "explicit_euler"])
def test_the_hanging_rope_holds_to_its_critical_step_and_no_further(name, stiffness):
    # At 30 N/m it hangs stretched tenfold, overdamped, and most so across its links.
    net = rope(10, stiffness=stiffness)
    state = State.at_rest(net)
    state.x[:] = find_rest_positions(net)
    h = critical_step(net, name, state)
    assert outcome(INTEGRATORS[name], net, 0.97 * h, state.x) == STABLE
    if name != "leapfrog":  # with damping its critical step is a bound
        assert outcome(INTEGRATORS[name], net, 1.03 * h, state.x) != STABLE
    assert outcome(INTEGRATORS[name], net, 8.0 * h, state.x) == EXPLODING


@pytest.mark.parametrize("surroundings", [{"floor": -1.0}, {"sphere": (-0.3, 0.05, -1.2, 0.5)}])
def test_a_settled_rope_stays_where_it_is(surroundings):
    net = rope(10, gravity=10.0, **surroundings)
    state = State.at_rest(net)
    state.x[:] = find_rest_positions(net)
    if "floor" in surroundings:  # on a sphere it may yet slide, very slowly
        assert np.abs(acceleration(net, state, 0.5)).max() < 1e-3
    before = state.x.copy()
    advance(net, state, INTEGRATORS["leapfrog"], 1 / 600, 300)
    assert np.abs(state.x - before).max() < 1e-2


def test_a_rope_that_does_not_come_to_rest_is_told(monkeypatch):
    monkeypatch.setattr(settling, "LOOKS", 10)
    with pytest.raises(
        ConvergenceError, match=r"a state of rest: no solution after 10 iterations; \S+ J of motion left"
    ):
        find_rest_positions(rope(10, floor=-1.0))


def test_a_free_hanging_rope_settles_as_statics_says():
    net = rope(10, stiffness=200.0)
    np.testing.assert_array_equal(find_rest_positions(net)[:, 0].T, hanging_chain(net).x)
    # The same by falling: a floor out of reach.
    fallen = find_rest_positions(rope(10, stiffness=200.0, floor=-100.0))
    assert np.abs(fallen[:, 0].T - hanging_chain(net).x).max() < 1e-6
