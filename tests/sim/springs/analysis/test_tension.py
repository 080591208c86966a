"""The tension of a rope's links against the hanging chain's."""

import numpy as np
import pytest

from sim.springs import rope
from sim.springs.analysis.tension import rope_tension
from sim.springs.statics import hanging_chain


@pytest.mark.parametrize("points", [2, 3, 40])
def test_each_link_of_a_chain_at_rest_carries_what_hangs_below_it(points):
    net = rope(points)
    still = hanging_chain(net)
    turn = np.linalg.qr(np.random.default_rng(points).standard_normal((3, 3)))[0]  # as links may lie in any direction
    x = np.ascontiguousarray((turn @ still.x.T)[:, None, :])
    assert rope_tension(net, x) == pytest.approx(still.tension, rel=1e-10)


def test_a_link_that_is_pressed_pushes():
    net = rope(3)
    link = net.families[0]
    x = net.x0.copy()
    x[:, 0, 2] = x[:, 0, 1] + 0.25 * (x[:, 0, 1] - x[:, 0, 0])  # a quarter as long as its rest
    assert rope_tension(net, x) == pytest.approx([0.0, -0.75 * link.stiffness * link.rest], abs=1e-9)
