"""The worst of the last gauges of a moving net: the share of its largest stable step rises and falls as it swings."""

import collections
from typing import Generic, Protocol, TypeVar

from sim.springs.stability import Gauge

SPAN = 5.0  # [s] of simulated time


class Gauged(Protocol):
    """Readings with a gauge."""

    @property
    def stability(self) -> Gauge:
        """Stability of the time step."""
        ...


R = TypeVar("R", bound=Gauged)


class RecentGauges(Generic[R]):
    """Readings of the last `SPAN` of one net, method and step."""

    def __init__(self) -> None:
        self.readings: collections.deque[tuple[float, R]] = collections.deque()  # (t [s], readings)

    def clear(self) -> None:
        """The net, its method or its step has changed."""
        self.readings.clear()

    def worst(self, t: float, readings: R) -> R:
        """The readings with the largest fraction of the stable step among these, of time t [s], and those before."""
        self.readings.append((t, readings))
        while self.readings[0][0] < t - SPAN:
            self.readings.popleft()
        return max(self.readings, key=lambda entry: entry[1].stability.share)[1]
