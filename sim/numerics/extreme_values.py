"""The largest value of a long time, expected from the peaks of a shorter record.

A peak is the largest value between two upcrossings of the mean. Heights of peaks over the mean follow a Weibull
distribution, fitted by its first two L-moments (Hosking 1990, J. R. Stat. Soc. B 52:105), and peaks are taken as
independent. A Gaussian process of a narrow band has the shape 2.

>>> import numpy as np
>>> record = Peaks(1)
>>> for t in np.arange(0.0, 3600.0, 0.5):
...     record.add(np.array([5.0 + np.sin(t) * (1.0 + 0.3 * np.sin(0.137 * t))]), 0.5)
>>> record.count[0], bool(6.2 < record.expected_largest(10800.0)[0] < 7.0)
(np.int64(572), True)
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_PEAKS = 20  # from which a distribution is fitted
EULER = 0.5772156649015329


def weibull_of(heights: Array) -> tuple[float, float]:
    """Scale and shape of the Weibull distribution from 0 with the first two L-moments of heights (n,) above 0."""
    ordered, n = np.sort(heights), len(heights)
    mean = float(ordered.mean())
    spread = 2.0 * float(np.arange(n) @ ordered) / (n * (n - 1)) - mean
    shape = -math.log(2.0) / math.log1p(-spread / mean) if spread > 0.0 else math.inf
    return mean / math.gamma(1.0 + 1.0 / shape), shape


def expected_largest(heights: Array, count: float) -> float:
    """Expected largest of `count` peaks with the distribution of heights (n,) above 0; NaN for fewer than LEAST_PEAKS.

    By the limit for many peaks, a (ln N)^(1/c) (1 + gamma/(c ln N)) (DNV-RP-C205, 3.5.11), within 1 % from N = 100 on.
    """
    if len(heights) < LEAST_PEAKS:
        return math.nan
    scale, shape = weibull_of(heights)
    many = math.log(max(count, 2.0))
    return scale * many ** (1.0 / shape) * (1.0 + EULER / (shape * many))


class Peaks:
    """The peaks of `count` numbers over time, above their means so far."""

    def __init__(self, count: int) -> None:
        self.duration = 0.0  # [s]
        self.mean = np.zeros(count)
        self.largest = np.full(count, math.nan)  # since the last upcrossing; NaN before the first one
        self.is_above = np.ones(count, bool)
        self.peaks: list[list[float]] = [[] for _ in range(count)]

    def add(self, values: Array, duration: float) -> None:
        """Add numbers (count,) that hold for `duration` [s]."""
        self.duration += duration
        self.mean = self.mean + (values - self.mean) * (duration / self.duration if self.duration > 0.0 else 1.0)
        is_above = values > self.mean
        for i in np.flatnonzero(is_above & ~self.is_above).tolist():
            if not math.isnan(self.largest[i]):
                self.peaks[i].append(float(self.largest[i]))
            self.largest[i] = values[i]
        self.largest = np.maximum(self.largest, values)  # NaN stays
        self.is_above = is_above

    @property
    def count(self) -> NDArray[np.int64]:
        """Number of peaks of each (count,)."""
        return np.array([len(one) for one in self.peaks], dtype=np.int64)

    def expected_largest(self, duration: float) -> Array:
        """Largest value of each (count,) that is expected in `duration` [s]; NaN for too few peaks."""
        largest = np.full(len(self.peaks), math.nan)
        for i, peaks in enumerate(self.peaks):
            heights = np.array(peaks) - self.mean[i]
            heights = heights[heights > 0.0]
            if len(heights) >= LEAST_PEAKS:
                rate = len(heights) / self.duration
                largest[i] = self.mean[i] + expected_largest(heights, rate * duration)
        return largest
