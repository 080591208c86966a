"""Loops on one clock: the same simulated time for all, whatever their steps, and the slowest sets the pace."""

import pytest

from app.messages import Begin, Change, Checkpoint, Pause, Play, Reset, Resume, StepOnce, TogglePlay
from app.scenes import race
from app.scenes.contract import FRAME_INTERVAL, AnyScene
from app.scenes.race.parameters import RaceParams
from app.scenes.rope import SCENE
from app.server.loop.shared_clock import LEAD, Seat, SharedClock
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record

STEPS = (1 / 240, 1 / 60, 1 / 100)


class Group:
    """Loops of ropes at one clock, ticked by hand."""

    def __init__(self, *scenes: AnyScene) -> None:
        self.clock = SharedClock()
        self.loops = [SimLoop(scene, effort=lambda: 0.0) for scene in scenes]
        seats: list[Seat] = []
        for loop in self.loops:
            seat = Seat(self.clock)
            seats.append(seat)
            self.clock.seats = tuple(seats)
            loop.join(seat)

    def run(self, seconds: float, *, every: tuple[int, ...] = (1, 1, 1)) -> None:
        """Tick the loops for a wall time [s]; every: how many frames each waits between two ticks."""
        for frame in range(1, round(seconds / FRAME_INTERVAL) + 1):
            for loop, gap in zip(self.loops, every, strict=False):
                if frame % gap == 0:
                    loop.tick(gap * FRAME_INTERVAL)

    @property
    def times(self) -> list[float]:
        """Simulated times [s]."""
        return [loop.scene.time for loop in self.loops]

    def spread(self) -> float:
        """The largest difference of two simulated times [s]."""
        return max(self.times) - min(self.times)


def rope(**changes: float | str) -> AnyScene:
    """A rope without a browser."""
    return SCENE.make(check_record(SCENE.params, changes))


def of_steps(*steps: float) -> Group:
    return Group(*(rope(time_step=step, integrator="rk4") for step in steps))


def test_loops_of_other_steps_and_frame_rates_keep_the_same_time():
    group = of_steps(*STEPS)
    for _ in range(30):
        group.run(0.1, every=(1, 2, 3))
        assert group.spread() < LEAD + max(STEPS) + 3 * FRAME_INTERVAL
    assert min(group.times) == pytest.approx(3.0, abs=0.12)  # and keep pace with the wall clock
    group.loops[1].commands.put(Pause())
    group.run(0.2)
    assert not any(loop.run.running for loop in group.loops)
    assert group.spread() < max(STEPS)
    assert all(group.clock.time - time < step + 1e-9 for time, step in zip(group.times, STEPS, strict=True))


def test_where_one_asks_for_slow_motion_all_have_it():
    group = of_steps(1 / 240, 1 / 60)
    setattr(group.loops[1].scene, "pace", 0.25)  # noqa: B010, as of a scene it is only read
    group.run(2.0)
    assert group.times == pytest.approx([0.5, 0.5], abs=0.12)
    assert group.spread() < LEAD + 1 / 60


def test_where_one_cannot_keep_up_all_slow_down_and_no_step_is_lost():
    group = of_steps(1 / 240, 1 / 60)
    slow = group.loops[0]
    slow.run.fixed_step.learn = lambda steps, seconds: None  # type: ignore[method-assign]
    slow.run.fixed_step.cost_unknown = False
    slow.run.fixed_step.cost = FRAME_INTERVAL / 2  # a frame takes one of its steps, of four that are due
    group.run(2.0)
    assert group.times[1] == pytest.approx(0.5, abs=0.1)
    assert group.spread() < LEAD + 2 / 60
    assert slow.run.fixed_step.dropped == 0
    assert slow.run.fixed_step.capped
    assert slow.scene.time == pytest.approx(slow.run.counts["steps"] / 240)


def test_a_browser_that_is_missing_stops_the_clock_for_all():
    group = of_steps(*STEPS)
    group.run(0.5)
    before = group.times
    for loop in group.loops:
        loop.run.audience = lambda: 0
    group.run(0.5)
    assert group.times == before


def test_play_pause_step_and_reset_of_one_act_on_all():
    group = of_steps(*STEPS)
    group.run(0.5)
    group.loops[2].commands.put(TogglePlay())
    group.run(0.1)
    assert not any(loop.run.running for loop in group.loops)
    before = group.times
    group.loops[1].commands.put(StepOnce(3))
    group.run(0.1)
    for time, start, step in zip(group.times, before, STEPS, strict=True):
        assert time - start == pytest.approx(3 / 60, abs=step + 1e-9)
    group.loops[1].commands.put(Reset())
    group.run(0.1)
    assert group.times == [0.0, 0.0, 0.0]
    group.loops[0].commands.put(Play())
    group.run(0.5)
    assert min(group.times) > 0.4
    assert group.spread() < LEAD + 2 * max(STEPS)


def test_what_begins_one_run_again_begins_all():
    group = of_steps(*STEPS)
    group.run(1.0)
    changed = check_record(SCENE.params, {"time_step": 1 / 60, "length": 1.0, "integrator": "rk4"})
    group.loops[1].commands.put(Begin(changed))
    group.run(0.2)
    assert 0.0 < max(group.times) < 0.3
    group.run(0.5)
    assert group.spread() < LEAD + 2 * max(STEPS)


def test_a_change_that_begins_one_run_again_begins_all():
    ropes = race.SCENE.make(RaceParams(ropes=2))
    group = Group(rope(), ropes)
    group.run(0.5)
    group.loops[1].commands.put(Change(RaceParams(ropes=1), "start"))
    group.run(0.2)
    assert len(ropes.frame().ropes) == 1
    assert 0.0 < max(group.times) < 0.3
    assert group.spread() < LEAD + 2 / 60


def test_a_run_that_diverges_stops_all_and_a_reset_lets_all_go_on():
    group = Group(rope(integrator="explicit_euler", time_step=1 / 60, stiffness=1e5), rope(integrator="rk4"))
    group.run(20.0)
    assert group.loops[0].run.halted
    assert not group.loops[0].run.running
    assert not group.loops[1].run.running
    assert group.spread() < LEAD + 2 / 60
    group.loops[1].commands.put(Reset())
    group.run(0.1)
    assert group.loops[1].run.running
    assert not group.loops[0].run.halted


def test_a_run_that_goes_on_from_an_earlier_moment_advances_as_the_others_do():
    group = of_steps(1 / 240, 1 / 240)
    group.run(1.0)
    first = group.loops[0]
    state = Checkpoint(first.scene.keep(), {})
    kept_at = first.scene.time
    group.run(1.0)
    first.commands.put(Resume(first.scene.params, state))
    group.run(FRAME_INTERVAL)
    gap = group.times[1] - group.times[0]
    assert group.times[0] == pytest.approx(kept_at, abs=0.05)
    group.run(1.0)
    assert group.times[1] - group.times[0] == pytest.approx(gap, abs=LEAD + 0.02)
