"""A slick of oil on clean water: how it spreads by Fay's regimes, how it drifts, and how it calms the waves under it.

Source of spreading: J. A. Fay, Physical processes in the spread of oil on a water surface (1971), Int. Oil Spill Conf.
Proc. 463-467: R = 1.14 (D g V t^2)^(1/4) while inertia holds oil back, 1.45 (D g V^2 t^(3/2)/nu^(1/2))^(1/6) when the
viscosity nu of the water does, and 2.30 (s^2 t^3/(rho^2 nu))^(1/4) once surface tension, s, pulls more than the weight
pushes; D = 1 - rho_oil/rho_water. It ends at an area of 1e5 V^(3/4), SI units. Stated for a volume spilled at once;
used here with what has been spilled so far.

Waves that run under a slick lose amplitude at its decay rate for the time that they need, at their group speed: a wave
that has come a length L through it has e^(-(gamma - gamma_clean) L/c_g) of its amplitude left, beyond it too.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.ocean.dispersion import group_speed
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import Fluid
from sim.validation import argument_error, check_number, check_positive
from sim.water import EARTH_GRAVITY, SEA_DENSITY

INERTIAL, VISCOUS, TENSION = 1.14, 1.45, 2.30
FINAL_AREA = 1e5  # [m^(-1/4)] over V^(3/4)


def spreading_coefficient(oil: Fluid, water: Fluid) -> float:
    """Tension of the water less those of the oil, against air and water [N/m], at least 0; 0 where one is not known."""
    if water.surface_tension is None or oil.surface_tension is None or oil.interface_tension is None:
        return 0.0
    return max(water.surface_tension - oil.surface_tension - oil.interface_tension, 0.0)


def slick_radius(
    volume: float,
    time: float,
    oil: float,
    water: float = SEA_DENSITY,
    viscosity: float = 1.19e-6,
    gravity: float = EARTH_GRAVITY,
    spreading: float = 0.0,
) -> float:
    """Radius [m] of `volume` [m3] of oil after `time` [s]; oil, water [kg/m3]; viscosity of the water [m2/s].

    spreading: coefficient [N/m], see `spreading_coefficient`. Raises ValueError for a negative volume, time or
    coefficient, an oil that is not lighter than the water, or a viscosity or gravity that is not above 0.
    """
    check_positive("viscosity", viscosity, "m2/s")
    check_positive("gravity", gravity, "m/s2")
    check_number("volume", volume, "m3", 0.0)
    check_number("time", time, "s", 0.0)
    check_number("spreading", spreading, "N/m", 0.0)
    if not 0.0 < oil < water:
        raise argument_error("oil", oil, f"above 0 and below the water's {water:g} kg/m3")
    lift = (1.0 - oil / water) * gravity
    inertial = INERTIAL * (lift * volume * time**2) ** 0.25
    viscous = VISCOUS * (lift * volume**2 * time**1.5 / math.sqrt(viscosity)) ** (1.0 / 6.0)
    tension = TENSION * (spreading**2 * time**3 / (water**2 * viscosity)) ** 0.25
    # Of two forces that spread the oil the stronger counts, of two that hold it back the stronger one, too.
    final = math.sqrt(FINAL_AREA * volume**0.75 / math.pi)
    return min(max(min(inertial, viscous), tension), final)


def slick_thickness(volume: float, radius: float) -> float:
    """V/(pi R^2) [m]; 0 where nothing is spilled."""
    return volume / (math.pi * radius**2) if radius > 0.0 else 0.0


class SlickCover(NamedTuple):
    """A round slick as waves meet it."""

    centre: tuple[float, float]  # [m]
    radius: float  # [m]
    column: FluidColumn  # the fluids inside it

    def attenuation(self, k: NDArray[np.float64], outside: FluidColumn) -> NDArray[np.float64]:
        """Loss [1/m] of waves of wavenumber k [rad/m] for each metre under the slick, beyond that outside of it."""
        excess = np.maximum(self.column.roots(k)[1] - outside.roots(k)[1], 0.0)
        top = outside.surface
        return excess / group_speed(k, outside.gravity, math.inf, top.surface_tension or 0.0, top.density)

    def paths(
        self, points: NDArray[np.float64], kx: NDArray[np.float64], ky: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Lengths (n, waves) [m] that waves (kx, ky) have come under the slick when they reach points (n, 2) [m]."""
        offset, direction = points - self.centre, np.stack([kx, ky]) / np.hypot(kx, ky)
        along, across = offset @ direction, offset @ np.stack([direction[1], -direction[0]])
        half = np.sqrt(np.maximum(self.radius**2 - across * across, 0.0))
        return np.minimum(np.maximum(along + half, 0.0), 2.0 * half)
