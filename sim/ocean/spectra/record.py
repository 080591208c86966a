"""The record of a wave spectrum, and the conditions under which it is evaluated."""

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from sim.dispersion import wavenumber
from sim.interruption import pieces
from sim.numerics.angles import within_half_turn
from sim.ocean.dispersion import group_speed, omega
from sim.ocean.spectra.moments import Moments, moments_of
from sim.ocean.spectra.spreading import SPREADINGS, cos2s, spread
from sim.parameters import check_value, parameter, parameters_of
from sim.validation import (
    argument_error,
    as_array,
    as_float,
    check_angle,
    check_choice,
    check_kind,
    check_number,
    check_positive,
)
from sim.water import EARTH_GRAVITY, SEA_DENSITY, Water

WIND_HEIGHTS = {10.0: 1.0, 19.5: 1.026}  # [m] -> wind there over U10, drag coefficient 1.3e-3 (Stewart 2008, eq. 16.33)
MIN_WIND_SPEED = 1e-3  # [m/s] below which a wind makes no waves: spectra take powers of it, which would underflow
PIECE = 16384  # wavenumbers at a time: these stay in the cache, and the solve yields in between
OMEGA_RANGE = (0.05, 1e6)  # of the moments, over the lowest and the highest peak
DIRECTIONS = 360  # over which a spectrum without a formula of S(omega) is summed
WAVENUMBERS = (1e-12, 1e15)  # [rad/m] of all waves that a spectrum has
SECOND_PEAK = 3.3  # gamma of the second system
SECOND_EXPONENT = 25.0  # s of cos2s of the second system: swell that came a short way (Goda 2010, Sec. 2.3)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Conditions:
    """Conditions of every spectrum. Raises ValueError for a value that is not allowed.

    A spectrum with further parameters has a class of conditions that extends this one and declares each by
    `parameter(...)`: `Sea`, the panels of both seas, the command line and sweeps take them from there.
    """

    wind_speed: float = 10.0  # [m/s] at the spectrum's `wind_height`: U10; U19.5 for pierson_moskowitz
    wind_direction: float = 0.0  # [rad] where the wind goes to, from +x towards +y
    gravity: float = EARTH_GRAVITY  # [m/s2]
    depth: float = math.inf  # [m]
    tension: float = 0.0  # [N/m]
    density: float = SEA_DENSITY  # [kg/m3]
    low_pass: float = 0.0  # [m] l: S is multiplied by exp(-k^2 l^2); l = 2 sqrt(nu T) is fluid nu left for a time T
    second_height: float = parameter(
        0.0, 0.0, 20.0, "m", "Significant height of a second system of waves, as swell from afar; 0 is none",
        title="Second system Hs",
    )  # fmt: skip
    second_period: float = parameter(12.0, 1.0, 30.0, "s", "Peak period of the second system", title="Second system Tp")
    second_direction: float = parameter(
        0.5 * math.pi, -math.pi, math.pi, "rad", "Direction that the second system goes to, from +x towards +y",
        title="Second system direction",
    )  # fmt: skip

    def __post_init__(self) -> None:
        # Wide, but without overflow or loss of digits in the powers that spectra take.
        check_number("wind_speed", self.wind_speed, "m/s", 0.0, 1e3)
        check_angle("wind_direction", self.wind_direction)
        check_number("gravity", self.gravity, "m/s2", 1e-6, 1e6)
        if as_float(self.depth) != math.inf:
            check_number("depth", self.depth, "m, or inf", 1e-6, 1e9)
        check_number("tension", self.tension, "N/m", 0.0, 1e3)
        check_number("density", self.density, "kg/m3", 1e-3, 1e6)
        check_number("low_pass", self.low_pass, "m", 0.0, 1e9)
        for name, declared in parameters_of(self).items():
            check_value(name, declared, getattr(self, name))

    @property
    def water(self) -> Water:
        """The water under these conditions, without its tension."""
        return Water(self.depth, self.gravity, self.density)

    def omega(self, k: np.ndarray) -> np.ndarray:
        """Angular frequency [rad/s] under these conditions."""
        return omega(k, self.gravity, self.depth, self.tension, self.density)

    def group_speed(self, k: np.ndarray) -> np.ndarray:
        """Group speed [m/s] under these conditions."""
        return group_speed(k, self.gravity, self.depth, self.tension, self.density)

    def wavenumber(self, frequency: np.ndarray) -> np.ndarray:
        """Wavenumber [rad/m], from 1e-12 to 1e15, of waves of these angular frequencies [rad/s]."""
        lowest, highest = self.omega(np.array(WAVENUMBERS))
        return wavenumber(np.clip(frequency, lowest, highest), self.gravity, self.depth, self.tension / self.density)


@dataclasses.dataclass(frozen=True, kw_only=True)
class SpreadConditions(Conditions):
    """Conditions of spectra that are given by frequency and spread over the directions."""

    spreading: str = parameter("cos2", choices=SPREADINGS, doc="Formula of the spreading over directions")
    spread_exponent: float = parameter(
        8.0, 0.0, 1000.0, "", "Exponent s of the spreading cos2s; larger is narrower", log_from=0.1
    )
    swell: float = parameter(0.0, 0.0, 1.0, "", "0 is a wind sea, 1 is swell with long crests")  # xi of Horvath


C = TypeVar("C", bound=Conditions)


class Spectrum(NamedTuple, Generic[C]):
    """A named spectrum. Closed forms are of the spectrum alone: infinite depth for all but tma, no low-pass, no second
    system."""

    name: str
    doc: str  # its authors and year, a colon, and its use
    density: Callable[[np.ndarray, np.ndarray, C], np.ndarray]  # S(kx, ky) [m4]
    significant_height: Callable[[C], float] | None  # Hs [m] if a closed form exists
    peak: Callable[[C], float] | None  # peak angular frequency [rad/s] if a closed form exists
    conditions: type[C]
    # S(omega) [m2 s] over all directions, if known; without it `density` is integrated
    frequency: Callable[[np.ndarray, C], np.ndarray] | None = None
    wind_height: float = 10.0  # [m] of its wind speed
    by_wind: bool = True  # the wind makes its waves: no wind, no waves
    line: Callable[[C], tuple[float, float, float]] | None = None  # (kx, ky [rad/m], m0 [m2]) of one regular wave
    notes: tuple[str, ...] = ()  # of one from a file: lines on data read and left out

    @property
    def title(self) -> str:
        """Title in a list of spectra: the first words of `doc`."""
        return self.doc.partition(": ")[0]

    def wind_speed(self, u10: float) -> float:
        """The wind speed [m/s] that it takes, from that 10 m above the sea."""
        return WIND_HEIGHTS[self.wind_height] * u10

    def is_level(self, conditions: C) -> bool:
        """True if there are no waves but those of the second system."""
        return self.by_wind and conditions.wind_speed < MIN_WIND_SPEED

    def unused(self, values: Mapping[str, Any]) -> set[str]:
        """Names of those parameters of spectra, name -> value, that have no effect on this one."""
        names = set(values) - set(parameters_of(self.conditions))
        if values.get("second_height") == 0.0:
            names |= {"second_period", "second_direction"} & set(values)
        return names if values.get("spreading") == "cos2s" else names | (set(values) & {"spread_exponent"})

    def uses(self, name: str) -> bool:
        """True for the name of one of its conditions."""
        return name in (field.name for field in dataclasses.fields(self.conditions))

    def conditions_from(self, values: Mapping[str, Any]) -> C:
        """The conditions, from those of the values that this spectrum knows.

        Raises ValueError for a value that is not allowed.
        """
        return self.conditions(**{name: value for name, value in values.items() if self.uses(name)})

    def check_used(self, values: Mapping[str, Any]) -> None:
        """Raises ValueError for the first of the values, by name, that is no condition of this spectrum."""
        for name in values:
            if not self.uses(name):
                known = ", ".join(field.name for field in dataclasses.fields(self.conditions))
                others = ", ".join(one.name for one in SPECTRA.values() if one.uses(name))
                hint = f"; it is one of {others}" if others else ""
                raise argument_error(name, values[name], f"a condition that {self.name} uses: {known}{hint}")

    def conditions_of(self, conditions: C | None, values: dict[str, Any]) -> C:
        """The conditions of a record, of values by name, or of a record with some changed.

        Raises ValueError for a condition that this spectrum does not use.
        """
        self.check_used(values)
        if conditions is None:
            return self.conditions(**values)
        check_kind("conditions", conditions, self.conditions, f"{self.conditions.__name__}, or None")
        return dataclasses.replace(conditions, **values)

    def frequency_density(self, omega: ArrayLike, conditions: C | None = None, **values: Any) -> np.ndarray:
        """S(omega) [m2 s] over all directions, of the shape of omega [rad/s]; its integral over omega is m0.

        With the second system and the low-pass; the one wave of a `line` has no density. The conditions come as a
        record or by name. S(f) [m2/Hz] is 2 pi S(2 pi f). Raises ValueError for a frequency that is not above 0, or a
        condition that this spectrum does not use.

        >>> from sim.ocean import SPECTRA
        >>> S = SPECTRA["jonswap"].frequency_density([0.5, 1.0], wind_speed=15.0, fetch=2e5)
        >>> S.round(2).tolist()  # [m2 s]
        [0.27, 0.74]
        """
        c = self.conditions_of(conditions, values)
        allowed = "finite numbers above 0 rad/s"
        w = as_array("omega", omega, allowed)
        if not ((w > 0.0) & (w < math.inf)).all():
            raise argument_error("omega", float(w[~((w > 0.0) & (w < math.inf))][0]), allowed)
        S, k = np.zeros(w.shape), None
        if not self.is_level(c) and self.line is None:
            if self.frequency is not None:
                S = self.frequency(w, c)
            else:
                k = c.wavenumber(w)
                theta = c.wind_direction + (np.arange(DIRECTIONS) + 0.5) * (2.0 * math.pi / DIRECTIONS)
                turned = [self.density(k * math.cos(one), k * math.sin(one), c) for one in theta]
                S = np.mean(turned, axis=0) * (2.0 * math.pi) * k / c.group_speed(k)
        if c.second_height > 0.0:
            S = S + peaked(w, c.second_height, 2.0 * math.pi / c.second_period, SECOND_PEAK)
        return S * np.exp(-((c.wavenumber(w) * c.low_pass) ** 2)) if c.low_pass > 0.0 else S

    def __call__(self, kx: np.ndarray, ky: np.ndarray, conditions: C) -> np.ndarray:
        """S(kx, ky) [m4] with the second system and the low-pass; 0 at k = 0. kx, ky [rad/m] of one shape.

        The one wave of a `line` has no density and is not in it.
        """
        kx, ky = np.broadcast_arrays(np.asarray(kx, np.float64), np.asarray(ky, np.float64))
        S, all_x, all_y = np.zeros(kx.size), kx.ravel(), ky.ravel()
        for piece in pieces(S.size, PIECE):
            x, y = all_x[piece], all_y[piece]
            waves = (x != 0.0) | (y != 0.0)
            if waves.all():
                S[piece] = self._of_waves(x, y, conditions)
            elif waves.any():
                S[piece][waves] = self._of_waves(x[waves], y[waves], conditions)
        return S.reshape(kx.shape)

    def _of_waves(self, kx: np.ndarray, ky: np.ndarray, conditions: C) -> np.ndarray:
        """The same for wavenumbers (n,) that are not 0."""
        S = np.zeros(kx.shape) if self.is_level(conditions) else self.density(kx, ky, conditions)
        if conditions.second_height > 0.0:
            S = S + second_system(kx, ky, conditions)
        return S * np.exp(-(kx**2 + ky**2) * conditions.low_pass**2)

    def moments(self, conditions: C | None = None, cut_off: float = math.inf, **values: Any) -> Moments:
        """The moments m0 to m4 of `frequency_density`, with Tp, Tz, Tm01 and the steepness.

        cut_off [rad/s]: the highest frequency that counts. Without it m4 of a spectrum that falls as omega^-5 is inf.

        >>> from sim.ocean import SPECTRA
        >>> sea = SPECTRA["sea_state"].moments(hs=2.0, tp=8.0)
        >>> f"{sea.significant_height:.2f} m, Tp {sea.peak_period:.2f} s, Tz {sea.zero_crossing_period:.2f} s"
        '2.00 m, Tp 8.00 s, Tz 6.22 s'

        Raises ValueError as `frequency_density`, and for a cut-off that is not above 0.
        """
        check_positive("cut_off", cut_off, "rad/s", allow_infinite=True)
        c = self.conditions_of(conditions, values)
        typical = self.peak(c) if self.peak is not None and not self.is_level(c) else c.gravity / 10.0
        own = [typical, *([2.0 * math.pi / c.second_period] if c.second_height > 0.0 else [])]
        # waves that feel the bottom fall more slowly: the tail that decides begins where they no longer do
        last = min(cut_off, max(*own, math.sqrt(c.gravity / c.depth)) * OMEGA_RANGE[1])
        first = min(min(own) * OMEGA_RANGE[0], 0.5 * last)
        moments = moments_of(lambda omega: self.frequency_density(omega, c), first, last, c.gravity, cut_off)
        if self.line is None or typical > cut_off:
            return moments
        m0 = self.line(c)[2]
        together = {f"m{n}": moments[n] + m0 * typical**n for n in range(5)}
        return moments._replace(peak_period=2.0 * math.pi / typical if m0 > 0.0 else moments.peak_period, **together)


SpreadC = TypeVar("SpreadC", bound=SpreadConditions)


SPECTRA: dict[str, Spectrum[Any]] = {}  # by name; the package fills it


def named_spectrum(spectrum: str | Spectrum[Any]) -> Spectrum[Any]:
    """The spectrum of a name in SPECTRA, or the record itself. Raises ValueError for an unknown name."""
    return spectrum if isinstance(spectrum, Spectrum) else SPECTRA[check_choice("spectrum", spectrum, SPECTRA)]


def from_frequency(
    frequency: Callable[[np.ndarray, SpreadC], np.ndarray],
    peak: Callable[[SpreadC], float],
    kx: np.ndarray,
    ky: np.ndarray,
    c: SpreadC,
    wind_height: float = 10.0,
) -> np.ndarray:
    """S(kx, ky) = S(omega) D(omega, theta) (d omega/dk)/k, from S(omega) [m2 s] and its peak [rad/s].

    wind_height [m]: of the conditions' wind speed; the spreading takes U10.
    """
    k = np.hypot(kx, ky)
    w = c.omega(k)
    theta = within_half_turn(np.arctan2(ky, kx) - c.wind_direction)
    u10 = c.wind_speed / WIND_HEIGHTS[wind_height]
    D = spread(c.spreading, w / peak(c), theta, c.spread_exponent, c.swell, u10 * peak(c) / c.gravity)
    return frequency(w, c) * D * c.group_speed(k) / k


@functools.lru_cache(maxsize=256)
def wavenumber_of(c: Conditions, frequency: float) -> float:
    """`Conditions.wavenumber` of one frequency [rad/s], which is kept."""
    return float(c.wavenumber(np.asarray(frequency)))


def peaked(w: np.ndarray, height: float, peak: float, gamma: float) -> np.ndarray:
    """S(omega) [m2 s] in the shape of JONSWAP, with this Hs [m], peak [rad/s] and peak factor gamma."""
    x = np.asarray(w, np.float64) / peak
    return height**2 / 16.0 / peak * _peaked_shape(x, gamma) / peaked_integral(gamma)


def _peaked_shape(x: np.ndarray, gamma: float) -> np.ndarray:
    """x^-5 exp(-5/4 x^-4) gamma^r of x = omega/omega_p."""
    sigma = np.where(x <= 1.0, 0.07, 0.09)
    return x**-5.0 * np.exp(-1.25 * x**-4.0) * gamma ** np.exp(-((x - 1.0) ** 2) / (2.0 * sigma**2))


@functools.lru_cache(maxsize=256)
def peaked_integral(gamma: float) -> float:
    """Integral of `_peaked_shape` over all x: by Simpson's rule in log x on both sides of the peak, which is a kink."""
    total = 0.0
    for a, b in ((math.log(0.3), 0.0), (0.0, math.log(100.0))):
        log_x, step = np.linspace(a, b, 4001, retstep=True)
        weight = np.full(log_x.size, 2.0)
        weight[1::2], weight[[0, -1]] = 4.0, 1.0
        x = np.exp(log_x)
        total += float(step / 3.0 * (weight * x * _peaked_shape(x, gamma)).sum())
    return total + 0.25 * 100.0**-4.0


def second_system(kx: np.ndarray, ky: np.ndarray, c: Conditions) -> np.ndarray:
    """S(kx, ky) [m4] of the second system: the shape of JONSWAP with gamma 3.3, spread as cos2s."""
    k = np.hypot(kx, ky)
    w = c.omega(k)
    theta = within_half_turn(np.arctan2(ky, kx) - c.second_direction)
    S = peaked(w, c.second_height, 2.0 * math.pi / c.second_period, SECOND_PEAK)
    return S * cos2s(SECOND_EXPONENT, theta) * c.group_speed(k) / k
