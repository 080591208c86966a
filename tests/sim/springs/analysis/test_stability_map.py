"""Rows of a stability map: the limit in runs, beside that of a single spring in closed form."""

import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, rope
from sim.springs.analysis.growth import EXPLODING, STABLE
from sim.springs.analysis.stability_map import LIMIT_RESOLUTION, limit_between, located, map_row

STEPS = np.geomspace(5e-3, 0.3, 12)  # [s]


@pytest.mark.parametrize(("name", "limit"), [("leapfrog", 2.0), ("rk4", math.sqrt(8.0))])
def test_one_spring_turns_at_the_limit_of_the_oscillator(name: str, limit: float) -> None:
    net = rope(2, length=1.0, mass=1.0, stiffness=400.0, damping=0.0, drag=0.0, gravity=10.0)  # omega = 20 rad/s
    row = map_row(INTEGRATORS[name], net, STEPS, 1 << 12, locate=True)
    assert row.critical == pytest.approx(limit / 20.0, rel=1e-6)
    assert row.measured == pytest.approx(limit / 20.0, rel=0.003)
    assert np.array_equal(row.outcomes == STABLE, limit / 20.0 > STEPS)
    assert row.outcomes[-1] == EXPLODING


def test_a_method_without_a_limit_is_stable_everywhere_and_one_that_is_not_asked_locates_nothing() -> None:
    net = rope(3, stiffness=400.0)
    row = map_row(INTEGRATORS["implicit_euler"], net, STEPS, 1 << 8, locate=True)
    assert not row.outcomes.any()
    assert row.measured == row.critical == math.inf
    assert math.isnan(map_row(INTEGRATORS["implicit_euler"], net, STEPS[:2], 1 << 8).measured)


@pytest.mark.parametrize("limit", [2e-3, 0.0123, 0.2999])
def test_a_limit_is_located_between_the_steps_and_below_the_first(limit: float) -> None:
    def grows(h: float) -> bool:
        return h > limit

    found = located(STEPS, limit < STEPS, grows)
    assert abs(math.log(found / limit)) <= 0.5 * math.log(LIMIT_RESOLUTION)
    assert located(STEPS, STEPS > 1.0, grows) == math.inf
    assert abs(math.log(limit_between(0.5 * limit, 3.0 * limit, grows) / limit)) <= 0.5 * math.log(LIMIT_RESOLUTION)
