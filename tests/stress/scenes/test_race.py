"""Races at both ends of every parameter, with any methods, and with ropes that are dragged."""

import math
import random

import pytest

from app.messages import GrabTo, Release, Reset
from app.scenes.race.entrants import RaceReadings
from app.scenes.race.parameters import MAX_ROPES, STEP_RULES
from sim.springs import INTEGRATORS
from tests.stress.hammer import Hammer, anywhere, ends
from tests.stress.tally import Tally

FRAMES = 3  # at each end


@pytest.fixture
def six(hammers) -> Hammer:
    """A race of six ropes."""
    hammer: Hammer = hammers("race")
    hammer.calm()
    hammer.set("ropes", MAX_ROPES)
    return hammer


def check_results(readings: RaceReadings, ropes: int) -> None:
    """Every rope has a step and a gauge, and either a motion or a reason; NaN only if there is no reference."""
    assert [result.number for result in readings.results] == list(range(1, ropes + 1))
    for result in readings.results:
        assert result.step > 0.0
        assert result.gauge.h_omega >= 0.0
        assert math.isfinite(result.step_time)
        assert result.failure or math.isfinite(result.numerical_dissipation)
        assert math.isfinite(result.error) or result.failure or readings.no_reference


@pytest.mark.parametrize("rule", STEP_RULES)
def test_each_parameter_of_a_race_at_both_ends(rule: str, six: Hammer) -> None:
    six.set("race_steps", rule)
    for name, parameter in six.parameters.items():
        if parameter.group not in ("Main", "Time", "Plots") or name == "ropes":
            continue
        before = getattr(six.viewer.settings.params, name)
        for value in ends(parameter):
            six.set(name, value)
            six.frame(FRAMES)
            assert not six.loop.run.halted, six.unusual()
            check_results(six.loop.latest.readings, MAX_ROPES)
        six.set(name, before)
    six.frame()


def test_any_methods_and_steps_side_by_side(six: Hammer, tally: Tally) -> None:
    rng = random.Random("race")
    six.set("race_steps", "own steps")
    names = ["integrator", "time_step", *(f"{w}_{n}" for w in ("integrator", "step") for n in range(2, MAX_ROPES + 1))]
    with tally.fault("race of six methods at six steps", 2 * len(INTEGRATORS)):
        for _ in range(2 * len(INTEGRATORS)):
            for name in names:
                six.set(name, anywhere(six.parameters[name], rng))
            six.frame(9)  # longer than the longest step
            assert not six.loop.run.halted, six.unusual()
            assert six.loop.scene.time > 0.0, six.unusual()
            check_results(six.loop.latest.readings, MAX_ROPES)


def test_the_number_of_ropes_changes_while_one_is_dragged(six: Hammer, tally: Tally) -> None:
    points = six.viewer.settings.params.points
    with tally.fault("rope removed while it is dragged", MAX_ROPES):
        for ropes in range(MAX_ROPES, 0, -1):
            # The last point of the last rope, which the next race does not have.
            six.loop.commands.put(GrabTo(ropes * points - 1, (-3.0, 5.0, 4.0)))
            six.frame(FRAMES)
            assert six.loop.latest.frame.grab is not None
            six.set("ropes", max(1, ropes - 1))
            six.frame(FRAMES)
            assert not six.loop.run.halted
            six.loop.commands.put(Release())
            six.loop.commands.put(Reset())
            six.frame()
    assert len(six.loop.latest.frame.ropes) == 1
