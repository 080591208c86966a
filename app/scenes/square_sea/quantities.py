"""Quantities of the square sea: as drawn and by theory, in other winds, on the Earth, and of its rain."""

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.quantities import Quantities, Quantity, SceneInstant, for_sweeps, for_tasks
from app.scenes.sea_parameters import chosen_spectrum
from app.scenes.square_sea.parameters import SquareSeaParams, acting, conditions, gravity
from app.scenes.square_sea.statistics import Report, measure, theory
from sim.ocean.planets import gravity_of
from sim.ocean.radial.gerstner import peak_wavenumber
from sim.ocean.spectra import Conditions, Spectrum
from sim.ocean.statistics.crest_heights import moments_of
from sim.ocean.statistics.statistics import open_sea_height
from sim.water import EARTH_GRAVITY

if TYPE_CHECKING:
    from app.scenes.square_sea.rainfall import RainReadings
    from app.scenes.square_sea.scene import SquareSeaScene

LIGHT, HEAVY = 0.01, 100.0  # [Earth masses] of the planets of the lab


class ReportNow(NamedTuple):
    """The part of the readings that a sweep reads."""

    report: Report


class SeaInstant(SceneInstant):
    """The present state of a square sea; no frame is drawn for it."""

    scene: "SquareSeaScene"

    @functools.cached_property
    def height(self) -> NDArray[np.floating]:
        """(n, n) [m] heights, without the height factor."""
        return self.scene.fields().height

    @functools.cached_property
    def readings(self) -> ReportNow:
        """A report of this time: that of the scene is up to half a second old."""
        sea, p = self.scene.sea, self.params
        return ReportNow(Report(measure(sea, self.height, None, p), theory(sea, self.scene.time, p)))

    @functools.cached_property
    def moments(self) -> tuple[float, float]:
        """Skewness and kurtosis of the heights."""
        return moments_of(self.height)

    @property
    def breaking_loss(self) -> float:
        """Energy [J/m2] lost by breaking since the start."""
        marching = self.scene.marching
        return 0.0 if marching is None else marching.sea.energy.breaking


def spectrum_conditions(params: SquareSeaParams, wind_speed: float, g: float) -> Conditions:
    """The conditions of the parameters' spectrum in another wind [m/s], 10 m above the sea, or gravity [m/s2]."""
    values = conditions(params, wind_speed) | {"gravity": g}
    return chosen_spectrum(params).conditions_from(values)


def peak_speed(spectrum: Spectrum, c: Conditions) -> float:
    """Phase speed [m/s] of the waves at the spectrum's peak."""
    k = peak_wavenumber(spectrum, c)
    return float(c.omega(np.asarray(k))) / k


class OpenSea(NamedTuple):
    """An open sea of the parameters' spectrum."""

    height: float  # significant [m]
    speed: float  # [m/s] of its peak waves; NaN for a level one


@functools.lru_cache(maxsize=8)
def open_sea(params: SquareSeaParams, wind_speed: float, g: float) -> OpenSea:
    """The open sea in a wind [m/s] and a gravity [m/s2]; cached, as several quantities read it in every snapshot."""
    spectrum, c = chosen_spectrum(params), spectrum_conditions(params, wind_speed, g)
    if spectrum.is_level(c):
        return OpenSea(0.0, math.nan)
    return OpenSea(open_sea_height(spectrum, c), peak_speed(spectrum, c))


def here(p: SquareSeaParams) -> OpenSea:
    """The open sea in this wind, here."""
    return open_sea(p, p.wind_speed, gravity(p))


def in_twice_the_wind(p: SquareSeaParams) -> OpenSea:
    """The open sea in twice this wind, here."""
    return open_sea(p, 2.0 * p.wind_speed, gravity(p))


def on_earth(p: SquareSeaParams) -> OpenSea:
    """The open sea in this wind, on the Earth."""
    return open_sea(p, p.wind_speed, EARTH_GRAVITY)


def ratio(a: float, b: float) -> float:
    """The ratio of two heights [m]; NaN for that to a level sea."""
    return a / b if b else math.nan


def height_over_earth(now: Any) -> float:
    """Height of the open sea here over that on the Earth."""
    return ratio(here(now.frame.params).height, on_earth(now.frame.params).height)


def height_by_wind(now: Any) -> float:
    """Height of the open sea in twice the wind over that in this one."""
    return ratio(in_twice_the_wind(now.frame.params).height, here(now.frame.params).height)


def of_report(value: Callable[[Report], float | None]) -> Callable[[Any], float | None]:
    """A number of the report; None before the sea has been measured."""
    return lambda now: None if now.readings.report is None else value(now.readings.report)


def of_rain(value: "Callable[[RainReadings], float | None]") -> Callable[[Any], float | None]:
    """A number of the rain; None without rain."""
    return lambda now: None if now.readings.rain is None else value(now.readings.rain)


def measured_over_earth(now: Any) -> float | None:
    """Height as drawn over that on the Earth; None before the sea has been measured."""
    report = now.readings.report
    return None if report is None else ratio(report.measured.significant_height, on_earth(now.frame.params).height)


MEASURED: Quantities = {  # of a `Report`
    "significant_height": Quantity(
        "m", "Significant wave height of the drawn sea", lambda r: r.measured.significant_height
    ),
    "peak_period": Quantity("s", "Peak period of the drawn sea", lambda r: r.measured.peak_period),
    "mean_square_slope": Quantity("1", "Mean square slope of the drawn sea", lambda r: r.measured.mean_square_slope),
}
EXPECTED: Quantities = {  # of a `Report`
    "expected_height": Quantity(
        "m", "Significant wave height by theory, of this tile", lambda r: r.theory.statistics.significant_height
    ),
    "expected_period": Quantity("s", "Peak period by theory, of this tile", lambda r: r.theory.statistics.peak_period),
    "expected_slope": Quantity(
        "1", "Mean square slope by theory, of this tile", lambda r: r.theory.statistics.mean_square_slope
    ),
    "height_scatter": Quantity("1", "Relative standard deviation of one tile's height", lambda r: r.theory.scatter),
    "endless_height": Quantity("m", "Significant wave height of an endless sea", lambda r: r.theory.whole),
    "wave_length": Quantity("m", "Length of the dominant waves", lambda r: r.theory.wave[0]),
    "wave_speed": Quantity("m/s", "Phase speed of the dominant waves", lambda r: r.theory.wave[1]),
}
OF_REPORT = {**MEASURED, **EXPECTED}
OF_RAIN: Quantities = {  # of `RainReadings`
    "drops_shown": for_tasks("1", "Drops that are drawn in the air", lambda rain: rain.drawn),
    "drops_falling": for_tasks("1", "Drops in the air", lambda rain: rain.drawn * rain.weight),
    "drops_fallen": for_tasks("1", "Drops that have met the sea", lambda rain: rain.fallen),
}


QUANTITIES: Quantities = {
    **{name: one._replace(value=of_report(one.value)) for name, one in MEASURED.items()},
    "crest_height": for_sweeps(
        "m", "Highest crest of the drawn sea", lambda now: now.params.amplitude * float(now.height.max())
    ),
    "skewness": for_sweeps("1", "Skewness of the heights of the drawn sea", lambda now: now.moments[0]),
    "kurtosis": for_sweeps("1", "Kurtosis of the heights of the drawn sea", lambda now: now.moments[1]),
    "breaking_loss": for_sweeps("J/m²", "Energy lost by breaking since the start", lambda now: now.breaking_loss),
    **{name: one._replace(value=of_report(one.value)) for name, one in EXPECTED.items()},
    "gravity_here": for_tasks("m/s²", "Gravity", lambda now: gravity(now.frame.params)),
    "gravity_light": for_tasks("m/s²", "Gravity of 1/100 Earth mass", lambda now: gravity_of(LIGHT, "same_density")),
    "gravity_heavy": for_tasks("m/s²", "Gravity of 100 Earth masses", lambda now: gravity_of(HEAVY, "same_density")),
    "open_height": for_tasks("m", "Significant height of an open sea", lambda now: here(now.frame.params).height),
    "open_speed": for_tasks("m/s", "Speed of its peak waves", lambda now: here(now.frame.params).speed),
    "twice_wind": for_tasks("m/s", "Twice the wind", lambda now: 2.0 * now.frame.params.wind_speed),
    "twice_height": for_tasks(
        "m", "Significant height in twice the wind", lambda now: in_twice_the_wind(now.frame.params).height
    ),
    "twice_speed": for_tasks(
        "m/s", "Speed of the peak waves in twice the wind", lambda now: in_twice_the_wind(now.frame.params).speed
    ),
    "earth_height": for_tasks(
        "m", "Significant height on the Earth, same wind", lambda now: on_earth(now.frame.params).height
    ),
    "earth_speed": for_tasks(
        "m/s", "Speed of the peak waves on the Earth, same wind", lambda now: on_earth(now.frame.params).speed
    ),
    "height_over_earth": for_tasks(
        "1",
        "Height over that on the Earth",
        height_over_earth,
    ),
    "height_by_wind": for_tasks("1", "Height in twice the wind over this one", height_by_wind),
    "measured_over_earth": for_tasks("1", "Height as drawn over that on the Earth", measured_over_earth),
    "damping_so_far": for_tasks(
        "m", "Length l of the decay by viscosity so far", lambda now: 2.0 * math.sqrt(now.readings.viscous_area)
    ),
    "minute_length": for_tasks(
        "m",
        "Length l of a minute of this viscosity",
        lambda now: 2.0 * math.sqrt(60.0 * acting(now.frame.params).viscosity),
    ),
    "square_grid_points": for_tasks("1", "Points of the square grid", lambda now: int(now.frame.params.size) ** 2),
    "square_spacing": for_tasks(
        "m", "Spacing of the square grid", lambda now: now.frame.params.length / int(now.frame.params.size)
    ),
    **{name: one._replace(value=of_rain(one.value)) for name, one in OF_RAIN.items()},
}
