"""Reach and speed of a net's particles: the check that a motion has not diverged."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.net import FARTHEST

DIVERGENCE_BOUND = FARTHEST  # [m]: a net that has left this bound has diverged, long before its numbers overflow


class Extremes(NamedTuple):
    """Largest values of a state. All three are NaN where a number is not finite: every comparison then fails."""

    max_coordinate: float  # [m] largest |x|, |y| or |z|
    reach: float  # [m] largest distance from the first particle along an axis
    speed: float  # [m/s] largest |vx|, |vy| or |vz|


@kernel(allocates=False)
def find_extremes(x, v, n):
    """The fields of `Extremes`, of flat positions and velocities (3 n,)."""
    max_coordinate, reach, speed, nan_or_zero = 0.0, 0.0, 0.0, 0.0
    for e in range(3):
        first = x[e * n]
        for j in range(e * n, (e + 1) * n):
            max_coordinate = max(max_coordinate, abs(x[j]))
            reach, speed = max(reach, abs(x[j] - first)), max(speed, abs(v[j]))
            # `max` ignores a NaN. This sum stays 0, and becomes NaN at the first number that is not finite.
            nan_or_zero += 0.0 * x[j] + 0.0 * v[j]
    return max_coordinate + nan_or_zero, reach + nan_or_zero, speed + nan_or_zero


def extremes(x: NDArray[np.float64], v: NDArray[np.float64]) -> Extremes:
    """Extremes of positions [m] and velocities [m/s], both (3, rows, cols)."""
    return Extremes(*find_extremes(x.reshape(-1), v.reshape(-1), x.size // 3))
