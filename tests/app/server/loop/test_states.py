"""Each event in each state of a run: what a loop then does with a small scene, and what the page says.

The expected outcomes are words on what a person sees. They name no state, and follow from no table.
"""

import random
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import NamedTuple

import pytest

from app.messages import (
    Advance,
    Begin,
    Change,
    Checkpoint,
    Command,
    GoBack,
    Halt,
    LastFrame,
    Pause,
    Play,
    Release,
    Reset,
    Resume,
    RunOn,
    RunState,
    StepOnce,
    TogglePlay,
)
from app.panel.head import status_line
from app.scenes.contract import FRAME_INTERVAL
from app.server.loop import states
from app.server.loop.replay import MOMENT_INTERVAL
from app.server.loop.run import LeftRun
from app.server.loop.sim_loop import SimLoop
from app.server.loop.states import Event, IllegalEventError
from sim.interruption import ABANDON, STOP, InterruptionError
from sim.validation import DivergenceError
from tests.app.server.loop.test_sim_loop import Clock, Params, Scene

CORNER = (0.0, 0.0, 0.0)
MOMENTS = tuple(LastFrame(0.01 * k, -1.0 - k, CORNER, CORNER) for k in range(40))  # their frames are below 0
PAUSED_ACT = 7  # of a run that was left paused
TICKS = round(3 * MOMENT_INTERVAL / FRAME_INTERVAL)


class SmallScene(Scene):
    """A scene whose beginnings can be cancelled or fail, and whose drags can be abandoned."""

    def __init__(self) -> None:
        super().__init__(Clock())
        self.cancels = 0  # number of beginnings to cancel
        self.refuses = self.abandons = False
        self.words: list[str] = []  # of the page during each beginning
        self.word: Callable[[], str] = str

    def reset(self) -> None:
        self.words.append(self.word())
        if self.cancels:
            self.cancels -= 1
            raise InterruptionError
        if self.refuses:
            raise DivergenceError("no such start")
        super().reset()

    def handle(self, command: object) -> None:
        if self.abandons:
            raise InterruptionError


class Lab(NamedTuple):
    """A loop and its scene."""

    loop: SimLoop
    scene: SmallScene

    def tick(self, count: int = 1, wall: float = FRAME_INTERVAL) -> None:
        for _ in range(count):
            self.loop.tick(wall)

    def word(self) -> str:
        """First word or words of the status line of a new snapshot."""
        status = self.loop.run.snapshots.status()
        match = re.search(r">([A-Z][a-z ]+)<", str(status_line(self.loop.latest._replace(status=status))))
        assert match is not None
        return match[1]

    def motion(self) -> str:
        """Appearance of the next ticks: time, moments of a divergence, or a picture that stands."""
        time, frames = self.scene.time, set()
        for _ in range(TICKS):
            self.tick()
            frames.add(self.loop.latest.frame)
        moments = {frame for frame in frames if frame < 0.0}
        return "time" if self.scene.time > time else "moments" if len(moments) > 1 else "nothing"


class Outcome(NamedTuple):
    """Words and motion on the page after an event."""

    word: str  # of the status line
    begins: bool  # the next tick begins the scene again
    motion: str
    motion_after_play: str


OUTCOMES = {
    "begins, plays": Outcome("Running", True, "time", "time"),
    "begins, paused": Outcome("Paused", True, "nothing", "time"),
    "cannot begin": Outcome("Stopped", False, "nothing", "nothing"),
    "plays": Outcome("Running", False, "time", "time"),
    "paused": Outcome("Paused", False, "nothing", "time"),
    "replays": Outcome("Slow motion", False, "moments", "moments"),
    "replay paused": Outcome("Slow motion", False, "nothing", "moments"),
    "stopped": Outcome("Stopped", False, "nothing", "time"),
    "stopped in a replay": Outcome("Stopped", False, "nothing", "moments"),
}


def new_lab() -> Lab:
    scene = SmallScene()
    lab = Lab(SimLoop(scene, clock=scene.clock, effort=scene.clock), scene)
    scene.word = lab.word
    lab.tick(30)
    return lab


def diverge(lab: Lab, moments: tuple[LastFrame, ...]) -> None:
    lab.scene.fails = DivergenceError("too far", moments)
    lab.tick()
    lab.scene.fails = None


def begin_again(lab: Lab) -> None:
    """Begin the scene by a reset that is cancelled."""
    lab.scene.cancels = 1
    lab.loop.commands.put(Reset())
    lab.tick(wall=0.0)


def fail_to_begin(lab: Lab) -> None:
    lab.scene.refuses = True
    lab.loop.commands.put(Reset())
    lab.tick()
    lab.scene.refuses = False


def lab_in(state: RunState) -> Lab:
    """A lab that commands and faults have brought into a state."""
    lab = new_lab()
    if state in (RunState.PAUSED, RunState.MAKING_PAUSED):
        lab.loop.handle(Pause())
    match state:
        case RunState.MAKING | RunState.MAKING_PAUSED:
            begin_again(lab)
        case RunState.UNMADE:
            fail_to_begin(lab)
        case RunState.REPLAYING | RunState.REPLAY_PAUSED:
            diverge(lab, MOMENTS)
        case RunState.HALTED:
            diverge(lab, ())
        case _:
            pass
    if state is RunState.REPLAY_PAUSED:
        lab.loop.handle(Pause())
    assert lab.loop.run.state is state
    return lab


def fail_outside(lab: Lab) -> None:
    """Let a tick fail outside of the scene."""

    def fail(commands: object) -> list[Command]:
        raise ZeroDivisionError("no such command")

    lab.loop.admit = fail
    lab.loop.tick_or_halt(0.0)
    lab.loop.admit = list


def cancel(lab: Lab) -> None:
    """Cancel the beginning of the scene once more, or abandon a drag."""
    if lab.loop.run.state.is_making:
        lab.scene.cancels = 1
        lab.tick(wall=0.0)
        return
    lab.scene.abandons, lab.loop.run.request[STOP] = True, ABANDON
    lab.loop.handle(Release())
    lab.scene.abandons, lab.loop.run.request[STOP] = False, 0


def begin_paused(lab: Lab) -> None:
    """Go back to a run that was left paused."""
    lab.loop.runs.left.add(LeftRun(PAUSED_ACT, lab.scene.params, Checkpoint(0.25, {}), (), False))
    lab.loop.handle(GoBack(lab.scene.params, PAUSED_ACT))


def replay(lab: Lab) -> None:
    """Diverge with moments to show, or play on with them."""
    if lab.loop.run.replay is None:
        diverge(lab, MOMENTS)
    else:
        lab.loop.handle(Play())


def resume(lab: Lab) -> None:
    lab.loop.handle(Resume(lab.scene.params, Checkpoint(0.25, {})))


CAUSES: dict[Event, Callable[[Lab], None]] = {
    Event.PLAY: lambda lab: lab.loop.handle(Play()),
    Event.PAUSE: lambda lab: lab.loop.handle(Pause()),
    Event.ADVANCE: lambda lab: lab.loop.handle(Advance(100.0, Future())),
    Event.HALT: fail_outside,
    Event.REPLAY: replay,
    Event.RESTART: lambda lab: lab.loop.handle(Reset()),
    Event.BEGIN: lambda lab: lab.loop.handle(Begin(lab.scene.params)),
    Event.BEGIN_PAUSED: begin_paused,
    Event.RESUME: resume,
    Event.CANCEL: cancel,
    Event.MADE: lambda lab: lab.tick(wall=0.0),
}
BEGINNINGS = (Event.RESTART, Event.BEGIN, Event.BEGIN_PAUSED)
ALWAYS = {Event.BEGIN: "plays", Event.BEGIN_PAUSED: "paused", Event.RESUME: "plays"}
EXPECTED: dict[RunState, dict[Event, str]] = {
    RunState.MAKING: {
        Event.PLAY: "begins, plays", Event.PAUSE: "begins, paused", Event.HALT: "cannot begin",
        Event.RESTART: "plays", Event.CANCEL: "begins, plays", Event.MADE: "plays",
    },
    RunState.MAKING_PAUSED: {
        Event.PLAY: "begins, plays", Event.PAUSE: "begins, paused", Event.HALT: "cannot begin",
        Event.RESTART: "paused", Event.CANCEL: "begins, paused", Event.MADE: "paused",
    },
    RunState.UNMADE: {
        Event.PLAY: "cannot begin", Event.PAUSE: "cannot begin", Event.ADVANCE: "cannot begin",
        Event.HALT: "cannot begin", Event.RESTART: "plays",
    },
    RunState.RUNNING: {
        Event.PLAY: "plays", Event.PAUSE: "paused", Event.ADVANCE: "plays", Event.HALT: "stopped",
        Event.REPLAY: "replays", Event.RESTART: "plays", Event.CANCEL: "begins, plays",
    },
    RunState.PAUSED: {
        Event.PLAY: "plays", Event.PAUSE: "paused", Event.ADVANCE: "plays", Event.HALT: "stopped",
        Event.RESTART: "paused", Event.CANCEL: "begins, paused",
    },
    RunState.REPLAYING: {
        Event.PAUSE: "replay paused", Event.ADVANCE: "replay paused", Event.HALT: "stopped in a replay",
        Event.REPLAY: "replays", Event.RESTART: "plays", Event.CANCEL: "begins, plays",
    },
    RunState.REPLAY_PAUSED: {
        Event.PAUSE: "replay paused", Event.ADVANCE: "replay paused", Event.HALT: "stopped in a replay",
        Event.REPLAY: "replays", Event.RESTART: "paused", Event.CANCEL: "begins, paused",
    },
    RunState.HALTED: {
        Event.PLAY: "plays", Event.PAUSE: "stopped", Event.ADVANCE: "stopped", Event.HALT: "stopped",
        Event.REPLAY: "replays", Event.RESTART: "plays", Event.CANCEL: "begins, plays",
    },
}  # fmt: skip
LEGAL = [(state, event) for state in RunState for event in (*EXPECTED[state], *ALWAYS)]
NAMES = [f"{state.value}: {event.value}" for state, event in LEGAL]


def check(state: RunState, event: Event, plant: RunState | None = None) -> None:
    """Cause an event in a state, and see what follows. plant: a wrong state to follow."""
    lab = lab_in(state)
    if (state, event) == (RunState.HALTED, Event.REPLAY):  # in the middle of a replay
        lab = lab_in(RunState.REPLAYING)
        lab.loop.handle(Halt("no picture"))
    row, resets, words = states.TABLE[state], lab.scene.resets, len(lab.scene.words)
    if plant is not None:
        states.TABLE[state] = {**row, event: plant}
    try:
        CAUSES[event](lab)
        outcome = OUTCOMES[EXPECTED[state].get(event) or ALWAYS[event]]
        word = lab.word()
        if event in BEGINNINGS:
            assert lab.scene.resets == resets + 1
            assert lab.scene.words[words:] == [word]  # the page says so from the first moment on
        resets = lab.scene.resets
        lab.tick(wall=0.0)
        begins, motion = lab.scene.resets > resets, lab.motion()
        lab.loop.handle(Play())
        assert Outcome(word, begins, motion, lab.motion()) == outcome
    finally:
        states.TABLE[state] = row


@pytest.mark.parametrize(("state", "event"), LEGAL, ids=NAMES)
def test_an_event_in_a_state_does_what_the_page_says(state: RunState, event: Event) -> None:
    check(state, event)


def test_every_wrong_entry_of_the_table_is_noticed(capsys: pytest.CaptureFixture) -> None:
    for state, event in LEGAL:
        for wrong in set(RunState) - {states.TABLE[state][event]}:
            with pytest.raises((AssertionError, IllegalEventError)):
                check(state, event, wrong)
    capsys.readouterr()


def test_other_events_are_errors() -> None:
    legal = {(state, event) for state, row in states.TABLE.items() for event in row}
    assert legal == set(LEGAL)
    for state in RunState:
        for event in set(Event) - states.TABLE[state].keys():
            lab = lab_in(state)
            with pytest.raises(IllegalEventError, match=f"{state.value} cannot meet {event.value}"):
                lab.loop.run.become(event)
            assert lab.loop.run.state is state


def test_every_state_is_reached_from_every_other() -> None:
    for start in RunState:
        reached, count = {start}, 0
        while len(reached) > count:
            count = len(reached)
            reached |= {after for state in reached for after in states.TABLE[state].values()}
        assert reached == set(RunState)


def test_a_run_that_has_not_begun_is_not_kept_for_an_undo() -> None:
    lab = new_lab()
    lab.scene.cancels = 1
    lab.loop.commands.put(Reset(2))
    lab.tick()
    assert lab.loop.run.state is RunState.MAKING
    lab.loop.commands.put(Reset(3))
    lab.tick()
    assert [run.act for run in lab.loop.runs.left.runs] == [1]


def test_a_run_whose_return_is_cancelled_takes_other_forces_after_it_has_begun() -> None:
    lab = new_lab()
    left, wanted = lab.scene.params, Params(stiffness=5.0)
    lab.loop.handle(Begin(left, 2))
    lab.scene.cancels = 1
    lab.loop.commands.put(GoBack(wanted, 1))
    lab.tick(wall=0.0)
    assert (lab.loop.run.state, lab.scene.changes) == (RunState.MAKING, 0)
    lab.tick(wall=0.0)
    assert (lab.loop.run.state, lab.scene.changes, lab.scene.params) == (RunState.RUNNING, 1, wanted)


def test_the_table_of_the_documentation_is_that_of_the_program() -> None:
    text = (Path(__file__).parents[4] / "docs" / "architecture.md").read_text("utf-8")
    rows = [[cell.strip(" *") for cell in line.split("|")[1:-1]] for line in text.split("\n") if line.startswith("|")]
    start = next(number for number, row in enumerate(rows) if row[0] == "state")
    assert rows[start] == ["state", *(event.value for event in Event)]
    table = {row[0]: row[1:] for row in rows[start + 2 : start + 2 + len(RunState)]}
    assert table == {
        state.value: [states.TABLE[state][event].value if event in states.TABLE[state] else "-" for event in Event]
        for state in RunState
    }


def commands(rng: random.Random) -> Iterator[Command]:
    """A few random commands."""
    for _ in range(rng.choice([0, 0, 1, 1, 2, 4])):
        yield rng.choice([
            Play(), Pause(), TogglePlay(), StepOnce(), Halt("no picture"), Reset(), Release(), Advance(0.1, Future()),
            RunOn(lambda snapshot: snapshot.status.time > 1.0), Change(Params(points=rng.randint(2, 4)), "start"),
            Change(Params(stiffness=rng.choice([1.0, 2.0])), "forces"), Begin(Params(), rng.randint(1, 3)),
            Resume(Params(), Checkpoint(0.25, {}), rng.randint(1, 3)),
            GoBack(Params(), rng.randint(1, 3), rng.random() < 0.5),
        ])  # fmt: skip


def test_no_commands_and_faults_lead_to_an_event_that_is_illegal() -> None:
    """Random ones, many in one tick, with beginnings that are cancelled or fail and runs that diverge."""
    rng, lab, reached = random.Random(1), new_lab(), set()
    for _ in range(20_000):
        scene, run = lab.scene, lab.loop.run
        scene.cancels, scene.refuses = int(rng.random() < 0.3), rng.random() < 0.1
        scene.abandons = rng.random() < 0.05
        run.request[STOP] = ABANDON if scene.abandons else 0
        scene.fails = DivergenceError("too far", rng.choice([(), MOMENTS[:3]])) if rng.random() < 0.05 else None
        for command in commands(rng):
            lab.loop.commands.put(command)
        lab.tick()
        reached.add(run.state)
        status = lab.loop.run.snapshots.status()
        assert (status.halted != "") is (lab.word() == "Stopped")
        assert (run.unfinished is not None) is run.state.is_making
    assert reached == set(RunState)
