"""The reference solution of a task, and the errors of a run."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Positions = tuple[NDArray[np.float64], ...]  # (3, rows, points) [m] at each of the task's times

RESOLUTION = 10.0  # an error below so many times the reference's own uncertainty says nothing


class Reference(NamedTuple):
    """The solution of a task, and its uncertainty [m]."""

    positions: Positions
    uncertainty: float


def largest_distances(positions: Positions, reference: Reference) -> tuple[float, ...]:
    """Largest distance [m] of any particle from the reference, at each time; not finite where the run diverged."""
    return tuple(
        float(np.linalg.norm(own - true, axis=0).max())
        for own, true in zip(positions, reference.positions, strict=True)
    )
