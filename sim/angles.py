"""Angles modulo a turn: one number for each direction, and differences that know no branch cut."""

import math

import numpy as np
from numpy.typing import ArrayLike

ROUNDING = 1e-9  # [rad] within which two angles are the same direction


def direction_of(east: float, north: float) -> float:
    """Direction [rad] of a vector, from +x towards +y, in (-pi, pi]; nan of none. That of west is pi, never -pi."""
    if not math.hypot(east, north) > 0.0:
        return math.nan
    angle = math.atan2(north, east)
    return math.pi if angle < ROUNDING - math.pi else angle


def within_turn(angle: ArrayLike) -> np.ndarray:
    """Angles [rad] brought to [0, 2 pi). Those that are a whole number of turns are 0, also if they were rounded."""
    found = np.mod(angle, 2.0 * math.pi)
    return np.where(found > 2.0 * math.pi - ROUNDING, 0.0, found)


def angle_from(theta: ArrayLike, direction: ArrayLike) -> np.ndarray:
    """theta - direction brought to [-pi, pi] [rad]."""
    return np.mod(np.subtract(theta, direction) + np.pi, 2.0 * np.pi) - np.pi
