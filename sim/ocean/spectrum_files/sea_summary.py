"""Summary of the sea in a file, to recognise it by: height, period and direction, and warnings."""

import math
from typing import Any

import numpy as np

from sim.ocean.spectra.record import Conditions, Spectrum, SpreadConditions

HIGHEST = 20.0  # [m] of Hs: a larger one is probably in a wrong unit
SHORTEST, LONGEST = 2.0, 30.0  # [s] of Tp
STEEPEST = 0.1  # 2 pi Hs/(g Tp^2); the steepest seas have 0.07
COMPASS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
ANGLES = np.radians(np.arange(0.0, 360.0, 2.0))
FREQUENCIES = 400


def summary_of(spectrum: Spectrum[Any]) -> tuple[str, ...]:
    """A line with Hs, Tp and main direction of a measured spectrum, and a warning for each that is unlikely."""
    moments = spectrum.moments()
    height, period = moments.significant_height, moments.peak_period
    bearing = bearing_of(spectrum)
    comes = "no directions" if bearing is None else f"waves come from {bearing:.0f}\u00b0 ({compass(bearing)})"
    return (f"Hs {height:.3g} m, Tp {period:.3g} s, {comes}", *warnings_of(height, period, moments.gravity))


def warnings_of(height: float, period: float, gravity: float = Conditions.gravity, name: str = "Tp") -> list[str]:
    """Warnings for Hs [m] and a period [s] of this name that are unlikely."""
    steepness = 2.0 * math.pi * height / (gravity * period**2)
    found = []
    if height > HIGHEST:
        found.append(f"Warning: Hs {height:.3g} m is above {HIGHEST:g} m: is the unit of the density m2/Hz?")
    if not SHORTEST <= period <= LONGEST:
        found.append(f"Warning: {name} {period:.3g} s is not within {SHORTEST:g} to {LONGEST:g} s: is its unit right?")
    if steepness > STEEPEST:
        found.append(f"Warning: the steepness 2 pi Hs/(g {name}^2) is {steepness:.2g}, above {STEEPEST:g}")
    return found


def bearing_of(spectrum: Spectrum[Any]) -> float | None:
    """Mean direction that waves come from [degrees from north], None for a spectrum without directions."""
    if spectrum.conditions is SpreadConditions:
        return None
    c = Conditions()
    peak = spectrum.peak(c) if spectrum.peak is not None else 1.0
    omega = peak * np.linspace(0.4, 3.0, FREQUENCIES)
    k = c.wavenumber(omega)
    # S(k) k dk dtheta; dk = d omega/c_g
    weight = (k / c.group_speed(k))[:, None] * spectrum.density(
        k[:, None] * np.cos(ANGLES), k[:, None] * np.sin(ANGLES), c
    )
    x, y = float((weight * np.cos(ANGLES)).sum()), float((weight * np.sin(ANGLES)).sum())
    return round((270.0 - math.degrees(math.atan2(y, x))) % 360.0, 3) % 360.0


def compass(bearing: float) -> str:
    """The nearest of 16 points of the compass."""
    return COMPASS[round(bearing / 22.5) % 16]
