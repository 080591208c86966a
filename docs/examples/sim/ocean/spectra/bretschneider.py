"""The spectrum of Bretschneider (1959): a sea of given significant height and peak period, for measured seas."""

import dataclasses
import math

import numpy as np

from sim.ocean.spectra.record import Spectrum, SpreadConditions, from_frequency
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True, kw_only=True)
class MeasuredConditions(SpreadConditions):
    """Conditions of a measured sea."""

    sea_height: float = parameter(2.0, 0.01, 30.0, "m", "Significant wave height", log_from=0.01)
    modal_period: float = parameter(8.0, 1.0, 30.0, "s", "Peak period")


def frequency(w: np.ndarray, c: MeasuredConditions) -> np.ndarray:
    """S(omega) [m2 s] = 5/16 Hs^2 omega_p^4 omega^-5 exp(-5/4 (omega_p/omega)^4)."""
    return 5 / 16 * c.sea_height**2 * peak(c) ** 4 * w**-5.0 * np.exp(-1.25 * (peak(c) / w) ** 4)


def significant_height(c: MeasuredConditions) -> float:
    """Hs [m] as given."""
    return c.sea_height


def peak(c: MeasuredConditions) -> float:
    """omega_p = 2 pi/T_p [rad/s]."""
    return 2.0 * math.pi / c.modal_period


def density(kx: np.ndarray, ky: np.ndarray, c: MeasuredConditions) -> np.ndarray:
    """S(kx, ky) [m4]."""
    return from_frequency(frequency, peak, kx, ky, c)


SPECTRUM = Spectrum(
    "bretschneider",
    "Bretschneider 1959: of a given height and period",
    density,
    significant_height,
    peak,
    MeasuredConditions,
)
