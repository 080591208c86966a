"""Small motions of a hull in the frequency domain, of its linear coefficients: response in a wave, and free decay.

`step` finds the same in time: tests and hydrodynamics.py compare the two.
"""

import itertools
import math

import numpy as np

from sim.floating.linear.hydrodynamics import LinearHull

SEA_DENSITY, GRAVITY = 1025.0, 9.81  # [kg/m3], [m/s2] that all here holds for


def linear_response(linear: LinearHull, mass: np.ndarray, stiffness: np.ndarray, X: np.ndarray, w: float) -> np.ndarray:
    """Motion (6,) in a wave of unit height at w [rad/s], x = Re(xi e^(-iwt))."""
    a, b = linear.at(w / math.sqrt(GRAVITY))
    a, b = SEA_DENSITY * a, SEA_DENSITY * math.sqrt(GRAVITY) * b
    # sway, surge and yaw have no stiffness; a little of it keeps the matrix regular
    return np.linalg.solve(stiffness - w * w * (mass + a) - 1j * w * b + 1e-9 * np.eye(6), X)


def linear_decay(linear: LinearHull, mass: np.ndarray, stiffness: np.ndarray, axis: int, t: np.ndarray) -> np.ndarray:
    """Free decay: displacement at times t [s] after release at rest from unit displacement, by the frequency response.

    With H = 1/(C - w^2 (M + A) + i w B) of the motion, x(t) = C int_t^inf h(s) ds and h(t) = 2/pi int Re H cos(wt) dw.
    So x(t) = 2 C/pi int -Re(H) sin(wt)/w dw + C H(0), which is 1.
    """
    w = np.linspace(1e-3, 60.0, 30000)
    last = float(linear.frequency[-1]) * math.sqrt(GRAVITY)
    H = np.empty(len(w))
    partner = {3: 1, 4: 0}.get(axis, axis)
    rows = [axis] if partner == axis else [partner, axis]
    pick = np.ix_(rows, rows)
    for i, one in enumerate(w):
        a, b = linear.at(one / math.sqrt(GRAVITY)) if one <= last else (linear.infinite, 0 * linear.infinite)
        D = stiffness - one * one * (mass + SEA_DENSITY * a) + 1j * one * SEA_DENSITY * math.sqrt(GRAVITY) * b
        H[i] = np.linalg.inv(D[pick])[-1, -1].real
    C, dw = stiffness[axis, axis], w[1] - w[0]
    return np.array([1 - 2 / math.pi * C * float((H * np.sin(w * one) / w).sum() * dw) for one in t])


def first_swings(x: np.ndarray) -> tuple[float, float]:
    """Period [samples] and ratio of successive extremes of a decaying oscillation, over its first swings."""
    down = np.flatnonzero((x[:-1] > 0) & (x[1:] <= 0))[:3]
    crossing = down + x[down] / (x[down] - x[down + 1])
    peaks = [np.abs(x[a:b]).max() for a, b in itertools.pairwise(down)]
    return float(np.diff(crossing).mean()), float(peaks[1] / peaks[0])
