"""Ropes side by side move as each moves alone."""

import dataclasses
import re

import numpy as np
import pytest

from sim.springs import INTEGRATORS, Contact, Grab, Net, PinPath, State, advance, cloth, rope
from sim.springs.many import METHODS, advance_many, is_plain
from sim.springs.many.lanes import WIDTH

# Round-off of sums in another order, which a rope that falls and folds makes grow.
CLOSE = 1e-11  # [m], [m/s], [J]


def different_ropes(count: int) -> list[Net]:
    rng = np.random.default_rng(7)
    return [
        rope(
            10,
            length=rng.uniform(1.0, 3.0),
            mass=rng.uniform(0.5, 2.0),
            stiffness=rng.uniform(200.0, 2000.0),
            damping=rng.uniform(0.0, 10.0) if i % 5 else 0.0,
            drag=rng.uniform(0.0, 2.0) if i % 3 else 0.0,
            gravity=rng.uniform(-5.0, 20.0),
            root=(0.1 * i, 0.0, 1.0),
            end=(1.0, 0.3, 0.5) if i % 4 == 1 else None,
        )
        for i in range(count)
    ]


def alone(net: Net, method: str, h: float, steps: int) -> State:
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[method], h, steps, with_account=True)
    return state


@pytest.mark.parametrize("method", METHODS)
def test_each_rope_moves_as_it_does_alone_with_a_step_and_a_number_of_steps_of_its_own(method):
    nets = different_ropes(WIDTH + 3)
    h = np.linspace(5e-4, 2e-3, len(nets))
    samples = [[0, 7 + i, 60 + 11 * (i % 4)] for i in range(len(nets))]
    found = advance_many(nets, method, h, samples)
    for i, net in enumerate(nets):
        for sample, steps in enumerate(samples[i]):
            one, many = alone(net, method, h[i], steps), found.state(i, sample)
            assert np.abs(many.x - one.x).max() < CLOSE
            assert np.abs(many.v - one.v).max() < CLOSE
            assert many.dissipated == pytest.approx(one.dissipated, abs=CLOSE)
            assert (many.t, many.steps) == (pytest.approx(one.t), one.steps)
    assert not found.diverged.any()


def test_a_rope_of_one_point_hangs_at_its_root():
    found = advance_many([rope(1), rope(1, root=(0.0, 0.0, 2.0))], "rk4", [1e-3, 1e-3], [[5], [9]])
    assert found.x[:, 0, 2, 0, 0].tolist() == [0.0, 2.0]


def test_a_rope_that_diverges_is_told_and_changes_no_other():
    nets = [rope(10, stiffness=800.0 + i) for i in range(WIDTH)]
    steps = [[100, 4000]] * WIDTH
    calm = advance_many(nets, "symplectic_euler", [1e-3] * WIDTH, steps)
    nets[3] = rope(10, stiffness=1e7)
    wild = advance_many(nets, "symplectic_euler", [1e-3] * WIDTH, steps)
    assert wild.diverged.tolist() == [[i == 3, i == 3] for i in range(WIDTH)]
    assert not np.isfinite(wild.x[3, 1]).all()
    others = [i for i in range(WIDTH) if i != 3]
    assert np.array_equal(wild.x[others], calm.x[others])
    assert np.array_equal(wild.dissipated[others], calm.dissipated[others])


@pytest.mark.parametrize("method", METHODS)
def test_the_box_holds_every_position_that_a_rope_passed(method):
    net, h, steps = rope(6, damping=1.0, end=None), 2e-3, 700
    found = advance_many([net], method, [h], [[steps]])
    state, low, high = State.at_rest(net), net.x0.copy(), net.x0.copy()
    for _ in range(steps):
        advance(net, state, INTEGRATORS[method], h, 1)
        low, high = np.minimum(low, state.x), np.maximum(high, state.x)
    # The stages of rk4 lie between the steps, and may go a little farther.
    farther = 1e-3 if method == "rk4" else CLOSE
    below = low.min(axis=(1, 2)) - found.low[0, 0]
    above = found.high[0, 0] - high.max(axis=(1, 2))
    assert (np.minimum(below, above) > -CLOSE).all()
    assert (np.maximum(below, above) < farther).all()


def test_nets_that_are_no_plain_ropes_are_refused():
    plain = rope(5)
    path = PinPath(0.0, ((0.0, 0.0, 0.0),) * 4)
    others = [
        cloth(3, 3),
        rope(5, floor=-3.0),
        rope(5, sphere=(0.0, 0.0, -2.0, 0.5), contact=Contact()),
        rope(5, damping_model="axial"),
        dataclasses.replace(plain, grab=Grab(0, 2, (0.0, 0.0, 0.0), 1.0, 0.0, 1.0)),
        dataclasses.replace(plain, pin_paths=(((0, 0), path),)),
        dataclasses.replace(plain, thickness=0.01),
    ]
    assert is_plain(plain)
    for net in others:
        assert not is_plain(net)
        with pytest.raises(ValueError, match=r"nets\[1\]: .* without contact"):
            advance_many([plain, net], "rk4", [1e-3, 1e-3], [[1], [1]])


@pytest.mark.parametrize(
    ("message", "change"),
    [
        ("integrator: 'pefrl' is not allowed", {"integrator": "pefrl"}),
        ("nets: [] is not allowed", {"nets": []}),
        ("net: 'rope' is not allowed", {"nets": ["rope", "rope"]}),
        ("nets: '6 points' is not allowed; allowed: 5 points", {"nets": [rope(5), rope(6)]}),
        ("h: '1 steps' is not allowed; allowed: 2", {"h": [1e-3]}),
        ("h: 0.0 is not allowed; allowed: above 0 s", {"h": [1e-3, 0.0]}),
        ("h: nan is not allowed", {"h": [1e-3, np.nan]}),
        ("samples: (2,) is not allowed", {"samples": [1, 2]}),
        ("samples: (2, 0) is not allowed", {"samples": [[], []]}),
        ("samples: 'float64' is not allowed", {"samples": [[1.0], [2.0]]}),
        ("samples: [2, 1] is not allowed; allowed: rising whole numbers from 0", {"samples": [[1, 2], [2, 1]]}),
        ("samples: [-1] is not allowed", {"samples": [[1], [-1]]}),
    ],
)
def test_what_cannot_be_is_named(message, change):
    given = {"nets": [rope(5), rope(5)], "integrator": "rk4", "h": [1e-3, 1e-3], "samples": [[1], [2]], **change}
    with pytest.raises(ValueError, match=re.escape(message)):
        advance_many(**given)
