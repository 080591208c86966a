"""Moments of a spectrum of frequencies, m_n = int omega^n S(omega) d omega, and the numbers of a sea that follow."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

POINTS = 20001  # frequencies of the sums
PEAK_POINTS = 401  # frequencies among which the peak is found
TAIL = 1e-3  # fraction that the last tenth of the decades may add to a moment that converges


class Moments(NamedTuple):
    """Moments of a sea up to a cut-off; inf for one that grows with every shorter wave. Means are nan on a level sea.

    The names are those of DNV-RP-C205 (2021), section 3.5.
    """

    m0: float  # [m2]
    m1: float  # [m2 rad/s]
    m2: float  # [m2 rad2/s2]
    m3: float  # [m2 rad3/s3]
    m4: float  # [m2 rad4/s4]
    peak_period: float  # [s] Tp, of the largest S(omega)
    gravity: float  # [m/s2]
    cut_off: float  # [rad/s] above which waves are left out

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m]."""
        return 4.0 * math.sqrt(self.m0)

    @property
    def zero_crossing_period(self) -> float:
        """Tz = 2 pi sqrt(m0/m2) [s]: the mean time between upward crossings of the mean level (Rice 1945)."""
        return 2.0 * math.pi * math.sqrt(self.m0 / self.m2) if self.m0 > 0.0 else math.nan

    @property
    def mean_period(self) -> float:
        """Tm01 = 2 pi m0/m1 [s]."""
        return 2.0 * math.pi * self.m0 / self.m1 if self.m0 > 0.0 else math.nan

    @property
    def steepness(self) -> float:
        """Ss = 2 pi Hs/(g Tz^2)."""
        return 2.0 * math.pi * self.significant_height / (self.gravity * self.zero_crossing_period**2)


def moments_of(
    density: Callable[[np.ndarray], np.ndarray], first: float, last: float, gravity: float, cut_off: float
) -> Moments:
    """The moments of S(omega) [m2 s] from the first to the last frequency [rad/s], by trapezoids in its logarithm.

    The last decades of an endless spectrum show whether a moment converges.
    """
    omega = np.geomspace(first, last, POINTS)
    S, moments = density(omega), []
    weights = np.full(POINTS, math.log(last / first) / (POINTS - 1))
    weights[[0, -1]] *= 0.5
    for n in range(5):
        parts = weights * omega ** (n + 1) * S
        total = float(parts.sum())
        grows = math.isinf(cut_off) and float(parts[-POINTS // 10 :].sum()) > TAIL * total
        moments.append(math.inf if grows else total)
    peak = math.nan
    if S.any():
        i = min(max(int(S.argmax()), 1), POINTS - 2)
        near = np.linspace(omega[i - 1], omega[i + 1], PEAK_POINTS)
        peak = 2.0 * math.pi / float(near[density(near).argmax()])
    m0, m1, m2, m3, m4 = moments
    return Moments(m0, m1, m2, m3, m4, peak, gravity, cut_off)
