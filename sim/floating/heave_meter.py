"""Mean draft and period of heave, measured on bodies while they move."""

import math

import numpy as np

MEAN_DURATION = 60.0  # [s] over which drafts are averaged: waves of 3 s leave less than 1 mm of it
BASELINE_DURATION = 8.0  # [s] over which the draft is averaged that a swing crosses
PERIOD_COUNT = 4  # periods that a measured heave period is the mean of, at most
MIN_SWING = 2e-4  # [m] from the mean draft that counts as a swing
SWING_SHARE = 0.3  # of the mean deviation that counts as a swing
MAX_AGE = 4.0  # periods since the last crossing, after which no period is given


class HeaveMeter:
    """Averages the drafts of n bodies, and times their upward crossings of the average of the last seconds."""

    def __init__(self, n: int) -> None:
        self.mean, self.age = np.zeros(n), np.zeros(n)  # [m] mean drafts, [s] over which they are taken so far
        self.baseline = np.zeros(n)  # [m] mean of the last seconds
        self.below = np.zeros(n, bool)  # whether a draft was clearly below its mean since the last crossing
        self.deviation = np.zeros(n)  # [m] running mean of the distance from the mean
        self.crossings: list[list[float]] = [[] for _ in range(n)]  # [s] times, the last few of each body

    def update(self, t: float, draft: np.ndarray, duration: float) -> None:
        """Take the drafts (n,) [m] at time t [s], `duration` [s] after the last ones."""
        self.age += duration
        self.mean += duration / np.minimum(self.age, MEAN_DURATION) * (draft - self.mean)
        share = np.minimum(duration / np.minimum(self.age, BASELINE_DURATION), 1.0)
        self.baseline += share * (draft - self.baseline)
        offset = draft - self.baseline
        self.deviation += share * (np.abs(offset) - self.deviation)
        swing = np.maximum(SWING_SHARE * self.deviation, MIN_SWING)
        for i in np.flatnonzero(self.below & (offset > swing)):
            self.crossings[i] = [*self.crossings[i][-PERIOD_COUNT:], t]
            self.below[i] = False
        self.below |= offset < -swing

    def restart(self, i: int) -> None:
        """Begin the averages of body i anew, as after it was dragged."""
        self.age[i] = self.deviation[i] = 0.0
        self.below[i] = False
        self.crossings[i] = []

    def period(self, i: int, t: float) -> float:
        """Measured period [s] of body i at time t [s]; NaN before two crossings, or when the last was long ago."""
        times = self.crossings[i]
        if len(times) < 2:
            return math.nan
        period = (times[-1] - times[0]) / (len(times) - 1)
        return period if t - times[-1] < MAX_AGE * period else math.nan
