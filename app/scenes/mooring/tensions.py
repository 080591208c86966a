"""What is kept of the tensions: the largest, when a line went slack, and for how long it was."""

import math

import numpy as np
from numpy.typing import NDArray

from app.scenes.mooring.frame import LineReading


class Tensions:
    """Tensions and uplift of so many lines, since the start."""

    def __init__(self, lines: int) -> None:
        self.fairlead, self.anchor, self.uplift = np.zeros((3, lines))  # [N] now
        self.most_fairlead, self.most_anchor, self.most_uplift = np.zeros((3, lines))  # [N]
        self.most_at = (0, 0.0)  # line, and time [s], of the largest tension
        self.slack_since = np.full(lines, math.nan)  # [s]
        self.slack_time, self.time = np.zeros(lines), 0.0  # [s]

    def measure(self, t: float, tension: NDArray[np.float64], points: NDArray[np.float64]) -> None:
        """Take the tensions (lines, segments) [N] at time t [s], of nodes at points (lines, segments + 1, 3) [m]."""
        self.fairlead, self.anchor = tension[:, -1].copy(), tension[:, 0].copy()
        first = points[:, 1] - points[:, 0]
        self.uplift = np.maximum(self.anchor * first[:, 2] / np.maximum(np.linalg.norm(first, axis=1), 1e-12), 0.0)
        line = int(self.fairlead.argmax())
        if self.fairlead[line] > self.most_fairlead.max():
            self.most_at = line, t
        self.most_fairlead = np.maximum(self.most_fairlead, self.fairlead)
        self.most_anchor = np.maximum(self.most_anchor, self.anchor)
        self.most_uplift = np.maximum(self.most_uplift, self.uplift)
        is_slack = self.fairlead <= 0.0
        self.slack_time += np.where(is_slack, t - self.time, 0.0)
        self.slack_since = np.where(is_slack, np.where(np.isnan(self.slack_since), t, self.slack_since), math.nan)
        self.time = t

    def readings(self, lying: NDArray[np.float64]) -> tuple[LineReading, ...]:
        """Each line. lying: (lines,) [m] of each on the bed."""
        share = self.slack_time / max(self.time, 1e-9)
        columns = (
            self.fairlead, self.anchor, self.most_fairlead, self.most_anchor, self.uplift, self.most_uplift, lying,
            self.slack_since, share,
        )  # fmt: skip
        return tuple(LineReading(*row) for row in np.stack(columns, axis=1).tolist())
