"""Mean draft and period of heave, measured on bodies while they move."""

import functools
import math

import numpy as np

MEAN_DURATION = 60.0  # [s] over which drafts and forces are averaged
SAMPLE_DURATION = 0.1  # [s] that each sample of such an average stands for
BASELINE_DURATION = 8.0  # [s] over which the draft is averaged that a swing crosses
PERIOD_COUNT = 4  # periods that a measured heave period is the mean of, at most
MIN_SWING = 2e-4  # [m] from the mean draft that counts as a swing
SWING_SHARE = 0.3  # of the mean deviation that counts as a swing
MAX_AGE = 4.0  # periods since the last crossing, after which no period is given


class WindowMean:
    """Mean over the last minute of readings of n bodies, in a window that fades at both ends (Hann).

    An oscillation of 8 s is reduced to 1e-4 of its amplitude. A plain mean of 60 s leaves up to 4 %.
    """

    def __init__(self, n: int, numbers: int) -> None:
        """n: number of bodies. numbers: readings of each."""
        self.samples = np.zeros((round(MEAN_DURATION / SAMPLE_DURATION), n, numbers))
        self.sum, self.filled = np.zeros((n, numbers)), 0.0  # of the sample that is being taken, and how long it is [s]
        self.count = 0  # of samples taken
        self.began = np.zeros(n, int)  # count at which the mean of a body begins
        self.means: dict[int, np.ndarray] = {}  # by body, after this number of samples:
        self.means_at = 0

    def update(self, values: np.ndarray, duration: float) -> None:
        """Take values (n, numbers) that hold for `duration` [s]."""
        self.sum += duration * values
        self.filled += duration
        if self.filled >= SAMPLE_DURATION * (1.0 - 1e-9):
            self.samples[self.count % len(self.samples)] = self.sum / self.filled
            self.count += 1
            self.sum[:], self.filled = 0.0, 0.0

    def restart(self, i: int) -> None:
        """Start the mean of body i again."""
        self.began[i] = self.count
        self.means.pop(i, None)

    def of(self, i: int) -> np.ndarray:
        """The means (numbers,) of body i; NaN before the first sample."""
        length = min(self.count - int(self.began[i]), len(self.samples))
        if length == 0:
            return np.full(self.samples.shape[2], np.nan)
        if self.means_at != self.count:  # else no sample was taken since
            self.means, self.means_at = {}, self.count
        if i not in self.means:
            window = np.arange(self.count - length, self.count) % len(self.samples)
            self.means[i] = fading_window(length) @ self.samples[window, i]
        return self.means[i]


@functools.lru_cache(maxsize=2)
def fading_window(length: int) -> np.ndarray:
    """Hann's window of a number of samples; its sum is 1."""
    window = np.hanning(length + 2)[1:-1]
    return window / window.sum()


class HeaveMeter:
    """Averages the drafts of n bodies, and times their upward crossings of the average of the last seconds."""

    def __init__(self, n: int) -> None:
        self.mean = WindowMean(n, 1)  # [m] of the drafts
        self.age = np.zeros(n)  # [s] since the averages of a body began
        self.baseline = np.zeros(n)  # [m] mean of the last seconds
        self.below = np.zeros(n, bool)  # True if a draft was clearly below its mean since the last crossing
        self.deviation = np.zeros(n)  # [m] running mean of the distance from the mean
        self.crossings: list[list[float]] = [[] for _ in range(n)]  # [s] times, the last few of each body

    def update(self, t: float, draft: np.ndarray, duration: float) -> None:
        """Take the drafts (n,) [m] at time t [s], `duration` [s] after the last ones."""
        self.age += duration
        self.mean.update(draft[:, None], duration)
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
        """Start the averages of body i again, as after it was dragged."""
        self.mean.restart(i)
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
