"""Time of one loop: the duration of ticks, the waiting time of controls, and the steps that fit a frame."""

import contextlib
from collections.abc import Callable, Generator
from typing import TypeAlias

from app.scenes.contract import FRAME_INTERVAL
from app.scenes.timer import TIMER_STEP

Clock: TypeAlias = Callable[[], float]  # [s]

PATIENCE = 0.03  # [s] of a solve between two times at which controls are handled
LATE_FRAMES = 16.0  # least ratio of the frame interval to the lateness of sleeps
MAX_FRAME_INTERVAL = 0.1  # [s] on a busy machine
LATENESS_WEIGHT = 0.1  # of the last sleep in the mean
SOLVE_SHARE = 0.7  # part of a frame that solving may take; the rest is for streaming
PART_GROWTH = 8  # ratio of two successive parts of a frame's steps while the cost of a step is not known
MAX_LONG_FRAME = 2 * FRAME_INTERVAL  # [s] after a sleep that ended late
MAX_CATCH_UP = 0.5  # [s] of wall time that one tick makes up for: on a busy machine sleeps end tenths of a second late


class TickClock:
    """Clock of a simulation thread, which alone changes it; the viewer thread reads it."""

    def __init__(self, now: Clock, effort: Clock, sleep: Callable[[float], None], *, gives_way: bool) -> None:
        """The arguments are those of `SimLoop`. now: its `clock`."""
        self.now, self.effort, self.sleep, self.gives_way = now, effort, sleep, gives_way
        self.wall = 0.0  # [s] of all ticks
        self.busy_since: float | None = None  # [s] of `now`, while a tick runs
        self.tick_time = 0.0  # [s] duration of the last tick
        self.lateness = 0.0  # [s] recent lateness of sleeps, due to other programs
        self.turn_at = 0.0  # [s] of `now`, when controls were last answered
        self.in_turn = False  # controls are being handled during a solve
        self.is_late = False  # commands were handled in this tick, or in the last one

    def begin_tick(self, wall: float) -> bool:
        """Begin a tick, `wall` seconds after the last; True if controls were handled during that."""
        self.wall += wall
        was_late, self.is_late = self.is_late, False
        self.begin_work()
        self.turn_at -= PATIENCE * was_late  # the command that ended the last tick has waited long enough
        return was_late

    def end_tick(self) -> None:
        """End the tick."""
        self.tick_time = self.busy_time
        self.end_work()

    def begin_work(self) -> None:
        """Note the start of work that may take long; controls have been handled."""
        self.busy_since = self.turn_at = self.now()

    def end_work(self) -> None:
        """Note the end of the work."""
        self.busy_since = None

    @property
    def busy_time(self) -> float:
        """Time [s] that the present work has taken; 0 in a sleep."""
        since = self.busy_since
        return 0.0 if since is None else self.now() - since

    @property
    def takes_long(self) -> bool:
        """True if controls may soon have to be handled during a tick."""
        return self.busy_since is not None or self.tick_time > 0.5 * PATIENCE

    def turn_is_due(self) -> bool:
        """True if input has been pending for longer than PATIENCE."""
        return self.busy_since is not None and not self.in_turn and self.now() - self.turn_at >= PATIENCE

    @contextlib.contextmanager
    def turn(self) -> Generator[None]:
        """Context in which controls are handled during a solve."""
        self.in_turn, self.turn_at = True, self.now()
        # A turn that was due at the start of a short tick is no reason for one in the next.
        self.is_late |= self.busy_since is not None and self.turn_at - self.busy_since >= PATIENCE
        try:
            yield
        finally:
            self.in_turn = False

    def end_sleep(self, now: float, wanted: float) -> None:
        """Record a sleep that should have ended at `wanted` [s] and ends `now` [s]."""
        self.lateness += LATENESS_WEIGHT * (max(0.0, now - wanted - TIMER_STEP) - self.lateness)

    def frame_interval(self, scene: float) -> float:
        """Time [s] between frames: longer on a busy hub, whose processor all labs need for their controls.

        scene: interval requested by the scene [s].
        """
        late = LATE_FRAMES * self.lateness if self.gives_way else 0.0
        return max(scene, min(late, MAX_FRAME_INTERVAL))


class FixedStep:
    """Turns elapsed wall time into whole steps, and drops the time that does not fit the budget."""

    def __init__(self) -> None:
        self.debt = 0.0  # [s] of simulated time not yet stepped
        self.cost = 0.0  # [s] recent processor time of a step
        self.cost_unknown = True  # of a step with the present parameters
        self.dropped = 0  # steps due but never taken
        self.capped = False  # some time could not be made up recently

    def steps(self, wall: float, speed: float, h: float, frame: float = FRAME_INTERVAL) -> int:
        """Steps to take now, for `wall` seconds at `speed` with steps of h [s]; sets `capped` if time is dropped.

        frame: [s] between pictures; a longer one, or a late sleep, leaves more time for solving.
        """
        self.debt += min(wall, MAX_CATCH_UP) * speed
        due = int(self.debt / h * (1 + 1e-9))
        most = self.most(due, max(frame, min(wall, MAX_LONG_FRAME)))
        self.capped = due > most
        if self.capped:
            self.debt = 0.0
            self.dropped += due - most
            return most
        self.debt = max(0.0, self.debt - due * h)
        return due

    def most(self, due: int, frame: float) -> int:
        """Number of due steps that fit the budget of a frame of `frame` [s]."""
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
