"""Linear dispersion of one fluid: the relation of frequency and wavenumber, which the whole library shares.

omega^2 = (g k + s k^3) tanh kh, s = sigma/rho (Lamb, Hydrodynamics, Art. 228-229 and 266-267). Arguments are not
checked here; `sim.ocean.dispersion` has the same functions with checks and units in their errors.

Wavenumbers k, frequencies: arrays of any shape, 0 or above. gravity [m/s2] above 0, depth [m] above 0 or inf, s [m3/s2]
0 or above. Frequencies over sqrt(g) [1/sqrt(m)] have a gravity of 1.
"""

import math
from typing import Any

import numpy as np

NEWTON_STEPS = 40  # usually 4 or 5, a few more between gravity waves and ripples
CLOSE = 1e-9  # relative change of a wavenumber at which the search ends: the next would be its square


def tanh_depth(k: np.ndarray, depth: float) -> np.ndarray:
    """tanh(k depth), exactly 1 on infinite depth (where 0 * inf would not be a number)."""
    return np.ones_like(k) if math.isinf(depth) else np.tanh(k * depth)


def omega(k: np.ndarray, gravity: float, depth: float, s: float = 0.0) -> Any:
    """Angular frequency [rad/s]."""
    return np.sqrt((gravity * k + s * k**3) * tanh_depth(k, depth))


def phase_speed(k: np.ndarray, gravity: float, depth: float, s: float = 0.0) -> Any:
    """Phase speed omega/k [m/s]; at k = 0 sqrt(g depth), inf where depth is."""
    endless, k = k == 0.0, np.maximum(k, smallest(depth))
    speed = np.sqrt((gravity / k + s * k) * tanh_depth(k, depth))
    return np.where(endless & math.isinf(depth), math.inf, speed)


def group_speed(k: np.ndarray, gravity: float, depth: float, s: float = 0.0) -> Any:
    """Group speed d omega/dk [m/s]; at k = 0 sqrt(g depth), inf where depth is."""
    endless, k = k == 0.0, np.maximum(k, smallest(depth))
    th = tanh_depth(k, depth)
    w = np.sqrt((gravity * k + s * k**3) * th)
    # cg = [(g + 3 s k^2) tanh kh + (g + s k^2) kh sech^2 kh] / (2 omega), sech^2 = (1 - tanh)(1 + tanh)
    shallow = 0.0 if math.isinf(depth) else k * depth * (1.0 - th) * (1.0 + th)
    speed = ((gravity + 3.0 * s * k**2) * th + (gravity + s * k**2) * shallow) / (2.0 * w)
    return np.where(endless & math.isinf(depth), math.inf, speed)


def wavenumber(frequency: np.ndarray, gravity: float, depth: float, s: float = 0.0) -> np.ndarray:
    """Wavenumber [rad/m] of waves of these angular frequencies [rad/s], to rounding.

    By Newton's method in the logarithms of both: ln omega rises with ln k by 1/2 to 3/2, so that every step converges.
    """
    w = np.asarray(frequency, np.float64)
    deep = np.square(w) / gravity
    if math.isinf(depth) and s == 0.0:
        return deep
    # tanh kh is below 1 and below kh: without tension k is above both of these, by at most 20 %
    k = deep if math.isinf(depth) else np.maximum(deep, w / math.sqrt(gravity * depth))
    if s > 0.0:  # with tension alone
        ripple = np.cbrt(np.square(w) / s)
        k = np.minimum(k, ripple if math.isinf(depth) else np.maximum(ripple, (np.square(w) / (s * depth)) ** 0.25))
    moving = w > 0.0
    k = np.where(moving, k, 1.0)
    for _ in range(NEWTON_STEPS):
        own = omega(k, gravity, depth, s)
        change = np.log(np.where(moving, w, own) / own) * own / (k * group_speed(k, gravity, depth, s))
        k = k * np.exp(change)
        if not (np.abs(change) > CLOSE).any():
            break
    return np.where(moving, k, 0.0)


def smallest(depth: float) -> float:
    """The wavenumber used for 0 in speeds: the limit is reached to rounding, and nothing divides by 0."""
    return 1e-100 if math.isinf(depth) else 1e-10 / depth
