"""Wall time turned into whole steps, within the part of a frame that solving may take."""

from app.scenes.contract import FRAME_INTERVAL

SOLVE_SHARE = 0.7  # part of a frame that solving may take; the rest is for streaming
PART_GROWTH = 8  # ratio of two successive parts of a frame's steps while the cost of a step is not known
MAX_LONG_FRAME = 2 * FRAME_INTERVAL  # [s] after a sleep that ended late
MAX_CATCH_UP = 0.5  # [s] of wall time that one tick makes up for: on a busy machine sleeps end late by tenths


class FixedStep:
    """Turns elapsed wall time into whole steps, and drops the time that does not fit the budget."""

    def __init__(self) -> None:
        self.debt = 0.0  # [s] of simulated time not yet stepped
        self.cost = 0.0  # [s] of processor time that a step takes, lately
        self.cost_unknown = True  # of a step with the present parameters
        self.dropped = 0  # steps that were due and never taken
        self.capped = False  # time could not be made up lately

    def steps(self, wall: float, speed: float, h: float, frame: float = FRAME_INTERVAL) -> int:
        """Steps to take now, for `wall` seconds at `speed` with steps of h [s]; capped where time is dropped.

        frame: [s] between pictures; where that is longer, or the last sleep ended late, there is more time to solve in.
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
