"""The fully developed sea of Pierson and Moskowitz (1964, JGR 69:5181). Choose it when the wind blew long enough."""

import numpy as np

from sim.ocean.spectra.record import Spectrum, SpreadConditions, from_frequency

ALPHA, BETA = 0.0081, 0.74
WIND_HEIGHT = 19.5  # [m]


def frequency(w: np.ndarray, c: SpreadConditions) -> np.ndarray:
    """S(omega) [m2 s] = alpha g^2 omega^-5 exp(-beta (g/(U omega))^4), U = U19.5."""
    return ALPHA * c.gravity**2 * w**-5.0 * np.exp(-BETA * (c.gravity / (c.wind_speed * w)) ** 4)


def significant_height(c: SpreadConditions) -> float:
    """Hs = 4 sqrt(alpha U^4/(4 beta g^2)) = 0.209246 U^2/g [m]."""
    return 4.0 * float(np.sqrt(ALPHA / (4.0 * BETA))) * c.wind_speed**2 / c.gravity


def peak(c: SpreadConditions) -> float:
    """omega_p = (4 beta/5)^(1/4) g/U = 0.8772 g/U [rad/s]."""
    return (0.8 * BETA) ** 0.25 * c.gravity / c.wind_speed


def density(kx: np.ndarray, ky: np.ndarray, c: SpreadConditions) -> np.ndarray:
    """S(kx, ky) [m4]."""
    return from_frequency(frequency, peak, kx, ky, c, WIND_HEIGHT)


SPECTRUM = Spectrum(
    "pierson_moskowitz",
    "Pierson-Moskowitz 1964: fully developed, wind at 19.5 m",
    density,
    significant_height,
    peak,
    SpreadConditions,
    frequency,
    wind_height=WIND_HEIGHT,
)
