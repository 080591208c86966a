"""The parameters of the square sea, and what of the sea they describe."""

import dataclasses
import math
from typing import Any

from sim.ocean.planets import RADIUS_RULES, SOLAR_SYSTEM, gravity_of
from sim.ocean.spectra import SPECTRA
from sim.parameters import parameter

SIZES = ("64", "128", "256", "512")
MESHES = ("32", "64", "128", "256")
VIEWS = ("swimmer", "deck", "bridge", "mast", "gull")
TENSION = 0.0728  # [N/m] of water against air
CALM = 0.05  # [m/s] wind below which there are no waves: squares of smaller numbers run out of range


@dataclasses.dataclass(frozen=True)
class Params:
    """The square sea's parameters; the defaults are the first preset."""

    spectrum: str = parameter(
        "pierson_moskowitz", choices=tuple(SPECTRA), doc="Law of the waves' energy", group="Weather"
    )
    wind_speed: float = parameter(
        8.0, 0.0, 60.0, "m/s", "Wind 10 m up, 19.5 m up for pierson_moskowitz", group="Weather"
    )
    wind_direction: float = parameter(
        20.0, -180.0, 180.0, "°", "Where the wind goes to, from x towards y", group="Weather"
    )
    rain: float = parameter(0.0, 0.0, 200.0, "mm/h", "Rain; 0 is none", log_from=0.1, group="Weather")
    transition: float = parameter(
        3.0, 0.0, 600.0, "s", "Time in which the sea takes to new weather", log_from=0.1, group="Weather"
    )
    start: str = parameter(
        "as set",
        choices=("as set", "calm", "storm"),
        doc="The sea at reset: as set here, or a calm or a storm that then gives way to it",
        group="Weather",
        affects="start",
    )
    fetch: float = parameter(100e3, 1e3, 1e6, "m", "Way of the wind over water", log_from=1e3, group="Weather")
    peak_enhancement: float = parameter(3.3, 1.0, 10.0, "", "Gamma: how peaked", group="Weather")
    inverse_wave_age: float = parameter(0.84, 0.84, 5.0, "", "Omega: 0.84 full grown, 5 very young", group="Weather")
    phillips_constant: float = parameter(
        1.7421e-3, 0.0, 0.1, "", "A of Phillips; 1.74e-3 gives Pierson and Moskowitz's height", log_from=1e-5,
        group="Weather",
    )  # fmt: skip
    swell: float = parameter(0.0, 0.0, 1.0, "", "0 wind sea to 1 long crests", group="Weather")

    planet: str = parameter(
        "by mass", choices=("by mass", "by gravity", *SOLAR_SYSTEM), doc="What sets gravity", group="Planet"
    )
    planet_mass: float = parameter(1.0, 0.01, 100.0, "Earths", "Mass of the planet", log_from=0.01, group="Planet")
    radius_rule: str = parameter(
        "same_density", choices=tuple(RADIUS_RULES), doc="How the planet's radius goes with its mass", group="Planet"
    )
    gravity: float = parameter(9.81, 0.01, 1000.0, "m/s^2", "Gravity", log_from=0.01, group="Planet")

    deep: bool = parameter(True, doc="No bottom; off: water of the depth below", group="Water")
    depth: float = parameter(20.0, 0.1, 5000.0, "m", "Depth", log_from=0.1, group="Water")
    choppiness: float = parameter(
        1.0, 0.0, 2.0, "", "Horizontal motion that sharpens crests; 1 is physics", group="Water"
    )
    amplitude: float = parameter(1.0, 0.0, 5.0, "", "Factor on every height as drawn; 1 is physics", group="Water")
    low_pass: float = parameter(
        0.0, 0.0, 100.0, "m", "The lab's damping: waves shorter than this length l are left out", log_from=1e-2,
        group="Water",
    )  # fmt: skip
    viscosity: float = parameter(
        0.0, 0.0, 10.0, "m^2/s", "Kinematic viscosity: waves decay from the last change on; water 1e-6, heavy oil 2e-2",
        log_from=1e-7, group="Water",
    )  # fmt: skip
    dispersion_scale: float = parameter(1.0, 0.0, 4.0, "", "Factor on every frequency; 1 is physics", group="Water")
    loop_period: float = parameter(
        0.0, 0.0, 1000.0, "s", "The lab's dispersion: the sea repeats after this time; 0 is never", log_from=1.0,
        group="Water",
    )  # fmt: skip

    length: float = parameter(
        192.0, 32.0, 4096.0, "m", "Side of the tile that repeats", log_from=32.0, group="Grid", affects="start"
    )
    size: str = parameter("256", choices=SIZES, doc="Waves solved along a side", group="Grid")
    mesh: str = parameter(
        "128", choices=MESHES, doc="Points drawn along a side, at most as many as solved", group="Grid"
    )
    grid: bool = parameter(False, doc="Show the grid of the drawn mesh (key G)", group="Grid", affects="look")
    frame_rate: float = parameter(30.0, 5.0, 60.0, "Hz", "Pictures a second", group="Grid", affects="look")
    speed: float = parameter(1.0, 0.01, 8.0, "", "Simulated per real time", log_from=0.01, group="Grid", affects="look")
    seed: int = parameter(4, 0, 999, "", "Another sea under the same weather", group="Grid", affects="start")

    foam: bool = parameter(True, doc="Foam where crests fold", group="Foam and rain")
    foam_by_wind: bool = parameter(True, doc="As much as Monahan measured at this wind", group="Foam and rain")
    foam_threshold: float = parameter(0.5, -1.0, 1.0, "", "Jacobian below which there is foam", group="Foam and rain")
    foam_fade: float = parameter(4.0, 0.1, 60.0, "s", "Time in which foam fades", log_from=0.1, group="Foam and rain")
    drops: int = parameter(1500, 1, 5000, "", "Drops drawn at most", log_from=1, group="Foam and rain")
    rings: float = parameter(1.0, 0.0, 5.0, "", "Strength of the rings; 0 is none", group="Foam and rain")

    view: str = parameter("deck", choices=VIEWS, doc="Where to look from", group="Look", affects="look")
    sky: str = parameter(
        "park", choices=("park", "sunset", "dawn", "night"), doc="Sky and light", group="Look", affects="look"
    )
    sun: float = parameter(18.0, -180.0, 180.0, "°", "Bearing of the sun", group="Look", affects="look")
    clouds: float = parameter(0.4, 0.0, 1.0, "", "Cloud cover", group="Look", affects="look")
    daylight: float = parameter(0.85, 0.05, 3.0, "", "Brightness", group="Look", affects="look")
    visibility: float = parameter(
        3000.0, 50.0, 20000.0, "m", "Distance at which haze hides", log_from=50.0, group="Look", affects="look"
    )

    statistics: bool = parameter(
        True, doc="Measure the drawn sea and hold it against theory", group="Plots", affects="look"
    )
    plot_probe: bool = parameter(
        False, doc="Height at the probe; click the water to place it", group="Plots", affects="look"
    )
    plot_spectrum: bool = parameter(False, doc="Spectrum at the probe beside theory", group="Plots", affects="look")


def gravity(params: Params) -> float:
    """Gravity [m/s2] that the parameters ask for."""
    if params.planet == "by gravity":
        return params.gravity
    if params.planet == "by mass":
        return gravity_of(params.planet_mass, params.radius_rule)
    return SOLAR_SYSTEM[params.planet].gravity


def conditions(params: Params, wind_speed: float | None = None) -> dict[str, Any]:
    """What `Sea` and `Sea.change` take, at another wind where one is given [m/s]."""
    wind = params.wind_speed if wind_speed is None else wind_speed
    return {
        "spectrum": params.spectrum,
        "wind_speed": wind if wind >= CALM else 0.0,
        "wind_direction": math.radians(params.wind_direction),
        "gravity": gravity(params),
        "depth": math.inf if params.deep else params.depth,
        "tension": TENSION,
        "fetch": params.fetch,
        "peak_enhancement": params.peak_enhancement,
        "inverse_wave_age": params.inverse_wave_age,
        "phillips_constant": params.phillips_constant,
        "swell": params.swell,
        "low_pass": params.low_pass,
        "viscosity": params.viscosity,
        "dispersion_scale": params.dispersion_scale,
        "loop_period": params.loop_period or None,
    }


def hidden(params: Params) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = {"fetch", "peak_enhancement", "inverse_wave_age", "phillips_constant", "swell"}
    names -= set(SPECTRA[params.spectrum].parameters)
    if params.planet != "by mass":
        names |= {"planet_mass", "radius_rule"}
    if params.planet != "by gravity":
        names.add("gravity")
    if params.deep:
        names.add("depth")
    if not params.foam:
        names |= {"foam_by_wind", "foam_fade"}
    if not params.foam or params.foam_by_wind:
        names.add("foam_threshold")
    if params.rain == 0.0:
        names |= {"drops", "rings"}
    return names
