"""The simulation thread's loop: handle commands, take fixed steps, publish a snapshot.

One accumulator and one wall deadline. Time that cannot be made up is dropped and shown, never owed. `SimLoop.tick` is a
plain function of elapsed wall time, so that tests, headless runs and benchmarks call it without a thread.
"""

import contextlib
import queue
import threading
import time
import traceback
from collections.abc import Callable, Iterable
from concurrent.futures import Future

from app.lab.process.shared import ON_HUB
from app.messages import (
    Advance,
    Ask,
    Begin,
    Change,
    Command,
    GoBack,
    GoOn,
    GrabTo,
    Halt,
    Pause,
    Place,
    Play,
    Release,
    Reset,
    Resume,
    RunOn,
    RunState,
    SceneCommand,
    StepOnce,
    StudentAnswer,
    TogglePlay,
)
from app.scenes.contract import FRAME_INTERVAL, AnyScene, AnySnapshot
from app.scenes.timer import effort_clock, fine_timer
from app.server.loop.clock import Clock, TickClock
from app.server.loop.commands import (
    NOTHING,
    OTHER_FORCES,
    STEPS,
    Motion,
    Record,
    effect_of_all,
    is_urgent,
    merged,
)
from app.server.loop.run import RunSequence, SceneRun
from app.server.loop.shared_clock import Seat
from sim.interruption import ABANDON, STOP, TURN, is_kept_whole, use_request

IDLE_INTERVAL = 0.1  # [s] between two ticks while there is nothing to do
ALONE_INTERVAL = 0.25  # [s] between two ticks while nobody watches; a new browser or a command ends the wait
MIN_SLEEP = 1e-3  # [s] between two ticks after a late sleep: a tick at once would have no steps to take
MAX_COMMAND_DELAY = 2 * FRAME_INTERVAL  # [s] for which a sleep may ignore commands


class SimLoop:
    """Runs a scene on a thread, by commands from other threads."""

    def __init__(
        self,
        scene: AnyScene,
        commands: "queue.SimpleQueue[Command] | None" = None,
        audience: Callable[[], int] = lambda: 1,
        *,
        admit: Callable[[Iterable[Command]], list[Command]] = list,
        paused: bool = False,
        act: int = 1,
        clock: Clock = time.perf_counter,
        effort: Clock = effort_clock,
        sleep: Callable[[float], None] = time.sleep,
        gives_way: bool = ON_HUB,
    ) -> None:
        """audience: number of watching browsers.

        admit: selects the commands to handle now, from new ones and those held back before. act: number of the person's
        act that begins the first run.
        clock: wall time [s]. effort: clock of the cost of solving, this thread's processor time [s], so that a busy
        machine that takes the processor away does not make the scene look expensive.
        sleep: for a time [s]. gives_way: draw fewer frames if sleeps end late, as on a hub.
        """
        self.scene, self.admit = scene, admit
        self.commands: queue.SimpleQueue[Command] = commands or queue.SimpleQueue()
        self.waiting: list[
            Command
        ] = []  # for the next tick: the one that ended a sleep, and those not handled during a solve
        self.clock = TickClock(clock, effort, sleep, gives_way=gives_way)
        self.run = SceneRun(scene, audience, self.clock, paused=paused, act=act)
        self.runs = RunSequence(self.run)

    @property
    def latest(self) -> AnySnapshot:
        """The latest snapshot, for other threads too."""
        return self.run.snapshots.latest

    @property
    def record(self) -> Record:
        """The parameters of the present run, and its act."""
        return Record(self.scene.params, self.run.identity.act)

    def tick(self, wall: float) -> None:
        """One frame, `wall` seconds after the last."""
        run, snapshots = self.run, self.run.snapshots
        was_late = self.clock.begin_tick(wall)
        self.take_in()
        changed = self.handle_waiting() or not snapshots.is_current
        if changed and was_late:
            snapshots.publish()  # before steps that may take long
            changed = False
        changed |= run.go_on(wall)
        run.counts["ticks"] += 1
        run.note_place()
        if changed:
            snapshots.publish()
            run.pause_at_event()
        run.settle()
        self.clock.end_tick()

    def take_in(self, *taken: Command) -> None:
        """Add the new commands that can be handled to the waiting ones. taken: popped from the queue before."""
        came = [*taken, *(self.commands.get_nowait() for _ in range(self.commands.qsize()))]  # no other thread pops
        seat = self.run.seat
        self.waiting += [command if seat is None else seat.share(command) for command in self.admit(came)]
        if seat is not None:
            self.waiting += [seat.told.get_nowait() for _ in range(seat.told.qsize())]

    def join(self, seat: Seat | None) -> None:
        """Follow a clock shared with other loops, all from their start; None: stop following.

        Called on the simulation thread, by an `Ask`.
        """
        self.run.seat = seat
        if seat is not None:
            self.handle(seat.share(Reset()))
            self.run.note_place()

    def tell(self, read: Callable[[], object], answer: Future[object]) -> None:
        """Answer a program's question."""
        if not answer.set_running_or_notify_cancel():
            return
        try:
            answer.set_result(read())
        except Exception as error:
            answer.set_exception(error)

    def ask_for_turn(self) -> None:
        """Have controls handled during a long solve; called from another thread."""
        if self.clock.turn_is_due():
            self.run.request[TURN] = 1

    def give_turn(self) -> None:
        """Handle controls during a solve, which calls this on its own thread.

        A command that needs another solve cancels this one; the next tick handles it, from the last good state. Other
        commands, such as a look or a drag, are handled at once, and the solve continues; a drag acts from the next step
        on. Resets, changes of forces and solves to be completed are cancelled only if the scene restarts; otherwise
        parameters are answered with the last frame and taken by the next tick. Turns do not nest, as showing a frame
        may need a solve.
        """
        if self.clock.in_turn:
            return
        try:
            with self.clock.turn():
                self.handle_in_solve()
        except Exception:  # the solve must not see it
            traceback.print_exc()

    def handle_in_solve(self) -> None:
        """Cancel the solve for the new commands, or answer them with a snapshot."""
        self.take_in()
        run, activity, whole = self.run, self.run.activity, is_kept_whole()
        params, effect = effect_of_all(self.record, self.waiting)
        urgent = any(map(is_urgent, self.waiting)) or effect in ("forces", "start")
        if effect == "start" and activity != NOTHING:
            run.cancel(ABANDON if whole else 1)
            return
        if urgent and activity.may_end and not whole:
            run.cancel()
            return
        if effect == "look" and not urgent and activity != OTHER_FORCES:
            self.scene.params = params
            self.waiting = [command for command in self.waiting if not isinstance(command, Change)]
        within_steps = activity == STEPS and not whole
        drags = self.drags_waiting() if within_steps else []
        for command in drags:
            self.scene.handle(command)
        is_begun = self.latest.status.run == run.identity
        if drags or self.latest.params != params or not is_begun:
            run.fixed_step.capped = activity == STEPS
            run.snapshots.publish_in_solve(params, with_frame=within_steps)

    def drags_waiting(self) -> list[GrabTo | Place | Release]:
        """Take the drags out of the waiting commands; the others wait for the next tick."""
        drags = [command for command in self.waiting if isinstance(command, GrabTo | Place | Release)]
        self.waiting = [command for command in self.waiting if not isinstance(command, GrabTo | Place | Release)]
        return drags

    def handle_waiting(self) -> bool:
        """Merge and handle the waiting commands; True if anything was handled.

        A cancelled beginning is repeated first, unless the first command that concerns the scene begins it again.
        Those that follow a cancelled one wait for the next tick, where what has cancelled it may supersede them.
        """
        run, waiting, self.waiting = self.run, self.waiting, []
        left, unfinished = merged(waiting), run.unfinished
        if unfinished is not None:
            first = [command for command in left if not isinstance(command, Motion)][:1]
            if effect_of_all(self.record, first)[1] == "start":
                run.unfinished = None
            else:
                run.begin(unfinished)
        while left and run.unfinished is None:
            self.handle(left.pop(0))
        self.waiting[:0] = left
        return bool(waiting) or unfinished is not None

    def handle(self, command: Command) -> None:
        """Carry out one command. A scene that could not begin only takes other values."""
        run = self.run
        match command:
            case _ if run.state is RunState.UNMADE and isinstance(command, SceneCommand | StepOnce | RunOn):
                pass
            case Play():
                run.play()
            case Pause():
                run.pause()
            case TogglePlay():
                run.pause() if run.running else run.play()
            case RunOn(reached):
                run.run_on(reached)
            case StepOnce(steps):
                run.step_by_hand(steps)
            case Halt(reason):
                run.halt(reason)
            case Change() | Begin() | Resume() | GoBack():
                self.runs.obey(command)
            case Reset(act):
                self.runs.begin_again(act)
            case GoOn(act):
                self.runs.go_on_under(act)
            case Ask(read, answer):
                self.tell(read, answer)
            case Advance(seconds, answer):
                run.aim_at(seconds, answer)
            case _:
                run.guarded(lambda: self.scene.handle(command))

    def tick_until(self, stop: threading.Event) -> None:
        """Tick until `stop` is set, at the frame rate while there is something to do."""
        run, clock = self.run, self.clock
        use_request(run.request, self.give_turn, clock.turn_is_due)
        with fine_timer():
            last = due = wanted = clock.now()  # wanted: the time at which a sleep should have ended
            while True:
                run.request[STOP] = run.request[TURN] = 0
                if stop.is_set():
                    return
                busy = run.running and (run.audience() > 0 or run.goal is not None)
                now = clock.now()
                clock.end_sleep(now, wanted)
                self.tick_or_halt(now - last)
                last = now
                idle = IDLE_INTERVAL if run.audience() else ALONE_INTERVAL
                interval = clock.frame_interval(self.scene.frame_interval) if busy else idle
                # A late sleep shortens the next one, unless it missed a whole frame.
                due = interval + (due if now - due < interval else now)
                wanted = max(due, clock.now())
                rest = max(due - clock.now(), MIN_SLEEP if clock.tick_time < interval else 0.0)
                if rest > 0:
                    self.wait(rest, stop)

    def tick_or_halt(self, wall: float) -> None:
        """Tick; an error that `guarded` does not catch halts the run, and the thread stays alive to report it."""
        try:
            self.tick(wall)
        except Exception as error:
            traceback.print_exc()
            self.run.halt(f"The scene stopped with {type(error).__name__}: {error}")
            with contextlib.suppress(Exception):  # reported once; not at all if even the clock fails
                self.run.snapshots.publish()
            self.clock.end_work()

    def take_answer(self, command: StudentAnswer) -> None:
        """Let the scene take an answer of the student's functions during a sleep; the next tick shows it."""
        self.clock.begin_work()
        self.handle(command)
        self.clock.end_work()
        self.run.snapshots.is_current = False

    def wait(self, seconds: float, stop: threading.Event) -> None:
        """Sleep for `seconds`; a command ends a sleep that is too long for a user to wait."""
        start, left = self.clock.now(), seconds
        while left > MAX_COMMAND_DELAY and not self.waiting and not stop.is_set():
            with contextlib.suppress(queue.Empty):
                command = self.commands.get(timeout=MAX_COMMAND_DELAY if self.run.audience() else left)
                if not isinstance(command, StudentAnswer):
                    self.take_in(command)
                    stop.wait(max(0.0, FRAME_INTERVAL - (self.clock.now() - start)))  # not more ticks than frames
                    return
                self.take_answer(command)
            self.take_in()  # held-back parameters may be ready
            if self.waiting:
                return
            left = seconds - (self.clock.now() - start)
        if left > 0.0:
            self.clock.sleep(min(left, MAX_COMMAND_DELAY))
