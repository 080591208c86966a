"""A scene on the simulation thread, and the snapshot of it that the viewer shows."""

import collections
import threading
import traceback
from collections.abc import Callable

import numpy as np

from app.messages import KeptState, Pause, PlotRow, Snapshot, Status, where_not_finite
from app.scenes.contract import AnyScene, AnySnapshot
from app.scenes.moments import arrays_in
from app.server.activity import NOTHING, STEPS, Activity
from app.server.pacer import FixedStep
from app.server.replay import Replay
from app.server.shared_clock import Seat
from app.server.tick_clock import TickClock
from sim.interruption import InterruptionError
from sim.validation import DivergenceError

MAX_BLIND_TIME = 1.0  # [s] without a whole picture, after which one is finished though controls wait
KEEP_INTERVAL = 0.1  # [s] of wall time between two states that are kept, at least
KEEP_SHARE = 0.003  # of a core that keeping states may take
RATE_WINDOW = 1.0  # [s] over which rates are measured
MAX_PLOT_ROWS = 20_000  # waiting for the viewer, and kept for a program; beyond that the oldest are dropped


class Snapshots:
    """Owns a scene, its clock and the latest snapshot of it."""

    def __init__(self, scene: AnyScene, audience: Callable[[], int], clock: TickClock, *, paused: bool) -> None:
        """The arguments are those of `SimLoop`."""
        self.scene, self.audience, self.clock = scene, audience, clock
        self.request = np.zeros(4, np.int64)  # what the solve that runs looks at: see sim/interruption.py
        self.activity = NOTHING
        self.pacer = FixedStep()
        self.unfinished: Callable[[], None] | None = None  # a reset that was ended early
        self.unmade = False  # the scene could not begin: it waits for other values
        self.running = not paused
        self.halted = ""
        self.seat: Seat | None = None  # at a clock that other loops have too
        self.replay: Replay | None = None  # of a run that has just diverged
        self.counts: collections.Counter[str] = collections.Counter()
        self.history: collections.deque[tuple[float, float]] = collections.deque()  # (wall, simulated) [s]
        self.restarted_until = 0.0  # [s] of the ticks, while the panel says that an undo could only begin a run again
        self.keep_at = 0.0  # [s] of the ticks from which a state is kept again
        self.plot_rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # for the viewer to take
        self.kept_rows: collections.deque[PlotRow] = collections.deque(maxlen=MAX_PLOT_ROWS)  # of this run
        self.published = 0.0  # [s] of simulated time, of the last snapshot
        self.is_shown = True  # the latest snapshot is of the scene as it is
        self.whole_at = 0.0  # [s] of the clock, when that was so last
        self.fresh = threading.Event()  # set with each new snapshot, cleared by who shows it
        self.latest: AnySnapshot = self.snapshot()

    @property
    def stopped_by(self) -> str:
        """Why the run can go no further, or ""; known before its last moments have been shown again."""
        return self.halted if self.replay is None else self.replay.reason

    def halt(self, reason: str) -> None:
        """Pause, with all on the same clock, and keep the reason for the panel."""
        if self.seat is not None:
            self.seat.tell_others(Pause())
        self.running = False
        self.halted = reason

    def keep_state(self) -> KeptState | None:
        """The state of a running scene, a few times a second; seldom where copying it takes long."""
        if not self.running or self.activity == STEPS or self.replay is not None:
            return None
        if self.clock.wall < self.keep_at or not self.audience():
            return None
        start = self.clock.effort()
        value = self.scene.keep()
        state = KeptState(value, arrays_in(value))
        self.keep_at = self.clock.wall + max(KEEP_INTERVAL, (self.clock.effort() - start) / KEEP_SHARE)
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
        if last is not None:
            self.activity = Activity("frame", may_end=self.clock.now() - self.whole_at < MAX_BLIND_TIME)
        try:
            if last is not None and (self.unfinished is not None or self.unmade):
                self.is_shown = True  # all that there is of a scene that is not made
                return self.without_frame(last)
            found = self.collect(serial)
            self.is_shown, self.whole_at = self.scene.params is params, self.clock.now()
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
            self.activity = NOTHING

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
        self.history.append((self.clock.wall, simulated))
        while len(self.history) > 2 and self.history[0][0] < self.clock.wall - RATE_WINDOW:
            self.history.popleft()
        elapsed = self.clock.wall - self.history[0][0]
        capped = self.pacer.capped and self.running
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
            unmade=self.unmade,
            restarted=self.clock.wall < self.restarted_until,
            replayed=None if moment is None else (moment.low, moment.high),
        )
