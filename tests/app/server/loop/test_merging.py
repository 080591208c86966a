"""Commands that wait for one tick: merged, they have the effect of all in order."""

import dataclasses
import functools
import itertools
from collections.abc import Iterable
from concurrent.futures import Future
from typing import Any

import numpy as np
import pytest

from app.messages import (
    Advance,
    Ask,
    BaseParams,
    Begin,
    Change,
    Checkpoint,
    Command,
    GrabTo,
    Halt,
    LastFrame,
    Pause,
    Place,
    Play,
    PointAlong,
    Release,
    Reset,
    Resume,
    RunState,
    StepOnce,
    StudentAnswer,
    TogglePlay,
)
from app.scenes.contract import FRAME_INTERVAL
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene
from app.server.loop.commands import merged
from app.server.loop.replay import Replay
from app.server.loop.run import Goal
from app.server.loop.sim_loop import SimLoop
from sim.parameters import Effect, effect_of_change
from tests.app.server.loop.test_sim_loop import Params

ORIGIN = (0.0, 0.0, 0.0)


class Scene:
    """A scene with a memory: `state` shows all commands and their order."""

    step = 0.01
    faster = ""
    frame_interval = FRAME_INTERVAL
    pace = 1.0
    time = 0.0

    def __init__(self) -> None:
        self.params = Params()
        self.reset()

    @property
    def state(self) -> tuple[object, ...]:
        return self.params, self.time, self.made_of, self.motion, self.hold, self.places, self.points, self.answers

    @state.setter
    def state(self, state: tuple[Any, ...]) -> None:
        self.params, self.time, self.made_of, self.motion, self.hold, self.places, self.points, self.answers = state

    def reset(self) -> None:
        """A start depends on all parameters; two objects stay in place, as the camera of a sea does."""
        self.made_of = self.params.points, self.params.stiffness
        self.time, self.hold, self.motion = 0.0, None, ()
        self.places: tuple[tuple[str, object], ...] = tuple(p for p in getattr(self, "places", ()) if p[0] == "camera")
        self.points: tuple[object, ...] = getattr(self, "points", ())
        self.answers = 1  # of a student's functions, that wait

    def change_forces(self, params: Params) -> None:
        self.params = params

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            self.time += self.step
            self.motion = hash((self.motion, self.params.stiffness, self.hold, self.places))

    def handle(self, command: Command) -> None:
        match command:
            case Place(thing, position):
                self.places = tuple(sorted({**dict(self.places), thing: position}.items()))
            case GrabTo(0, target):  # as the root of a rope, which stays there
                self.places = tuple(sorted({**dict(self.places), "root": target}.items()))
            case GrabTo(particle, target, client) if self.hold is None or self.hold[2] == client:
                self.hold = particle, target, client
            case Release(client) if self.hold is not None and self.hold[2] == client:
                self.hold = None
            case PointAlong(origin):
                self.points = (*self.points, origin)
            case StudentAnswer():
                self.motion = hash((self.motion, self.answers, self.params.stiffness)) if self.answers else self.motion
                self.answers = 0
            case _:
                pass

    def keep(self) -> object:
        return self.time

    def resume(self, kept: Any) -> None:
        self.time, self.motion, self.hold, self.made_of = kept, ("kept",), None, ("kept", self.params)

    def frame(self) -> float:
        return self.time

    def readings(self) -> None:
        return None

    def take_plot_rows(self) -> tuple[()]:
        return ()

    def curves(self) -> None:
        return None


class Lane:
    """A loop whose whole state is a value: the effect of a command on a state is computed once."""

    def __init__(self) -> None:
        self.scene = Scene()
        self.loop = SimLoop(self.scene, clock=lambda: 0.0, effort=lambda: 0.0)  # type: ignore[arg-type]
        self.known: dict[tuple[object, ...], tuple[Any, ...]] = {}

    def after(self, state: tuple[Any, ...], command: Command) -> tuple[Any, ...]:
        """The state after a command. Commands without content are equal as tuples, so that they are told by kind."""
        key = state, type(command), command if isinstance(command, StepOnce | Change) else id(command)
        if key not in self.known:
            self.known[key] = self.handled(state, command)
        return self.known[key]

    def begin(self, **changes: object) -> tuple[Any, ...]:
        """A state of the loop after half a second, with other values of `state`, `reason`, `replay`, `goal`."""
        self.scene.__init__()
        self.scene.advance(50)
        values = {"state": RunState.RUNNING, "reason": "", "replay": None, "goal": None, **changes}
        return self.scene.state, values["state"], values["reason"], values["replay"], values["goal"], False, ()

    def handled(self, state: tuple[Any, ...], command: Command) -> tuple[Any, ...]:
        """The state after a command; the answers to programs are part of it."""
        loop, scene = self.loop, self.scene
        scene.state, loop.run.state, loop.run.reason, moment, goal, starts, answers = state
        loop.run.replay = None if moment is None else Replay(MOMENTS, "it diverged")
        if loop.run.replay is not None:
            loop.run.replay.number, loop.run.replay.shown_for = moment
        waiting: Future[float] = Future()
        loop.run.goal = None if goal is None else Goal(goal[0], waiting, goal[1])
        loop.run.counts["starts"] = starts
        match command:
            case Ask():
                answers = (*answers, scene.state)
            case Advance(seconds):
                loop.handle(Advance(seconds, Future()))
            case _:
                loop.handle(command)
        if waiting.done():
            answers = (*answers, str(waiting.exception()))
        return (
            scene.state, loop.run.state, loop.run.halted,
            None if loop.run.replay is None else (loop.run.replay.number, loop.run.replay.shown_for),
            None if loop.run.goal is None else (loop.run.goal.until, loop.run.goal.was_running),
            loop.run.counts["starts"] > 0, answers,
        )  # fmt: skip


MOMENTS = tuple(LastFrame(0.1 * k, k, ORIGIN, ORIGIN) for k in range(3))
CHANGES = (
    Params(grid=False), Params(stiffness=3.0), Params(points=5), Params(), Params(points=5, stiffness=3.0),
)  # fmt: skip
COMMANDS: tuple[Command, ...] = (  # the effect of a change depends on those before it: see `posted`
    Play(), Pause(), TogglePlay(), StepOnce(), StepOnce(2), Halt("no picture"), Reset(),
    *(Change(params, "look") for params in CHANGES), Begin(Params(stiffness=4.0)),
    Resume(Params(stiffness=5.0), Checkpoint(0.25, {})),
    Place("root", (1.0, 0.0, 0.0)), Place("camera", (2.0, 0.0, 0.0)),
    GrabTo(0, (3.0, 0.0, 0.0)), GrabTo(1, (4.0, 0.0, 0.0)), GrabTo(1, (5.0, 0.0, 0.0)), GrabTo(1, (6.0, 0.0, 0.0), 7),
    Release(), PointAlong((8.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
    StudentAnswer(), Ask(lambda: None, Future()), Advance(2.0, Future()),
)  # fmt: skip
STATES: dict[str, dict[str, object]] = {
    "running": {},
    "paused": {"state": RunState.PAUSED},
    "halted": {"state": RunState.HALTED, "reason": "it diverged"},
    "replayed": {"state": RunState.REPLAYING, "replay": (0, 0.0)},
    "replayed, paused": {"state": RunState.REPLAY_PAUSED, "replay": (1, 0.0)},
    "a program waits": {"goal": (9.0, False)},
}


@pytest.mark.parametrize(("length", "least"), [(3, 100), pytest.param(4, 1000, marks=pytest.mark.long)])
def test_all_sequences_of_commands_do_the_same_merged_as_in_order(length: int, least: int) -> None:
    """Of every kind, on loops in every state; a shorter sequence begins a longer one."""
    lane = Lane()
    begins = [lane.begin(**changes) for changes in STATES.values()]
    after, count = lane.after, 0
    for sequence in sequences(length):
        sequence = posted(Params(), sequence)
        several = merged(sequence)
        if len(several) == len(sequence):
            assert all(a is b for a, b in zip(several, sequence, strict=True))
            continue
        count += 1
        for begin in begins:
            assert functools.reduce(after, several, begin) == functools.reduce(after, sequence, begin), sequence
    assert count > least


@pytest.mark.parametrize(
    ("effects", "left"),
    [
        (("look", "forces", "look"), ["forces"]),
        (("forces", "start"), ["start"]),
        (("start", "look"), ["start"]),
        (("start", "forces"), ["start", "forces"]),
        (("start", "forces", "look", "forces"), ["start", "forces"]),
        (("start", "forces", "start"), ["start"]),
    ],
)
def test_changes_merge_into_one_of_their_greatest_effect(effects: tuple[Effect, ...], left: list[Effect]) -> None:
    changes = [Change(Params(stiffness=float(number)), effect) for number, effect in enumerate(effects)]
    several = merged(changes)
    assert [command.effect for command in several if isinstance(command, Change)] == left
    assert several[-1] == Change(changes[-1].params, left[-1])


def test_grabs_of_one_particle_by_one_browser_are_one() -> None:
    """Another browser cannot take a grabbed particle, and another particle is a new grab."""
    first, second = GrabTo(1, (1.0, 0.0, 0.0), 7), GrabTo(1, (2.0, 0.0, 0.0), 7)
    assert merged([first, second]) == [second]
    for other in (GrabTo(2, (2.0, 0.0, 0.0), 7), GrabTo(1, (2.0, 0.0, 0.0), 8)):
        assert merged([first, other]) == [first, other]


def posted(params: BaseParams, commands: Iterable[Command]) -> tuple[Command, ...]:
    """Commands in which each change has its effect after those before it, as a panel posts it. params: at first."""
    done: list[Command] = []
    for command in commands:
        if isinstance(command, Change):
            command = command._replace(effect=effect_of_change(params, command.params) or "look")
        if isinstance(command, Change | Begin | Resume):
            params = command.params
        done.append(command)
    return tuple(done)


def sequences(most: int) -> Iterable[tuple[Command, ...]]:
    """All sequences up to a number of commands."""
    return itertools.chain.from_iterable(itertools.product(COMMANDS, repeat=length) for length in range(1, most + 1))


@pytest.mark.parametrize(
    "first", [2, *(pytest.param(first, marks=pytest.mark.long) for first in range(10) if first != 2)]
)
def test_a_rope_is_left_by_merged_commands_as_by_all_in_order(first: int) -> None:
    params = RopeParams(points=4, root_swing=0.1, integrator="rk4")
    earlier = RopeScene(params)
    earlier.advance(20)
    stiffer = dataclasses.replace(params, stiffness=900.0)
    commands: tuple[Command, ...] = (
        StepOnce(3), Reset(), Change(stiffer, "look"), Change(dataclasses.replace(stiffer, gravity=3.0), "look"),
        Change(params, "look"),
        Begin(stiffer), Resume(params, Checkpoint(earlier.keep(), {})),
        GrabTo(3, (1.0, 0.0, 0.0)), GrabTo(3, (0.0, 1.0, 0.0)), Place("root", (0.2, 0.0, 0.0)),
    )  # fmt: skip
    count = 0
    for rest in itertools.product(commands, repeat=2):
        sequence = posted(params, (commands[first], *rest))
        several = merged(sequence)
        if len(several) == len(sequence):
            continue
        ends = []
        for done in (several, sequence):
            loop = SimLoop(RopeScene(params), paused=True, effort=lambda: 0.0)
            loop.scene.advance(30)
            for command in (*done, StepOnce(20)):
                loop.handle(command)
            state = loop.scene.state
            assert not loop.run.halted
            ends.append((loop.scene.params, loop.scene.time, state.x, state.v))
        assert ends[0][:2] == ends[1][:2], sequence
        assert np.array_equal(ends[0][2], ends[1][2]), sequence
        assert np.array_equal(ends[0][3], ends[1][3]), sequence
        count += 1
    assert count > 5
