"""The fetch-limited sea of JONSWAP (Hasselmann and others 1973). Choose it for wind over a known distance.

The growth law holds up to full growth, where the peak is that of Pierson and Moskowitz under the same wind,
omega_p = 0.877 g/U19.5 = 0.855 g/U10, at the dimensionless fetch g F/U10^2 = 1.70e4. A longer fetch adds nothing.
There the peak factor is 1; it falls to that over the last part of the fetch.
"""

import dataclasses

import numpy as np

from sim.ocean.spectra import pierson_moskowitz
from sim.ocean.spectra.record import WIND_HEIGHTS, Spectrum, SpreadConditions, from_frequency, peaked_integral
from sim.parameters import parameter

GROWN_PEAK = (0.8 * pierson_moskowitz.BETA) ** 0.25 / WIND_HEIGHTS[pierson_moskowitz.WIND_HEIGHT]  # omega_p U10/g
FULL_GROWTH = (22.0 / GROWN_PEAK) ** 3  # g F/U10^2
PEAKED_UNTIL = 0.86  # fraction of the fetch of full growth from which on the peak factor falls


@dataclasses.dataclass(frozen=True, kw_only=True)
class PeakConditions(SpreadConditions):
    """Conditions of a sea with a peak of JONSWAP's shape."""

    peak_enhancement: float = parameter(3.3, 1.0, 20.0, "", "Height of the peak of the spectrum", title="Peak factor γ")


@dataclasses.dataclass(frozen=True, kw_only=True)
class FetchConditions(PeakConditions):
    """Conditions of a sea of limited fetch."""

    fetch: float = parameter(100e3, 100.0, 1e7, "m", "Distance the wind blows over water", log_from=100.0)


def frequency(w: np.ndarray, c: FetchConditions) -> np.ndarray:
    """S(omega) [m2 s] = alpha g^2 omega^-5 exp(-5/4 (omega_p/omega)^4) gamma^r."""
    wp = peak(c)
    sigma = np.where(w <= wp, 0.07, 0.09)
    r = np.exp(-((w - wp) ** 2) / (2.0 * sigma**2 * wp**2))
    return alpha(c) * c.gravity**2 * w**-5.0 * np.exp(-1.25 * (wp / w) ** 4) * peak_factor(c) ** r


def fetch_of_full_growth(c: FetchConditions) -> float:
    """The fetch [m] beyond which the sea no longer grows."""
    return FULL_GROWTH * c.wind_speed**2 / c.gravity


def dimensionless_fetch(c: FetchConditions) -> float:
    """chi = g F/U10^2, at most that of full growth."""
    grown = c.gravity * c.fetch >= FULL_GROWTH * c.wind_speed**2
    return FULL_GROWTH if grown else c.gravity * c.fetch / c.wind_speed**2


def peak_factor(c: FetchConditions) -> float:
    """gamma as declared; from PEAKED_UNTIL to full growth its logarithm falls to 0 as that of the fetch grows."""
    to_come = np.log(FULL_GROWTH / dimensionless_fetch(c)) / -np.log(PEAKED_UNTIL)
    return float(c.peak_enhancement ** min(to_come, 1.0))


def alpha(c: FetchConditions) -> float:
    """alpha = 0.076 chi^-0.22."""
    return 0.076 * dimensionless_fetch(c) ** -0.22


def peak(c: FetchConditions) -> float:
    """omega_p = 22 (g^2/(U10 F))^(1/3) = 22 chi^(-1/3) g/U10 [rad/s]."""
    return 22.0 * dimensionless_fetch(c) ** (-1.0 / 3.0) * c.gravity / c.wind_speed


def significant_height(c: FetchConditions) -> float:
    """Hs [m] = 4 sqrt(alpha I(gamma)) g/omega_p^2, I the integral of the shape, omega_p written out."""
    scale = dimensionless_fetch(c) ** (2.0 / 3.0) * c.wind_speed**2 / (22.0**2 * c.gravity)
    return 4.0 * float(np.sqrt(alpha(c) * peaked_integral(peak_factor(c)))) * scale


def density(kx: np.ndarray, ky: np.ndarray, c: FetchConditions) -> np.ndarray:
    """S(kx, ky) [m4]."""
    return from_frequency(frequency, peak, kx, ky, c)


SPECTRUM = Spectrum(
    "jonswap",
    "JONSWAP 1973: fetch-limited, peaked",
    density,
    significant_height,
    peak,
    FetchConditions,
    frequency,
)
