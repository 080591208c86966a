"""Statistics of the tensions and the slack of lines, without the times of drags."""

import math

import numpy as np
from numpy.typing import NDArray

from app.scenes.mooring.frame import EndStatistics, LineReading
from sim.numerics.extreme_values import Peaks

LONG = 10800.0  # [s] in which a largest tension is expected: the usual length of a sea state
SETTLING_PERIODS = 3.0  # of the waves after a drag, until its motion has died down

Array = NDArray[np.float64]


class RunningStatistics:
    """Least, mean, largest and standard deviation of `count` numbers over time, by West's update (1979, CACM 22:532).

    A number counts for the time since the one before.
    """

    def __init__(self, count: int) -> None:
        self.least, self.largest = np.full((2, count), math.nan)
        self.mean, self.squares = np.zeros((2, count))  # squares: sum of squared deviations, times their times
        self.duration = 0.0  # [s]

    def add(self, values: Array, duration: float) -> None:
        """Add numbers (count,) that hold for `duration` [s]."""
        self.least, self.largest = np.fmin(self.least, values), np.fmax(self.largest, values)
        self.duration += duration
        away = values - self.mean
        self.mean = self.mean + away * (duration / self.duration if self.duration > 0.0 else 1.0)
        self.squares = self.squares + duration * away * (values - self.mean)

    def each(self) -> list[EndStatistics]:
        """The values of each number; NaN before the first."""
        deviation = np.sqrt(self.squares / max(self.duration, 1e-9))
        known = np.where(np.isnan(self.least), math.nan, 1.0)
        rows = np.stack((self.least, self.mean * known, self.largest, deviation * known), axis=1)
        return [EndStatistics(*row) for row in rows.tolist()]


def with_expected(rows: list[EndStatistics], peaks: Peaks) -> list[EndStatistics]:
    """The statistics of each number with the largest one that is expected in `LONG`."""
    expected = peaks.expected_largest(LONG).tolist()
    # one NaN, so that equal statistics are equal
    return [
        row._replace(expected=math.nan if math.isnan(one) else one) for row, one in zip(rows, expected, strict=True)
    ]


class Tensions:
    """Tensions and uplift of lines, since the statistics began."""

    def __init__(self, lines: int) -> None:
        self.fairlead, self.anchor, self.uplift = np.zeros((3, lines))  # [N] now
        self.slack_since = np.full(lines, math.nan)  # [s]
        self.time = self.counted_from = 0.0  # [s] now, and when what a drag has left behind has died down
        self.restart()

    def restart(self) -> None:
        """Begin the statistics now."""
        lines = len(self.fairlead)
        self.since = self.time  # [s]
        self.at_fairlead, self.at_anchor = RunningStatistics(lines), RunningStatistics(lines)
        self.fairlead_peaks, self.anchor_peaks = Peaks(lines), Peaks(lines)
        self.most_uplift, self.slack_time = np.zeros((2, lines))  # [N], [s]
        self.most_at = (0, self.time)  # line, and time [s], of the largest tension
        self.dragged = math.nan  # [N] largest tension at a fairlead while it was dragged, and until that died down

    def leave_out(self, t: float, period: float) -> None:
        """Leave out the time t [s] and all until `SETTLING_PERIODS` of a period [s] have gone by."""
        self.counted_from = t + SETTLING_PERIODS * period

    @property
    def counts(self) -> bool:
        """False while the time is left out."""
        return self.time >= self.counted_from

    def take_now(self, at_anchor: Array, at_fairlead: Array) -> None:
        """Set the present forces (lines, 3) at both ends [N], without statistics."""
        self.anchor, self.fairlead = (np.linalg.norm(force, axis=1) for force in (at_anchor, at_fairlead))
        self.uplift = np.maximum(at_anchor[:, 2], 0.0)

    def measure(self, t: float, tension: Array, at_anchor: Array, at_fairlead: Array) -> None:
        """Add the tensions (lines, segments) and the forces (lines, 3) at both ends [N], at time t [s]."""
        duration, self.time = t - self.time, t
        self.take_now(at_anchor, at_fairlead)
        is_slack = tension.min(axis=1) <= 0.0
        self.slack_since = np.where(is_slack, np.where(np.isnan(self.slack_since), t, self.slack_since), math.nan)
        if not self.counts:
            self.dragged = float(np.fmax(self.dragged, self.fairlead.max()))
            return
        line, most = int(self.fairlead.argmax()), self.at_fairlead.largest
        if np.isnan(most).all() or self.fairlead[line] > most.max():
            self.most_at = line, t
        self.at_fairlead.add(self.fairlead, duration)
        self.at_anchor.add(self.anchor, duration)
        self.fairlead_peaks.add(self.fairlead, duration)
        self.anchor_peaks.add(self.anchor, duration)
        self.most_uplift = np.maximum(self.most_uplift, self.uplift)
        self.slack_time = self.slack_time + np.where(is_slack, duration, 0.0)

    def readings(self, lying: Array) -> tuple[LineReading, ...]:
        """Each line. lying: (lines,) [m] of each on the bed."""
        fraction = self.slack_time / max(self.at_fairlead.duration, 1e-9)
        columns = self.uplift, self.most_uplift, lying, self.slack_since, fraction
        both = (self.at_fairlead, self.fairlead_peaks), (self.at_anchor, self.anchor_peaks)
        at_fairlead, at_anchor = (with_expected(statistics.each(), peaks) for statistics, peaks in both)
        ends = zip(self.fairlead.tolist(), self.anchor.tolist(), at_fairlead, at_anchor, strict=True)
        return tuple(LineReading(*end, *row) for end, row in zip(ends, np.stack(columns, axis=1).tolist(), strict=True))
