"""The lab's spectrum: Phillips as Tessendorf (2001) writes it, with waves that run along the wind both ways."""

import dataclasses
import math

import numpy as np

from sim.ocean.spectra.record import Conditions, Spectrum
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True, kw_only=True)
class PhillipsConditions(Conditions):
    """Conditions of the spectrum of Phillips."""

    phillips_constant: float = parameter(
        1.7421e-3,
        0.0,
        0.1,
        "",
        "Constant of Phillips' spectrum; 1.74e-3 gives the wave height of Pierson and Moskowitz",
        log_from=1e-5,
        title="Phillips constant A",
    )


def density(kx: np.ndarray, ky: np.ndarray, c: PhillipsConditions) -> np.ndarray:
    """S(kx, ky) [m4] = A exp(-1/(kL)^2)/k^4 cos^2(theta), L = U^2/g (Tessendorf, eq. 40, with S in the plane)."""
    k2 = kx**2 + ky**2
    L = c.wind_speed**2 / c.gravity
    along = kx * math.cos(c.wind_direction) + ky * math.sin(c.wind_direction)
    return c.phillips_constant * np.exp(-1.0 / (k2 * L**2)) / k2**2 * along**2 / k2


def frequency(w: np.ndarray, c: PhillipsConditions) -> np.ndarray:
    """S(omega) [m2 s] = pi A exp(-1/(kL)^2)/k^3 dk/domega: the mean of cos^2 is 1/2."""
    k, L = c.wavenumber(w), c.wind_speed**2 / c.gravity
    return math.pi * c.phillips_constant * np.exp(-1.0 / (k * L) ** 2) / k**3 / c.group_speed(k)


def significant_height(c: PhillipsConditions) -> float:
    """Hs = 4 L sqrt(pi A/2) [m]."""
    return 4.0 * c.wind_speed**2 / c.gravity * math.sqrt(0.5 * math.pi * c.phillips_constant)


def peak(c: PhillipsConditions) -> float:
    """Peak of S(omega) ~ k^-5/2 exp(-1/(kL)^2), deep water: k_p = sqrt(4/5)/L, omega_p = sqrt(g k_p) [rad/s]."""
    return math.sqrt(math.sqrt(0.8)) * c.gravity / c.wind_speed


SPECTRUM = Spectrum(
    "phillips",
    "Phillips after Tessendorf 2001: the lab's, both ways along the wind",
    density,
    significant_height,
    peak,
    PhillipsConditions,
    frequency,
)
