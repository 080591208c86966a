"""The record of a peer: another program that is given one of our tasks."""

import importlib.util
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Run = Callable[[float], NDArray[np.float64]]  # simulated time [s] -> positions (3, rows, points) [m] at that time


class Peer(NamedTuple):
    """A program, and how it is given the task.

    make: for ropes and cloths, takes the net and a time step [s] or a relative tolerance, and gives a `Run`; for seas,
    takes the sea and a precision, and gives frame(t), height and displacements (3, N, N) [m], or None if it draws
    another sea. What has to be compiled is compiled by the first call, which is timed apart.
    """

    name: str
    package: str
    make: Callable[..., Any]
    damping: str = "isotropic"  # the damping model that it can express; or "axial"
    max_size: float = math.inf  # links of a rope, rows of a cloth; larger ones take minutes, or the package gives up
    step: float = 0.0  # [s] its own time step; 0: it takes the step that it is given
    tolerances: tuple[float, ...] = ()  # relative ones of its ladder, where it chooses its steps; a hundredth: absolute
    precisions: tuple[str, ...] = ()  # of its ladder, where it takes no steps
    settings: tuple[tuple[str, Any], ...] = ()  # of its ladder with their labels, where no single number says them

    def reason_left_out(self, size: int) -> str:
        """Why the peer is not timed on a task of this size, or ""."""
        if not is_installed(self.package):
            return "not installed"
        return "left out: minutes a run" if size > self.max_size else ""


def is_installed(package: str) -> bool:
    """Whether a package can be imported, without importing it."""
    return importlib.util.find_spec(package) is not None
