"""What a spectrum is, and the conditions it is evaluated under."""

import dataclasses
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sim.ocean.dispersion import group_speed, omega
from sim.ocean.spectra.spreading import SPREADINGS, spread
from sim.validation import argument_error, check_finite, check_not_negative, check_positive, check_within


@dataclasses.dataclass(frozen=True, kw_only=True)
class Conditions:
    """Everything a spectrum may ask for. Raises ValueError for a value that is not allowed."""

    wind_speed: float = 10.0  # [m/s] U10; U19.5 for pierson_moskowitz
    wind_direction: float = 0.0  # [rad] where the wind goes to, from +x towards +y
    gravity: float = 9.81  # [m/s2]
    depth: float = math.inf  # [m]
    tension: float = 0.0  # [N/m]
    density: float = 1000.0  # [kg/m3]
    fetch: float = 100e3  # [m] for jonswap and tma
    peak_enhancement: float = 3.3  # gamma of jonswap and tma
    inverse_wave_age: float = 0.84  # Omega of elfouhaily, 0.84 fully developed to 5 very young
    phillips_constant: float = 1.7421e-3  # A of phillips; this value gives the height of Pierson and Moskowitz
    spreading: str = "cos2"  # for the spectra known by frequency
    spread_exponent: float = 8.0  # s of cos2s
    swell: float = 0.0  # Horvath's xi: 0 wind sea to 1 long-crested swell
    low_pass: float = 0.0  # [m] l: S is multiplied by exp(-k^2 l^2); l = 2 sqrt(nu T) is fluid nu left for a time T

    def __post_init__(self) -> None:
        check_not_negative("wind_speed", self.wind_speed, "m/s")
        check_finite("wind_direction", self.wind_direction, "rad")
        check_positive("gravity", self.gravity, "m/s2")
        check_positive("depth", self.depth, "m", allow_infinite=True)
        check_not_negative("tension", self.tension, "N/m")
        check_positive("density", self.density, "kg/m3")
        check_positive("fetch", self.fetch, "m")
        check_within("peak_enhancement", self.peak_enhancement, 1.0, 20.0)
        check_within("inverse_wave_age", self.inverse_wave_age, 0.84, 5.0)
        check_not_negative("phillips_constant", self.phillips_constant, "")
        check_within("spread_exponent", self.spread_exponent, 0.0, 1000.0)
        check_within("swell", self.swell, 0.0, 1.0)
        check_not_negative("low_pass", self.low_pass, "m")
        if self.spreading not in SPREADINGS:
            raise argument_error("spreading", self.spreading, "one of " + ", ".join(SPREADINGS))

    def omega(self, k: np.ndarray) -> np.ndarray:
        """Angular frequency [rad/s] under these conditions."""
        return omega(k, self.gravity, self.depth, self.tension, self.density)

    def group_speed(self, k: np.ndarray) -> np.ndarray:
        """Group speed [m/s] under these conditions."""
        return group_speed(k, self.gravity, self.depth, self.tension, self.density)


class Spectrum(NamedTuple):
    """A named spectrum. Closed forms are of the spectrum alone: infinite depth for all but tma, no low-pass."""

    name: str
    doc: str
    density: Callable[[np.ndarray, np.ndarray, Conditions], np.ndarray]  # S(kx, ky) [m4]
    significant_height: Callable[[Conditions], float] | None  # Hs [m] where a closed form exists
    peak: Callable[[Conditions], float] | None  # peak angular frequency [rad/s] where a closed form exists
    parameters: tuple[str, ...]  # the conditions it reads besides gravity, depth, tension and density

    def __call__(self, kx: np.ndarray, ky: np.ndarray, conditions: Conditions) -> np.ndarray:
        """S(kx, ky) [m4] with the low-pass applied; 0 at k = 0 and without wind. kx, ky [rad/m] of one shape."""
        kx, ky = np.broadcast_arrays(np.asarray(kx, np.float64), np.asarray(ky, np.float64))
        S = np.zeros(kx.shape)
        waves = (kx != 0.0) | (ky != 0.0)
        if conditions.wind_speed == 0.0 or not waves.any():
            return S
        x, y = kx[waves], ky[waves]
        S[waves] = self.density(x, y, conditions) * np.exp(-(x**2 + y**2) * conditions.low_pass**2)
        return S


def from_frequency(
    frequency: Callable[[np.ndarray, Conditions], np.ndarray],
    peak: Callable[[Conditions], float],
    kx: np.ndarray,
    ky: np.ndarray,
    c: Conditions,
) -> np.ndarray:
    """S(kx, ky) = S(omega) D(omega, theta) (d omega/dk)/k, from S(omega) [m2 s] and its peak [rad/s]."""
    k = np.hypot(kx, ky)
    w = c.omega(k)
    theta = angle_from(np.arctan2(ky, kx), c.wind_direction)
    D = spread(c.spreading, w / peak(c), theta, c.spread_exponent, c.swell, c.wind_speed * peak(c) / c.gravity)
    return frequency(w, c) * D * c.group_speed(k) / k


def angle_from(theta: np.ndarray, direction: float) -> np.ndarray:
    """theta - direction brought to [-pi, pi] [rad]."""
    return np.mod(theta - direction + np.pi, 2.0 * np.pi) - np.pi
