"""The simulation thread's loop: drain commands, read knobs, take fixed steps, publish a snapshot.

One accumulator and one wall deadline. Time that cannot be made up is dropped and shown, never owed. `SimLoop.tick` is a
plain function of elapsed wall time, so that tests, headless runs and benchmarks call it without a thread.
"""

import collections
import contextlib
import queue
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

from app.ledger import Work
from app.messages import (
    Command,
    DivergenceError,
    Halt,
    Pause,
    Play,
    Reset,
    Snapshot,
    Status,
    StepOnce,
    TogglePlay,
    where_not_finite,
)

FRAME = 1 / 60  # [s] between ticks
BUDGET = 0.7  # part of a frame that solving may take; the rest is for streaming
GROWTH = 8  # from one part to the next of steps whose cost is not known
IDLE = 0.1  # [s] between looks while there is nothing to do
SHORT = 2 * FRAME  # [s] that a hand may have to wait
LONGEST = 0.25  # [s] of wall time that one tick makes up for
WINDOW = 1.0  # [s] over which rates are measured


class FixedStep:
    """Turns elapsed wall time into whole steps, dropping what does not fit the budget."""

    def __init__(self) -> None:
        self.debt = 0.0  # [s] of simulated time not yet stepped
        self.cost = 0.0  # [s] of processor time a step takes, lately
        self.dropped = 0  # steps that were due and never taken

    def steps(self, wall: float, speed: float, h: float, frame: float = FRAME) -> tuple[int, bool]:
        """(steps to take now, whether time was dropped) for `wall` seconds at `speed` with steps of h [s].

        frame: [s] between pictures; where that is longer, there is more time to solve in.
        """
        self.debt += min(wall, LONGEST) * speed
        due = int(self.debt / h * (1 + 1e-9))
        most = max(1, int(BUDGET * max(frame, FRAME) / self.cost)) if self.cost > 0 else due
        if due > most:
            self.debt = 0.0
            self.dropped += due - most
            return most, True
        self.debt = max(0.0, self.debt - due * h)
        return due, False

    def next_part(self, last: int, spent: float) -> int:
        """Steps to try next, after `spent` [s] of this frame and a last part of `last` steps; 0 when it is full."""
        left = BUDGET * FRAME - spent
        if left <= 0.0:
            return 0
        return min(GROWTH * last, int(left / self.cost)) if self.cost > 0 else GROWTH * last

    def learn(self, steps: int, seconds: float) -> None:
        """Take note that `steps` steps took `seconds` of processor time."""
        if steps:
            each = seconds / steps
            # Down at once, up slowly: the first step of a method loads its kernel.
            self.cost = each if not 0 < self.cost < each else 0.8 * self.cost + 0.2 * each


class SimLoop:
    """Owns a scene and its clock."""

    def __init__(
        self,
        scene: Any,
        commands: "queue.SimpleQueue[Command] | None" = None,
        read_params: Callable[[], Any] | None = None,
        audience: Callable[[], int] = lambda: 1,
        *,
        paused: bool = False,
        clock: Callable[[], float] = time.perf_counter,
        effort: Callable[[], float] = time.thread_time,
    ) -> None:
        """read_params: the knobs' current values, already clamped; audience: how many browsers look.

        clock: wall time [s]. effort: what solving is charged by, this thread's processor time [s], so that a busy
        machine that takes the processor away does not make the scene look expensive.
        """
        self.scene = scene
        self.commands: queue.SimpleQueue[Command] = commands or queue.SimpleQueue()
        self.read_params = read_params or (lambda: scene.params)
        self.audience = audience
        self.clock, self.effort = clock, effort
        self.first: Command | None = None  # what ended a sleep, for the next tick
        self.running = not paused
        self.halted = ""
        self.untried = True  # nothing is known of what a step costs with the knobs as they are
        self.pacer = FixedStep()
        self.capped = False
        self.counts: collections.Counter[str] = collections.Counter()
        self.history: collections.deque[tuple[float, float]] = collections.deque()  # (wall, simulated) [s]
        self.wall = 0.0
        self.fresh = threading.Event()  # set with each new snapshot, cleared by who shows it
        self.latest: Snapshot = self.snapshot(0.0)

    @property
    def frame(self) -> float:
        """Time [s] between pictures: a scene may ask for fewer."""
        return getattr(self.scene, "frame", FRAME)

    def tick(self, wall: float) -> None:
        """One frame, `wall` seconds after the last."""
        self.wall += wall
        # Knobs first: a preset sets them all and then asks for a reset.
        params = self.read_params()
        # Mostly the very same record: not to compare it knob by knob.
        changed = params is not self.scene.params and params != self.scene.params
        if changed:
            self.untried = True
            self.guarded(lambda: self.scene.set_params(params))
        changed |= self.drain()
        solve = 0.0
        if self.running and self.audience():
            n, self.capped = self.pacer.steps(wall, self.scene.params.speed, self.scene.step, self.frame)
            if n:
                solve = self.try_out(n) if self.untried else self.advance(n)
                changed = True
        else:
            self.counts["idle ticks"] += 1
        self.counts["ticks"] += 1
        if changed:
            self.publish(solve)

    def try_out(self, n: int) -> float:
        """Take up to n steps in growing parts while the frame's budget lasts; returns what they took [s].

        Another method or more points may make a step a thousand times as dear as the last one was.
        """
        part, spent = 1, 0.0
        while n > 0 and part > 0 and self.running:
            part = min(part, n)
            self.pacer.cost = 0.0
            spent += self.advance(part)
            n -= part
            part = self.pacer.next_part(part, spent)
        self.untried = False
        if n > 0 and self.running:
            self.capped, self.pacer.debt = True, 0.0
            self.pacer.dropped += n
        return spent

    def work(self) -> dict[str, Work]:
        """For the ledger: what ran against what had no need to, paused or unwatched, or no time to."""
        c = self.counts
        return {
            "ticks": Work(c["ticks"] - c["idle ticks"], c["idle ticks"]),
            "steps": Work(c["steps"], self.pacer.dropped),
            "snapshots": Work(c["snapshots"], max(c["ticks"] - c["snapshots"], 0)),
        }

    def advance(self, n: int) -> float:
        """Take n steps; returns the processor time they took [s]."""
        start = self.effort()
        self.guarded(lambda: self.scene.advance(n))
        seconds = self.effort() - start
        self.pacer.learn(n, seconds)
        self.counts["steps"] += n
        return seconds

    def guarded(self, action: Callable[[], None]) -> None:
        """Run scene code; whatever goes wrong pauses the run and is kept for the panel to say."""
        try:
            action()
        except DivergenceError as reason:
            self.halt(str(reason))
        except Exception as error:
            traceback.print_exc()
            self.halt(f"The scene stopped with {type(error).__name__}: {error}")

    def halt(self, reason: str) -> None:
        self.running = False
        self.halted = reason

    def drain(self) -> bool:
        """Obey every waiting command; True where there was one."""
        changed = self.first is not None
        if self.first is not None:
            self.obey(self.first)
            self.first = None
        while not self.commands.empty():  # nobody else takes from it
            self.obey(self.commands.get_nowait())
            changed = True
        return changed

    def obey(self, command: Command) -> None:
        match command:
            case Play():
                self.running, self.halted = True, ""
            case Pause():
                self.running = False
            case TogglePlay():
                self.obey(Pause() if self.running else Play())
            case StepOnce():
                self.running = False
                self.advance(1)
            case Halt(reason):
                self.halt(reason)
            case Reset():
                self.running, self.halted = self.running or bool(self.halted), ""
                self.pacer.debt = 0.0
                self.guarded(self.scene.reset)
            case _:
                self.guarded(lambda: self.scene.obey(command))

    def publish(self, solve: float) -> None:
        """Let whoever shows them have what there is now."""
        self.latest = self.snapshot(solve)
        self.fresh.set()

    def snapshot(self, solve: float) -> Snapshot:
        """What there is to show now; the last good picture where the scene has none."""
        self.counts["snapshots"] += 1
        shown: list[Any] = []
        self.guarded(lambda: shown.extend(self.look()))
        if not shown:
            shown = [self.latest.picture, self.latest.gauge, (), self.latest.work, None]
        picture, gauge, samples, work, curves = shown
        return Snapshot(self.counts["snapshots"], picture, self.status(solve), gauge, samples, work, curves)

    def look(self) -> tuple[Any, ...]:
        """The scene's picture, gauge, plot rows, ledger and curves; DivergenceError for a number that is none."""
        scene = self.scene
        picture = scene.picture()
        where = where_not_finite(picture)
        if where:
            raise DivergenceError(f"The picture's {where} holds what is no number. Reset, or take a smaller step.")
        gauge, work = scene.gauge(), getattr(scene, "work", dict)()
        return picture, gauge, scene.take_samples(), work, scene.curves() if hasattr(scene, "curves") else None

    def status(self, solve: float) -> Status:
        simulated = self.scene.time
        self.history.append((self.wall, simulated))
        while len(self.history) > 2 and self.history[0][0] < self.wall - WINDOW:
            self.history.popleft()
        elapsed = self.wall - self.history[0][0]
        return Status(
            running=self.running,
            time=simulated,
            steps=self.counts["steps"],
            speed=self.scene.params.speed,
            actual=max(0.0, (simulated - self.history[0][1]) / elapsed) if elapsed > 0 and self.running else 0.0,
            capped=self.capped and self.running,
            solve=solve,
            rate=(len(self.history) - 1) / elapsed if elapsed > 0 else 0.0,
            halted=self.halted,
        )

    def run(self, stop: threading.Event) -> None:
        """Tick until `stop` is set, at the frame rate while there is something to do."""
        last = self.clock()
        while not stop.is_set():
            busy = self.running and self.audience() > 0
            now = self.clock()
            self.tick(now - last)
            last = now
            rest = (self.frame if busy else IDLE) - (self.clock() - now)
            if rest > 0:
                self.wait(rest, stop, busy)

    def wait(self, seconds: float, stop: threading.Event, busy: bool) -> None:
        """Sleep; while idle, or where pictures are few, a command ends the sleep at once."""
        if busy and seconds <= SHORT:
            stop.wait(seconds)
            return
        with contextlib.suppress(queue.Empty):
            self.first = self.commands.get(timeout=seconds)
