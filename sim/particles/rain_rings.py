"""Rings that raindrops make on water: how many a second, and the wave that they begin with.

A drop excites waves of all lengths. The slowest are those where gravity and tension pull equally:
k = sqrt(rho g/sigma), c = (4 g sigma/rho)^(1/4) (Lamb, Hydrodynamics, Art. 267). Their group is as fast as they are, so
that they spread as one ring about still water.
"""

import math
from typing import NamedTuple

from sim.particles.rain import drop_sizes, terminal_speed
from sim.validation import check_positive
from sim.water import EARTH_GRAVITY, SEA_DENSITY

SMALLEST_RING_DROP = 2e-3  # [m] drops below it make rings too low to be seen


class RingWave(NamedTuple):
    """The wave of a ring."""

    length: float  # [m]
    speed: float  # [m/s]


def ring_wave(gravity: float, tension: float = 0.0728, density: float = SEA_DENSITY) -> RingWave:
    """The slowest wave on deep fluid; gravity [m/s2], tension [N/m], density [kg/m3], that of sea water.

    Raises ValueError if one is not above 0.
    """
    check_positive("gravity", gravity, "m/s2")
    check_positive("tension", tension, "N/m")
    check_positive("density", density, "kg/m3")
    return RingWave(
        2.0 * math.pi * math.sqrt(tension / (density * gravity)), (4.0 * gravity * tension / density) ** 0.25
    )


def ring_flux(rate: float, gravity: float = EARTH_GRAVITY) -> float:
    """Drops that make a ring, of SMALLEST_RING_DROP and above, for each square metre and second [1/(m2 s)].

    rate [mm/h]; gravity [m/s2]. Raises ValueError if one is not above 0.
    """
    check_positive("rate", rate, "mm/h")
    check_positive("gravity", gravity, "m/s2")
    D, N, step = drop_sizes(rate, gravity)
    return float((N * terminal_speed(D, gravity) * step)[D >= SMALLEST_RING_DROP].sum())
