"""XPBD: bounded at any stiffness, and the springs' own physics as the step goes to 0."""

import numpy as np
import pytest

from sim.springs import INTEGRATORS, rope
from sim.springs.state import State, advance
from sim.springs.statics import hanging_chain
from tests.sim.springs.reference import slope

XPBD = INTEGRATORS["xpbd"]


def test_one_link_alone_takes_exactly_an_implicit_step():
    """x+ = (x + h v)/(1 + z^2) of a link that stays straight, at any z."""
    net = rope(2, length=1e3, stiffness=1.0, damping=0.0, drag=0.0, gravity=0.0)
    for z in (0.05, 0.93, 10.0, 1e3):
        state = State.at_rest(net)
        state.x[0, 0, 1] -= 0.4
        advance(net, state, XPBD, z, 1)
        assert -1e3 - state.x[0, 0, 1] == pytest.approx(0.4 / (1.0 + z * z), rel=1e-9)


def test_its_equilibrium_is_too_long_by_the_square_of_the_step():
    """A sweep passes a pull on by one link, so that a hanging rope is softer than its springs."""
    net = rope(10, drag=20.0, damping=20.0)
    counts, errors = [300, 600, 1200, 2400], []
    exact = hanging_chain(net).x.T[:, None]
    for count in counts:
        state = State.at_rest(net)
        state.x[:] = exact
        advance(net, state, XPBD, 1.0 / count, 20 * count)
        assert state.x[2, 0, -1] < exact[2, 0, -1]
        errors.append(np.abs(state.x - exact).max())
    assert slope(counts, errors) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9, 1e12])
def test_no_stiffness_explodes_and_each_costs_the_same(stiffness):
    net = rope(50, stiffness=stiffness, damping=0.0, drag=0.0)
    state = State.at_rest(net)
    advance(net, state, XPBD, 1 / 60, 600)
    assert state.force_evals == 600
    assert np.linalg.norm(state.x, axis=0).max() < 40.0
