"""Angles modulo a turn: one number for each direction, and differences that know no branch cut."""

import math

import numpy as np
from numpy.typing import ArrayLike

CANCELLED = 1e-6  # of the lengths of vectors, below which their sum is round-off
ROUNDING = 1e-6  # [rad] within which two angles are one direction: a turn in single precision is off by 2e-7


def direction_of(east: float, north: float, total: float) -> float:
    """Direction [rad] of a sum of vectors, from +x towards +y, in (-pi, pi]. That of west is pi, never -pi.

    total: the sum of their lengths. nan where they cancel out to less than 1e-6 of it.
    """
    if not math.hypot(east, north) > CANCELLED * total:
        return math.nan
    angle = math.atan2(north, east)
    return math.pi if angle < ROUNDING - math.pi else angle


def within_turn(angle: ArrayLike) -> np.ndarray:
    """Angles [rad] brought to [0, 2 pi). Those that are a whole number of turns are 0, also if they were rounded."""
    remainder = np.mod(angle, 2.0 * math.pi)
    return np.where(remainder > 2.0 * math.pi - ROUNDING, 0.0, remainder)


def within_half_turn(angle: ArrayLike) -> np.ndarray:
    """Angles [rad] brought to [-pi, pi], such as the differences of two directions."""
    angle = np.asarray(angle)
    return angle - 2.0 * math.pi * np.rint(angle / (2.0 * math.pi))


def once_around(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles (n,) [rad] in [0, 2 pi), rising, and their indices in `angle`; of equal directions the first."""
    turned = within_turn(angle)
    order = np.argsort(turned, kind="stable")
    keep = np.diff(turned[order], prepend=-math.inf) > ROUNDING
    return turned[order][keep], order[keep]
