"""Steps of bodies on a sea: the water at them, the forces of waves, and `step`. `FloatState` and scenes take them."""

import copy
import functools
from collections.abc import Sequence

import numpy as np

from sim.floating.linear.excitation import LAST_RATES, WaveExcitation, rate_of_change
from sim.floating.motion.body import Body, Fleet
from sim.floating.motion.fluid_state import make_water
from sim.floating.motion.motion import MotionCoefficients, step
from sim.floating.statics.equilibrium import Layers
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
        forces, acceleration = None, at.acceleration
        if sea.is_sum_of_waves:
            self.rises = ()
            forces = self.excitation.forces(fleet, at.label, sea.waves_at(middle), middle, h)
        else:  # along the way of the bodies, so that it has no mean (excitation.py)
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
            excitation=forces, lead=h / 2, **interface,
        )  # fmt: skip
        step(fleet, water, h, coefficients)
