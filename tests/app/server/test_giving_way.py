"""A solve gives way to a control that waits for it."""

import dataclasses

import pytest

from app.messages import Grab, Pause, Play, Reset
from app.scenes.rope.parameters import Params
from app.scenes.rope.scene import RopeScene
from app.server.loop import PATIENCE, SimLoop
from sim.interruption import InterruptionError


@pytest.fixture
def busy():
    """A loop in the middle of a tick that takes long."""
    loop = SimLoop(RopeScene(Params(points=4)), clock=lambda: 1.0)
    loop.busy_since = 1.0 - 2.0 * PATIENCE
    return loop


@pytest.mark.parametrize(("command", "ends"), [(Reset(), 1), (Pause(), 1), (Play(), 0), (Grab(1, (0.0, 0.0, 0.0)), 0)])
def test_a_solve_ends_for_what_begins_anew_and_not_for_a_drag(busy, command, ends):
    busy.commands.put(command)
    busy.give_way(busy.scene.params)
    assert busy.request[0] == ends


@pytest.mark.parametrize(("change", "ends"), [({"stiffness": 90.0}, 1), ({"points": 5}, 1), ({"speed": 0.5}, 0)])
def test_a_solve_ends_for_other_forces_and_not_for_the_look(busy, change, ends):
    busy.give_way(dataclasses.replace(busy.scene.params, **change))
    assert busy.request[0] == ends


def test_a_short_solve_and_an_idle_loop_are_left_alone(busy):
    busy.commands.put(Reset())
    for since in (None, 1.0 - 0.5 * PATIENCE):
        busy.busy_since = since
        busy.give_way(busy.scene.params)
        assert busy.request[0] == 0


def test_a_reset_that_was_ended_early_is_done_again_and_a_step_is_not(busy):
    calls = []

    def ended_once(what, action):
        def call(*arguments):
            calls.append(what)
            if calls.count(what) == 1:
                raise InterruptionError
            return action(*arguments)

        return call

    busy.scene.reset = ended_once("reset", busy.scene.reset)
    busy.commands.put(Reset())
    busy.tick(0.0)
    assert calls == ["reset", "reset"]  # ended, then done in the same tick, before any step
    busy.scene.advance = ended_once("advance", busy.scene.advance)
    busy.tick(0.1)
    assert busy.running
    assert not busy.halted
    assert busy.unfinished is None
    assert busy.counts["solves ended early"] == 2
