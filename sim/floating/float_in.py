"""Bodies in a sea for a time: the loop of water, wave forces and `step`, with the frames kept.

>>> from sim.floating import Body, Hull
>>> from sim.ocean import Sea
>>> sea = Sea(64, 128.0, "regular", wave_height=0.5, wave_period=6.0, wind_speed=0.0)
>>> buoy = Body(Hull.cylinder(0.5, 1.0), mass=390.0, center_of_gravity=(0.0, 0.0, -0.25))
>>> run = float_in(sea, [buoy.afloat()], duration=10.0, frames=101)
>>> run.x.shape, run.lift.shape
((101, 1, 3), (101, 1, 4))
"""

import math
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim.floating.body import Body, make_fleet
from sim.floating.equilibrium import Layers, check_layers
from sim.floating.excitation import LAST_RATES, WaveExcitation, rate_of_change
from sim.floating.fluid_state import make_water
from sim.floating.hydrodynamics import check_water_depth
from sim.floating.motion import STANDARD, MotionCoefficients, step
from sim.floating.stability import Loaded, is_stable, near_upright
from sim.interruption import raise_if_stopped
from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea
from sim.ocean.radial import RadialSea, SurfaceAt
from sim.validation import argument_error, check_kind, check_positive, is_whole_number

LONGEST_STEP = 1 / 60  # [s]


class FloatRun(NamedTuple):
    """n bodies at frames of equal spacing."""

    t: np.ndarray  # (frames,) [s]
    x: np.ndarray  # (frames, n, 3) [m] of the centres of gravity
    rotation: np.ndarray  # (frames, n, 4) quaternions (w, x, y, z) from body to world
    velocity: np.ndarray  # (frames, n, 3) [m/s]
    spin: np.ndarray  # (frames, n, 3) [rad/s] in world axes
    # (frames, n, 4) [N] upward: buoyancy, waves, drag, and the reaction to the motion, mean over the last step
    lift: np.ndarray
    surface: np.ndarray  # (frames, n) [m] height of the water at the bodies, in the middle of the last step


def float_in(
    sea: Sea | NonlinearSea | RadialSea,
    bodies: Sequence[Body],
    duration: float,
    frames: int = 61,
    coefficients: MotionCoefficients = STANDARD,
) -> FloatRun:
    """Let bodies float in a sea from its time 0 for a duration [s]; `Body.afloat` lets them begin at rest.

    On a sum of waves they feel linear wave forces; on the tiles those of waves long beside the hull (motion.py). The
    gravity is the sea's. A step is 1/60 s, or shorter to divide the frames. A UserWarning gives the GM of a body that
    is not stable upright. Raises ValueError for a value that is not allowed, for a hull with a dataset of another depth
    or heading than the sea's, and as `make_fleet`, `RadialSea.at` and `step`.
    """
    check_kind("sea", sea, Sea | NonlinearSea | RadialSea, "a Sea, a NonlinearSea or a RadialSea")
    check_kind("coefficients", coefficients, MotionCoefficients, "MotionCoefficients")
    duration = check_positive("duration", duration, "s")
    if not is_whole_number(frames) or frames < 2:
        raise argument_error("frames", frames, "a whole number from 2")
    layers = layers_of(sea)
    gravity = sea.column.gravity if isinstance(sea, RadialSea) else sea.conditions.gravity
    coefficients = coefficients._replace(gravity=gravity)
    fleet = make_fleet(bodies, layers)
    for i, body in enumerate(bodies):
        check_water_depth(f"bodies[{i}]", body.hull, sea.conditions.depth if isinstance(sea, Sea) else math.inf)
    for words in unstable(bodies, layers):
        warnings.warn(words, UserWarning, stacklevel=2)
    widths = np.array([math.sqrt(float(body.hull.size[0] * body.hull.size[1])) for body in bodies])
    excitation = WaveExcitation(bodies, widths, layers) if isinstance(sea, RadialSea) else None
    each = math.ceil(duration / (frames - 1) / LONGEST_STEP * (1.0 - 1e-9))
    h, n = duration / (frames - 1) / each, len(fleet.mass)
    shown = (fleet.position, fleet.rotation, fleet.velocity, fleet.spin, fleet.lift)
    kept = [np.empty((frames, *array.shape)) for array in shown]
    surface, rises = np.empty((frames, n)), ()
    surface[0] = sea.at(fleet.position[:, :2], 0.0, widths).height if n else 0.0
    for frame in range(frames):
        for out, array in zip(kept, shown, strict=True):
            out[frame] = array
        if frame == frames - 1 or n == 0:
            continue
        for i in range(each):
            raise_if_stopped()
            middle = (frame * each + i + 0.5) * h
            at = sea.at(fleet.position[:, :2], middle, widths)
            forces, acceleration = None, at.acceleration
            if isinstance(sea, RadialSea) and excitation is not None:
                forces = excitation.forces(fleet, at.label, sea.waves_at(middle), middle, h)
            else:  # along the way of the bodies, so that it has no mean (excitation.py)
                rises = (at.velocity[:, 2].copy(), *rises[: len(LAST_RATES)])
                if len(rises) > len(LAST_RATES):
                    acceleration = np.clip(rate_of_change(rises, h), -gravity, gravity)
            interface = {} if len(layers) == 1 else interface_of(at, layers[0][1])
            water = make_water(
                fleet, layers, at.height, slope=at.slope, velocity=at.velocity, acceleration=acceleration,
                excitation=forces, lead=h / 2, **interface,
            )  # fmt: skip
            step(fleet, water, h, coefficients)
            surface[frame + 1] = at.height
    x, rotation, velocity, spin, lift = kept
    return FloatRun(np.linspace(0.0, duration, frames), x, rotation, velocity, spin, lift, surface)


def unstable(bodies: Sequence[Body], layers: Layers) -> list[str]:
    """A sentence with the GM of each load of a hull that floats, but is not stable upright."""
    fluids, found = check_layers(layers), {}
    for i, body in enumerate(bodies):
        load = body.loaded()
        if load in found or load[1] > fluids[-1][0]:
            continue
        found[load], rest = "", near_upright(Loaded(*load, fluids))
        if rest is not None and not is_stable(load[0], rest):
            found[load] = f"bodies[{i}]: GM = {rest.least_height:.3g} m: it is not stable upright"
    return [words for words in found.values() if words]


def layers_of(sea: Sea | NonlinearSea | RadialSea) -> Layers:
    """(density [kg/m3], thickness [m]) of the fluids of a sea, from the top."""
    return sea.column.layers if isinstance(sea, RadialSea) else ((sea.conditions.density, math.inf),)


def interface_of(at: SurfaceAt, thickness: float) -> dict[str, np.ndarray]:
    """The interface under a layer [m], as `make_water` takes it, of a `SurfaceAt`."""
    return {
        "interface": at.interface - thickness,
        "interface_slope": at.interface_slope,
        "interface_rise": at.interface_rise,
    }
