"""One regular wave of given height and period. Choose it to see how a body responds to a single wave."""

import dataclasses
import math

import numpy as np

from sim.ocean.spectra.record import Conditions, Spectrum, wavenumber_of
from sim.parameters import parameter


@dataclasses.dataclass(frozen=True, kw_only=True)
class RegularConditions(Conditions):
    """Conditions of one regular wave."""

    wave_height: float = parameter(1.0, 0.0, 20.0, "m", "Height H of the wave, from trough to crest", title="Height H")
    wave_period: float = parameter(6.0, 0.5, 30.0, "s", "Period T of the wave", title="Period T")


def density(kx: np.ndarray, ky: np.ndarray, c: RegularConditions) -> np.ndarray:
    """0 [m4]: the energy of one wave lies at one point of the plane, see `line`."""
    return np.zeros(np.shape(kx))


def significant_height(c: RegularConditions) -> float:
    """Hs = 4 sqrt(m0) = sqrt(2) H [m]."""
    return math.sqrt(2.0) * c.wave_height


def peak(c: RegularConditions) -> float:
    """2 pi/T [rad/s]."""
    return 2.0 * math.pi / c.wave_period


def line(c: RegularConditions) -> tuple[float, float, float]:
    """(kx, ky [rad/m], m0 = H^2/8 [m2], with the low-pass) of the wave, along the wind."""
    k = wavenumber_of(c, peak(c))
    m0 = c.wave_height**2 / 8.0 * math.exp(-((k * c.low_pass) ** 2))
    return k * math.cos(c.wind_direction), k * math.sin(c.wind_direction), m0


SPECTRUM = Spectrum(
    "regular",
    "One regular wave: given height H and period T, along the wind",
    density,
    significant_height,
    peak,
    RegularConditions,
    by_wind=False,
    line=line,
)
