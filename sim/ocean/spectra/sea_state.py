"""A sea of given significant height and peak period, in the shape of JONSWAP. Choose it where these are known."""

import dataclasses
import math

import numpy as np

from sim.ocean.spectra.jonswap import PeakConditions
from sim.ocean.spectra.record import Spectrum, from_frequency, peaked
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True, kw_only=True)
class HeightConditions(PeakConditions):
    """Conditions of a sea of given height and period."""

    hs: float = parameter(
        2.0, 0.0, 20.0, "m", "Mean height of the highest third of the waves", title="Significant height Hs"
    )
    tp: float = parameter(8.0, 0.5, 30.0, "s", "Period of the waves with the most energy", title="Peak period Tp")


def frequency(w: np.ndarray, c: HeightConditions) -> np.ndarray:
    """S(omega) [m2 s]: omega^-5 exp(-5/4 (omega_p/omega)^4) gamma^r, scaled to m0 = Hs^2/16."""
    return peaked(w, c.hs, peak(c), c.peak_enhancement)


def significant_height(c: HeightConditions) -> float:
    """Hs [m], as given."""
    return c.hs


def peak(c: HeightConditions) -> float:
    """omega_p = 2 pi/Tp [rad/s]."""
    return 2.0 * math.pi / c.tp


def density(kx: np.ndarray, ky: np.ndarray, c: HeightConditions) -> np.ndarray:
    """S(kx, ky) [m4]."""
    return from_frequency(frequency, peak, kx, ky, c)


SPECTRUM = Spectrum(
    "sea_state",
    "Given Hs, Tp and γ: JONSWAP's shape, whatever the wind",
    density,
    significant_height,
    peak,
    HeightConditions,
    frequency,
    by_wind=False,
)
