"""The fluids as the bodies feel them during one frame: a tilted, rising plane per body, or heights per vertex.

Each body sees the surface as the plane through `height` above `at`, with `slope`, moving with the fluid velocity
there. A hull large beside the waves adds `relief`, the surface above that plane at each of its vertices. The
interface between an upper and a lower fluid is given in the same way; one fluid is two of the same density.
"""

from typing import NamedTuple

import numpy as np

from sim.floating.motion.body import Fleet, check_fleet
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers, density_steps
from sim.records import equal_to_itself
from sim.validation import argument_error, as_array, check_number


@equal_to_itself
class FluidState(NamedTuple):
    """Surface and interface for n bodies. Made by `make_water` or `still_water`."""

    upper: float  # [kg/m3]
    lower: float  # [kg/m3]
    at: np.ndarray  # (n, 2) [m] where the surface was sampled, as a rule the bodies' positions
    height: np.ndarray  # (n,) [m] of the surface there
    slope: np.ndarray  # (n, 2)
    velocity: np.ndarray  # (n, 3) [m/s] of the fluid at the surface
    acceleration: np.ndarray  # (n,) [m/s2] of the fluid at the surface, upwards
    interface: np.ndarray  # (n,) [m] height
    interface_slope: np.ndarray  # (n, 2)
    interface_rise: np.ndarray  # (n,) [m/s]
    relief: np.ndarray  # (0,), or per vertex of each body in turn [m]: surface above its body's plane
    interface_relief: np.ndarray  # (0,) or the same of the interface [m]
    excitation: np.ndarray  # (0, 6), or (n, 6) [m3, m4 times m/s2]: wave force beyond the pressure of the plane
    yaw: np.ndarray  # (n,) [m4 times m/s2] moment of waves about the vertical axis, where no excitation is given
    lead: float  # [s] from the beginning of the step to the time of all these values


def make_water(
    fleet: Fleet,
    layers: Layers,
    height: np.ndarray,
    *,
    slope: np.ndarray | None = None,
    velocity: np.ndarray | None = None,
    acceleration: np.ndarray | None = None,
    interface: np.ndarray | None = None,
    interface_slope: np.ndarray | None = None,
    interface_rise: np.ndarray | None = None,
    relief: np.ndarray | None = None,
    interface_relief: np.ndarray | None = None,
    excitation: np.ndarray | None = None,
    yaw: np.ndarray | None = None,
    lead: float = 0.0,
) -> FluidState:
    """The water around a fleet from its values at the bodies' positions, of the shapes and units of `FluidState`.

    layers: one or two (density, thickness) pairs as in `equilibrium_draft`. By default the fluids are still and level,
    and the interface follows the surface at the thickness of the upper layer (its slope and rise too).
    Give acceleration if it is known: with it a small hull follows a wave exactly; without it the relative error is
    (frequency of the wave over that of heave)^2. excitation: from `WaveExcitation`, where the surface is a sum of
    waves: what diffraction, the decay of pressure with depth and the length of the hull add to the pressure of the
    plane. Without it that is the mass displaced and the added mass times the fluid's acceleration, as in waves long
    beside the hull, and the moment `yaw` of their twist. lead [s]: how long after the beginning of the step the values
    hold; half of the step is best.
    Raises ValueError for bad layers or shapes; values are checked by `step`.
    """
    check_fleet(fleet)
    n = len(fleet.mass)
    layers = check_layers(layers)
    steps = density_steps(layers)
    if len(steps) > 2:
        raise argument_error("layers", layers, "one or two layers")
    thickness = steps[-1][1]

    def field(name: str, value: np.ndarray | None, shape: tuple[int, ...], otherwise: np.ndarray | float) -> np.ndarray:
        if value is None:
            return np.full(shape, otherwise, dtype=float)
        array = np.ascontiguousarray(as_array(name, value, f"numbers of shape {shape}"))
        if array.shape != shape:
            raise argument_error(name, array.shape, f"an array of shape {shape}")
        return array

    eta = field("height", height, (n,), 0.0)
    tilt = field("slope", slope, (n, 2), 0.0)
    flow = field("velocity", velocity, (n, 3), 0.0)
    rise = flow[:, 2] - (flow[:, :2] * tilt).sum(axis=1)
    many = int(fleet.vertex_start[-1])
    bumps = (0,) if relief is None else (many,)
    interface_bumps = (0,) if interface_relief is None else (many,)
    return FluidState(
        upper=float(layers[0][0]),
        lower=float(layers[-1][0]),
        at=np.ascontiguousarray(fleet.position[:, :2]).copy(),
        height=eta,
        slope=tilt,
        velocity=flow,
        acceleration=field("acceleration", acceleration, (n,), 0.0),
        interface=field("interface", interface, (n,), eta - thickness),
        interface_slope=field("interface_slope", interface_slope, (n, 2), tilt if interface is None else 0.0),
        interface_rise=field("interface_rise", interface_rise, (n,), rise if interface is None else 0.0),
        relief=field("relief", relief, bumps, 0.0),
        interface_relief=field("interface_relief", interface_relief, interface_bumps, 0.0),
        excitation=field("excitation", excitation, (0, 6) if excitation is None else (n, 6), 0.0),
        yaw=field("yaw", yaw, (n,), 0.0),
        lead=check_number("lead", lead, "s"),
    )


def still_water(fleet: Fleet, layers: Layers = SEA_WATER, level: float = 0.0) -> FluidState:
    """Level water at rest, its surface at `level` [m]. Raises ValueError for bad layers."""
    check_fleet(fleet)
    return make_water(fleet, layers, np.full(len(fleet.mass), check_number("level", level, "m")))
