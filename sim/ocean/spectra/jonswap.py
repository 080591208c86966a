"""The fetch-limited sea of JONSWAP (Hasselmann and others 1973). Choose it for wind over a known distance."""

import dataclasses

import numpy as np

from sim.ocean.spectra.record import Spectrum, SpreadConditions, from_frequency
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True, kw_only=True)
class FetchConditions(SpreadConditions):
    """What a sea of limited fetch is evaluated under."""

    fetch: float = parameter(100e3, 100.0, 1e7, "m", "Distance the wind blows over water", log_from=100.0)
    peak_enhancement: float = parameter(3.3, 1.0, 20.0, "", "Height of the peak of the spectrum", title="Peak factor γ")


def frequency(w: np.ndarray, c: FetchConditions) -> np.ndarray:
    """S(omega) [m2 s] = alpha g^2 omega^-5 exp(-5/4 (omega_p/omega)^4) gamma^r."""
    wp = peak(c)
    sigma = np.where(w <= wp, 0.07, 0.09)
    r = np.exp(-((w - wp) ** 2) / (2.0 * sigma**2 * wp**2))
    return alpha(c) * c.gravity**2 * w**-5.0 * np.exp(-1.25 * (wp / w) ** 4) * c.peak_enhancement**r


def alpha(c: FetchConditions) -> float:
    """alpha = 0.076 chi^-0.22, chi = g F/U10^2."""
    return 0.076 * (c.gravity * c.fetch / c.wind_speed**2) ** -0.22


def peak(c: FetchConditions) -> float:
    """omega_p = 22 (g^2/(U10 F))^(1/3) [rad/s]."""
    return 22.0 * (c.gravity**2 / (c.wind_speed * c.fetch)) ** (1.0 / 3.0)


def significant_height(c: FetchConditions) -> float:
    """Hs = 4 sqrt(alpha g^2/(5 omega_p^4 (1 - 0.287 ln gamma))) [m]; 0.12 % off at gamma 3.3 (DNV-RP-C205)."""
    m0 = alpha(c) * c.gravity**2 / (5.0 * peak(c) ** 4 * (1.0 - 0.287 * np.log(c.peak_enhancement)))
    return 4.0 * float(np.sqrt(m0))


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
)
