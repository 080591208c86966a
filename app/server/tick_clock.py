"""Time of one loop: how long its ticks take, how late its sleeps end, and when controls have waited for too long."""

import contextlib
from collections.abc import Callable, Generator
from typing import TypeAlias

from app.scenes.timer import TIMER_STEP

Clock: TypeAlias = Callable[[], float]  # [s]

PATIENCE = 0.03  # [s] of a solve, after which controls are answered in the middle of it, and again after as much
LATE_FRAMES = 16.0  # ratio of the frame interval to the time by which sleeps end too late, at least
MAX_FRAME_INTERVAL = 0.1  # [s] that a busy machine may lead to
LATENESS_WEIGHT = 0.1  # of the last sleep in the mean


class TickClock:
    """Clock of a simulation thread, which alone changes it; the viewer thread reads it."""

    def __init__(self, now: Clock, effort: Clock, sleep: Callable[[float], None], *, gives_way: bool) -> None:
        """The arguments are those of `SimLoop`. now: its `clock`."""
        self.now, self.effort, self.sleep, self.gives_way = now, effort, sleep, gives_way
        self.wall = 0.0  # [s] of all ticks
        self.busy_since: float | None = None  # [s] of `now`, while a tick runs
        self.tick_time = 0.0  # [s] that the last tick took
        self.lateness = 0.0  # [s] by which sleeps lately ended too late, as others had the processor
        self.turn_at = 0.0  # [s] of `now`, when controls were last answered
        self.in_turn = False  # controls are being answered in the middle of a solve
        self.is_late = False  # they were in this tick, or in the last one

    def begin_tick(self, wall: float) -> bool:
        """A tick begins, `wall` seconds after the last; True where controls were answered in the middle of that."""
        self.wall += wall
        was_late, self.is_late = self.is_late, False
        self.begin_work()
        self.turn_at -= PATIENCE * was_late  # what ended the last tick has waited long enough
        return was_late

    def end_tick(self) -> None:
        """The tick has ended."""
        self.tick_time = self.busy_time
        self.end_work()

    def begin_work(self) -> None:
        """Work begins that may take long; controls have been answered."""
        self.busy_since = self.turn_at = self.now()

    def end_work(self) -> None:
        """It has ended."""
        self.busy_since = None

    @property
    def busy_time(self) -> float:
        """Time [s] that the present work has taken; 0 in a sleep."""
        since = self.busy_since
        return 0.0 if since is None else self.now() - since

    @property
    def takes_long(self) -> bool:
        """True if controls may have to be answered in the middle of a tick soon."""
        return self.busy_since is not None or self.tick_time > 0.5 * PATIENCE

    def turn_is_due(self) -> bool:
        """True if input has been pending for longer than PATIENCE."""
        return self.busy_since is not None and not self.in_turn and self.now() - self.turn_at >= PATIENCE

    @contextlib.contextmanager
    def turn(self) -> Generator[None]:
        """Inside, controls are answered in the middle of a solve."""
        self.in_turn, self.turn_at = True, self.now()
        # A turn that was due at the start of a short tick is no reason for one in the next.
        self.is_late |= self.busy_since is not None and self.turn_at - self.busy_since >= PATIENCE
        try:
            yield
        finally:
            self.in_turn = False

    def end_sleep(self, now: float, wanted: float) -> None:
        """Record that a sleep that was to end at `wanted` [s] ends `now` [s]."""
        self.lateness += LATENESS_WEIGHT * (max(0.0, now - wanted - TIMER_STEP) - self.lateness)

    def frame_interval(self, scene: float) -> float:
        """Time [s] between frames: longer on a busy hub, whose processor all labs need for their controls.

        scene: what the scene asks for [s].
        """
        late = LATE_FRAMES * self.lateness if self.gives_way else 0.0
        return max(scene, min(late, MAX_FRAME_INTERVAL))
