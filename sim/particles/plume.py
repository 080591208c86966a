"""The plume of a fire: speed and temperature on its axis, its rise in the wind, and the path of its gas.

In still air McCaffrey's three regimes (1979, NBSIR 79-1910): with q = Q^(2/5), Q in kW, z in m,

    w = kappa (z/q)^eta Q^(1/5),    dT = (kappa/(0.9 sqrt(2 g)))^2 (z/q)^(2 eta - 1) T0.

In wind a plume bends over, and rises by Briggs's two-thirds law (1984, Atmospheric Science and Power Production, 8.97):

    z = 1.6 F^(1/3) x^(2/3)/u,    F = g Qc/(pi rho cp T0),    r = 0.6 z.

The turbulence of the wind widens it too, by Briggs's curves for neutral air over open country (1973, ATDL 79):

    sy = 0.08 x/sqrt(1 + 0.0001 x),    sz = 0.06 x/sqrt(1 + 0.0015 x).

The time for each metre is the sum of the times of both laws, the second from the height of the flame on. From there the
plume widens by 0.15 of its rise in still air (Morton, Taylor and Turner 1956) and by Briggs's 0.6 when bent over. The
square of 2 sqrt(sy sz) is added to the square of that radius, because a disc of even density is twice as wide as its
standard deviation. Gas is as hot as in still air after the same path length.
Limits: neutral air; nearer than 119 F^(2/5) [m], where Briggs's plume stops rising.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.validation import check_number, check_positive
from sim.water import EARTH_GRAVITY

AIR_TEMPERATURE, AIR_DENSITY, AIR_HEAT = 293.0, 1.2, 1005.0  # [K], [kg/m3], [J/(kg K)]
RADIATED_SHARE = 0.3  # of the power of a fire of hydrocarbons; the rest heats the plume
# Upper end in z/q of flame, intermittent flame and plume; kappa and eta in each.
REGIME_ENDS = (0.08, 0.2)
KAPPA = np.array([6.8, 1.9, 1.1])
ETA = np.array([0.5, 0.0, -1.0 / 3.0])
STILL_WIDENING, BENT_WIDENING = 0.15, 0.6  # of the radius over the rise
SIDE_SPREAD, HEIGHT_SPREAD = (0.08, 1e-4), (0.06, 1.5e-3)  # sy, sz over the distance; 1/[m] at which they slow down
DRAG_TIME = 1.2  # [s] in which gas is dragged to the speed of the wind
SOOT_SHARE = 0.1  # kg of soot for each kg of crude that burns (Mulholland et al. 1989, Fire Saf. Sci. 2:347)
SOOT_EXTINCTION = 8700.0  # [m2/kg] of light by soot (Mulholland and Croarkin 2000, Fire Mater. 24:227)
COMBUSTION_HEAT = 42e6  # [J/kg] of crude
TRACK_POINTS = 512


def flame_height(power: float, diameter: float) -> float:
    """L [m] = 0.235 Q^(2/5) - 1.02 D, Q in kW (Heskestad 1983, Fire Saf. J. 5:103); at least the radius.

    power [W], diameter [m] of the fire. Raises ValueError if either is not above 0.
    """
    check_positive("power", power, "W")
    check_positive("diameter", diameter, "m")
    return max(0.235 * (power / 1e3) ** 0.4 - 1.02 * diameter, 0.5 * diameter)


def centreline(height: ArrayLike, power: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(speed [m/s], temperature over the air's [K]) at heights > 0 [m] above a fire of this power [W], in still air.

    Raises ValueError if the power is not above 0.
    """
    kilowatts = check_positive("power", power, "W") / 1e3
    z = np.asarray(height, float) / kilowatts**0.4
    regime = np.searchsorted(REGIME_ENDS, z)
    kappa, eta = KAPPA[regime], ETA[regime]
    speed = kappa * z**eta * kilowatts**0.2
    return speed, (kappa / (0.9 * math.sqrt(2.0 * EARTH_GRAVITY))) ** 2 * z ** (2.0 * eta - 1.0) * AIR_TEMPERATURE


def buoyancy_flux(power: float) -> float:
    """F [m4/s3] of a fire of this power [W]. Raises ValueError if it is not above 0."""
    heat = (1.0 - RADIATED_SHARE) * check_positive("power", power, "W")
    return EARTH_GRAVITY * heat / (math.pi * AIR_DENSITY * AIR_HEAT * AIR_TEMPERATURE)


def turbulent_radius(distance: ArrayLike) -> NDArray[np.float64]:
    """Radius [m] by which the wind's turbulence alone widens smoke at distances [m] downwind."""
    x = np.asarray(distance, float)
    sides = (share * x / np.sqrt(1.0 + slowing * x) for share, slowing in (SIDE_SPREAD, HEIGHT_SPREAD))
    return 2.0 * np.sqrt(math.prod(sides))


def soot_made(power: float) -> float:
    """Area [m2/s] by which the soot of a fire of this power [W] would darken, if no part hid another."""
    return SOOT_EXTINCTION * SOOT_SHARE * check_positive("power", power, "W") / COMBUSTION_HEAT


class Track(NamedTuple):
    """Path of the gas on the axis of a plume, at equal steps of its age; arrays (TRACK_POINTS,) float32."""

    step: float  # [s]
    height: NDArray[np.float32]  # [m] above the fire
    radius: NDArray[np.float32]  # [m] of the plume
    heat: NDArray[np.float32]  # temperature over the air's, as a fraction of that in the flame


def track(power: float, diameter: float, wind_speed: float, duration: float) -> Track:
    """Path of the gas of a fire of this power [W] and diameter [m] for `duration` [s]; wind [m/s].

    Raises ValueError for a value that is not allowed.
    """
    length = flame_height(power, diameter)
    check_number("wind_speed", wind_speed, "m/s", 0.0)
    check_positive("duration", duration, "s")
    # Time over height: 1/w is integrated from where the flame's law, z = (kappa/2)^2 t^2, gives the time itself.
    z = np.geomspace(1e-3, 30.0 * length + 60.0 * duration, 4000)
    speed = centreline(z, power)[0]
    slowness, above = 1.0 / speed, 1.0 - np.exp(-((z / length) ** 2))  # above: the flame, 0 to 1
    if wind_speed > 0.0:
        # z = A t^(2/3) takes 1.5 A^(-3/2) sqrt(z) for each metre at z.
        rise = 1.6 * (buoyancy_flux(power) / wind_speed) ** (1.0 / 3.0)
        slowness = slowness + 1.5 * rise**-1.5 * np.sqrt(z) * above
    bent = 1.0 - 1.0 / (slowness * speed)
    widening = (STILL_WIDENING + (BENT_WIDENING - STILL_WIDENING) * bent) * above
    steps = np.diff(z)
    time = 2.0 * math.sqrt(z[0]) / KAPPA[0] + np.append(0.0, np.cumsum(0.5 * steps * (slowness[1:] + slowness[:-1])))
    radius = 0.5 * diameter + np.append(0.0, np.cumsum(0.5 * steps * (widening[1:] + widening[:-1])))
    age = np.linspace(0.0, duration, TRACK_POINTS)
    # Along the wind by the closed form of drag.
    lag = DRAG_TIME * -np.expm1(-time / DRAG_TIME)
    distance = wind_speed * (time - lag)
    radius = np.hypot(radius, turbulent_radius(distance))
    way = z[0] + np.append(0.0, np.cumsum(np.hypot(steps, np.diff(distance))))
    temperature = centreline(way, power)[1]
    hottest = float(centreline(1e-3, power)[1])
    height = np.where(age < time[0], (0.5 * KAPPA[0] * age) ** 2, np.interp(age, time, z))
    values = (height, np.interp(age, time, radius), np.interp(age, time, temperature) / hottest)
    return Track(float(age[1]), *(np.ascontiguousarray(value, np.float32) for value in values))


def radiated_light(power: float) -> float:
    """Radiant intensity [W/sr] of a fire of this power [W], the same in all directions."""
    return RADIATED_SHARE * check_positive("power", power, "W") / (4.0 * math.pi)
