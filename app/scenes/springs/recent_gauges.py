"""The worst of the last gauges of a moving net: the share of its largest stable step rises and falls as it swings."""

import collections
from typing import Any, Generic, Protocol, TypeVar

from sim.springs.stability import Gauge

SPAN = 5.0  # [s] of simulated time


class Gauged(Protocol):
    """Readings with a gauge."""

    @property
    def stability(self) -> Gauge:
        """Stability of the time step."""
        ...

    def _replace(self, **fields: Any) -> Any:
        """The readings with other values, as a NamedTuple has it."""
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
        """The readings with the largest fraction of the stable step among these, of time t [s], and those before.

        Their accuracy is that of the readings with the largest error.
        """
        self.readings.append((t, readings))
        while self.readings[0][0] < t - SPAN:
            self.readings.popleft()
        worst = max(self.readings, key=lambda entry: entry[1].stability.share)[1]
        least_right = max((entry[1].stability for entry in self.readings), key=lambda gauge: gauge.error)
        return worst._replace(
            stability=worst.stability._replace(
                accurate_step=min(least_right.accurate_step, worst.stability.critical_step),
                error=least_right.error,
                accurate_method=least_right.accurate_method,
            )
        )
