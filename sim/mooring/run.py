"""`MooringRun`: the record of a simulated mooring."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.records import equal_to_itself
from sim.springs.analysis.energy_history import EnergyHistory
from sim.springs.state import State

Array = NDArray[np.float64]


@equal_to_itself
class MooringRun(NamedTuple):
    """A simulated motion."""

    t: Array  # (frames,) [s] from the time of the start
    x: dict[int, Array]  # by line: (frames, segments + 1, 3) [m]
    v: dict[int, Array]  # by line: (frames, segments + 1, 3) [m/s]
    tension: dict[int, Array]  # by line: (frames, segments) [N], internal damping included
    end_tension: dict[int, Array]  # by line: (frames, 2) [N] at its start and end, see `sim.mooring.end_forces`
    force: dict[int, Array]  # by fixed or coupled point: (frames, 3) [N] on what holds it, see `point_forces`
    bodies: dict[int, Array]  # by body: (frames, 6) [m, rad] from its place
    bodies_v: dict[int, Array]  # by body: (frames, 6) [m/s, rad/s]
    energy: EnergyHistory  # by name, (frames,) each [J]; `contact` is the bed's
    force_evals: int
    diverged_at: float | None  # [s]
    step: float  # [s] that was taken
    integrator: str
    state: State  # at the end: `simulate` continues from it
    unsettled: int  # kicks of lines whose drag or slack links had not settled
