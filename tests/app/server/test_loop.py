"""The loop, ticked with a clock of the test's own."""

import dataclasses
import threading
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

from app.messages import DivergenceError, Halt, Pause, Play, Reset, StepOnce, TogglePlay, WorkCount, where_not_finite
from app.server.loop import BUDGET, FRAME_INTERVAL, IDLE, FixedStep, SimLoop
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True)
class Params:
    speed: float = parameter(1.0, 0.01, 8.0)
    stiffness: float = parameter(1.0, 0.0, 10.0)


class Clock:
    """Wall time that only moves when the test or a step moves it."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class Scene:
    """A scene that counts."""

    step = 0.01

    def __init__(self, clock: Clock, cost: float = 0.0) -> None:
        self.params = Params()
        self.clock, self.cost = clock, cost
        self.time = 0.0
        self.resets = 0
        self.fails: Exception | None = None
        self.seen: list[float] = []

    def set_params(self, params: Params) -> None:
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
        self.fails = None

    def frame_interval(self) -> float:
        return self.time

    def readings(self) -> None:
        return None

    def take_plot_rows(self) -> tuple:
        return ()

    def work(self) -> dict[str, WorkCount]:
        return {"advances": WorkCount(len(self.seen))}


def make(cost: float = 0.0, **options) -> tuple[SimLoop, Scene]:
    clock = Clock()
    scene = Scene(clock, cost)
    return SimLoop(scene, clock=clock, effort=clock, **options), scene


def test_simulated_time_follows_wall_time() -> None:
    loop, scene = make()
    for _ in range(600):
        loop.tick(FRAME_INTERVAL)
    assert scene.time == pytest.approx(10.0, abs=scene.step)


def test_steps_are_whole_and_owe_less_than_one() -> None:
    pacer = FixedStep()
    taken = sum(pacer.steps(0.007, 1.0, 0.01)[0] for _ in range(1000))
    assert taken == 700 or (taken == 699 and pacer.debt < 0.01 * (1 + 1e-9))


def test_speed_scales_time() -> None:
    loop, scene = make()
    scene.params = Params(speed=0.25)
    for _ in range(240):
        loop.tick(FRAME_INTERVAL)
    assert scene.time == pytest.approx(1.0, abs=scene.step)


def test_time_that_cannot_be_made_up_is_dropped_and_shown() -> None:
    loop, scene = make(cost=0.02)  # a step of 10 ms takes 20 ms
    for _ in range(100):
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.status.capped
    assert loop.pacer.debt <= scene.step
    assert scene.time <= 100 * scene.step * 1.01
    scene.cost = 0.0
    loop.pacer.cost = 0.0
    before = scene.time
    loop.tick(FRAME_INTERVAL)
    assert scene.time - before <= 2 * scene.step  # no catching up


def test_a_frame_never_solves_longer_than_its_budget_allows() -> None:
    pacer = FixedStep()
    pacer.learn(10, 0.01)
    steps, capped = pacer.steps(0.25, 8.0, 1e-5)
    assert capped
    assert steps <= BUDGET * FRAME_INTERVAL / 0.001


def test_a_slider_reaches_the_simulation_in_the_next_frame() -> None:
    values = Params()
    loop, scene = make(read_params=lambda: values)
    loop.tick(FRAME_INTERVAL)
    values = Params(stiffness=7.0)
    loop.tick(FRAME_INTERVAL)
    assert scene.seen[-1] == 7.0


def test_paused_takes_no_step_and_publishes_nothing() -> None:
    loop, scene = make(paused=True)
    shown = loop.latest
    for _ in range(50):
        loop.tick(FRAME_INTERVAL)
    assert scene.seen == []
    assert loop.latest is shown
    assert loop.counts["idle ticks"] == 50


def test_nobody_looking_takes_no_step() -> None:
    loop, scene = make(audience=lambda: 0)
    for _ in range(50):
        loop.tick(FRAME_INTERVAL)
    assert scene.seen == []
    assert loop.counts["snapshots"] == 1


def test_commands_play_pause_step_and_reset() -> None:
    loop, scene = make(paused=True)
    loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert scene.time == pytest.approx(scene.step)
    loop.commands.put(Play())
    loop.tick(FRAME_INTERVAL)
    assert loop.running
    loop.commands.put(TogglePlay())
    loop.tick(FRAME_INTERVAL)
    assert not loop.running
    loop.commands.put(Play())
    loop.commands.put(Pause())
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert not loop.running
    assert scene.resets == 1


@pytest.mark.parametrize("error", [DivergenceError("h omega 3 over 2"), ZeroDivisionError("float division")])
def test_what_goes_wrong_pauses_the_run_and_is_said(error: Exception, capsys: pytest.CaptureFixture) -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    good = loop.latest.frame
    scene.fails = error
    loop.tick(FRAME_INTERVAL)
    assert not loop.running
    assert str(error) in loop.latest.status.halted
    assert loop.latest.frame == good
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.running
    assert loop.latest.status.halted == ""
    capsys.readouterr()


def test_the_real_time_factor_is_measured() -> None:
    loop, scene = make()
    scene.params = Params(speed=0.5)
    for _ in range(120):
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.status.actual_speed == pytest.approx(0.5, abs=0.02)


def test_a_step_that_became_a_thousand_times_as_dear_does_not_hold_up_the_frame() -> None:
    values = Params(speed=8.0)
    loop, scene = make(cost=1e-7, read_params=lambda: values)
    scene.step = 1e-5
    for _ in range(10):
        loop.tick(FRAME_INTERVAL)
    assert loop.counts["steps"] > 10_000
    values, scene.cost = Params(speed=8.0, stiffness=2.0), 1e-4
    before = scene.clock.now
    loop.tick(FRAME_INTERVAL)
    assert scene.clock.now - before <= FRAME_INTERVAL
    assert loop.latest.status.capped


class Numbers(NamedTuple):
    points: np.ndarray
    load: float = 0.0
    parts: tuple = ()


@pytest.mark.parametrize(
    ("picture", "where"),
    [
        (Numbers(np.ones(3), 2.0, (np.arange(3), None, "text")), ""),
        (Numbers(np.array([1.0, np.nan])), "points"),
        (Numbers(np.ones(3), np.inf), "load"),
        (Numbers(np.ones(3), 0.0, (1.0, (Numbers(np.full(2, np.inf, np.float32)),))), "points"),
    ],
)
def test_what_is_not_finite_in_a_picture_is_found(picture: Numbers, where: str) -> None:
    assert where_not_finite(picture) == where


@pytest.mark.parametrize("fault", [lambda: float("nan"), lambda: 1 / 0])
def test_a_picture_that_cannot_be_shown_pauses_the_run_and_the_last_good_one_stays(
    fault: Callable[[], float], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    loop, scene = make()
    loop.tick(FRAME_INTERVAL)
    good = loop.latest.frame
    with monkeypatch.context() as patch:
        patch.setattr(scene, "picture", fault)
        loop.tick(FRAME_INTERVAL)
    assert loop.latest.frame == good
    assert not loop.running
    assert "number" in loop.latest.status.halted or "division" in loop.latest.status.halted
    loop.commands.put(Reset())
    loop.tick(FRAME_INTERVAL)
    assert loop.running
    capsys.readouterr()


def test_a_halt_from_outside_is_said() -> None:
    loop, _ = make()
    loop.commands.put(Halt("The picture could not be drawn"))
    loop.tick(FRAME_INTERVAL)
    assert loop.latest.status.halted == "The picture could not be drawn"
    assert not loop.latest.status.running


def test_a_scene_of_fewer_pictures_has_as_much_time_to_solve_in() -> None:
    every, other = FixedStep(), FixedStep()
    every.cost = other.cost = 0.5 * FRAME_INTERVAL * BUDGET  # two steps fill a frame
    assert every.steps(FRAME_INTERVAL, 1.0, FRAME_INTERVAL / 3) == (2, True)
    assert other.steps(2 * FRAME_INTERVAL, 1.0, FRAME_INTERVAL / 3, 2 * FRAME_INTERVAL) == (4, True)
    assert other.steps(2 * FRAME_INTERVAL, 1.0, FRAME_INTERVAL / 2, 2 * FRAME_INTERVAL) == (4, False)


def test_whoever_shows_is_told_of_each_new_snapshot_and_of_nothing_else() -> None:
    loop, _ = make()
    told = []
    for _ in range(20):
        loop.tick(FRAME_INTERVAL)
        told.append(loop.fresh.is_set())
        loop.fresh.clear()
    assert sum(told) == loop.latest.serial - 1
    loop.handle(Pause())
    loop.tick(FRAME_INTERVAL)
    assert not loop.fresh.is_set()
    loop.commands.put(StepOnce())
    loop.tick(FRAME_INTERVAL)
    assert loop.fresh.is_set()


@pytest.mark.parametrize(("busy", "seconds"), [(False, IDLE), (True, 4 * FRAME_INTERVAL)])
def test_a_command_ends_a_long_sleep_and_is_obeyed_after_the_parameters(busy: bool, seconds: float) -> None:
    given = Params()
    loop, scene = make(read_params=lambda: given)
    stop = threading.Event()
    threading.Timer(0.1, lambda: loop.commands.put(Reset())).start()
    loop.wait(1000.0 * seconds, stop, busy)
    assert loop.first == Reset()
    assert scene.resets == 0
    given = Params(stiffness=3.0)
    reset, seen = scene.reset, []
    scene.reset = lambda: seen.append(scene.params.stiffness) or reset()
    loop.tick(FRAME_INTERVAL)
    assert seen == [3.0]
    assert scene.resets == 1
    loop.tick(FRAME_INTERVAL)
    assert scene.resets == 1
