"""Steps of bodies on a sea: the water at them, the forces of waves, and `step`. `FloatState` and scenes take them."""

import copy
import functools
import math
from collections.abc import Sequence

import numpy as np

from sim.floating.linear.excitation import LAST_RATES, WaveExcitation, rate_of_change
from sim.floating.linear.hydrodynamics import coefficients_afloat
from sim.floating.motion.body import Body, Fleet
from sim.floating.motion.fluid_state import make_water
from sim.floating.motion.motion import MotionCoefficients, step
from sim.floating.motion.rotation import heading_angle
from sim.floating.statics.equilibrium import Layers, check_layers
from sim.ocean.any_sea import AnySea, SurfaceAt

MAX_ACCELERATION = 2.0  # of gravity, of the water; where a sea is exchanged for another it jumps


class SeaSteps:
    """Steps of one fleet, with the rates of its last ones."""

    def __init__(self, bodies: Sequence[Body], widths: np.ndarray, layers: Layers) -> None:
        """bodies, widths and layers as of `WaveExcitation`."""
        self.bodies, self.widths, self.layers = bodies, widths, layers
        self.h = 0.0  # [s] of the last steps
        self.rises: tuple[np.ndarray, ...] = ()  # (n,) [m/s] of the water in the last steps, the newest first

    @functools.cached_property
    def excitation(self) -> WaveExcitation:
        """Wave forces, on a sea that is a sum of waves."""
        return WaveExcitation(self.bodies, self.widths, self.layers)

    @functools.cached_property
    def twists(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) [m5] yaw moments by twist, and (n,) [m] from each body to where it takes the slope, fore and aft."""
        fluids, loads = check_layers(self.layers), [body.loaded() for body in self.bodies]
        share = {load: coefficients_afloat(*load, fluids).linear.long.twist for load in dict.fromkeys(loads)}
        lengths = np.array([float(hull.size[0]) for hull, _ in loads])
        return np.array([share[load] for load in loads]), lengths / math.sqrt(12.0)

    def yaw_moments(self, sea: AnySea, fleet: Fleet, middle: float) -> np.ndarray:
        """(n,) [m4 times m/s2] of the twist of the surface, -g T d2 eta/dx dy along and across each hull.

        The twist is that of the slopes across, at the two points of Gauss' quadrature along the hull: waves shorter
        than the hull turn it less.
        """
        share, reach = self.twists
        moments = np.zeros(len(share))
        turned = np.flatnonzero(share)
        if len(turned):
            angle = np.array([heading_angle(rotation) for rotation in fleet.rotation[turned]])
            along = np.column_stack([np.cos(angle), np.sin(angle)])
            across = np.column_stack([-along[:, 1], along[:, 0]])
            offset, widths = reach[turned, None] * along, np.tile(self.widths[turned], 2)
            ends = np.concatenate([fleet.position[turned, :2] + offset, fleet.position[turned, :2] - offset])
            fore, aft = np.split(sea.at(ends, middle, widths).slope, 2)
            twist = ((fore - aft) * across).sum(axis=1) / (2.0 * reach[turned])
            moments[turned] = -sea.water.gravity * share[turned] * twist
        return moments

    def __deepcopy__(self, memo: object) -> "SeaSteps":
        """An independent copy with the same bodies."""
        other = copy.copy(self)
        if "excitation" in vars(self):
            other.excitation = copy.deepcopy(self.excitation)
        return other

    def step(
        self,
        sea: AnySea,
        fleet: Fleet,
        at: SurfaceAt,
        middle: float,
        h: float,
        coefficients: MotionCoefficients,
        layers: Layers,
        thickness: np.ndarray | float | None = None,
    ) -> None:
        """One step of h [s]. at: the sea at the bodies in the middle [s] of the step.

        layers: as of `make_water`; thickness: of the upper one [m], or (n,) at the bodies; None for a single fluid.
        Raises FloatingPointError as `step`, and ValueError as `WaveExcitation.forces`.
        """
        if h != self.h:  # rates of change are those over equal steps
            self.h, self.rises = h, ()
            if "excitation" in vars(self):
                self.excitation.impulses = ()
        forces, yaw, acceleration = None, None, at.acceleration
        if sea.is_sum_of_waves:
            self.rises = ()
            forces = self.excitation.forces(fleet, at.label, sea.waves_at(middle), middle, h)
        else:  # along the way of the bodies, so that it has no mean (excitation.py)
            yaw = self.yaw_moments(sea, fleet, middle)
            self.rises = (at.velocity[:, 2].copy(), *self.rises[: len(LAST_RATES)])
            if len(self.rises) > len(LAST_RATES):
                most = MAX_ACCELERATION * coefficients.gravity
                acceleration = np.clip(rate_of_change(self.rises, h), -most, most)
        interface = {}
        if thickness is not None:
            interface = {"interface": at.interface - thickness, "interface_slope": at.interface_slope,
                         "interface_rise": at.interface_rise}  # fmt: skip
        water = make_water(
            fleet, layers, at.height, slope=at.slope, velocity=at.velocity, acceleration=acceleration,
            excitation=forces, yaw=yaw, lead=h / 2, **interface,
        )  # fmt: skip
        step(fleet, water, h, coefficients)
