"""Mean draft and period of heave, measured on bodies while they move."""

import math

import numpy as np

MEAN_DURATION = 8.0  # [s] over which drafts are averaged
PERIOD_COUNT = 4  # periods that a measured heave period is the mean of, at most
MIN_SWING = 2e-4  # [m] from the mean draft that counts as a swing
SWING_SHARE = 0.3  # of the mean deviation that counts as a swing
MAX_AGE = 4.0  # periods since the last crossing, after which no period is given


class HeaveMeter:
    """Averages the drafts of n bodies, and times the upward crossings of that average."""

    def __init__(self, n: int) -> None:
        self.mean, self.age = np.zeros(n), 0.0  # [m], [s]
        self.below = np.zeros(n, bool)  # whether a draft was clearly below its mean since the last crossing
        self.deviation = np.zeros(n)  # [m] running mean of the distance from the mean
        self.crossings: list[list[float]] = [[] for _ in range(n)]  # [s] times, the last few of each body

    def update(self, t: float, draft: np.ndarray, duration: float) -> None:
        """Take the drafts (n,) [m] at time t [s], `duration` [s] after the last ones."""
        self.age += duration
        share = min(duration / min(MEAN_DURATION, max(self.age, duration)), 1.0)
        self.mean += share * (draft - self.mean)
        offset = draft - self.mean
        self.deviation += share * (np.abs(offset) - self.deviation)
        swing = np.maximum(SWING_SHARE * self.deviation, MIN_SWING)
        for i in np.flatnonzero(self.below & (offset > swing)):
            self.crossings[i] = [*self.crossings[i][-PERIOD_COUNT:], t]
            self.below[i] = False
        self.below |= offset < -swing

    def period(self, i: int, t: float) -> float:
        """Measured period [s] of body i at time t [s]; NaN before two crossings, or when the last was long ago."""
        times = self.crossings[i]
        if len(times) < 2:
            return math.nan
        period = (times[-1] - times[0]) / (len(times) - 1)
        return period if t - times[-1] < MAX_AGE * period else math.nan
