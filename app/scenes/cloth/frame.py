"""Frames and readings of the cloth for its view and the panel, immutable."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.cloth.parameters import ClothParams
from app.scenes.springs.grab import GrabFrame
from app.scenes.springs.net_motion import SolverReport
from sim.springs.stability import Gauge


class ClothFrame(NamedTuple):
    """Drawn state of a cloth."""

    params: ClothParams
    points: NDArray[np.float32]  # (rows, cols, 3) [m], C-contiguous
    strain: NDArray[np.float32]  # (rows, cols), largest of the structural springs at a particle
    pins: tuple[Vector, Vector] | None  # [m] where the two ends of the first row are going to
    sphere: tuple[float, float, float, float] | None  # x, y, z, radius [m]
    sphere_home: Vector  # [m] where the sphere's arrows are
    grab: GrabFrame | None
    student: NDArray[np.float32] | None  # (r, c, 3) [m] the student's cloth beside the program's


class ClothReadings(NamedTuple):
    """The stability of the time step, and the cost of a step."""

    stability: Gauge
    exact: bool  # the gauge is that of the state; otherwise a bound for all states
    corrections: float  # corrections a step, of implicit methods
    note: str  # reason why another method runs than the one chosen, or ""
    threads: int  # that compute the forces
    left_out: int = 0  # most particles that self-collision has left out, its list of pairs being full
    solver: SolverReport = SolverReport()
