"""How far and how fast the particles of a net are: what a scene asks after every frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel


class Extremes(NamedTuple):
    """NaN, all three, where a position or a velocity is not finite: every comparison with it then fails."""

    out: float  # [m] largest |x|, |y| or |z|
    reach: float  # [m] largest distance from the first particle along an axis
    speed: float  # [m/s] largest |vx|, |vy| or |vz|


@kernel(allocates=False)
def largest(x, v, n):
    """The fields of `Extremes` of flat positions and velocities (3 n,)."""
    out, reach, speed, nothing = 0.0, 0.0, 0.0, 0.0
    for e in range(3):
        first = x[e * n]
        for j in range(e * n, (e + 1) * n):
            out, reach, speed = max(out, abs(x[j])), max(reach, abs(x[j] - first)), max(speed, abs(v[j]))
            nothing += 0.0 * x[j] + 0.0 * v[j]  # NaN from the first number on that is not finite
    return out + nothing, reach + nothing, speed + nothing


def extremes(x: NDArray[np.float64], v: NDArray[np.float64]) -> Extremes:
    """Of positions [m] and velocities [m/s], both (3, rows, cols)."""
    return Extremes(*largest(x.reshape(-1), v.reshape(-1), x.size // 3))
