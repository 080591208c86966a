"""The loop, ticked with a clock of the test's own."""

import contextvars
import dataclasses
import math
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from typing import Any, NamedTuple

import numpy as np
import pytest

from app.messages import (
    Advance,
    Ask,
    Begin,
    Change,
    Checkpoint,
    Command,
    Halt,
    Pause,
    Play,
    Reset,
    Resume,
    StepOnce,
    StudentAnswer,
    TogglePlay,
    where_not_finite,
)
from app.panel.head import status_line
from app.scenes.contract import FRAME_INTERVAL
from app.server.loop.clock import MAX_FRAME_INTERVAL, MAX_LONG_FRAME, PATIENCE, SOLVE_SHARE, FixedStep
from app.server.loop.run import HURRY_INTERVAL
from app.server.loop.sim_loop import IDLE_INTERVAL, SimLoop
from sim.parameters import effect_of_change, parameter
from sim.validation import DivergenceError
from tests.waiting import wait_for


@dataclasses.dataclass(frozen=True)
class Params:
    speed: float = parameter(1.0, 0.01, 8.0, affects="look")
    stiffness: float = parameter(1.0, 0.0, 10.0, affects="forces")
    points: int = parameter(2, 2, 10, affects="start")
    grid: bool = parameter(True, affects="look")


class Clock:
    """Wall time that moves only with the test or a step."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class Scene:
    """A scene that counts."""

    step = 0.01
    faster = "fewer points"
    pace = 1.0

    def __init__(self, clock: Clock, cost: float = 0.0) -> None:
        self.params = Params()
        self.clock, self.cost = clock, cost
        self.time = 0.0
        self.resets = self.changes = 0
        self.starts: list[Params] = []  # parameters at each reset
        self.fails: Exception | None = None
        self.seen: list[float] = []

    @property
    def frame_interval(self) -> float:
        return FRAME_INTERVAL

    def change_forces(self, params: Params) -> None:
        self.changes += 1
        if self.fails:
            raise self.fails
        self.params = params

    def advance(self, steps: int) -> None:
        if self.fails:
            raise self.fails
        self.clock.now += steps * self.cost
        self.time += steps * self.step
        self.seen.append(self.params.stiffness)

    def reset(self) -> None:
        self.time = 0.0
        self.resets += 1
        self.starts.append(self.params)
        self.fails = None

    def handle(self, command: object) -> None:
        """Ignore all commands."""

    def keep(self) -> float:
        return self.time

    def resume(self, kept: float) -> None:
        self.time = kept

    def frame(self) -> float:
        return self.time

    def readings(self) -> None:
        return None

    def take_plot_rows(self) -> tuple:
        return ()

    def curves(self) -> None:
        return None


def make(cost: float = 0.0, **options) -> tuple[SimLoop, Scene]:
    clock = Clock()
    scene = Scene(clock, cost)
    return SimLoop(scene, clock=clock, effort=clock, **options), scene


@pytest.mark.parametrize("speed", [1.0, 0.5, 0.25])
def test_simulated_time_follows_wall_time_at_the_speed_that_is_set(speed: float) -> None:
    loop, scene = make()
    scene.params = Params(speed=speed)
    for _ in range(600):
        loop.tick(FRAME_INTERVAL)
    assert scene.time == pytest.approx(10.0 * speed, abs=scene.step)
    assert loop.latest.status.actual_speed == pytest.approx(speed, abs=0.02)


def test_slow_motion_that_a_scene_asks_for_takes_the_same_steps_in_more_time() -> None:
    loop, scene = make()
    scene.params = Params(speed=2.0)
    for pace, since in ((1.0, 0.0), (0.1, 2.0), (1.0, 2.2)):
        scene.pace = pace
        assert scene.time == pytest.approx(since, abs=2 * scene.step)
        for _ in range(60):
            loop.tick(FRAME_INTERVAL)
        assert loop.latest.status.pace == pace
        assert loop.latest.status.speed == 2.0
        assert ("Slow motion" in str(status_line(loop.latest))) == (pace < 1.0)
    scene.pace = 0.1
    loop.commands.put(Pause())
    before = scene.time
    for _ in range(10):
        loop.tick(FRAME_INTERVAL)
    assert scene.time == before
    assert "Paused" in str(status_line(loop.latest))


def test_steps_are_whole_and_owe_less_than_one() -> None:
    fixed_step = FixedStep()
    taken = sum(fixed_step.steps(0.007, 1.0, 0.01) for _ in range(1000))
    assert taken == 700 or (taken == 699 and fixed_step.debt < 0.01 * (1 + 1e-9))


def test_a_sleep_that_ended_late_is_made_up_for_up_to_half_a_second() -> None:
    for wall, steps in ((0.4, 40), (5.0, 50)):
        fixed_step = FixedStep()
        assert fixed_step.steps(wall, 1.0, 0.01) == steps
        assert not fixed_step.capped


def test_time_that_cannot_be_made_up_is_dropped_and_shown() -> None:
    loop, scene = make(cost=0.02)  # a step of 10 ms takes 20 ms
    for _ in range(100):
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.status.capped
    assert loop.run.fixed_step.debt <= scene.step
    assert scene.time <= 100 * scene.step * 1.01
    scene.cost = 0.0
    loop.run.fixed_step.cost = 0.0
    before = scene.time
    loop.tick(FRAME_INTERVAL)
    assert scene.time - before <= 2 * scene.step  # no catching up


def test_the_next_part_of_a_frame_has_the_steps_that_there_is_time_for() -> None:
    fixed_step, budget = FixedStep(), SOLVE_SHARE * FRAME_INTERVAL
    assert fixed_step.next_part(4, 0.5 * budget) > 4  # at an unknown cost
    fixed_step.cost = 0.01 * budget
    assert fixed_step.next_part(100, 0.8 * budget) in (19, 20)
    for spent in (budget, 2.0 * budget):
        assert fixed_step.next_part(4, spent) == 0


def test_steps_that_a_frame_has_no_time_for_are_counted_as_dropped() -> None:
    loop, scene = make(cost=1.0)
    loop.run.advance_within_budget(10)
    assert (scene.time, loop.run.fixed_step.dropped, loop.run.fixed_step.capped) == (scene.step, 9, True)
    loop.run.take_single_steps(5)
    assert (scene.time, loop.run.fixed_step.dropped) == (2.0 * scene.step, 13)


@pytest.mark.parametrize(("wall", "frame"), [(FRAME_INTERVAL, FRAME_INTERVAL), (0.25, MAX_LONG_FRAME)])
def test_a_frame_never_solves_longer_than_its_budget_allows(wall: float, frame: float) -> None:
    fixed_step = FixedStep()
    fixed_step.learn(10, 0.01)
    steps = fixed_step.steps(wall, 8.0, 1e-5)
    assert fixed_step.capped
    assert steps == int(SOLVE_SHARE * frame / 0.001)


def test_a_slider_reaches_the_simulation_in_the_next_frame() -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    for stiffness in np.linspace(2.0, 7.0, 200):  # as many as a mouse sends in one frame, and more
        loop.commands.put(Change(Params(stiffness=stiffness), "forces"))
    loop.tick(FRAME_INTERVAL)
    assert scene.seen[-1] == 7.0
    assert scene.changes == 1


@pytest.mark.parametrize("options", [{"paused": True}, {"audience": lambda: 0}], ids=["paused", "nobody looks"])
def test_a_loop_that_rests_takes_no_step_and_publishes_nothing(options: dict[str, Any]) -> None:
    loop, scene = make(**options)
    shown = loop.latest
    for _ in range(50):
        loop.tick(FRAME_INTERVAL)
    assert scene.seen == []
    assert loop.latest is shown
    assert loop.run.counts["idle ticks"] == 50


def test_commands_play_pause_step_and_reset() -> None:
    loop, scene = make(paused=True)
    loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert scene.time == pytest.approx(scene.step)
    loop.commands.put(Play())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.running
    loop.commands.put(TogglePlay())
    loop.tick(FRAME_INTERVAL)
    assert not loop.run.running
    loop.commands.put(Play())
    loop.commands.put(Pause())
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert not loop.run.running
    assert scene.resets == 1


@pytest.mark.parametrize("error", [DivergenceError("h omega 3 over 2"), ZeroDivisionError("float division")])
def test_what_goes_wrong_pauses_the_run_and_is_said(error: Exception, capsys: pytest.CaptureFixture) -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    good = loop.latest.frame
    scene.fails = error
    loop.tick(FRAME_INTERVAL)
    assert not loop.run.running
    assert str(error) in loop.latest.status.halted
    assert loop.latest.frame == good
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.running
    assert loop.latest.status.halted == ""
    capsys.readouterr()


def test_parameters_that_the_scene_cannot_take_pause_the_run_and_are_tried_once(capsys: pytest.CaptureFixture) -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    values, scene.fails = Params(stiffness=3.0), ValueError("no such net")
    loop.commands.put(Change(values, "forces"))
    for _ in range(5):
        loop.tick(FRAME_INTERVAL)
    assert "no such net" in loop.latest.status.halted
    assert scene.changes == 1
    assert capsys.readouterr().err.count("Traceback") == 1
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.running
    assert scene.starts == [values]


def test_a_step_that_became_a_thousand_times_as_expensive_does_not_hold_up_the_frame() -> None:
    loop, scene = make(cost=1e-7)
    scene.params, scene.step = Params(speed=8.0), 1e-5
    for _ in range(10):
        loop.tick(FRAME_INTERVAL)
    assert loop.run.counts["steps"] > 10_000
    loop.commands.put(Change(Params(speed=8.0, stiffness=2.0), "forces"))
    scene.cost = 1e-4
    before = scene.clock.now
    loop.tick(FRAME_INTERVAL)
    assert scene.clock.now - before <= FRAME_INTERVAL
    assert loop.latest.status.capped


class Numbers(NamedTuple):
    points: np.ndarray
    load: float = 0.0
    parts: tuple = ()


@pytest.mark.parametrize(
    ("frame", "where"),
    [
        (Numbers(np.ones(3), 2.0, (np.arange(3), None, "text")), ""),
        (Numbers(np.array([1.0, np.nan])), "points"),
        (Numbers(np.ones(3), np.inf), "load"),
        (Numbers(np.ones(3), 0.0, (1.0, (Numbers(np.full(2, np.inf, np.float32)),))), "points"),
    ],
)
def test_what_is_not_finite_in_a_frame_is_found(frame: Numbers, where: str) -> None:
    assert where_not_finite(frame) == where


@pytest.mark.parametrize("fault", [lambda: float("nan"), lambda: 1 / 0])
def test_a_frame_that_cannot_be_shown_pauses_the_run_and_the_last_good_one_stays(
    fault: Callable[[], float], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    good = loop.latest.frame
    with monkeypatch.context() as patch:
        patch.setattr(scene, "frame", fault)
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.frame == good
    assert not loop.run.running
    assert "NaN or infinity" in loop.latest.status.halted or "division" in loop.latest.status.halted
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.running
    capsys.readouterr()


def test_a_halt_from_outside_is_said() -> None:
    loop, _ = make()
    loop.commands.put(Halt("The picture could not be drawn"))
    loop.tick(FRAME_INTERVAL)
    assert loop.latest.status.halted == "The picture could not be drawn"
    assert not loop.latest.status.running


def test_a_scene_of_fewer_pictures_has_as_much_time_to_solve_in() -> None:
    every, other = FixedStep(), FixedStep()
    every.cost = other.cost = 0.5 * FRAME_INTERVAL * SOLVE_SHARE  # two steps fill a frame
    assert (every.steps(FRAME_INTERVAL, 1.0, FRAME_INTERVAL / 3), every.capped) == (2, True)
    for step, capped in ((FRAME_INTERVAL / 3, True), (FRAME_INTERVAL / 2, False)):
        assert (other.steps(2 * FRAME_INTERVAL, 1.0, step, 2 * FRAME_INTERVAL), other.capped) == (4, capped)


def test_whoever_shows_is_told_of_each_new_snapshot_and_of_nothing_else() -> None:
    loop, _ = make()
    told = []
    for _ in range(20):
        loop.tick(FRAME_INTERVAL)
        told.append(loop.run.snapshots.fresh.is_set())
        loop.run.snapshots.fresh.clear()
    assert sum(told) == loop.latest.serial - 1
    loop.handle(Pause())
    loop.tick(FRAME_INTERVAL)
    assert not loop.run.snapshots.fresh.is_set()
    loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.snapshots.fresh.is_set()


def test_whoever_shows_has_to_look_often_only_where_ticks_take_long() -> None:
    loop, scene = make()
    now, seen, spent = [0.0], [], iter((0.1 * PATIENCE, PATIENCE, 0.1 * PATIENCE))
    loop.clock.now = lambda: now[0]

    def advance(steps: int) -> None:
        now[0] += next(spent)
        seen.append(loop.clock.takes_long)

    scene.advance = advance  # type: ignore[method-assign]
    for _ in range(3):
        loop.tick(FRAME_INTERVAL)
        seen.append(loop.clock.takes_long)
    assert seen == [True, False, True, True, True, False]  # within a tick and after it


def test_other_parameters_end_a_long_sleep() -> None:
    loop, _ = make()
    stop = threading.Event()
    sleep = threading.Thread(target=loop.wait, args=(1000.0, stop))
    sleep.start()
    sleep.join(0.2)
    assert sleep.is_alive()
    loop.commands.put(Change(Params(stiffness=3.0), "forces"))
    sleep.join(10.0)
    stop.set()
    assert not sleep.is_alive()


def test_an_answer_of_the_student_s_functions_is_taken_in_a_sleep_and_does_not_end_it() -> None:
    loop, scene = make()
    taken: list[object] = []
    scene.handle = taken.append  # type: ignore[method-assign]
    stop = threading.Event()
    sleep = threading.Thread(target=loop.wait, args=(1000.0, stop))
    sleep.start()
    for count in (1, 2):
        loop.commands.put(StudentAnswer())
        wait_for(lambda count=count: len(taken) == count)
    assert sleep.is_alive()
    stop.set()
    sleep.join(10.0)
    loop.handle(Pause())
    serial = loop.latest.serial
    loop.tick(0.0)
    assert loop.latest.serial == serial + 1


@pytest.mark.parametrize(
    ("late", "interval", "apart"),
    [(0.0, FRAME_INTERVAL, FRAME_INTERVAL), (0.005, 0.08, 0.08), (0.15, MAX_FRAME_INTERVAL, MAX_FRAME_INTERVAL + 0.15)],
)
def test_where_sleeps_end_late_there_are_fewer_frames_in_the_same_simulated_time(
    late: float, interval: float, apart: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.server.loop.clock.TIMER_STEP", 0.0)
    loop, scene = make(gives_way=True)
    clock, stop, starts = scene.clock, threading.Event(), []

    def sleep(seconds: float, stop: threading.Event) -> None:
        clock.now += seconds + late
        starts.append(clock.now)
        if len(starts) == 100:
            stop.set()

    loop.wait = sleep  # type: ignore[method-assign]
    contextvars.copy_context().run(loop.tick_until, stop)
    assert loop.clock.frame_interval(scene.frame_interval) == pytest.approx(interval, rel=1e-3)
    assert starts[-1] - starts[-2] == pytest.approx(apart, rel=1e-3)
    assert scene.time == pytest.approx(starts[-2], abs=interval + late + scene.step)


class CoarseClock(Clock):
    """Wall time of a system that ends every wait at the next step of its timer."""

    def sleep(self, seconds: float) -> None:
        self.now = math.ceil(64.0 * (self.now + seconds) - 1e-9) / 64.0


@pytest.mark.parametrize("cost", [0.0, 0.001, 0.004])
def test_a_coarse_timer_costs_neither_frames_nor_speed(cost: float) -> None:
    """Waits end at multiples of 1/64 s, as on Windows: 60 frames a second, at the speed that is set."""
    clock, stop, shown = CoarseClock(), threading.Event(), []
    scene = Scene(clock, cost)
    loop = SimLoop(scene, clock=clock, effort=clock, sleep=clock.sleep)
    publish = loop.run.snapshots.publish

    def count() -> None:
        shown.append(clock.now)
        if clock.now >= 10.0:
            stop.set()
        publish()

    loop.run.snapshots.publish = count  # type: ignore[method-assign]
    contextvars.copy_context().run(loop.tick_until, stop)
    assert len(shown) / clock.now == pytest.approx(1.0 / FRAME_INTERVAL, rel=0.02)
    assert scene.time / clock.now == pytest.approx(1.0, abs=0.01)
    assert not loop.run.fixed_step.capped


@pytest.mark.parametrize("seconds", [IDLE_INTERVAL, 4 * FRAME_INTERVAL])
def test_a_command_ends_a_long_sleep_and_is_handled_after_the_parameters_before_it(seconds: float) -> None:
    loop, scene = make()
    stop = threading.Event()
    both = [Change(Params(stiffness=3.0), "forces"), Reset()]
    threading.Timer(0.1, lambda: [loop.commands.put(command) for command in both]).start()
    loop.wait(1000.0 * seconds, stop)
    loop.take_in()  # the second may have come after the sleep
    assert loop.waiting == both
    assert scene.resets == 0
    reset, seen = scene.reset, []
    scene.reset = lambda: seen.append(scene.params.stiffness) or reset()
    loop.tick(FRAME_INTERVAL)
    assert seen == [3.0]
    assert scene.resets == 1
    loop.tick(FRAME_INTERVAL)
    assert scene.resets == 1


def test_a_change_of_look_touches_neither_forces_nor_start() -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)

    def give(params: Params) -> None:
        loop.commands.put(Change(params, effect_of_change(scene.params, params) or "look"))
        loop.tick(FRAME_INTERVAL)
        assert scene.params == params

    give(Params(grid=False, speed=2.0))
    assert (scene.changes, scene.resets) == (0, 0)
    give(Params(grid=False, speed=2.0, stiffness=3.0))
    assert (scene.changes, scene.resets) == (1, 0)
    give(Params(points=5))
    assert (scene.changes, scene.starts) == (1, [Params(points=5)])


def test_a_preset_starts_from_exactly_its_record_and_what_is_changed_after_it_follows() -> None:
    loop, scene = make(paused=True)
    loop.tick(FRAME_INTERVAL)
    preset = Params(stiffness=5.0, points=7)
    loop.commands.put(Change(Params(stiffness=4.0), "forces"))  # of no more interest
    loop.commands.put(Begin(preset))
    loop.commands.put(Change(Params(stiffness=6.0, points=7), "forces"))  # changed by hand before the next frame
    loop.tick(FRAME_INTERVAL)
    assert scene.starts == [preset]
    assert (scene.params.stiffness, scene.changes) == (6.0, 1)
    assert loop.run.running
    assert loop.latest.status.run.number == 2


def test_states_are_kept_while_the_run_goes_on_and_gone_on_from_without_a_new_start() -> None:
    loop, scene = make()
    states = []
    for _ in range(60):
        loop.tick(FRAME_INTERVAL)
        if loop.latest.state is not None:
            states.append((loop.latest.status.time, loop.latest.state))
    assert 8 <= len(states) <= 11
    loop.commands.put(Pause())
    loop.tick(1.0)
    assert loop.latest.state is None
    time, state = states[3]
    run = loop.latest.status.run
    loop.commands.put(Resume(Params(stiffness=3.0), state))
    loop.tick(0.0)
    assert (scene.time, scene.params.stiffness, scene.resets) == (time, 3.0, 0)
    assert loop.run.running
    assert loop.latest.status.run[:4] == (run.number + 1, run.act, run.number, time)


def test_single_steps_are_counted_and_bounded_by_the_frames_budget() -> None:
    loop, scene = make(paused=True)
    for _ in range(5):
        loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert loop.run.counts["steps"] == 5
    scene.cost = SOLVE_SHARE * FRAME_INTERVAL / 3
    for _ in range(20_000):
        loop.commands.put(StepOnce())
    before = scene.clock.now
    loop.tick(FRAME_INTERVAL)
    assert scene.clock.now - before <= FRAME_INTERVAL
    loop.tick(FRAME_INTERVAL)
    assert loop.run.counts["steps"] == 5 + 4  # and none is owed


def test_no_plot_row_is_lost_where_nobody_takes_the_snapshots() -> None:
    loop, scene = make()
    scene.take_plot_rows = lambda: ((scene.time, 1.0),)
    loop.run.snapshots.plot_rows.clear()
    for _ in range(30):
        loop.tick(FRAME_INTERVAL)
    times = [row[0] for _, row in loop.run.snapshots.plot_rows]
    assert times == pytest.approx([FRAME_INTERVAL * k for k in range(1, 31)], abs=0.011)


def test_a_scene_that_fails_outside_its_guard_halts_the_run_and_the_thread_lives(capsys: pytest.CaptureFixture) -> None:
    loop, _ = make()
    stop = threading.Event()
    faults = [ZeroDivisionError("no such step")]

    def fail_once(commands: Iterable[Command]) -> list[Command]:
        if faults:
            raise faults.pop()
        return list(commands)

    loop.admit = fail_once
    thread = threading.Thread(target=loop.tick_until, args=(stop,), daemon=True)
    thread.start()
    stop.wait(0.1)
    assert thread.is_alive()
    assert "no such step" in loop.latest.status.halted
    assert not loop.latest.status.running
    stop.set()
    thread.join(5.0)
    assert "no such step" in capsys.readouterr().err


def test_what_a_program_waits_for_ends_at_the_whole_step_and_leaves_the_clock_as_it_was() -> None:
    for audience in (0, 1):
        for paused in (False, True):
            loop, scene = make(audience=lambda audience=audience: audience, paused=paused, cost=1e-4)
            answer: Future[float] = Future()
            loop.commands.put(Advance(0.995, answer))
            while not answer.done():
                loop.tick(FRAME_INTERVAL)
            assert answer.result() == scene.time == pytest.approx(1.0)
            assert loop.run.running is loop.latest.status.running is not paused
            assert loop.latest.status.time == scene.time


def test_without_an_audience_a_program_does_not_wait_for_the_clock() -> None:
    loop, _ = make(audience=lambda: 0, cost=1e-4)
    answer: Future[float] = Future()
    loop.commands.put(Advance(1.0, answer))
    loop.tick(FRAME_INTERVAL)
    assert loop.scene.time >= 0.5  # 100 steps take 10 ms
    assert loop.run.fixed_step.dropped == 0


def test_for_a_program_that_waits_there_is_a_snapshot_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    loop, scene = make(audience=lambda: 0, cost=1e-5)
    published: list[float] = []
    publish = loop.run.snapshots.publish

    def note() -> None:
        publish()
        published.append(scene.time)

    monkeypatch.setattr(loop.run.snapshots, "publish", note)
    loop.run.hurry(5.0)
    assert scene.time > 2.0
    gaps = np.diff([0.0, *published])
    assert gaps.min() >= HURRY_INTERVAL - 1e-9
    assert gaps.max() < HURRY_INTERVAL + 2.0 * FRAME_INTERVAL


def test_a_program_that_waits_is_told_why_the_time_does_not_come() -> None:
    loop, scene = make()
    for command, kind, words in (
        (Reset(), RuntimeError, "was reset"),
        (Begin(Params()), RuntimeError, "was reset"),
        (Resume(Params(), Checkpoint(0.0, {})), RuntimeError, "another moment"),
        (Advance(1.0, Future()), RuntimeError, "another program"),
        (Halt("no more"), DivergenceError, "no more"),
    ):
        answer: Future[float] = Future()
        loop.handle(Play())
        loop.commands.put(Advance(5.0, answer))
        loop.tick(FRAME_INTERVAL)
        assert not answer.done()
        loop.commands.put(command)
        loop.tick(FRAME_INTERVAL)
        with pytest.raises(kind, match=words):
            answer.result(0)
    assert loop.run.goal is None
    scene.fails = DivergenceError("too far")
    loop.handle(Play())
    answer = Future()
    loop.commands.put(Advance(5.0, answer))
    loop.tick(FRAME_INTERVAL)
    with pytest.raises(DivergenceError, match="too far"):
        answer.result(0)


def test_a_program_is_answered_between_two_steps_with_what_it_reads_or_what_went_wrong() -> None:
    loop, scene = make()
    good: Future[object] = Future()
    bad: Future[object] = Future()
    late: Future[object] = Future()
    late.cancel()
    for answer, read in ((good, lambda: scene.time), (bad, lambda: 1 / 0), (late, lambda: 1 / 0)):
        loop.commands.put(Ask(read, answer))
    loop.tick(FRAME_INTERVAL)
    assert good.result(0) == 0.0
    with pytest.raises(ZeroDivisionError):
        bad.result(0)
