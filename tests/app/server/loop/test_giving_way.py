"""Controls are answered in the middle of a solve that takes long."""

import contextvars
import dataclasses

import numpy as np
import pytest

from app.messages import Begin, Change, GrabTo, Pause, Place, Play, Reset, StudentAnswer
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from app.server.loop.clock import PATIENCE
from app.server.loop.commands import BEGINNING, NOTHING, STEPS
from app.server.loop.sim_loop import SimLoop
from app.server.loop.snapshots import MAX_TIME_WITHOUT_FRAME
from sim.interruption import STOP, TURN, InterruptionError, kept_whole, pieces, raise_if_stopped, use_request
from sim.ocean.fluids.fluid_column import FluidColumn, _layer_roots
from sim.ocean.spectra import SPECTRA
from sim.ocean.statistics.statistics import open_sea_height
from sim.parameters import effect_of_change


def ask(loop, **changes):
    """Have a loop asked for a change of its parameters; returns the record."""
    params = dataclasses.replace(loop.scene.params, **changes)
    loop.commands.put(Change(params, effect_of_change(loop.scene.params, params) or "look"))
    return params


@pytest.fixture
def busy():
    """A loop in the middle of a step that takes long."""
    scene = RopeScene(RopeParams(points=4))
    loop = SimLoop(scene, clock=lambda: 1.0)
    loop.clock.busy_since = loop.clock.turn_at = 1.0 - 2.0 * PATIENCE
    loop.run.activity = STEPS
    return loop


@pytest.mark.parametrize(
    ("command", "ends"), [(Reset(), 1), (Pause(), 1), (Play(), 0), (GrabTo(1, (0.0, 0.0, 0.0)), 0)]
)
def test_a_solve_ends_for_what_begins_anew_and_not_for_a_drag(busy, command, ends):
    busy.commands.put(command)
    busy.give_turn()
    assert busy.run.request[STOP] == ends


@pytest.mark.parametrize(("change", "ends"), [({"stiffness": 90.0}, 1), ({"points": 5}, 1), ({"speed": 0.5}, 0)])
def test_a_solve_ends_for_other_forces_and_not_for_the_look(busy, change, ends):
    ask(busy, **change)
    busy.give_turn()
    assert busy.run.request[STOP] == ends


def test_a_look_and_a_drag_show_in_the_middle_of_a_solve_and_nothing_new_does_not(busy):
    busy.give_turn()
    assert busy.latest.serial == 1
    params = ask(busy, grid=False)
    busy.give_turn()
    assert busy.latest.serial == 2
    assert not busy.latest.frame.params.grid
    assert busy.latest.params is params
    busy.commands.put(Play())
    busy.commands.put(Place("root", (0.0, 0.0, 0.5)))
    busy.give_turn()
    assert busy.latest.serial == 3
    assert busy.latest.frame.root == (0.0, 0.0, 0.5)
    assert busy.waiting == [Play()]


def test_in_the_middle_of_a_reset_the_last_frame_stays_with_the_new_parameters(busy):
    busy.run.activity = BEGINNING
    busy.scene.params = dataclasses.replace(busy.scene.params, points=5)
    busy.scene.frame = None  # not asked for
    busy.give_turn()
    assert len(busy.latest.frame.points) == 4
    assert busy.latest.params.points == 5


def test_a_turn_is_asked_for_after_a_while_and_not_of_an_idle_loop(busy):
    for since, turn_at, asked in ((None, 0.0, 0), (0.0, 1.0 - 0.5 * PATIENCE, 0), (0.0, 1.0 - 1.5 * PATIENCE, 1)):
        busy.clock.busy_since, busy.clock.turn_at = since, turn_at
        busy.ask_for_turn()
        assert busy.run.request[TURN] == asked


def test_one_tick_that_takes_long_makes_only_the_next_show_a_picture_more():
    now, seconds = [0.0], iter([2.0 * PATIENCE, 0.0, 0.0, 0.0])
    scene = RopeScene(RopeParams(points=4))
    loop = SimLoop(scene, clock=lambda: now[0], effort=lambda: 0.0)
    advance = scene.advance

    def slow(steps):
        now[0] += next(seconds)
        advance(steps)
        raise_if_stopped()

    scene.advance, shown = slow, []
    use_request(loop.run.request, loop.give_turn, loop.clock.turn_is_due)
    try:
        for _ in range(4):
            now[0] += 1 / 60
            loop.commands.put(StudentAnswer())  # as a student's rope has one for each tick
            before = loop.run.counts["snapshots"]
            loop.tick(1 / 60)
            shown.append(loop.run.counts["snapshots"] - before)
    finally:
        use_request(np.array([0, 1, 0, 0]))
    assert shown == [1, 2, 1, 1]


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
    assert busy.run.unfinished is not None
    busy.commands.put(GrabTo(1, (0.0, 0.0, 0.0)))  # what else is asked for does not make it forget that
    busy.tick(0.0)
    assert calls == ["reset", "reset"]
    assert busy.run.unfinished is None
    busy.scene.advance = ended_once("advance", busy.scene.advance)
    busy.tick(0.1)
    assert busy.run.running
    assert not busy.run.halted
    assert busy.run.unfinished is None
    assert busy.run.counts["solves ended early"] == 2


@pytest.fixture
def ended_once(busy):
    """Resets that were begun, with their stiffness; the first is ended early."""
    begun, reset = [], busy.scene.reset

    def ended():
        begun.append(busy.scene.params.stiffness)
        if len(begun) == 1:
            raise InterruptionError
        reset()

    busy.scene.reset = ended
    return begun


def test_other_forces_after_a_reset_that_was_ended_early_follow_it(busy, ended_once):
    busy.commands.put(Reset())
    ask(busy, stiffness=90.0)
    busy.tick(0.0)
    assert [type(command) for command in busy.waiting] == [Change]  # of a scene that is not made
    busy.tick(0.0)
    assert ended_once == [800.0, 800.0]
    assert (busy.run.unfinished, busy.run.halted, busy.scene.params.stiffness) == (None, "", 90.0)


def test_a_preset_that_was_ended_early_for_another_leaves_nothing_of_itself(busy, ended_once):
    first, second = (dataclasses.replace(busy.scene.params, stiffness=k) for k in (90.0, 70.0))
    for command in (Begin(first), Change(dataclasses.replace(first, gravity=1.0), "forces")):
        busy.commands.put(command)
    busy.tick(0.0)
    busy.commands.put(Begin(second))
    busy.tick(0.0)
    assert ended_once == [90.0, 70.0]
    assert (busy.run.unfinished, busy.scene.params, busy.waiting) == (None, second, [])


@pytest.mark.parametrize(("command", "ends"), [(Reset(), 1), (Pause(), 0)])
def test_a_change_of_forces_is_ended_in_its_middle_only_for_a_new_beginning(busy, command, ends):
    def change(params):
        busy.commands.put(command)
        busy.give_turn()
        ended.append(int(busy.run.request[STOP]))
        if busy.run.request[STOP]:
            busy.scene.motion.net = None  # half of the change
            raise InterruptionError
        whole(params)

    ended, resets, reset, whole = [], [], busy.scene.reset, busy.scene.change_forces
    busy.run.activity, busy.scene.change_forces = NOTHING, change
    busy.scene.reset = lambda: resets.append(reset())
    frame = busy.latest.frame
    busy.runs.take(dataclasses.replace(busy.scene.params, stiffness=90.0), "forces")
    busy.run.snapshots.publish()
    assert ended == [ends]
    assert (busy.latest.frame is frame) == ends  # nothing is shown of what is half done
    busy.run.request[STOP] = 0
    busy.tick(0.0)
    assert len(resets) == ends
    assert (busy.run.unfinished, busy.run.halted, busy.scene.params.stiffness) == (None, "", 90.0)


def test_where_nothing_may_be_ended_other_forces_are_answered_with_the_last_frame(busy):
    busy.run.activity = NOTHING
    first = busy.latest.frame
    params = ask(busy, stiffness=90.0)
    busy.give_turn()
    assert busy.run.request[STOP] == 0
    assert busy.latest.params is params
    assert busy.latest.frame is first
    assert busy.scene.params is not params  # which the next tick gives it
    busy.tick(0.0)
    assert busy.scene.params is params


def test_steps_that_are_kept_whole_are_neither_ended_nor_shown_half_done(busy):
    params = ask(busy, stiffness=90.0)
    busy.commands.put(Pause())
    busy.commands.put(GrabTo(1, (0.0, 0.0, 0.0)))
    busy.scene.frame = None  # not asked for
    with kept_whole():
        busy.give_turn()
    assert busy.run.request[STOP] == 0
    assert busy.latest.params is params
    assert busy.waiting == [Change(params, "forces"), Pause(), GrabTo(1, (0.0, 0.0, 0.0))]
    busy.give_turn()
    assert busy.run.request[STOP] == 1


def test_steps_that_are_kept_whole_are_abandoned_for_a_new_beginning(busy):
    def half_a_step(steps):
        busy.commands.put(Reset())
        with kept_whole():
            busy.scene.motion.net = None  # half of a step
            raise_if_stopped()

    resets, reset = [], busy.scene.reset
    busy.scene.advance, busy.scene.reset = half_a_step, lambda: resets.append(reset())
    use_request(busy.run.request, busy.give_turn, lambda: True)
    try:
        busy.run.advance(1)
        busy.run.snapshots.publish()
    finally:
        use_request(np.array([0, 1, 0, 0]))
    assert resets == []
    assert busy.run.halted == ""
    busy.run.activity, busy.run.request[STOP] = NOTHING, 0
    busy.tick(0.0)
    assert len(resets) == 1
    assert busy.run.halted == ""


def test_a_reset_that_takes_long_says_that_it_has_begun(busy):
    def long_reset():
        busy.give_turn()
        seen.append(busy.latest.status.run.number)
        reset()

    seen, reset, busy.run.activity = [], busy.scene.reset, NOTHING
    busy.scene.reset = long_reset
    busy.commands.put(Reset())
    busy.tick(0.0)
    assert seen == [2]
    assert busy.run.request[STOP] == 0


def test_a_reset_is_not_ended_by_other_forces_or_a_pause(busy):
    def long_reset():
        ask(busy, stiffness=90.0)
        busy.commands.put(Pause())
        busy.give_turn()
        ended.append(int(busy.run.request[STOP]))
        reset()

    ended, reset, busy.run.activity = [], busy.scene.reset, NOTHING
    busy.scene.reset = long_reset
    busy.commands.put(Reset())
    busy.tick(0.0)
    assert ended == [0]
    assert busy.run.unfinished is None
    busy.tick(0.0)
    assert busy.scene.params.stiffness == 90.0
    assert not busy.run.running


def test_a_turn_that_is_due_is_given_though_nobody_asks():
    def try_out():
        turns, due = [], iter([False, True, False])
        use_request(np.zeros(4, np.int64), lambda: turns.append(1), lambda: next(due))
        found = [(piece.start, piece.stop, len(turns)) for piece in pieces(5, 2)]
        assert found == [(0, 2, 0), (2, 4, 1), (4, 5, 1)]

    contextvars.copy_context().run(try_out)


def test_what_a_turn_shows_may_need_a_solve_but_gives_no_further_turn(busy, monkeypatch, capsys):
    """As the restoring curve of a mooring, whose chart is opened while steps run."""
    calls = []

    def curves():
        calls.append(1)
        raise_if_stopped()
        busy.give_turn()
        return {}

    monkeypatch.setattr(busy.scene, "curves", curves)
    monkeypatch.setattr(busy.clock, "now", lambda: 1.0 + 2.0 * PATIENCE * len(calls))  # each takes long

    def try_out():
        use_request(busy.run.request, busy.give_turn, busy.clock.turn_is_due)
        params = ask(busy, grid=False)
        raise_if_stopped()
        return params

    params = contextvars.copy_context().run(try_out)
    assert (len(calls), busy.latest.params) == (1, params)
    assert busy.clock.turn_is_due()
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("changes", [{"integrator": "implicit_euler", "time_step": 0.05}, {"thickness": 0.1}])
def test_a_cloth_gives_turns_within_a_step_and_shows_the_last_whole_one(changes):
    scene = ClothScene(ClothParams(rows=16, cols=16, **changes))
    loop = SimLoop(scene)
    other = ClothScene(scene.params)
    seen = []

    def turn():
        loop.give_turn()
        loop.run.request[TURN] = len(seen) < 5
        seen.append((scene.time, scene.state.x.copy()))

    use_request(loop.run.request, turn)
    try:
        loop.run.request[TURN] = 1
        start = scene.state.x.copy()
        scene.advance(1)
    finally:
        use_request(np.array([0, 1, 0, 0]))
    assert len(seen) == 6
    assert all(t == 0.0 and np.array_equal(x, start) for t, x in seen)
    other.advance(1)
    assert scene.time == other.time > 0.0
    assert np.array_equal(scene.state.x, other.state.x)  # the turns change nothing


def test_a_picture_ends_for_other_forces_and_after_a_while_without_one_does_not(busy):
    def long_frame():
        busy.give_turn()
        ended.append(int(busy.run.request[STOP]))
        if busy.run.request[STOP]:
            raise InterruptionError
        return frame()

    ended, frame, earlier = [], busy.scene.frame, busy.latest.frame
    busy.handle(Pause())
    busy.run.activity, busy.scene.frame = NOTHING, long_frame
    params = ask(busy, points=5)
    busy.run.snapshots.publish()
    assert (ended, busy.run.snapshots.is_current, busy.run.halted) == ([1], False, "")
    assert busy.latest.frame is earlier
    busy.run.request[STOP] = 0
    busy.tick(0.0)
    assert (ended, busy.run.snapshots.is_current) == ([1, 0], True)
    assert busy.latest.params is params
    assert len(busy.latest.frame.points) == 5
    busy.run.snapshots.whole_at -= MAX_TIME_WITHOUT_FRAME
    ask(busy, points=6)
    busy.run.snapshots.publish()
    assert ended == [1, 0, 0]
    assert busy.run.snapshots.is_current


def test_a_picture_that_was_ended_is_made_again_by_a_paused_lab(busy):
    busy.handle(Pause())
    busy.run.activity, busy.run.snapshots.is_current = NOTHING, False
    busy.tick(0.0)
    assert busy.latest.serial == 2
    busy.tick(0.0)
    assert busy.latest.serial == 2


def test_a_look_that_is_taken_in_the_middle_of_a_picture_is_drawn_by_the_next(busy):
    def long_frame():
        found = frame()
        busy.give_turn()
        return found

    busy.handle(Pause())
    frame, busy.run.activity = busy.scene.frame, NOTHING
    busy.scene.frame = long_frame
    ask(busy, grid=False)
    busy.run.snapshots.publish()
    assert busy.latest.serial == 3  # the answer in between was the second
    assert busy.latest.frame.params.grid
    busy.tick(0.0)
    assert not busy.latest.frame.params.grid


@pytest.mark.parametrize(
    "work",
    [
        lambda: open_sea_height.__wrapped__(SPECTRA["elfouhaily"], SPECTRA["elfouhaily"].conditions()),
        lambda: FluidColumn(thickness=0.01, film=True).roots(np.array([0.123])),
    ],
)
def test_what_a_sea_takes_long_for_gives_turns_and_can_be_ended_but_where_it_is_kept_whole(work):
    def try_out():
        request, turns = np.array([0, 0, 1, 0], np.int64), []
        use_request(request, lambda: turns.append(1))
        work()
        assert turns == [1]
        _layer_roots.cache_clear()
        request[STOP] = request[TURN] = 1
        with kept_whole():
            work()
        assert turns == [1, 1]
        _layer_roots.cache_clear()
        with pytest.raises(InterruptionError):
            work()

    contextvars.copy_context().run(try_out)
