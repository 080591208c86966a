"""The runs of a scene: the present one, its steps within the budget of a frame, and the undo of its start."""

import collections
import functools
import itertools
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from typing import NamedTuple

import numpy as np

from app.messages import (
    BaseParams,
    Begin,
    Change,
    Checkpoint,
    GoBack,
    Pause,
    Play,
    PlotRow,
    RecordCommand,
    Resume,
    RunIdentity,
    RunState,
)
from app.panel.recording.recorder import FrameMemory
from app.scenes.contract import FRAME_INTERVAL, AnyScene, AnySnapshot
from app.scenes.stepping import steps_to
from app.server.loop.clock import MAX_CATCH_UP, SOLVE_SHARE, FixedStep, TickClock
from app.server.loop.commands import BEGINNING, NOTHING, OTHER_FORCES, STEPS, Activity
from app.server.loop.replay import Replay
from app.server.loop.shared_clock import Seat
from app.server.loop.snapshots import Snapshots, kept_state
from app.server.loop.states import Event, state_after
from sim.interruption import ABANDON, STOP, InterruptionError
from sim.parameters import Effect, effect_of_change
from sim.validation import DivergenceError

HURRY_INTERVAL = 0.1  # [s] of simulated time between two snapshots while nobody looks and a program waits
MAX_BYTES = 100e6  # of all runs kept for an undo; beyond that the oldest are dropped
ROW_BYTES = 32  # of a number in a plot row, with its place in the tuple
BEGUN = "the lab was reset or resumed from another moment"  # answer to a program that awaits a time


class Goal(NamedTuple):
    """Goal of an `Advance`."""

    until: float  # [s] of simulated time
    answer: Future[float]
    was_running: bool

    def end(self, result: float | Exception) -> None:
        """Answer with the time [s], or raise there."""
        if self.answer.set_running_or_notify_cancel():
            if isinstance(result, Exception):
                self.answer.set_exception(result)
            else:
                self.answer.set_result(result)


class AwaitedEvent:
    """Event at whose beginning the run pauses; if it is happening now, its next occurrence."""

    def __init__(self, reached: Callable[[AnySnapshot], bool], latest: AnySnapshot) -> None:
        """reached: true of a snapshot in which it happens."""
        self.reached = reached
        self.happens = reached(latest)

    def begins(self, latest: AnySnapshot) -> bool:
        """True if it happens in this snapshot and did not in the last one."""
        before, self.happens = self.happens, self.reached(latest)
        return self.happens and not before


class SceneRun:
    """Takes a scene's steps, and restarts it."""

    def __init__(
        self, scene: AnyScene, audience: Callable[[], int], clock: TickClock, *, paused: bool, act: int
    ) -> None:
        """The arguments are those of `SimLoop`."""
        self.scene, self.audience, self.clock = scene, audience, clock
        self.identity = RunIdentity(act=act, placed=act)
        self.numbers = itertools.count(2)  # of the runs to come
        self.request = np.zeros(4, np.int64)  # for the running solve: see sim/interruption.py
        self.activity = NOTHING
        self.state = RunState.PAUSED if paused else RunState.RUNNING
        self.unfinished: Callable[[], None] | None = None  # the beginning to repeat while the scene is being made
        self.reason = ""  # of the last halt
        self.halted_with = scene.params  # parameters of the run that halted
        self.fixed_step = FixedStep()
        self.replay: Replay | None = None  # of a run that has diverged, until it plays on
        self.seat: Seat | None = None  # at a clock shared with other loops
        self.goal: Goal | None = None  # awaited by a program
        self.awaited: AwaitedEvent | None = None
        self.counts: collections.Counter[str] = collections.Counter()
        self.snapshots = Snapshots(self)

    def become(self, event: Event) -> None:
        """Change the state by an event. Raises IllegalEventError if the table has none."""
        self.state = state_after(self.state, event)

    @property
    def running(self) -> bool:
        """True if the run goes on by itself."""
        return self.state.plays

    @property
    def halted(self) -> str:
        """Reason why the run has stopped, or ""."""
        return self.reason if self.state.has_stopped else ""

    @property
    def stopped_by(self) -> str:
        """Reason why the run can go no further, or ""; known before its last frames have been shown again."""
        return self.replay.reason if self.replay is not None and self.state.replays else self.halted

    def cancel(self, how: int = 1) -> None:
        """Cancel the running solve. how: ABANDON even if it should be completed. Any thread may call it."""
        self.request[STOP] = how

    def play(self) -> None:
        """Play; after the last moments of a divergence from the last good state."""
        if self.replay is not None and self.replay.ended:
            self.replay = None
        self.become(Event.PLAY if self.replay is None else Event.REPLAY)

    def pause(self) -> None:
        """Pause, and await no event."""
        self.awaited = None
        self.become(Event.PAUSE)

    def run_on(self, reached: Callable[[AnySnapshot], bool]) -> None:
        """Run up to an event."""
        self.play()
        self.awaited = AwaitedEvent(reached, self.snapshots.latest)

    def halt(self, reason: str) -> None:
        """Halt, pause all on the same clock, and keep the reason for the panel."""
        if self.seat is not None:
            self.seat.tell_others(Pause())
        self.reason, self.halted_with, self.unfinished = reason, self.scene.params, None
        self.become(Event.HALT)

    def go_on(self, wall: float) -> bool:
        """Take steps, or replay the last moments of a divergence, within a tick; True if there is news to show.

        wall: [s] since the last tick.
        """
        if self.state.is_making:
            return False  # a scene that has not begun takes no steps
        if self.state is RunState.REPLAYING and self.audience() and self.replay is not None:
            return self.play_replay(self.replay, wall)
        if self.goal is not None and self.state is RunState.RUNNING and not self.audience():
            self.hurry(self.goal.until)
            return True
        if self.seat is not None and self.audience():
            return self.follow(self.seat, wall)
        if self.state is RunState.RUNNING and self.audience():
            return self.keep_time(wall)
        self.counts["idle ticks"] += 1
        return False

    def keep_time(self, wall: float) -> bool:
        """Take the steps that are due; True if there were any."""
        frame = self.clock.frame_interval(self.scene.frame_interval)
        n = self.fixed_step.steps(wall, self.scene.params.speed * self.scene.pace, self.scene.step, frame)
        if self.goal is not None:
            n = min(n, steps_to(self.scene, self.goal.until))
        return self.take_steps(n)

    def take_steps(self, n: int) -> bool:
        """Take steps that are due, few at first if their cost is unknown; True if there were any."""
        if n:
            (self.advance_within_budget if self.fixed_step.cost_unknown and self.running else self.advance)(n)
        return n > 0

    def note_place(self) -> None:
        """Report the time of the run to the clock of several loops."""
        if self.seat is not None:
            seat, scene = self.seat, self.scene
            seat.note(scene.time, scene.step, scene.pace, running=self.running, halted=self.state.has_failed)

    def follow(self, seat: Seat, wall: float) -> bool:
        """Take the steps up to the time of the clock, as many as fit the frame; True if there were any.

        The loop of the first seat advances the clock.
        """
        if seat.is_first and self.running:
            seat.clock.advance(min(wall, MAX_CATCH_UP), self.scene.params.speed)
        due = 0 if self.state.has_failed else seat.due(self.scene.time, self.scene.step)
        n = self.fixed_step.most(due, self.clock.frame_interval(self.scene.frame_interval))
        self.fixed_step.capped = n < due or (seat.is_first and seat.clock.late)
        return self.take_steps(n)

    def aim_at(self, seconds: float, answer: Future[float]) -> None:
        """Run for this long, and then answer the waiting program with the time."""
        self.give_up("another program waits for the lab")
        self.goal = Goal(self.scene.time + seconds, answer, self.running)
        self.become(Event.ADVANCE)

    def settle(self) -> None:
        """Answer the waiting program if the run has reached the time or cannot continue."""
        goal, reason = self.goal, self.stopped_by
        if goal is None or not (reason or steps_to(self.scene, goal.until) == 0 or goal.answer.cancelled()):
            return
        if not reason and not goal.was_running:
            self.become(Event.PAUSE)
            self.snapshots.publish()  # the page says that it stands still
        self.goal = None
        goal.end(DivergenceError(reason) if reason else self.scene.time)

    def pause_at_event(self) -> None:
        """Pause if the awaited event has begun since the last frame."""
        if self.awaited is not None and self.running and self.awaited.begins(self.snapshots.latest):
            self.pause()
            self.snapshots.publish()

    def hurry(self, until: float) -> None:
        """Take steps up to a time [s] while the frame's budget lasts, as many at once as a frame of a viewer has.

        Some scenes record what they draw, so a snapshot is taken now and then.
        """
        most = max(1, int(FRAME_INTERVAL / self.scene.step * (1 + 1e-9)))
        start = self.clock.effort()
        while self.state is RunState.RUNNING and self.clock.effort() - start < SOLVE_SHARE * FRAME_INTERVAL:
            left = steps_to(self.scene, until)
            if left == 0:
                return
            self.advance(min(most, left))
            if self.scene.time - self.snapshots.published >= HURRY_INTERVAL:
                self.snapshots.publish()

    def advance_within_budget(self, n: int) -> None:
        """Take up to n steps in growing parts while the frame's budget lasts.

        Another method or more points may make a step a thousand times as expensive as the last one was.
        """
        part, spent = 1, 0.0
        while n > 0 and part > 0 and self.state is RunState.RUNNING and not self.request[STOP]:
            part = min(part, n)
            self.fixed_step.cost = 0.0
            spent += self.advance(part)
            n -= part
            part = self.fixed_step.next_part(part, spent)
        self.fixed_step.cost_unknown = False
        if n > 0 and self.running:
            self.fixed_step.capped, self.fixed_step.debt = True, 0.0
            self.fixed_step.dropped += n if self.seat is None else 0

    def advance(self, n: int) -> float:
        """Take n steps; returns the processor time they took [s]."""
        start = self.clock.effort()
        self.guarded(lambda: self.scene.advance(n), STEPS)
        seconds = self.clock.effort() - start
        self.fixed_step.learn(n, seconds)
        self.counts["steps"] += n
        return seconds

    def guarded(self, action: Callable[[], None], activity: Activity = NOTHING) -> None:
        """Run scene code; an error pauses the run and is kept for the panel.

        A cancelled beginning is repeated; after a cancelled change of forces the scene restarts.
        """
        self.activity, begins = activity, activity == BEGINNING
        try:
            action()
        except InterruptionError:
            self.counts["solves ended early"] += 1
            if begins or activity == OTHER_FORCES or self.request[STOP] == ABANDON:
                self.unfinished, self.replay = action if begins else self.scene.reset, None
                self.become(Event.CANCEL)
                if not begins:
                    self.identify()
        except DivergenceError as error:
            if error.moments and self.running and not begins:
                self.replay = Replay(error.moments, str(error))
                self.become(Event.REPLAY)
            else:
                self.halt(str(error))
        except Exception as error:
            self.halt(failure_words(error, begins=begins))
        else:
            if begins:
                self.become(Event.MADE)
        finally:
            self.activity = NOTHING

    def play_replay(self, replay: Replay, wall: float) -> bool:
        """Continue the replay of a divergence, and halt at its end; True if there is news to show."""
        self.fixed_step.capped = False
        changed = replay.play(wall)
        if replay.ended:
            self.halt(replay.reason)
        return changed or replay.ended

    def step_by_hand(self, count: int) -> None:
        """Pause and take single steps: with all on the same clock, or as many as a frame allows."""
        self.become(Event.PAUSE)
        if self.seat is None or self.replay is not None:
            self.take_single_steps(count)
        elif self.seat.is_first:
            self.seat.clock.step_by_hand(count)

    def take_single_steps(self, count: int) -> None:
        """Take up to `count` single steps, at least one, while the frame's budget lasts; the rest is dropped.

        The last moments of a run that diverged are shown first, one for each step.
        """
        spent, halted = 0.0, self.halted
        for done in range(count):
            if self.replay is not None and not self.replay.ended:
                self.replay.step()
                if self.replay.ended:
                    self.halt(self.replay.reason)
                    halted = self.halted
                continue
            self.replay = None
            spent += self.advance(1)
            if self.state.is_making or self.halted != halted or spent > SOLVE_SHARE * FRAME_INTERVAL:
                self.fixed_step.dropped += count - done - 1
                return

    def give_up(self, reason: str) -> None:
        """Tell a waiting program why the awaited time will not be reached."""
        goal, self.goal = self.goal, None
        if goal is not None:
            goal.end(RuntimeError(reason))

    def clear(self) -> None:
        """Discard the state of the run, before the scene continues from its start or from another moment."""
        self.give_up(BEGUN)
        self.replay = self.unfinished = None
        self.fixed_step.debt = 0.0

    def identify(self, act: int = 0, before: int = 0, since: float = 0.0) -> None:
        """Give the new run its number; see `RunIdentity`. act: 0 for that of the run before."""
        act = act or self.identity.act
        self.identity = RunIdentity(next(self.numbers), act, before, since, act)

    def reset(self, act: int = 0, action: Callable[[], None] | None = None, event: Event = Event.RESTART) -> None:
        """Restart the scene, or begin it by another action, for an act. event: how it begins."""
        self.become(event)
        self.clear()
        self.identify(act)
        if self.seat is not None:
            self.seat.begin()
        self.begin(action or self.scene.reset)

    def begin(self, reset: Callable[[], None]) -> None:
        """Begin the scene again; if that is cancelled, the next tick does it."""
        self.unfinished = None
        self.guarded(reset, BEGINNING)


def failure_words(error: Exception, *, begins: bool) -> str:
    """Reason why a scene stopped, for the panel. Prints the traceback, unless a user's values are the cause."""
    if begins and isinstance(error, ValueError):
        return f"The scene cannot begin with these values. {error}"
    traceback.print_exception(error)
    return f"The scene stopped with {type(error).__name__}: {error}"


class LeftRun(NamedTuple):
    """A run in the state in which it was left."""

    act: int  # that began it
    params: BaseParams
    state: Checkpoint
    rows: tuple[PlotRow, ...] | None  # of its plots; None: it was to resume from a moment, and has not begun
    running: bool

    @property
    def arrays(self) -> dict[int, int]:
        """Identity -> bytes of everything it holds."""
        rows = self.rows or ()
        return {**self.state.arrays, id(rows): ROW_BYTES * len(rows) * len(rows[0]) if rows else 0}


class LeftRuns:
    """The last runs left, within bounded memory; a larger one is not kept."""

    def __init__(self) -> None:
        self.runs: collections.deque[LeftRun] = collections.deque()
        self.memory = FrameMemory()

    def add(self, run: LeftRun) -> None:
        """Keep a run."""
        self.runs.append(run)
        self.memory.add(run.arrays)
        while self.memory.bytes > MAX_BYTES:
            self.memory.remove(self.runs.popleft().arrays)

    def pop(self, act: int) -> LeftRun | None:
        """Take out the last run of that act; None if it is not kept."""
        for place in reversed(range(len(self.runs))):
            if self.runs[place].act == act:
                run = self.runs[place]
                del self.runs[place]
                self.memory.remove(run.arrays)
                return run
        return None


class RunSequence:
    """The sequence of a scene's runs: the commands that begin a new one, and the undo that goes back."""

    def __init__(self, run: SceneRun) -> None:
        self.run, self.left = run, LeftRuns()

    def obey(self, command: RecordCommand) -> None:
        """Take a record of parameters: with another run, or according to the effect of the change."""
        run = self.run
        is_other = command.act not in (0, run.identity.act)
        if not isinstance(command, Change):
            run.awaited = None
        if is_other:
            self.leave()
        match command:
            case GoBack() if is_other:
                self.go_back(command)
            case GoBack(params):  # the run that an undo leaves has never begun
                self.take_back(params)
            case Resume(params, state, act):
                self.resume(params, state, act)
            case Begin(params, act):
                self.begin_with(params, act)
            case Change(params, effect, act):
                self.take(params, effect, act)

    def take_back(self, params: BaseParams) -> None:
        """Take the parameters to which an undo goes back, in the run to which it goes back."""
        self.take(params, effect_of_change(self.run.scene.params, params))

    def take(self, params: BaseParams, effect: Effect | None, act: int = 0) -> None:
        """Take parameters according to the effect of their change; those that affect the start begin another run."""
        run, scene = self.run, self.run.scene
        if effect in (None, "look"):
            scene.params = params
        elif effect == "start" or run.state is RunState.UNMADE:
            self.change_start(params, act)
        elif run.unfinished is not None:  # the scene has not begun: its beginning comes first
            beginning = run.unfinished
            run.unfinished = lambda: self.begin_and_change(beginning, params)
        else:
            self.end_replay()
            run.fixed_step.cost_unknown = True
            run.guarded(functools.partial(scene.change_forces, params), OTHER_FORCES)
            scene.params = params  # even if the scene failed, so that a reset uses them

    def begin_and_change(self, beginning: Callable[[], None], params: BaseParams) -> None:
        """Begin the scene, then change its forces."""
        beginning()
        self.run.scene.change_forces(params)
        self.run.scene.params = params

    def end_replay(self) -> None:
        """End showing the last moments of a run that diverged."""
        run = self.run
        if run.replay is not None:
            run.halt(run.replay.reason)
            run.replay = None

    def change_start(self, params: BaseParams, act: int = 0) -> None:
        """Restart the scene with these parameters; it plays if it played before or had halted."""
        run = self.run
        self.end_replay()
        run.scene.params, run.fixed_step.cost_unknown = params, True
        if run.seat is not None:
            run.seat.begin_others()
        run.reset(act)

    def begin_again(self, act: int) -> None:
        """Restart the scene for an act; 0: for none."""
        self.run.awaited = None
        if act not in (0, self.run.identity.act):
            self.leave()
        self.run.reset(act)

    def begin_with(self, params: BaseParams, act: int, left: LeftRun | None = None) -> None:
        """Restart the scene with these parameters, playing; or restore a run that was left, playing if it did."""
        run = self.run
        run.scene.params, run.fixed_step.cost_unknown = params, True
        if run.seat is not None:
            run.seat.begin_others()
            run.seat.tell_others(Play())
        if left is None:
            run.reset(act, event=Event.BEGIN)
        else:
            run.reset(act, lambda: self.return_to(left), Event.BEGIN if left.running else Event.BEGIN_PAUSED)

    def resume(self, params: BaseParams, state: Checkpoint, act: int) -> None:
        """Resume from a checkpoint, with its parameters, playing."""
        run = self.run
        run.become(Event.RESUME)
        run.clear()
        run.scene.params, run.fixed_step.cost_unknown = params, True
        run.guarded(lambda: run.scene.resume(state.value))
        run.identify(act, state.run, run.scene.time)
        if run.seat is not None:
            run.seat.go_on_from(run.scene.time)
            run.seat.tell_others(Play())

    def leave(self) -> None:
        """Keep the present run for an undo before another one begins, unless it cannot go on."""
        run = self.run
        if not (run.state.has_failed or run.state.is_making):
            rows = tuple(run.snapshots.kept_rows)
            self.left.add(LeftRun(run.identity.act, run.scene.params, kept_state(run), rows, run.running))

    def go_on_under(self, act: int) -> None:
        """Continue the run under another act, and keep it as it is for an undo of that."""
        run = self.run
        if act == run.identity.act:
            return
        self.leave()
        placed = run.identity.placed
        run.identify(act, run.identity.number, run.scene.time)
        run.identity = run.identity._replace(placed=placed)
        run.snapshots.keep_rates()

    def keep_dropped(self, command: RecordCommand) -> None:
        """Keep a run that was to resume from a moment for an undo, when newer parameters replace it."""
        if isinstance(command, Resume):
            self.left.add(LeftRun(command.act, command.params, command.state, None, True))

    def go_back(self, command: GoBack) -> None:
        """Go back to the run of an act as it was left; restart it if it is not kept."""
        params, act, runs = command
        run, left = self.run, self.left.pop(act)
        if left is None:
            (self.begin_with if runs else self.change_start)(params, act)
            run.snapshots.show_restarted()
            return
        if left.rows is None:
            self.resume(left.params, left.state, act)
        else:
            self.begin_with(left.params, act, left)
        if run.seat is not None and not run.running:
            run.seat.tell_others(Pause())
        self.take_back(params)  # they may have changed just before the run was left

    def return_to(self, left: LeftRun) -> None:
        """Restart the scene, then restore a run that was left, with its plots."""
        run = self.run
        run.scene.reset()
        run.scene.resume(left.state.value)
        run.snapshots.bring_back(left.rows or ())
        if run.seat is not None:
            run.seat.go_on_from(run.scene.time)
