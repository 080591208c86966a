"""The state that a mooring starts with."""

import dataclasses
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.mooring.start_check import Fault
from sim.mooring import System, at_rest
from sim.mooring.rest.statics import Rest, rest_of, straight
from sim.validation import ConvergenceError

NO_REST = "No state of rest was found for the lines"
LEAST_SCALE = 1.0  # [N]


class MooringStart(NamedTuple):
    """The state of rest that a run began with, as far as the scene needs it later."""

    scale: float  # [N] largest tension, for the colours
    stretch: NDArray[np.float64]  # (lines,) over the length
    fault: Fault | None
    failure: str  # reason why no state of rest was found, or ""; then nothing moves

    @classmethod
    def of(cls, rest: Rest, stretch: NDArray[np.float64], fault: Fault | None, failure: str) -> "MooringStart":
        """Make the start from a state of rest. A failure is the fault if there is no other."""
        scale = max(float(max(tension.max() for tension in rest.tension.values())), LEAST_SCALE)
        if fault is None and failure:
            fault = Fault(failure, NO_REST, "length", None, True)
        return cls(scale, stretch, fault, failure)


def rest_or_start(system: System) -> tuple[Rest, str]:
    """The state of rest in still water: a current would carry away lines on the bed, which only friction holds.

    If none is found, the shape that the search begins with, and the reason: the panel stays, and nothing moves.
    """
    still = dataclasses.replace(system, current=(0.0, 0.0, 0.0))
    try:
        return at_rest(still), ""
    except ConvergenceError as error:
        reason = f"{NO_REST} ({error}). Change their length, their anchors or EA."
        return rest_of(still, straight(still), still.kernel_view(1.0)), reason
