"""Frames and readings of the rope for its view and the panel, immutable."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.grab import GrabFrame
from app.scenes.springs.net_motion import SolverReport
from sim.springs.stability import Gauge


class RopeFrame(NamedTuple):
    """Drawn state of a rope: the student's if there is one, with the program's beside it."""

    params: RopeParams
    points: NDArray[np.float32]  # (n, 3) [m], C-contiguous
    reference: NDArray[np.float32] | None  # (n, 3) [m] the program's rope beside the student's
    tension: NDArray[np.float32]  # (n - 1,) [N]
    full_scale: float  # [N] tension at the end of the colour scale
    root: Vector  # [m] where the root is going to
    sphere: tuple[float, float, float, float] | None  # x, y, z, radius [m]
    grab: GrabFrame | None


class NumericalCost(NamedTuple):
    """Cost of an implicit method since it was chosen."""

    corrections: float  # recent corrections a step
    numerical_dissipation: float  # [J] that the method took, negative where it fed the motion
    damping_dissipation: float  # [J] that the rope's own damping took


class RopeReadings(NamedTuple):
    """The stability of the time step, and the largest values that would be stable."""

    stability: Gauge
    parameter: str  # name of the stiffness parameter in use
    largest_stiffness: float  # in that parameter's unit
    note: str  # reason why another method runs than the one chosen, or ""
    cost: NumericalCost | None  # None for explicit methods
    solver: SolverReport = SolverReport()
