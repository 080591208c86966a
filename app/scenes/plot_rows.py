"""The plot rows of a scene: one each interval of simulated time, handed over once."""

import collections
import math

from app.messages import PlotRow

ROW_INTERVAL = 1 / 30  # [s] of simulated time between two plot rows of springs
TOLERANCE = 1e-6  # of an interval: the round-off of a clock that adds up steps for hours
MAX_WAITING_ROWS = 5400  # beyond that the oldest are dropped: a headless run takes none


def row_number(t: float, interval: float) -> int:
    """Number of whole intervals [s] at time t [s]. A row is due where it has grown, so rows keep their rate."""
    return math.floor(t / interval + TOLERANCE)


class PlotRows:
    """Rows of values, one each `interval` [s] of simulated time."""

    def __init__(self, interval: float = ROW_INTERVAL) -> None:
        self.interval = interval
        self.waiting: collections.deque[PlotRow] = collections.deque(maxlen=MAX_WAITING_ROWS)
        self.restart()

    def restart(self) -> None:
        """Restart, with the row of the start."""
        self.waiting.clear()
        self.number = -1  # of the last row; the first is that of the start

    def resume(self) -> None:
        """Take the next row at once: the run continues from another moment."""
        self.number = -1

    def is_due(self, t: float) -> bool:
        """True if a row is due at time t [s]."""
        return row_number(t, self.interval) > self.number

    def add(self, t: float, *values: float) -> None:
        """Add the row of time t [s]."""
        self.waiting.append((t, *values))
        self.number = row_number(t, self.interval)

    def add_due(self, t: float, *values: float) -> None:
        """Add the row of time t [s] if one is due."""
        if self.is_due(t):
            self.add(t, *values)

    def take(self) -> tuple[PlotRow, ...]:
        """The rows since the last call."""
        rows = tuple(self.waiting)
        self.waiting.clear()
        return rows
