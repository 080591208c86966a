"""The mooring lines of the floating bodies, and how hard they pull."""

import numpy as np
from numpy.typing import NDArray

from sim.floating import Fleet, Hull
from sim.floating.motion.mooring_lines import fairleads, just_taut, pulls

BED_DEPTH = 60.0  # [m] of the anchors, and of what has sunk
LINE_REACH = 180.0  # [m] from a body to its anchors, level
LINE_STIFFNESS = 8e3  # [N] EA of a line, per m3 of its body: an elastic rope, by which bodies surge slower than waves


class BodyMoorings:
    """Four lines from each body to the bed, which do not pull at its rest position."""

    def __init__(self, places: NDArray[np.float64], drafts: NDArray[np.float64], hulls: list[Hull]) -> None:
        """places: (n, 2) [m] where the bodies are held. drafts: (n,) [m] at rest."""
        self.tension = np.zeros((len(hulls), 4))  # [N] of each line
        self.tie(places, drafts, hulls)

    def tie(self, places: NDArray[np.float64], drafts: NDArray[np.float64], hulls: list[Hull]) -> None:
        """Tie the bodies again."""
        keel, volume = (np.array(values) for values in ([h.extents[2, 0] for h in hulls], [h.volume for h in hulls]))
        rest = np.column_stack([places, -drafts])
        self.lines = just_taut(rest, keel, LINE_STIFFNESS * volume, BED_DEPTH, LINE_REACH)

    @property
    def places(self) -> NDArray[np.float64]:
        """Places (n, 2) [m] of rest of the bodies."""
        return self.lines.anchors.mean(axis=1)[:, :2]

    def pull(self, fleet: Fleet, h: float, *, moored: bool) -> None:
        """Pull as in the middle of a step of h [s]: by a body's place before it lines would drive it."""
        if moored:
            place = fleet.position + 0.5 * h * fleet.velocity
            fleet.mooring[:], self.tension = pulls(self.lines, place, fleet.rotation)
        else:
            fleet.mooring[:] = self.tension[:] = 0.0

    def fairleads(self, fleet: Fleet, *, moored: bool) -> NDArray[np.float32]:
        """Fairleads (n, 3) [m] of the bodies; (0, 3) without lines."""
        if not moored:
            return np.empty((0, 3), np.float32)
        return fairleads(self.lines, fleet.position, fleet.rotation).astype(np.float32)
