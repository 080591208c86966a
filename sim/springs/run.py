"""`Run`: the record of a simulated net."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.records import equal_to_itself
from sim.springs.analysis.energy_history import EnergyHistory


@equal_to_itself
class Run(NamedTuple):
    """A simulated motion. Ropes have (frames, points, 3), other nets (frames, rows, cols, 3)."""

    t: NDArray[np.float64]  # (frames,) [s] from the time of the start
    x: NDArray[np.float64]  # [m]
    v: NDArray[np.float64]  # [m/s]
    energy: EnergyHistory  # by name, (frames,) each [J]
    force_evals: int
    diverged_at: float | None  # [s]
    step: float | None  # [s] that was taken; None if the method chose its own
    integrator: str  # that ran: what "auto" took
    left_out: int = 0  # most particles at once that self-contact left out, its list of pairs being full
    unsettled: int = 0  # steps of implicit methods and kicks of damped nets whose solver had not settled
    slowed: int = 0  # steps in which parts that touch were slowed down, as impulses alone did not keep them apart
    state: Any = None  # `State` at the end, from which `simulate` continues
