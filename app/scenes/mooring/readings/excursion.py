"""Excursion of the body or vessel: the level way from its rest position, how far it came, and its path."""

import numpy as np
from numpy.typing import NDArray

MAX_PATH = 1200  # places of the path that are kept
PATH_INTERVAL = 0.25  # [s]


class Excursion:
    """The level offset from a rest position over time."""

    def __init__(self, rest: NDArray[np.float64]) -> None:
        """rest: (3,) [m]."""
        self.rest = rest
        self.offset = self.largest = self.farthest = 0.0  # [m] now, of the statistics, and since the start
        self.path, self.path_count = np.empty((0, 2), np.float32), 0

    def restart(self) -> None:
        """Begin the statistics again."""
        self.largest = 0.0

    def measure(self, t: float, place: NDArray[np.float64], *, counts: bool) -> None:
        """Take the place (3,) [m] at time t [s]. counts: the statistics take it, too."""
        self.offset = float(np.linalg.norm((place - self.rest)[:2]))
        self.farthest = max(self.farthest, self.offset)
        if counts:
            self.largest = max(self.largest, self.offset)
        if t >= PATH_INTERVAL * self.path_count:
            self.path = np.concatenate((self.path[1 - MAX_PATH :], place[None, :2].astype(np.float32)))
            self.path_count += 1
