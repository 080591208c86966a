"""The state that a mooring starts with."""

import dataclasses
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.mooring.rows import LineRows
from app.scenes.mooring.start_check import Fault
from sim.mooring import System, at_rest
from sim.mooring.rest.statics import Rest, rest_of, straight
from sim.validation import ConvergenceError

NO_REST = "No state of rest was found for the lines"
LEAST_SCALE = 1.0  # [N]
# Of lines and places at rest, beyond which a run has diverged. Drag bounds positions where steps are not far too long,
# and nylon breaks at half of the strain.
FARTHEST, MAX_STRAIN = 5.0, 1.0


class MooringStart(NamedTuple):
    """The state of rest that a run began with, as far as the scene needs it later."""

    scale: float  # [N] largest tension, for the colours
    stretch: NDArray[np.float64]  # (lines,) over the length
    fault: Fault | None
    failure: str  # reason why no state of rest was found, or ""; then nothing moves
    farthest: float  # [m] largest coordinate of a state that has not diverged
    largest_strain: float  # of a piece in such a state

    @classmethod
    def of(cls, rest: Rest, rows: LineRows, fault: Fault | None, failure: str) -> "MooringStart":
        """Make the start from a state of rest. A failure is the fault if there is no other."""
        scale = max(float(max(tension.max() for tension in rest.tension.values())), LEAST_SCALE)
        if fault is None and failure:
            fault = Fault(failure, NO_REST, "length", None, True)
        farthest = FARTHEST * float(rows.lengths.sum() + np.abs(rest.nodes).max())
        largest_strain = MAX_STRAIN + max(rows.largest_strain(rest.nodes), 0.0)
        return cls(scale, rows.stretch(rest.nodes), fault, failure, farthest, largest_strain)

    def is_bounded(self, x: NDArray[np.float64], rows: LineRows) -> bool:
        """False for a state x (3, nodes) [m] that is not finite, or beyond the reach or strain of any line."""
        return bool(np.abs(x).max() < self.farthest) and rows.largest_strain(x) < self.largest_strain


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
