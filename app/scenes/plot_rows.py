"""The plot rows of a scene: taken at a fixed interval of simulated time, and handed over once."""

import math

from app.messages import PlotRow

ROW_INTERVAL = 1 / 30  # [s] of simulated time between two plot rows


class PlotRows:
    """Collects rows of `columns` values each."""

    def __init__(self, columns: int) -> None:
        self.columns = columns
        self.waiting: list[PlotRow] = []
        self.restart()

    def restart(self) -> None:
        """Clear the plots, by a row without numbers (see `app/messages.py`)."""
        self.waiting.append((math.nan,) * (self.columns + 1))
        self.last = -math.inf  # [s] time of the last row

    def is_due(self, t: float) -> bool:
        """Whether a row is due at time t [s]."""
        return t - self.last >= ROW_INTERVAL

    def add(self, t: float, *values: float) -> None:
        """Add the row of time t [s]."""
        self.waiting.append((t, *values))
        self.last = t

    def take(self) -> tuple[PlotRow, ...]:
        """The rows since the last call."""
        rows, self.waiting = tuple(self.waiting), []
        return rows
