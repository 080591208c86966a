"""Summary of the sea in a file, to recognise it by: height, period and direction, and warnings."""

import math
from typing import Any

import numpy as np

from sim.inputs.bounds import beyond
from sim.ocean.spectra.record import Conditions, Spectrum, SpreadConditions

MAIN = 0.05  # of the largest density, from which on one is compared with those beside it
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
    return [
        *beyond("spectrum", "Hs", height),
        *beyond("spectrum", "period", period, said=f"{name} {period:.3g} s"),
        *beyond("spectrum", "steepness", steepness, said=f"the steepness 2 pi Hs/(g {name}^2), {steepness:.2g},"),
    ]


def spike_of(frequency: np.ndarray, density: np.ndarray) -> list[str]:
    """A warning for the density (n,) that is the farthest above both beside it, if that is unlikely.

    frequency (n,) [Hz], rising.
    """
    beside = np.maximum(density[:-2], density[2:])
    main = (density[1:-1] > MAIN * density.max()) & (beside > 0.0)
    ratio = np.where(main, density[1:-1] / np.where(main, beside, 1.0), 0.0)
    at = int(ratio.argmax()) if len(ratio) else 0
    if not len(ratio):
        return []
    said = f"the density {density[at + 1]:.3g} m2/Hz, {ratio[at]:.3g} times those beside it,"
    return beyond("spectrum", "density over those beside it", float(ratio[at]), f"{frequency[at + 1]:.4g} Hz", said)


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
