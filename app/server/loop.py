"""The simulation thread's loop: handle commands, read parameters, take fixed steps, publish a snapshot.

One accumulator and one wall deadline. Time that cannot be made up is dropped and shown, never owed. `SimLoop.tick` is a
plain function of elapsed wall time, so that tests, headless runs and benchmarks call it without a thread.
"""

import collections
import contextlib
import queue
import threading
import time
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from typing import NamedTuple

import numpy as np

from app.messages import (
    Advance,
    Ask,
    BaseParams,
    Command,
    DivergenceError,
    Grab,
    Halt,
    KeptState,
    Load,
    Pause,
    Place,
    Play,
    PlotRow,
    Release,
    Reset,
    Snapshot,
    Status,
    StepOnce,
    TogglePlay,
    where_not_finite,
)
from app.scenes.contract import FRAME_INTERVAL, AnyScene, AnySnapshot
from app.scenes.moments import arrays_in
from app.scenes.stepping import steps_to
from app.server.merging import begins_anew, is_urgent, merged
from app.server.replay import Replay
from app.server.shared_clock import Seat
from sim.interruption import ABANDON, STOP, TURN, InterruptionError, is_kept_whole, use_request
from sim.parameters import effect_of_change

SOLVE_SHARE = 0.7  # part of a frame that solving may take; the rest is for streaming
PART_GROWTH = 8  # ratio of two successive parts of a frame's steps while the cost of a step is not known
MAX_BLIND_TIME = 1.0  # [s] without a whole picture, after which one is finished though controls wait
PATIENCE = 0.03  # [s] of a solve, after which controls are answered in the middle of it, and again after as much
IDLE_INTERVAL = 0.1  # [s] between two ticks while there is nothing to do
ALONE_INTERVAL = 0.25  # [s] between two ticks while nobody looks: a browser that comes, or a command, ends it
MAX_DEAF_TIME = 2 * FRAME_INTERVAL  # [s] for which a sleep may ignore commands
MAX_CATCH_UP = 0.25  # [s] of wall time that one tick makes up for
KEEP_INTERVAL = 0.1  # [s] of wall time between two states that are kept, at least
KEEP_SHARE = 0.003  # of a core that keeping states may take
HURRY_INTERVAL = 0.1  # [s] of simulated time between two snapshots while nobody looks and a program waits
RATE_WINDOW = 1.0  # [s] over which rates are measured
MAX_PLOT_ROWS = 20_000  # waiting for the viewer, and kept for a program; beyond that the oldest are dropped


class Goal(NamedTuple):
    """Goal of an `Advance`."""

    until: float  # [s] of simulated time
    answer: Future[float]
    was_running: bool


class FixedStep:
    """Turns elapsed wall time into whole steps, and drops the time that does not fit the budget."""

    def __init__(self) -> None:
        self.debt = 0.0  # [s] of simulated time not yet stepped
        self.cost = 0.0  # [s] of processor time that a step takes, lately
        self.dropped = 0  # steps that were due and never taken

    def steps(self, wall: float, speed: float, h: float, frame: float = FRAME_INTERVAL) -> tuple[int, bool]:
        """(steps to take now, whether time was dropped) for `wall` seconds at `speed` with steps of h [s].

        frame: [s] between pictures; where that is longer, there is more time to solve in.
        """
        self.debt += min(wall, MAX_CATCH_UP) * speed
        due = int(self.debt / h * (1 + 1e-9))
        most = self.most(due, frame)
        if due > most:
            self.debt = 0.0
            self.dropped += due - most
            return most, True
        self.debt = max(0.0, self.debt - due * h)
        return due, False

    def most(self, due: int, frame: float) -> int:
        """How many of the steps that are due fit the budget of a frame of `frame` [s]."""
        if self.cost <= 0:
            return due
        return min(due, max(1, int(SOLVE_SHARE * max(frame, FRAME_INTERVAL) / self.cost)))

    def next_part(self, last: int, spent: float) -> int:
        """Steps to try next, after `spent` [s] of this frame and a last part of `last` steps; 0 when it is full."""
        left = SOLVE_SHARE * FRAME_INTERVAL - spent
        if left <= 0.0:
            return 0
        return min(PART_GROWTH * last, int(left / self.cost)) if self.cost > 0 else PART_GROWTH * last

    def learn(self, steps: int, seconds: float) -> None:
        """Record that `steps` steps took `seconds` of processor time."""
        if steps:
            each = seconds / steps
            # Down at once, up slowly: the first step of a method loads its kernel.
            self.cost = each if not 0 < self.cost < each else 0.8 * self.cost + 0.2 * each


class SimLoop:
    """Owns a scene and its clock."""

    def __init__(
        self,
        scene: AnyScene,
        commands: "queue.SimpleQueue[Command] | None" = None,
        read_params: Callable[[], tuple[BaseParams, int]] | None = None,
        audience: Callable[[], int] = lambda: 1,
        *,
        admit: Callable[[Iterable[Command]], list[Command]] = list,
        paused: bool = False,
        clock: Callable[[], float] = time.perf_counter,
        effort: Callable[[], float] = time.thread_time,
    ) -> None:
        """read_params: the parameters as set now, and the number of the last `Load`; audience: how many browsers look.

        admit: of the commands that have come, those to handle now; called before `read_params`, on the same thread.
        clock: wall time [s]. effort: what solving is charged by, this thread's processor time [s], so that a busy
        machine that takes the processor away does not make the scene look expensive.
        """
        self.scene = scene
        self.commands: queue.SimpleQueue[Command] = commands or queue.SimpleQueue()
        self.admit = admit
        self.request = np.zeros(4, np.int64)  # what the solve that runs looks at: see sim/interruption.py
        self.solving = False  # the scene takes steps: its frame is that of a whole step, also in the middle of one
        self.may_end = False  # what runs may be ended early: steps, or a picture
        self.may_begin = False  # what runs may be ended early where the scene begins anew after it
        self.is_late = False  # controls were answered in the middle of the last tick, as it took long
        self.turn_at = 0.0  # [s] of the clock, when controls were last answered
        self.is_shown = True  # the latest snapshot is of the scene as it is
        self.whole_at = 0.0  # [s] of the clock, when one was
        self.unfinished: Callable[[], None] | None = None  # a reset that was ended early
        self.read_params = read_params or (lambda: (scene.params, self.loaded))
        self.audience = audience
        self.clock, self.effort = clock, effort
        self.waiting: list[Command] = []  # what ended a sleep, and what a solve did not answer, for the next tick
        self.running = not paused
        self.halted = ""
        self.seat: Seat | None = None  # at a clock that other loops have too
        self.replay: Replay | None = None  # of a run that has just diverged
        self.cost_unknown = True  # the cost of a step with the parameters as they are is not known
        self.loaded = 0  # number of the last `Load` that was handled
        self.pacer = FixedStep()
        self.capped = False
        self.counts: collections.Counter[str] = collections.Counter()
        self.history: collections.deque[tuple[float, float]] = collections.deque()  # (wall, simulated) [s]
        self.wall = 0.0
        self.keep_at = 0.0  # [s] of `wall` from which a state is kept again
        self.busy_since: float | None = None  # [s] of the clock, while a tick runs
        self.plot_rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # for the viewer to take
        self.kept_rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # of this run
        self.published = 0.0  # [s] of simulated time, of the last snapshot
        self.goal: Goal | None = None  # that a program waits for
        self.fresh = threading.Event()  # set with each new snapshot, cleared by who shows it
        self.latest: AnySnapshot = self.snapshot()

    @property
    def frame_interval(self) -> float:
        """Time [s] between pictures: a scene may ask for fewer."""
        return self.scene.frame_interval

    def tick(self, wall: float) -> None:
        """One frame, `wall` seconds after the last."""
        self.wall += wall
        was_late, self.is_late = self.is_late, False
        self.busy_since = self.clock()
        self.turn_at = self.busy_since - PATIENCE * was_late  # what ended the last tick has waited long enough
        params, loads = self.poll()
        # Parameters first: a reset starts from them. A record of a `Load` that is still on the way comes with it.
        changed = loads == self.loaded and params is not self.scene.params and self.take(params)
        changed |= self.handle_waiting() or not self.is_shown
        if changed and was_late:
            self.publish()  # before steps that may take long
            changed = False
        if self.unfinished is not None:
            pass  # no steps of a scene that is not made
        elif self.running and self.audience() and self.replay is not None:
            changed |= self.play_replay(self.replay, wall)
        elif self.goal is not None and self.running and not self.audience():
            self.hurry(self.goal.until)
            changed = True
        elif self.seat is not None and self.audience():
            changed |= self.follow(self.seat, wall)
        elif self.running and self.audience():
            n, self.capped = self.pacer.steps(wall, self.scene.params.speed, self.scene.step, self.frame_interval)
            if self.goal is not None:
                n = min(n, steps_to(self.scene, self.goal.until))
            if n:
                (self.advance_within_budget if self.cost_unknown else self.advance)(n)
                changed = True
        else:
            self.counts["idle ticks"] += 1
        self.counts["ticks"] += 1
        if self.seat is not None:
            self.seat.note(self.scene.time, self.scene.step, running=self.running, halted=bool(self.stopped_by))
        if changed:
            self.publish()
        if self.goal is not None:
            self.settle(self.goal)
        self.busy_since = None

    def poll(self) -> tuple[BaseParams, int]:
        """Take in the commands that have come, then read the parameters: these are as new as any preset among them."""
        self.take_in()
        return self.read_params()

    def take_in(self, *taken: Command) -> None:
        """Have the commands wait that have come and can be handled. taken: out of the queue before."""
        came = [*taken, *(self.commands.get_nowait() for _ in range(self.commands.qsize()))]  # nobody else takes
        seat = self.seat
        self.waiting += [command if seat is None else seat.share(command) for command in self.admit(came)]
        if seat is not None:
            self.waiting += [seat.told.get_nowait() for _ in range(seat.told.qsize())]

    def join(self, seat: Seat | None) -> None:
        """Follow a clock that other loops follow too, all from their start on; None: no longer.

        Called on the simulation thread, by an `Ask`.
        """
        self.seat = seat
        if seat is not None:
            self.handle(seat.share(Reset()))
            seat.note(self.scene.time, self.scene.step, running=self.running, halted=bool(self.stopped_by))

    def follow(self, seat: Seat, wall: float) -> bool:
        """Take the steps that lead to the time of the clock, as many as fit the frame; True where there were any.

        The loop of the first seat lets the clock's time pass.
        """
        if seat.is_first and self.running:
            seat.clock.advance(min(wall, MAX_CATCH_UP), self.scene.params.speed)
        due = 0 if self.stopped_by else seat.due(self.scene.time, self.scene.step)
        n = self.pacer.most(due, self.frame_interval)
        self.capped = n < due or (seat.is_first and seat.clock.late)
        if n:
            (self.advance_within_budget if self.cost_unknown and self.running else self.advance)(n)
        return n > 0

    def take(self, params: BaseParams) -> bool:
        """Take parameters according to the effect of their change; False if they are those of the scene."""
        effect = effect_of_change(self.scene.params, params)
        if effect is None:
            return False
        if effect == "look":
            self.scene.params = params
            return True
        self.cost_unknown = True
        if self.replay is not None:
            self.halt(self.replay.reason)
            self.replay = None
        if effect == "forces" and self.unfinished is None:
            self.guarded(lambda: self.scene.change_forces(params), else_anew=True)
            self.scene.params = params  # also where the scene failed: not to be tried again in every tick
        else:
            self.scene.params = params
            if self.seat is not None:
                self.seat.begin_others()
            self.reset()
        return True

    def settle(self, goal: Goal) -> None:
        """Answer the program that waits, where the run has come to the time or can come no further."""
        reason = self.stopped_by
        arrived = steps_to(self.scene, goal.until) == 0
        if not (arrived or reason or goal.answer.cancelled()):
            return
        if not reason:
            self.running = goal.was_running
        self.goal = None
        if not goal.answer.set_running_or_notify_cancel():
            return
        if reason:
            goal.answer.set_exception(DivergenceError(reason))
        else:
            goal.answer.set_result(self.scene.time)

    @property
    def stopped_by(self) -> str:
        """Why the run can go no further, or ""; known before its last moments have been shown again."""
        return self.halted if self.replay is None else self.replay.reason

    def tell(self, read: Callable[[], object], answer: Future[object]) -> None:
        """Answer a program that asks."""
        if not answer.set_running_or_notify_cancel():
            return
        try:
            answer.set_result(read())
        except Exception as error:
            answer.set_exception(error)

    def hurry(self, until: float) -> None:
        """Take steps up to a time [s] while the frame's budget lasts, as many at once as a frame of a viewer has.

        Some scenes record what they draw, so there is a snapshot now and then.
        """
        most = max(1, int(FRAME_INTERVAL / self.scene.step * (1 + 1e-9)))
        start = self.effort()
        while self.running and self.replay is None and self.effort() - start < SOLVE_SHARE * FRAME_INTERVAL:
            left = steps_to(self.scene, until)
            if left == 0:
                return
            self.advance(min(most, left))
            if self.scene.time - self.published >= HURRY_INTERVAL:
                self.publish()

    def advance_within_budget(self, n: int) -> None:
        """Take up to n steps in growing parts while the frame's budget lasts.

        Another method or more points may make a step a thousand times as expensive as the last one was.
        """
        part, spent = 1, 0.0
        while n > 0 and part > 0 and self.running and self.replay is None and not self.request[STOP]:
            part = min(part, n)
            self.pacer.cost = 0.0
            spent += self.advance(part)
            n -= part
            part = self.pacer.next_part(part, spent)
        self.cost_unknown = False
        if n > 0 and self.running:
            self.capped, self.pacer.debt = True, 0.0
            self.pacer.dropped += n if self.seat is None else 0

    def advance(self, n: int) -> float:
        """Take n steps; returns the processor time they took [s]."""
        start = self.effort()
        self.solving = True
        try:
            self.guarded(lambda: self.scene.advance(n))
        finally:
            self.solving = False
        seconds = self.effort() - start
        self.pacer.learn(n, seconds)
        self.counts["steps"] += n
        return seconds

    def turn_is_due(self) -> bool:
        """True if input has been pending for longer than PATIENCE."""
        return self.busy_since is not None and self.clock() - self.turn_at >= PATIENCE

    def ask_for_turn(self) -> None:
        """Have controls answered in the middle of a solve that takes long; called from another thread."""
        if self.turn_is_due():
            self.request[TURN] = 1

    def give_turn(self) -> None:
        """Answer controls in the middle of a solve, which calls this on its own thread.

        What asks for another solve ends this one; the next tick handles it, from the last good state. What does not is
        answered at once, and the solve goes on: a look, or a drag, which counts from the next steps on. A reset, a
        change of forces, and what is kept whole are ended only where the scene begins anew; else parameters are
        answered with the last frame, and the next tick takes them.
        """
        self.turn_at = self.clock()
        # A turn that was due at the start of a short tick is no reason for one in the next.
        self.is_late |= self.busy_since is not None and self.turn_at - self.busy_since >= PATIENCE
        try:
            params, loads = self.poll()
            if loads != self.loaded:  # they come with a `Load` that waits
                params = self.scene.params
            effect, whole = effect_of_change(self.scene.params, params), is_kept_whole()
            anew = any(map(begins_anew, self.waiting)) or effect == "start"
            asked = anew or any(map(is_urgent, self.waiting)) or effect == "forces"
            if anew and (self.solving or self.may_begin):
                self.request[STOP] = ABANDON if whole else 1
                return
            if asked and self.may_end and not whole:
                self.request[STOP] = 1
                return
            if effect == "look":
                self.scene.params = params
            within_steps = self.solving and not whole
            drags = self.drags_waiting() if within_steps else []
            for command in drags:
                self.scene.handle(command)
            is_begun = self.latest.status.starts == self.counts["starts"]
            if drags or self.latest.params != params or not is_begun:
                self.capped = self.solving
                self.publish_in_solve(params, with_frame=within_steps)
        except Exception:  # the solve knows nothing of it
            traceback.print_exc()

    def drags_waiting(self) -> list[Grab | Place | Release]:
        """The drags among the waiting commands; the others go on waiting for the next tick."""
        drags = [command for command in merged(self.waiting) if isinstance(command, Grab | Place | Release)]
        self.waiting = [command for command in self.waiting if not isinstance(command, Grab | Place | Release)]
        return drags

    def publish_in_solve(self, params: BaseParams, *, with_frame: bool) -> None:
        """Hand the viewer these parameters with the last whole step; without `with_frame`, with the last frame."""
        self.counts["snapshots"] += 1
        last = self.without_frame(self.latest)._replace(params=params)
        try:
            self.latest = self.collect(last.serial)._replace(params=params) if with_frame else last
        except DivergenceError:  # the solve is about to find that out
            self.latest = last
        self.fresh.set()

    def guarded(self, action: Callable[[], None], *, again: bool = False, else_anew: bool = False) -> None:
        """Run scene code; whatever goes wrong pauses the run and is kept for the panel to say.

        again: to be done once more where it is ended early. else_anew: where it is ended early the scene begins anew.
        """
        self.may_end, self.may_begin = self.solving, again or else_anew
        try:
            action()
        except InterruptionError:
            self.counts["solves ended early"] += 1
            if again or else_anew or self.request[STOP] == ABANDON:
                self.unfinished = action if again else self.scene.reset
        except DivergenceError as error:
            if error.moments and self.running:
                self.replay = Replay(error.moments, str(error))
            else:
                self.halt(str(error))
        except Exception as error:
            traceback.print_exc()
            self.halt(f"The scene stopped with {type(error).__name__}: {error}")
        finally:
            self.may_end = self.may_begin = False

    def play_replay(self, replay: Replay, wall: float) -> bool:
        """Go on showing the last moments of a run that diverged, and halt at their end; True where that shows."""
        self.capped = False
        changed = replay.play(wall)
        if replay.ended:
            self.halt(replay.reason)
        return changed or replay.ended

    def halt(self, reason: str) -> None:
        """Pause, with all on the same clock, and keep the reason for the panel."""
        if self.seat is not None:
            self.seat.tell_others(Pause())
        self.running = False
        self.halted = reason

    def handle_waiting(self) -> bool:
        """Handle the waiting commands once they are merged, after a reset that was cancelled, unless
        another one waits; True where there was one."""
        waiting, self.waiting = self.waiting, []
        left = merged(waiting)
        unfinished = None if any(begins_anew(command) for command in left) else self.unfinished
        if unfinished is not None:
            self.begin(unfinished)
        for command in left:
            self.handle(command)
        return bool(waiting) or unfinished is not None

    def handle(self, command: Command) -> None:
        """Carry out one command."""
        match command:
            case Play():
                self.running, self.halted = True, ""
                if self.replay is not None and self.replay.ended:
                    self.replay = None  # on from the last good state
            case Pause():
                self.running = False
            case TogglePlay():
                self.handle(Pause() if self.running else Play())
            case StepOnce(steps):
                self.running = False
                if self.seat is None or self.replay is not None:
                    self.step_by_hand(steps)
                elif self.seat.is_first:
                    self.seat.clock.step_by_hand(steps)
            case Halt(reason):
                self.halt(reason)
            case Load(params, number, state):
                self.loaded = number
                self.scene.params = params
                self.cost_unknown = True
                if state is None:
                    self.counts["starts"] += 1
                    self.reset()
                else:
                    self.resume(state)
                self.running = not self.halted
            case Reset():
                self.counts["starts"] += 1
                self.reset()
            case Ask(read, answer):
                self.tell(read, answer)
            case Advance(seconds, answer):
                self.give_up("another program waits for the lab")
                self.goal = Goal(self.scene.time + seconds, answer, self.running)
                self.running = not self.stopped_by
            case _:
                self.guarded(lambda: self.scene.handle(command))

    def step_by_hand(self, count: int) -> None:
        """Take up to `count` single steps, at least one, while the frame's budget lasts; the rest is dropped."""
        if self.replay is not None and not self.replay.ended:
            self.replay.step()
            if self.replay.ended:
                self.halt(self.replay.reason)
            return
        self.replay = None
        spent = 0.0
        for done in range(count):
            spent += self.advance(1)
            if self.halted or spent > SOLVE_SHARE * FRAME_INTERVAL:
                self.pacer.dropped += count - done - 1
                return

    def give_up(self, reason: str) -> None:
        """Tell the program that waits, if any, why the time that it waits for does not come."""
        goal, self.goal = self.goal, None
        if goal is not None and goal.answer.set_running_or_notify_cancel():
            goal.answer.set_exception(RuntimeError(reason))

    def reset(self) -> None:
        """The scene from its start; a run that had halted goes on."""
        self.give_up("the lab was begun again")
        self.running, self.halted = self.running or bool(self.halted), ""
        self.pacer.debt = 0.0
        self.replay = None
        if self.seat is not None:
            self.seat.begin()
        self.begin(self.scene.reset)

    def begin(self, reset: Callable[[], None]) -> None:
        """Begin the scene again; if that is cancelled, the next tick does it."""
        self.unfinished = None
        self.guarded(reset, again=True)

    def resume(self, state: KeptState) -> None:
        """The scene from a state that was kept."""
        self.halted, self.replay, self.unfinished, self.pacer.debt = "", None, None, 0.0
        self.history.clear()
        self.guarded(lambda: self.scene.resume(state.value))
        if self.seat is not None:
            self.seat.go_on_from(self.scene.time)

    def keep_state(self) -> KeptState | None:
        """The state of a running scene, a few times a second; seldom where copying it takes long."""
        if not self.running or self.solving or self.replay is not None:
            return None
        if self.wall < self.keep_at or not self.audience():
            return None
        start = self.effort()
        value = self.scene.keep()
        state = KeptState(value, arrays_in(value))
        self.keep_at = self.wall + max(KEEP_INTERVAL, (self.effort() - start) / KEEP_SHARE)
        return state

    def publish(self) -> None:
        """Publish the present state for the viewer."""
        self.latest = self.snapshot()
        self.published = self.scene.time
        self.fresh.set()

    def snapshot(self) -> AnySnapshot:
        """Frame to show now; the last good one if the scene has none or controls cancel it."""
        self.counts["snapshots"] += 1
        serial, params = self.counts["snapshots"], self.scene.params
        last: AnySnapshot | None = getattr(self, "latest", None)
        self.may_begin = last is not None
        self.may_end = self.may_begin and self.clock() - self.whole_at < MAX_BLIND_TIME
        try:
            if last is not None and self.unfinished is not None:
                return self.without_frame(last)  # of a scene that is not made
            found = self.collect(serial)
            self.is_shown, self.whole_at = self.scene.params is params, self.clock()
            return found._replace(serial=self.counts["snapshots"])  # controls may have been answered with others
        except InterruptionError:
            assert last is not None
            self.counts["pictures ended early"] += 1
            self.is_shown = False
            return self.without_frame(last)
        except Exception as error:
            if last is None:
                raise  # nothing to show instead: the scene cannot be opened
            if not isinstance(error, DivergenceError):
                traceback.print_exc()
                error = DivergenceError(f"The scene stopped with {type(error).__name__}: {error}")
            self.halt(str(error))
            return self.without_frame(last)
        finally:
            self.may_end = self.may_begin = False

    def without_frame(self, last: AnySnapshot) -> AnySnapshot:
        """The last snapshot with parameters and clock as they are now."""
        serial = self.counts["snapshots"]
        return last._replace(serial=serial, status=self.status(), params=self.scene.params, state=None)

    def collect(self, serial: int) -> AnySnapshot:
        """The scene's frame, readings, parameters and curves; hands its plot rows over.

        While the last moments before a divergence are shown again, the frame is of one of them.
        Raises DivergenceError where the frame holds a number that is not finite.
        """
        scene = self.scene
        frame = scene.frame() if self.replay is None else self.replay.moment.frame
        where = where_not_finite(frame)
        if where:
            raise DivergenceError(f"What is to be drawn is not finite ({where}). Reset, or take a smaller step.")
        readings, curves = scene.readings(), scene.curves()
        rows = scene.take_plot_rows()
        self.plot_rows.extend(rows)
        for row in rows:
            if row[0] != row[0]:  # a NaN time: the run starts over
                self.kept_rows.clear()
                continue
            while self.kept_rows and self.kept_rows[-1][0] >= row[0]:  # it has gone on from an earlier moment
                self.kept_rows.pop()
            self.kept_rows.append(row)
        return Snapshot(serial, frame, self.status(), readings, scene.params, curves, self.keep_state())

    def status(self) -> Status:
        """The clock and the rates."""
        moment = None if self.replay is None else self.replay.moment
        simulated = self.scene.time if moment is None else moment.time
        self.history.append((self.wall, simulated))
        while len(self.history) > 2 and self.history[0][0] < self.wall - RATE_WINDOW:
            self.history.popleft()
        elapsed = self.wall - self.history[0][0]
        capped = self.capped and self.running
        return Status(
            running=self.running,
            time=simulated,
            steps=self.counts["steps"],
            speed=self.scene.params.speed,
            actual_speed=max(0.0, (simulated - self.history[0][1]) / elapsed) if elapsed > 0 and self.running else 0.0,
            capped=capped,
            frame_rate=(len(self.history) - 1) / elapsed if elapsed > 0 else 0.0,
            halted=self.halted,
            faster=self.scene.faster if capped else "",
            starts=self.counts["starts"],
            replayed=None if moment is None else (moment.low, moment.high),
        )

    def run(self, stop: threading.Event) -> None:
        """Tick until `stop` is set, at the frame rate while there is something to do."""
        use_request(self.request, self.give_turn, self.turn_is_due)
        last = self.clock()
        while True:
            self.request[STOP] = self.request[TURN] = 0
            if stop.is_set():
                return
            busy = self.running and (self.audience() > 0 or self.goal is not None)
            now = self.clock()
            try:
                self.tick(now - last)
            except Exception as error:  # outside what `guarded` covers: the thread lives to say so
                traceback.print_exc()
                self.halt(f"The scene stopped with {type(error).__name__}: {error}")
                with contextlib.suppress(Exception):  # said once, and where even the clock fails not at all
                    self.publish()
                self.busy_since = None
            last = now
            idle = IDLE_INTERVAL if self.audience() else ALONE_INTERVAL
            rest = (self.frame_interval if busy else idle) - (self.clock() - now)
            if rest > 0:
                self.wait(rest, stop)

    def wait(self, seconds: float, stop: threading.Event) -> None:
        """Sleep for `seconds`; a command or other parameters end a sleep that is longer than a hand should have to
        wait."""
        start, left = self.clock(), seconds
        while left > MAX_DEAF_TIME and not self.waiting and not stop.is_set():
            with contextlib.suppress(queue.Empty):
                self.take_in(self.commands.get(timeout=MAX_DEAF_TIME if self.audience() else left))
                stop.wait(max(0.0, FRAME_INTERVAL - (self.clock() - start)))  # not more ticks than frames
                return
            if self.poll()[0] != self.scene.params or self.waiting:
                return
            left = seconds - (self.clock() - start)
        if left > 0.0:
            stop.wait(min(left, MAX_DEAF_TIME))
