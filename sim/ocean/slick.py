"""How a spill of oil spreads on calm water: Fay's regimes, and the thickness that follows from the volume.

Source: J. A. Fay, Physical processes in the spread of oil on a water surface (1971), Int. Oil FluidColumn Conf. Proc.
463-467: R = 1.14 (D g V t^2)^(1/4) while inertia holds oil back, 1.45 (D g V^2 t^(3/2)/nu^(1/2))^(1/6) when the
viscosity nu of the water does; D = 1 - rho_oil/rho_water. The slower of the two is in force. The third regime, surface
tension, takes over at thicknesses of a tenth of a millimetre and is left out. Stated for a volume spilt at once; used
here with what has been spilt so far.
"""

import math

from sim.validation import argument_error, check_not_negative, check_positive

INERTIAL, VISCOUS = 1.14, 1.45


def slick_radius(
    volume: float, time: float, oil: float, water: float = 1025.0, viscosity: float = 1.19e-6, gravity: float = 9.81
) -> float:
    """Radius [m] of `volume` [m3] of oil after `time` [s]; oil, water [kg/m3]; viscosity of the water [m2/s].

    Raises ValueError for a negative volume or time, an oil that is not lighter than the water, or a viscosity or
    gravity that is not above 0.
    """
    check_positive("viscosity", viscosity, "m2/s")
    check_positive("gravity", gravity, "m/s2")
    check_not_negative("volume", volume, "m3")
    check_not_negative("time", time, "s")
    if not 0.0 < oil < water:
        raise argument_error("oil", oil, f"above 0 and below the water's {water:g} kg/m3")
    lift = (1.0 - oil / water) * gravity
    inertial = INERTIAL * (lift * volume * time**2) ** 0.25
    viscous = VISCOUS * (lift * volume**2 * time**1.5 / math.sqrt(viscosity)) ** (1.0 / 6.0)
    return min(inertial, viscous)


def slick_thickness(volume: float, radius: float) -> float:
    """V/(pi R^2) [m]; 0 where nothing is spilt."""
    return volume / (math.pi * radius**2) if radius > 0.0 else 0.0
