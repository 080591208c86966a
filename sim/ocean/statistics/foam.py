"""Foam where the displaced surface is most compressed: the Jacobian below which the measured fraction of a sea is foam.

The law of the covered fraction was measured on the seas of the Earth. Where short waves are damped, fewer waves break:
the fraction is multiplied by the remaining ratio of the mean square slope (`Sea.slope_left`).

The Jacobian J is 1 + Dxx + Dyy to first order, and Dxx + Dyy is Gaussian with variance choppiness^2 mss. A point below
the threshold 1 - z sigma is breaking; it stays there for Rice's mean excursion, and its foam outlasts that.
"""

import functools
import math
from typing import TYPE_CHECKING

from sim.numerics.root import narrowed
from sim.validation import check_number

if TYPE_CHECKING:
    from sim.ocean.tile.sea import Sea

MAX_COVER = 0.6  # largest fraction of foam, reached at 33 m/s: the law is measured up to about 25 m/s, and would pass 1


def whitecaps(wind_speed: float) -> float:
    """Fraction of the sea that is foam, W = 3.84e-6 U10^3.41 (Monahan and O'Muircheartaigh 1980), at most MAX_COVER."""
    return min(3.84e-6 * check_number("wind_speed", wind_speed, "m/s", 0.0) ** 3.41, MAX_COVER)


def slope_and_frequency(sea: "Sea", t: float) -> tuple[float, float]:
    """(mean square slope, rms frequency [rad/s] of it) of the sea as its tile resolves it at time t [s]."""
    energy = sea.energy_at(t)
    steepness = (sea.k[:, None] ** 2 + sea.k[None, :] ** 2) * energy
    slope = float(steepness.sum())
    if not slope > 0.0:
        return 0.0, 0.0
    return slope, math.sqrt(float((sea.frequencies**2 * steepness).sum()) / slope)


def threshold(coverage: float, spread: float, frequency: float, lasting: float) -> float:
    """The Jacobian below which foam is made so that the fraction `coverage` of the sea is foam; -inf without foam.

    spread: standard deviation of J, choppiness sqrt(mss); frequency [rad/s]: of `slope_and_frequency`; lasting [s]: for
    how long foam is seen after its crest has passed.
    Excursions of a Gaussian process below -z sigma last Phi(-z)/rate on average, with rate = (omega/2 pi) exp(-z^2/2)
    of them a second (Rice 1944). Passages come at random, so a point that is not breaking is free of foam with the
    probability exp(-rate lasting), and the covered share is 1 - Phi(z) exp(-rate lasting).
    """
    if not (spread > 0.0 and coverage > 0.0):
        return -math.inf
    return 1.0 - excess(coverage, frequency, lasting) * spread


@functools.lru_cache(maxsize=4)
def excess(coverage: float, frequency: float, lasting: float) -> float:
    """The z of `threshold`; cached, because every frame needs it and it rarely changes."""

    def too_little(z: float) -> float:
        rate = frequency / (2.0 * math.pi) * math.exp(-0.5 * z * z)
        # Phi(z) is erfc(-z/sqrt(2))/2.
        return coverage - 1.0 + 0.5 * math.erfc(-z * math.sqrt(0.5)) * math.exp(-rate * lasting)

    return float(narrowed(too_little, -4.0, 8.0, 1e-14)[1])
