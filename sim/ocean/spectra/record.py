"""What a spectrum is, and the conditions that it is evaluated under."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from sim.ocean.dispersion import group_speed, omega
from sim.ocean.spectra.spreading import SPREADINGS, spread
from sim.parameters import check_value, parameter, parameters_of
from sim.validation import check_finite, check_not_negative, check_positive


@dataclasses.dataclass(frozen=True, kw_only=True)
class Conditions:
    """What every spectrum is evaluated under. Raises ValueError for a value that is not allowed.

    A spectrum with parameters of its own has a class of conditions that extends this one and declares each by
    `parameter(...)`: `Sea`, the panels of both seas, the command line and sweeps take them from there.
    """

    wind_speed: float = 10.0  # [m/s] U10; U19.5 for pierson_moskowitz
    wind_direction: float = 0.0  # [rad] where the wind goes to, from +x towards +y
    gravity: float = 9.81  # [m/s2]
    depth: float = math.inf  # [m]
    tension: float = 0.0  # [N/m]
    density: float = 1000.0  # [kg/m3]
    low_pass: float = 0.0  # [m] l: S is multiplied by exp(-k^2 l^2); l = 2 sqrt(nu T) is fluid nu left for a time T

    def __post_init__(self) -> None:
        check_not_negative("wind_speed", self.wind_speed, "m/s")
        check_finite("wind_direction", self.wind_direction, "rad")
        check_positive("gravity", self.gravity, "m/s2")
        check_positive("depth", self.depth, "m", allow_infinite=True)
        check_not_negative("tension", self.tension, "N/m")
        check_positive("density", self.density, "kg/m3")
        check_not_negative("low_pass", self.low_pass, "m")
        for name, declared in parameters_of(self).items():
            check_value(name, declared, getattr(self, name))

    def omega(self, k: np.ndarray) -> np.ndarray:
        """Angular frequency [rad/s] under these conditions."""
        return omega(k, self.gravity, self.depth, self.tension, self.density)

    def group_speed(self, k: np.ndarray) -> np.ndarray:
        """Group speed [m/s] under these conditions."""
        return group_speed(k, self.gravity, self.depth, self.tension, self.density)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SpreadConditions(Conditions):
    """What the spectra are evaluated under that are known by frequency, and spread over the directions."""

    spreading: str = parameter("cos2", choices=SPREADINGS, doc="Formula of the spreading over directions")
    spread_exponent: float = parameter(
        8.0, 0.0, 1000.0, "", "Exponent s of the spreading cos2s; larger is narrower", log_from=0.1
    )
    swell: float = parameter(0.0, 0.0, 1.0, "", "0 is a wind sea, 1 is swell with long crests")  # xi of Horvath


C = TypeVar("C", bound=Conditions)


class Spectrum(NamedTuple, Generic[C]):
    """A named spectrum. Closed forms are of the spectrum alone: infinite depth for all but tma, no low-pass."""

    name: str
    doc: str  # its authors and year, a colon, and what it is good for
    density: Callable[[np.ndarray, np.ndarray, C], np.ndarray]  # S(kx, ky) [m4]
    significant_height: Callable[[C], float] | None  # Hs [m] where a closed form exists
    peak: Callable[[C], float] | None  # peak angular frequency [rad/s] where a closed form exists
    conditions: type[C]  # what it is evaluated under

    @property
    def title(self) -> str:
        """What a list of spectra calls it: the first words of `doc`."""
        return self.doc.partition(":")[0]

    def unused(self, values: Mapping[str, Any]) -> set[str]:
        """Which of these parameters of spectra, name -> value, have no effect on this one."""
        names = set(values) - set(parameters_of(self.conditions))
        return names if values.get("spreading") == "cos2s" else names | (set(values) & {"spread_exponent"})

    def conditions_from(self, values: Mapping[str, Any]) -> C:
        """The conditions, from those of the values that this spectrum knows.

        Raises ValueError for a value that is not allowed.
        """
        known = {field.name for field in dataclasses.fields(self.conditions)}
        return self.conditions(**{name: value for name, value in values.items() if name in known})

    def __call__(self, kx: np.ndarray, ky: np.ndarray, conditions: C) -> np.ndarray:
        """S(kx, ky) [m4] with the low-pass applied; 0 at k = 0 and without wind. kx, ky [rad/m] of one shape."""
        kx, ky = np.broadcast_arrays(np.asarray(kx, np.float64), np.asarray(ky, np.float64))
        S = np.zeros(kx.shape)
        waves = (kx != 0.0) | (ky != 0.0)
        if conditions.wind_speed == 0.0 or not waves.any():
            return S
        x, y = kx[waves], ky[waves]
        S[waves] = self.density(x, y, conditions) * np.exp(-(x**2 + y**2) * conditions.low_pass**2)
        return S


SpreadC = TypeVar("SpreadC", bound=SpreadConditions)


def from_frequency(
    frequency: Callable[[np.ndarray, SpreadC], np.ndarray],
    peak: Callable[[SpreadC], float],
    kx: np.ndarray,
    ky: np.ndarray,
    c: SpreadC,
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
