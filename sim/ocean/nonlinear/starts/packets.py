"""Packets of free waves along +x that grow into high ones, as starts of a `NonlinearSea`.

>>> from sim.ocean.nonlinear import NonlinearSea, breather
>>> waves, focus = breather(amplitude=0.3, count=20, length=400.0)  # the highest wave comes after `focus` [s]
>>> sea = NonlinearSea(size=(256, 1), length=400.0, order=4, start=waves)
>>> sea.surface(0.0).height.shape, round(focus)
((256, 1), 250)
"""

import math

import numpy as np

from sim.validation import argument_error, check_kind, check_number, check_positive, is_whole_number
from sim.water import Water
from sim.waves import DEEP_SEA, Waves

SAMPLES = 8  # of an envelope, to a wave
BEFORE = 3.0  # time of a breather's start before its peak, over 1/(omega (ka)^2): it is 1.3 times the carrier
DELAY = 1.3  # of the peak of steep waves over that of the equation, measured at order 4, ka = 0.06 to 0.1
SIDE_BAND = 0.1  # amplitude of each side band over the carrier's


def breather(
    amplitude: float, count: int, length: float, place: float = 0.0, water: Water = DEEP_SEA
) -> tuple[Waves, float]:
    """Waves of Peregrine's breather on deep water (1983, J. Aust. Math. Soc. B 25:16), and the time [s] to its peak.

    A carrier of this amplitude [m], with `count` waves on the length [m], grows threefold at `place` x [m], and becomes
    even again. In the form of Chabchoub, Hoffmann and Akhmediev (2011, Phys. Rev. Lett. 106:204502), eq. 2. Raises
    ValueError for a value that is not allowed, as water of a finite depth.
    """
    k, frequency = carrier(amplitude, count, length, water)
    place = check_number("place", place, "m")
    if amplitude == 0.0:
        return free_waves(np.array([count]), np.zeros(1), length, water), 0.0
    start = BEFORE / (frequency * (k * amplitude) ** 2)
    focus = DELAY * start
    size = SAMPLES * count
    x = np.arange(size) * (length / size)
    away = x - (place - 0.5 * frequency / k * focus)  # the packet moves at the group speed, and the tile repeats
    away -= length * np.rint(away / length)
    shape = 1.0 - 4.0 * (1.0 + 1j * BEFORE) / (1.0 + 8.0 * (k * k * amplitude * away) ** 2 + BEFORE**2)
    waves = np.fft.fft(amplitude * np.exp(1j * k * x) * shape) / size
    return free_waves(np.arange(1, size // 2), waves[1 : size // 2], length, water), focus


def modulated_waves(amplitude: float, count: int, length: float, water: Water = DEEP_SEA) -> Waves:
    """A carrier as in `breather` with the two side bands that grow fastest (Benjamin and Feir 1967, J. Fluid Mech.
    27:417): k (1 +- 2ka), in the phase in which they grow. Errors as of `breather`."""
    k, _ = carrier(amplitude, count, length, water)
    aside = min(max(round(2.0 * k * amplitude * count), 1), max(count - 1, 1))
    side = SIDE_BAND * amplitude * np.exp(-0.25j * math.pi)
    numbers, waves = np.array([count - aside, count, count + aside]), np.array([side, amplitude, side])
    there = numbers > 0
    return free_waves(numbers[there], waves[there], length, water)


def carrier(amplitude: float, count: int, length: float, water: Water) -> tuple[float, float]:
    """Wavenumber [rad/m] and frequency [rad/s]; the arguments are checked."""
    check_number("amplitude", amplitude, "m", 0.0)
    check_kind("water", water, Water, "a Water")
    check_positive("water: gravity", water.gravity, "m/s2")
    if not math.isinf(water.depth):
        raise argument_error("water: depth", water.depth, "inf: the waves are those of deep water")
    if not is_whole_number(count) or count < 1:
        raise argument_error("count", count, "a whole number of at least 1")
    k = 2.0 * math.pi * count / check_positive("length", length, "m")
    return k, math.sqrt(water.gravity * k)


def free_waves(numbers: np.ndarray, waves: np.ndarray, length: float, water: Water) -> Waves:
    """Waves with these numbers on the length; waves: complex amplitudes [m] at time 0."""
    k = numbers * (2.0 * math.pi / length)
    return Waves(k, np.zeros_like(k), np.abs(waves), np.angle(waves), water=water)
