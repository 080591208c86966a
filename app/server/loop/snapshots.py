"""The snapshots of a scene that the viewer shows, with their plot rows, states and rates."""

import collections
import threading
import traceback
from collections.abc import Callable, Sequence
from typing import Protocol

from app.messages import (
    BaseParams,
    Checkpoint,
    PlotRow,
    RunIdentity,
    RunLine,
    RunRow,
    RunState,
    Snapshot,
    Status,
    where_not_finite,
)
from app.scenes.checkpoints import arrays_in
from app.scenes.contract import AnyScene, AnySnapshot
from app.server.loop.clock import FixedStep, TickClock
from app.server.loop.commands import NOTHING, STEPS, Activity
from app.server.loop.replay import Replay
from sim.interruption import InterruptionError
from sim.parameters import effect_of_change
from sim.validation import DivergenceError

MAX_TIME_WITHOUT_FRAME = 1.0  # [s] without a complete picture, after which one is finished although controls wait
KEEP_INTERVAL = 0.1  # [s] least wall time between two checkpoints
KEEP_SHARE = 0.003  # fraction of a core for checkpoints
RATE_WINDOW = 1.0  # [s] over which rates are measured
MIN_RATE_TIME = 0.25  # [s] of a run before its speed is known
RESTARTED_SHOWN = 8.0  # [s] of wall time for which the panel reports a run that was not kept
MAX_PLOT_ROWS = 20_000  # waiting for the viewer, and kept for a program; beyond that the oldest are dropped


class ShownRun(Protocol):
    """The parts of a `SceneRun` that its snapshots show."""

    scene: AnyScene
    identity: RunIdentity
    audience: Callable[[], int]
    clock: TickClock
    fixed_step: FixedStep
    counts: collections.Counter[str]
    activity: Activity
    state: RunState
    halted_with: BaseParams
    replay: Replay | None

    @property
    def running(self) -> bool:
        """True if it goes on by itself."""
        ...

    @property
    def halted(self) -> str:
        """Reason why it has stopped, or ""."""
        ...

    def halt(self, reason: str) -> None:
        """Pause, and keep the reason for the panel."""
        ...


class Snapshots:
    """Makes and publishes the snapshots of a run, on its thread."""

    def __init__(self, run: ShownRun) -> None:
        self.run = run
        self.history: collections.deque[tuple[float, float]] = collections.deque()  # (wall, simulated) [s]
        self.rated = 0  # number of the run of this history
        self.restarted_until = 0.0  # [s] of the ticks until which the panel reports an undo that had to restart a run
        self.restarted = 0  # number of the restarted run
        self.keep_at = 0.0  # [s] of the ticks of the next checkpoint
        self.plot_rows: collections.deque[RunRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # for the viewer to take
        self.kept_rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # of this run
        self.line = RunLine()  # of `kept_rows`
        self.published = 0.0  # [s] of simulated time, of the last snapshot
        self.is_current = True  # the latest snapshot shows the present scene
        self.whole_at = run.clock.now()  # [s] when that was last true
        self.fresh = threading.Event()  # set with each new snapshot, cleared when it is shown
        self.latest: AnySnapshot = self.collect(self.next_serial())

    def next_serial(self) -> int:
        """Number of a new snapshot, from 1."""
        self.run.counts["snapshots"] += 1
        return self.run.counts["snapshots"]

    def publish(self) -> None:
        """Publish the present state for the viewer."""
        self.latest = self.snapshot()
        self.published = self.run.scene.time
        self.fresh.set()

    def publish_in_solve(self, params: BaseParams, *, with_frame: bool) -> None:
        """Publish these parameters with the last whole step; without `with_frame`, with the last frame."""
        self.next_serial()
        last = self.without_frame()._replace(params=params)
        try:
            self.latest = self.collect(last.serial)._replace(params=params) if with_frame else last
        except DivergenceError:  # the solve itself is about to raise this
            self.latest = last
        self.fresh.set()

    def snapshot(self) -> AnySnapshot:
        """Frame to show now; the last good one if the scene has none or controls cancel it."""
        run, serial = self.run, self.next_serial()
        params = run.scene.params
        run.activity = Activity("frame", may_end=run.clock.now() - self.whole_at < MAX_TIME_WITHOUT_FRAME)
        try:
            if run.state.is_making or run.state is RunState.UNMADE:
                self.is_current = True  # a scene that could not be made has nothing else
                return self.without_frame()
            latest = self.collect(serial)
            self.is_current, self.whole_at = run.scene.params is params, run.clock.now()
            return latest._replace(serial=run.counts["snapshots"])  # controls may have received others
        except InterruptionError:
            run.counts["pictures ended early"] += 1
            self.is_current = False
            return self.without_frame()
        except Exception as error:
            if not isinstance(error, DivergenceError):
                traceback.print_exc()
                error = DivergenceError(f"The scene stopped with {type(error).__name__}: {error}")
            run.halt(str(error))
            return self.without_frame()
        finally:
            run.activity = NOTHING

    def without_frame(self) -> AnySnapshot:
        """The last snapshot with parameters and clock as they are now."""
        run = self.run
        serial = run.counts["snapshots"]
        return self.latest._replace(serial=serial, status=self.status(), params=run.scene.params, state=None)

    def collect(self, serial: int) -> AnySnapshot:
        """The scene's frame, readings, parameters and curves; hands its plot rows over.

        During the replay of a divergence the frame is one of its last moments.
        Raises DivergenceError if a number of the frame is not finite.
        """
        scene, replay = self.run.scene, self.run.replay
        frame = scene.frame() if replay is None else replay.moment.frame
        where = where_not_finite(frame)
        if where:
            raise DivergenceError(f"The frame contains NaN or infinity ({where}). Reset, or use a smaller time step.")
        readings, curves = scene.readings(), scene.curves()
        self.hand_over(scene.take_plot_rows())
        return Snapshot(serial, frame, self.status(), readings, scene.params, curves, self.keep_state())

    def hand_over(self, rows: Sequence[PlotRow]) -> None:
        """Queue new plot rows for the viewer, and keep those of the present run."""
        identity, run_rows = self.run.identity, self.kept_rows
        end = self.line.follow(identity)
        while run_rows and run_rows[-1][0] > end:
            run_rows.pop()
        for row in rows:
            if not run_rows or row[0] > run_rows[-1][0]:  # a run that resumes from a moment repeats its row
                run_rows.append(row)
                self.plot_rows.append((identity, row))

    def pop_rows(self) -> list[RunRow]:
        """Take out the rows since the last call; the viewer thread calls it."""
        return [self.plot_rows.popleft() for _ in range(len(self.plot_rows))]

    def bring_back(self, rows: Sequence[PlotRow]) -> None:
        """Plot the rows of a restored run, in place of those of its start, and rate it from now on."""
        self.run.scene.take_plot_rows()
        self.hand_over(rows)
        self.forget_rates()

    def keep_state(self) -> Checkpoint | None:
        """Checkpoint of a running scene, a few times a second; rarely if copying takes long."""
        run, clock = self.run, self.run.clock
        if run.state is not RunState.RUNNING or run.activity == STEPS:
            return None
        if clock.wall < self.keep_at or not run.audience():
            return None
        start = clock.effort()
        state = kept_state(run)
        self.keep_at = clock.wall + max(KEEP_INTERVAL, (clock.effort() - start) / KEEP_SHARE)
        return state

    def status(self) -> Status:
        """The clock and the rates."""
        run, history, wall = self.run, self.history, self.run.clock.wall
        moment = None if run.replay is None else run.replay.moment
        simulated = run.scene.time if moment is None else moment.time
        if self.rated != run.identity.number:  # a rate never crosses two runs
            self.forget_rates()
        history.append((wall, simulated))
        while len(history) > 2 and history[0][0] < wall - RATE_WINDOW:
            history.popleft()
        elapsed = wall - history[0][0]
        is_rated = elapsed >= MIN_RATE_TIME and run.running
        capped = run.fixed_step.capped and run.running
        return Status(
            state=run.state,
            time=simulated,
            steps=run.counts["steps"],
            speed=run.scene.params.speed,
            actual_speed=max(0.0, (simulated - history[0][1]) / elapsed) if is_rated else None,
            capped=capped,
            frame_rate=(len(history) - 1) / elapsed if elapsed > 0 else 0.0,
            halted=run.halted,
            faster=run.scene.faster if capped else "",
            run=run.identity,
            pace=run.scene.pace,
            restarted=wall < self.restarted_until and run.identity.number == self.restarted,
            outdated=run.state.has_stopped and is_other_run(run.halted_with, run.scene.params),
            replayed=None if moment is None else (moment.low, moment.high),
        )

    def forget_rates(self) -> None:
        """Measure speed and frame rate from now on."""
        self.history.clear()
        self.rated = self.run.identity.number

    def keep_rates(self) -> None:
        """Measure on: the present run continues the last one."""
        self.rated = self.run.identity.number

    def show_restarted(self) -> None:
        """Have the panel report for a while that an undo had to restart a run."""
        self.restarted_until, self.restarted = self.run.clock.wall + RESTARTED_SHOWN, self.run.identity.number


def is_other_run(before: BaseParams, now: BaseParams) -> bool:
    """True if two records differ in more than the look of a run."""
    return effect_of_change(before, now) not in (None, "look")


def kept_state(run: ShownRun) -> Checkpoint:
    """Checkpoint of a run, to resume from."""
    value = run.scene.keep()
    return Checkpoint(value, arrays_in(value), run.identity.number)
