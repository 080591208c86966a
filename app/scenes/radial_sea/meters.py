"""Meters on the floating bodies: drafts, heave, stains of oil, and mean upward forces."""

import numpy as np
from numpy.typing import NDArray

from sim.floating import Fleet, HeaveMeter
from sim.floating.motion.heave_meter import WindowMean
from sim.floating.motion.rotation import body_z_axes
from sim.ocean.any_sea import SurfaceAt

MIN_COSINE = 0.2  # of the angle between a body's axis and the normal of the water, where drafts still mean something
UPWARD_FORCES = 4  # buoyancy, waves, drag, and what the motion through the water meets


class BodyMeters:
    """Numbers that are measured on n bodies as they float."""

    def __init__(self, keel: NDArray[np.float64], is_round: NDArray[np.bool_]) -> None:
        """keel: (n,) [m] height of the lowest point over the centre, negative. is_round: (n,) of spheres."""
        self.keel, self.is_round = keel, is_round
        self.draft, self.stain = np.zeros((2, len(keel)))  # [m]; above the lowest point to which oil has wetted a body
        self.restart()

    def restart(self) -> None:
        """Restart all means and periods."""
        self.heave, self.lift = HeaveMeter(len(self.keel)), WindowMean(len(self.keel), UPWARD_FORCES)

    def restart_of(self, i: int) -> None:
        """Restart those of body i."""
        self.heave.restart(i)
        self.lift.restart(i)

    def measure(self, fleet: Fleet, t: float, at: SurfaceAt, duration: float, lead: float = 0.0) -> None:
        """Measure drafts at time t [s]: the length of each body below the plane of the water, along its own axis.

        lead [s]: from that time to the time of the surface `at` the bodies.
        That length, times the area of the cross-section, is the wet volume of a hull with straight sides, however it
        leans. Of a sphere every diameter is an axis; it is measured along the normal of the water.
        """
        normal = np.column_stack([-at.slope, np.ones(len(self.keel))])
        normal /= np.sqrt((normal * normal).sum(axis=1, keepdims=True))
        up = np.where(self.is_round[:, None], normal, body_z_axes(fleet.rotation))
        keel = self.keel[:, None] * up  # from a body's centre
        rise = at.velocity[:, 2] - (at.velocity[:, :2] * at.slope).sum(axis=1)
        keel[:, 2] += fleet.position[:, 2] - (at.height - lead * rise)
        lean = np.maximum((normal * up).sum(axis=1), MIN_COSINE)
        self.draft[:] = -(normal * keel).sum(axis=1) / lean
        self.heave.update(t, self.draft, duration)

    def wet_with_oil(self, oiled: NDArray[np.bool_]) -> None:
        """Stain the bodies (n,) that oil wets up to their drafts."""
        np.maximum(self.stain, np.where(oiled, self.draft, 0.0), out=self.stain)
