"""Anchors and fairleads, which a user drags."""

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.mooring.arrangement import Places, first_places
from app.scenes.mooring.parameters import MooringParams
from app.scenes.springs.tracking import CriticallyDampedTracker

# Largest speeds of what is dragged, so that no line snaps by it: in distances of anchors and sizes of the body [1/s].
ANCHOR_SPEED, FAIRLEAD_SPEED = 0.02, 0.1


class Attachments:
    """The ends of all lines, with their places and the targets of drags."""

    def __init__(self, params: MooringParams) -> None:
        anchors, fairleads = first_places(params)
        self.anchors = tuple(CriticallyDampedTracker(place, ANCHOR_SPEED * params.reach) for place in anchors)
        self.fairleads = tuple(CriticallyDampedTracker(place, FAIRLEAD_SPEED * params.size) for place in fairleads)

    @property
    def places(self) -> Places:
        """Their places."""
        return Places(tuple(one.position for one in self.anchors), tuple(one.position for one in self.fairleads))

    @property
    def at_rest(self) -> bool:
        """True if none is moving."""
        return all(one.at_rest for one in (*self.anchors, *self.fairleads))

    def drag(self, thing: str, place: Vector) -> None:
        """Let an end go to a place: "anchor 1" [m], or "fairlead 1" [m] from the body's centre. No other thing does."""
        kind, _, number = thing.partition(" ")
        ends = {"anchor": self.anchors, "fairlead": self.fairleads}.get(kind, ())
        if number.isdecimal() and 1 <= int(number) <= len(ends):
            ends[int(number) - 1].target = place

    def advance(self, t: float, duration: float) -> NDArray[np.float64]:
        """Paths (lines, 5, 3) of the anchors for `duration` [s] from t [s], as `LineArrays` has them.

        Fairleads are moved at once.
        """
        for fairlead in self.fairleads:
            fairlead.advance(t, duration)
        paths = np.zeros((len(self.anchors), 5, 3))
        for q, anchor in enumerate(self.anchors):
            path = anchor.advance(t, duration)
            paths[q, 0], paths[q, 4] = anchor.position, t
            if path is not None:
                paths[q, :4] = path[1]
        return paths
