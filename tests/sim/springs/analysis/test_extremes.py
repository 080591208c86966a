"""How far and how fast a net's particles are."""

import numpy as np
import pytest

from sim.springs.analysis.extremes import extremes
from sim.springs.state import DIVERGENCE_BOUND, State


def some(points: int) -> State:
    rng = np.random.default_rng(points)
    return State(*rng.normal(size=(2, 3, 1, points)))


@pytest.mark.parametrize("points", [1, 2, 17, 300])
def test_they_are_what_numpy_finds(points: int) -> None:
    state = some(points)
    found = extremes(state.x, state.v)
    assert found.max_coordinate == np.abs(state.x).max()
    assert found.reach == np.abs(state.x - state.x[:, :, :1]).max()
    assert found.speed == np.abs(state.v).max()


@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("what", ["x", "v"])
@pytest.mark.parametrize("at", [0, 8, 50])
def test_one_number_that_is_none_is_seen(number: float, what: str, at: int) -> None:
    state = some(17)
    getattr(state, what).reshape(-1)[at] = number
    assert np.isnan(extremes(state.x, state.v)).all()
    assert not state.is_bounded


def test_what_is_too_far_out_is_not_sane() -> None:
    state = some(17)
    assert state.is_bounded
    state.x[2, 0, 5] = -1.01 * DIVERGENCE_BOUND
    assert not state.is_bounded
