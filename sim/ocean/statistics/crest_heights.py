"""High crests of a random sea by linear theory and by theory of second order, for the tile of a `Sea`.

>>> from sim.ocean import Sea
>>> crests = high_crests(Sea(64, 500.0, "jonswap", wind_speed=15.0, fetch=50e3))
>>> crests.linear < crests.second_order, crests.skewness > 0.0
(True, True)
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sim.numerics.root import narrowed
from sim.water import Water
from sim.waves import DEEP_SEA

if TYPE_CHECKING:
    from sim.ocean.tile.sea import Sea

LONG_CRESTED = 1e-3  # ratio of the slopes' standard deviations across and along, below which crests count as long


class HighCrests(NamedTuple):
    """Theory of the heights of a tile at one moment. Linear heights are Gaussian: skewness 0 and kurtosis 3."""

    linear: float  # [m] the most probable highest crest of a linear sea
    second_order: float  # [m] the equally rare crest of second order
    skewness: float  # of second order
    kurtosis: float


def high_crests(sea: "Sea", t: float | None = None) -> HighCrests:
    """Theory of the highest crest, skewness and kurtosis of a tile at time t [s], by default the sea's own.

    The highest crest of an area: Adler 1981, The Geometry of Random Fields, Th. 6.9.3; of a line: Rice 1944. Crests of
    second order: `forristall_crest`. Moments: `narrow_band_moments`. All 0 on a level sea, except the kurtosis.
    """
    energy = sea.energy_at(sea.time if t is None else t)
    m0, kx, ky = float(energy.sum()), sea.k[:, None], sea.k[None, :]
    if not m0 > 0.0:
        return HighCrests(0.0, 0.0, 0.0, 3.0)
    xx, yy, xy = (float((energy * product).sum()) for product in (kx * kx, ky * ky, kx * ky))
    area = math.sqrt(max(xx * yy - xy * xy, 0.0))
    is_long = area < LONG_CRESTED * (xx + yy)
    if is_long:
        count, power = sea.length / (2.0 * math.pi) * math.sqrt((xx + yy) / m0), 0
    else:
        count, power = sea.length**2 * area / m0 / (2.0 * math.pi) ** 1.5, 1
    highest = most_probable_highest(count, power)
    period = 2.0 * math.pi * m0 / float((energy * sea.frequencies).sum())
    c, hs = sea.conditions, 4.0 * math.sqrt(m0)
    k = float(c.wavenumber(np.array(2.0 * math.pi / period)))
    crest = forristall_crest(0.5 * highest**2, hs, period, k, c.water, is_long_crested=is_long)
    return HighCrests(highest * math.sqrt(m0), crest, *narrow_band_moments(k, math.sqrt(m0), c.depth))


def most_probable_highest(count: float, power: int) -> float:
    """The height in standard deviations that is exceeded once: count x^power exp(-x^2/2) = 1; at least 1."""
    logarithm = math.log(max(count, 1.0))
    high = math.sqrt(2.0 * logarithm) + 2.0
    return float(
        narrowed(lambda x: (0.5 * x * x - power * math.log(x) - logarithm, x - power / x), 1.0, high, has_slope=True)[0]
    )


def forristall_crest(
    rarity: float, hs: float, period: float, k: float, water: Water = DEEP_SEA, *, is_long_crested: bool
) -> float:
    """The crest [m] that a wave exceeds with probability exp(-rarity), of second order.

    A Weibull law fitted to simulations (Forristall 2000, J. Phys. Oceanogr. 30:1931, eqs. 13 to 18). hs [m]; period
    T1 = m0/m1 [s] and its wavenumber k [rad/m] on the water.
    """
    steepness, ursell = 2.0 * math.pi * hs / (water.gravity * period**2), hs / (k**2 * water.depth**3)
    if is_long_crested:
        alpha = 0.3536 + 0.2892 * steepness + 0.1060 * ursell
        beta = 2.0 - 2.1597 * steepness + 0.0968 * ursell**2
    else:
        alpha = 0.3536 + 0.2568 * steepness + 0.0800 * ursell
        beta = 2.0 - 1.7912 * steepness - 0.5302 * ursell + 0.2824 * ursell**2
    return alpha * hs * rarity ** (1.0 / max(beta, 0.5))


def narrow_band_moments(k: float, deviation: float, depth: float) -> tuple[float, float]:
    """Skewness and kurtosis of waves about one wavenumber k [rad/m] with their bound waves of second order.

    The height is x + b (x^2 - y^2)/2 with x and its Hilbert transform y Gaussian (Tayfun 1980, J. Geophys. Res.
    85:1548); b is k on deep water, and of Stokes's second-order wave elsewhere. deviation [m]: of x.
    """
    kd = min(k * depth, 50.0)
    b = k * math.cosh(kd) * (2.0 + math.cosh(2.0 * kd)) / (2.0 * math.sinh(kd) ** 3)
    square = (b * deviation) ** 2
    return (
        3.0 * math.sqrt(square) / (1.0 + square) ** 1.5,
        (3.0 + 18.0 * square + 9.0 * square**2) / (1.0 + square) ** 2,
    )


def moments_of(height: np.ndarray) -> tuple[float, float]:
    """Skewness and kurtosis of heights of any shape; 0 and 3 of level water."""
    away = np.asarray(height, np.float64) - float(np.mean(height, dtype=np.float64))
    deviation = math.sqrt(float(np.square(away).mean()))
    if deviation == 0.0:
        return 0.0, 3.0
    away /= deviation
    return float((away**3).mean()), float((away**4).mean())
