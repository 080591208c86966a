"""Waves of a record, counted from one upward crossing of its mean level to the next.

    >>> import numpy as np
    >>> from sim.ocean import zero_crossings
    >>> t = np.arange(0.0, 100.0, 0.1)
    >>> waves = zero_crossings(t, 0.5 * np.sin(2.0 * np.pi * t / 8.0))
    >>> waves.number, round(waves.significant_height, 2), round(waves.mean_period, 2)
    (12, 1.0, 8.0)

Theory beside it is `Spectrum.moments`: the mean period is Tz (Rice 1945), and the mean height of the highest third is
4.00 sqrt(m0) where the band is narrow (Longuet-Higgins 1952, J. Mar. Res. 11:245), up to a tenth less in a real sea.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.validation import argument_error, as_array


class ZeroCrossings(NamedTuple):
    """The whole waves of a record; means are nan without any."""

    number: int
    significant_height: float  # [m] H1/3, mean of the highest third
    mean_height: float  # [m]
    largest_height: float  # [m]
    mean_period: float  # [s] Tz


def zero_crossings(t: ArrayLike, height: ArrayLike) -> ZeroCrossings:
    """The waves of heights (n,) [m] at rising times (n,) [s]; crossings lie on the lines between samples.

    The height of a wave is from its lowest to its highest sample. Raises ValueError for other shapes, values that are
    not finite, or times that do not rise.
    """
    times, heights = as_array("t", t, "numbers [s]"), as_array("height", height, "numbers [m]")
    if times.ndim != 1 or not (np.isfinite(times).all() and (np.diff(times) > 0.0).all()):
        raise argument_error("t", times.shape if times.ndim != 1 else times, "finite, rising times of shape (n,)")
    if heights.shape != times.shape or not np.isfinite(heights).all():
        raise argument_error("height", heights.shape, f"finite heights, one for each of {times.size} times")
    eta = heights - heights.mean() if heights.size else heights
    up = np.flatnonzero((eta[:-1] < 0.0) & (eta[1:] >= 0.0))
    if up.size < 2:
        return ZeroCrossings(0, math.nan, math.nan, math.nan, math.nan)
    crossing = times[up] - eta[up] * (times[up + 1] - times[up]) / (eta[up + 1] - eta[up])
    inside = eta[: up[-1] + 1]
    tallest = np.sort(np.maximum.reduceat(inside, up[:-1] + 1) - np.minimum.reduceat(inside, up[:-1] + 1))[::-1]
    third = tallest[: max(round(tallest.size / 3), 1)]
    return ZeroCrossings(
        up.size - 1,
        float(third.mean()),
        float(tallest.mean()),
        float(tallest[0]),
        float(crossing[-1] - crossing[0]) / (up.size - 1),
    )
