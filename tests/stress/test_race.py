"""Races of ropes at the ends of what they may be made of, and pulled about."""

import math
import random

import pytest

from app.messages import Grab, Release, Reset
from app.scenes.race.race import RaceReadings
from app.scenes.rope.parameters import MOST_ROPES, RACE_ONLY, STEP_RULES
from sim.springs import INTEGRATORS
from tests.stress.hammer import Hammer, anywhere, ends
from tests.stress.tally import Tally

FRAMES = 3  # at each end


@pytest.fixture
def six(hammers) -> Hammer:
    """Six ropes racing."""
    hammer: Hammer = hammers("rope")
    hammer.calm()
    hammer.set("ropes", MOST_ROPES)
    return hammer


def check_standings(gauge: RaceReadings, ropes: int) -> None:
    """Every rope has a step and a gauge, and either a motion or a reason; NaN only where there is no reference."""
    assert [s.number for s in gauge.standings] == list(range(1, ropes + 1))
    for s in gauge.standings:
        assert s.step > 0.0
        assert s.gauge.h_omega >= 0.0
        assert math.isfinite(s.cost)
        assert s.out or math.isfinite(s.taken)
        assert math.isfinite(s.error) or s.out or gauge.no_ghost


@pytest.mark.parametrize("rule", STEP_RULES)
def test_each_parameter_of_a_race_at_both_ends(rule: str, six: Hammer) -> None:
    six.set("race_steps", rule)
    for name in sorted({*RACE_ONLY, "integrator", "time_step"}):
        parameter, before = six.parameters[name], getattr(six.viewer.panel.params, name)
        for value in ends(parameter):
            six.set(name, value)
            six.frame(FRAMES)
            assert not six.loop.halted, six.unusual()
            check_standings(six.loop.latest.readings, MOST_ROPES)
        six.set(name, before)
    six.frame()


def test_any_methods_and_steps_side_by_side(six: Hammer, tally: Tally) -> None:
    rng = random.Random("race")
    six.set("race_steps", "own steps")
    names = ["integrator", "time_step", *(f"{w}_{n}" for w in ("integrator", "step") for n in range(2, MOST_ROPES + 1))]
    with tally.fault("race of six methods at six steps", 2 * len(INTEGRATORS)):
        for _ in range(2 * len(INTEGRATORS)):
            for name in names:
                six.set(name, anywhere(six.parameters[name], rng))
            six.frame(9)  # longer than the longest step
            assert not six.loop.halted, six.unusual()
            assert six.loop.scene.time > 0.0, six.unusual()
            check_standings(six.loop.latest.readings, MOST_ROPES)


def test_ropes_come_and_go_while_one_is_pulled(six: Hammer, tally: Tally) -> None:
    points = six.viewer.panel.params.points
    with tally.fault("rope taken away from a hand", MOST_ROPES):
        for ropes in range(MOST_ROPES, 0, -1):
            # The last point of the last rope, which the next race has no more.
            six.loop.commands.put(Grab(ropes * points - 1, (-3.0, 5.0, 4.0)))
            six.frame(FRAMES)
            assert six.loop.latest.frame.pull is not None
            six.set("ropes", max(1, ropes - 1))
            six.frame(FRAMES)
            assert not six.loop.halted
            six.loop.commands.put(Release())
            six.loop.commands.put(Reset())
            six.frame()
    assert six.loop.latest.frame.race is None
