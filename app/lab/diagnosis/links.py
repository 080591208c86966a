"""Forms in which the force of a damped spring is written wrongly, for all tasks with springs.

A law gives the force on the first end of each link, (..., 3), from r (..., 3), from the first end to the second, its
length s (..., 1), dv = v1 - v2 (..., 3), k, b and the rest length d.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

Law = Callable[..., Any]


def spring(r: Any, s: Any, dv: Any, k: float, b: float, d: Any) -> Any:
    """The right force of the spring."""
    return k * (s - d) * r / s


def damping(r: Any, s: Any, dv: Any, k: float, b: float, d: Any) -> Any:
    """The right force of the damping."""
    return -b * dv


SPRING = "k (|r| - d) r/|r|"
DAMPING = "-b (v1 - v2)"
SPRING_FORMS: tuple[tuple[str, str, Law], ...] = (
    ("k |r| r/|r|", "The rest length is missing.", lambda r, s, dv, k, b, d: k * r),
    ("k (|r| - d) r", "The direction r does not have unit length.", lambda r, s, dv, k, b, d: k * (s - d) * r),
    ("k (r - d)", "The rest length is subtracted from each component.", lambda r, s, dv, k, b, d: k * (r - d)),
    ("k (|r|/d - 1) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s / d - 1.0) * r / s),
    ("k (1 - d/|r|) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (1.0 - d / s) * r / s),
    ("k (|r|² - d²) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s**2 - d**2) * r / s),
    ("k (|r|² - d) r/|r|", "The length is squared.", lambda r, s, dv, k, b, d: k * (s**2 - d) * r / s),
    ("k (|r| - d)² r/|r|", "The stretch is squared.", lambda r, s, dv, k, b, d: k * (s - d) ** 2 * r / s),
    ("k ||r| - d| r/|r|", "A compressed spring must push.", lambda r, s, dv, k, b, d: k * abs(s - d) * r / s),
    ("k max(|r| - d, 0) r/|r|", "It only pulls; a compressed spring must push.",
     lambda r, s, dv, k, b, d: k * np.maximum(s - d, 0.0) * r / s),
    ("k min(|r| - d, 0) r/|r|", "It only pushes; a stretched spring must pull.",
     lambda r, s, dv, k, b, d: k * np.minimum(s - d, 0.0) * r / s),
    ("k (|r| - d)", "It has no direction.", lambda r, s, dv, k, b, d: k * (s - d) * np.ones_like(r)),
    ("k (|r| - d) r/|r|²", "It is divided by the length twice.", lambda r, s, dv, k, b, d: k * (s - d) * r / s**2),
    ("k (|r| + d) r/|r|", "The stretch is |r| - d.", lambda r, s, dv, k, b, d: k * (s + d) * r / s),
)  # fmt: skip
DAMPING_FORMS: tuple[tuple[str, str, Law], ...] = (
    ("-b ((v1 - v2) . r/|r|) r/|r|", "It acts along the link only.",
     lambda r, s, dv, k, b, d: -b * (dv * r).sum(axis=-1, keepdims=True) / s**2 * r),
    ("-b |v1 - v2| r/|r|", "It acts along the link, by the size of v1 - v2.",
     lambda r, s, dv, k, b, d: -b * size(dv) * r / s),
    ("-b |v1 - v2| (v1 - v2)", "It is multiplied by the speed.", lambda r, s, dv, k, b, d: -b * size(dv) * dv),
    ("-b (v1 - v2)/|v1 - v2|", "The speed does not count.", lambda r, s, dv, k, b, d: -b * dv / size(dv)),
    ("-b |v1 - v2|", "It has no direction.", lambda r, s, dv, k, b, d: -b * size(dv) * np.ones_like(r)),
    ("-b (v1 - v2) (|r| - d)", "It is multiplied by the stretch.", lambda r, s, dv, k, b, d: -b * dv * (s - d)),
    ("-b |v1 - v2|, by components", "It never changes its sign.", lambda r, s, dv, k, b, d: -b * abs(dv)),
)  # fmt: skip


def size(vectors: Any) -> Any:
    """The lengths of vectors, (..., 1)."""
    return np.linalg.norm(vectors, axis=-1, keepdims=True)
