"""The parameters of the square sea, its presets, and the sea that they describe."""

import dataclasses
import functools
import math
from typing import Any, NamedTuple

from app.formats.formatting import number
from app.scenes.groups import in_grid, in_look, in_main, in_plots, in_waves, speed_parameter
from app.scenes.sea_parameters import (
    SKY_TITLES,
    SPECTRUM_PARAMETERS,
    SPECTRUM_TITLES,
    chosen_spectrum,
    follows_wind,
    spectrum_values,
    unused_waves,
)
from sim.ocean.planets import RADIUS_RULES, SOLAR_SYSTEM, gravity_of
from sim.parameters import parameter, with_parameters
from sim.water import EARTH_GRAVITY

SIZES = ("64", "128", "256", "512")
MESHES = ("32", "64", "128", "256")
VIEW_HEIGHTS = {
    "swimmer": 1.7,
    "side": 3.0,
    "deck": 2.6,
    "bridge": 4.5,
    "mast": 8.0,
    "platform": 20.0,
    "gull": 40.0,
}  # [m] of the camera
VIEW_TITLES = {
    **{name: f"{name.capitalize()}, {height:g} m up" for name, height in VIEW_HEIGHTS.items()},
    "gauge": "Beside the wave gauge",
}
# [m/s2] of each body. The Earth has that of a planet of its mass, and of the other scenes.
GRAVITIES = {**{name: planet.gravity for name, planet in SOLAR_SYSTEM.items()}, "Earth": EARTH_GRAVITY}
PLANET_TITLES = {
    "by mass": "By mass",
    "by gravity": "By gravity",
    **{name: f"{name}, {number(g)} m/s²" for name, g in GRAVITIES.items()},
}
GAUGE_OFFSET_SHARE = (0.06, -0.015)  # of the tile's side: where the wave gauge stands, from the middle of the tile
MAX_GAUGE_OFFSET = (12.0, 3.0)  # [m] of a wave gauge near the camera, before a click has placed it
SURFACE_TENSION = 0.0728  # [N/m] of water against air
MAX_POINTS, MAX_POINTS_OF_HIGH_ORDER = 256, 128  # of a nonlinear sea, up to order 3 and above
LONG_CRESTED_STARTS = ("breather", "groups")
MARCHING_STARTS = (*LONG_CRESTED_STARTS, "rogue")  # solved step by step, at order 1 too
# Parameters of a linear sea only, and their values in a sea that is solved step by step.
LINEAR_ONLY = {"choppiness": 1.0, "transition": 0.0, "viscosity": 0.0, "dispersion_scale": 1.0, "loop_period": 0.0,
               "rings": 0.0}  # fmt: skip
in_foam = functools.partial(parameter, group="Foam and rain")
in_water = functools.partial(parameter, group="Water and planet")


@dataclasses.dataclass(frozen=True)
@with_parameters(SPECTRUM_PARAMETERS, group="Waves")
class SquareSeaParams:
    """The square sea's parameters, with those of all spectra; the defaults are the first preset."""

    wind_speed: float = in_main(8.0, 0.0, 60.0, "m/s", "Wind speed 10 m above the sea")
    rain: float = in_main(0.0, 0.0, 200.0, "mm/h", "Rainfall; 0 is no rain", log_from=0.1)
    planet: str = in_main("by mass", choices=PLANET_TITLES, doc="Source of the gravity")
    planet_mass: float = in_main(1.0, 0.01, 100.0, "Earths", "Mass of the planet", log_from=0.01, title="Mass")
    gravity: float = in_main(9.81, 0.01, 1000.0, "m/s²", "Gravity", log_from=0.01)
    view: str = in_main("deck", choices=VIEW_TITLES, doc="Place of the camera", affects="look")

    spectrum: str = in_waves("pierson_moskowitz", choices=SPECTRUM_TITLES, doc="Spectrum of the waves")
    wind_direction: float = in_main(20.0, -180.0, 180.0, "°", "Direction that the wind blows to, from +x towards +y")
    transition: float = in_waves(
        3.0, 0.0, 600.0, "s", "Time for the sea to adapt to new weather", log_from=0.1, title="Time to adapt"
    )
    start: str = in_waves(
        "as set",
        choices={
            "as set": "As set here", "calm": "Calm", "storm": "Storm", "breather": "Breather",
            "groups": "Regular waves with side bands", "rogue": "Towards a rogue wave",
        },
        doc="The sea at the start: as set here; a calm or a storm, from which a linear sea develops; or waves that "
        "grow: long-crested ones of this significant height, or the sea as set with a high crest after 4 periods",
        affects="start",
    )  # fmt: skip
    order: int = in_waves(
        1, 1, 7, "", "Order of nonlinearity: 1 is linear. From 3 on waves steepen, gather in groups, and break",
        affects="start", title="Order of waves",
    )  # fmt: skip

    radius_rule: str = in_water(
        "same_density", choices=tuple(RADIUS_RULES), doc="Rule for the radius of the planet, from its mass",
        title="Planet radius",
    )  # fmt: skip
    deep: bool = in_water(True, doc="Deep water; off: water of the depth below", title="Deep water")
    depth: float = in_water(20.0, 0.1, 5000.0, "m", "Depth of the water", log_from=0.1)
    choppiness: float = in_main(
        1.0, 0.0, 2.0, "", "Factor on the horizontal motion, which sharpens the crests; 1 is physics"
    )
    amplitude: float = in_water(1.0, 0.0, 5.0, "", "Factor on every height; 1 is physics", title="Height factor")
    low_pass: float = in_water(
        0.0, 0.0, 100.0, "m",
        "The damping parameter of the course lab: a length l, below which waves are left out; 0 is off", log_from=1e-2,
        title="Lab's damping length",
    )  # fmt: skip
    viscosity: float = in_water(
        0.0, 0.0, 10.0, "m²/s", "Kinematic viscosity: waves decay after the last change. Water 1e-6, heavy oil 2e-2",
        log_from=1e-7,
    )  # fmt: skip
    dispersion_scale: float = in_water(
        1.0, 0.0, 4.0, "", "Factor on the frequency of every wave; 1 is physics", title="Frequency factor"
    )
    loop_period: float = in_water(
        0.0, 0.0, 1000.0, "s", "The dispersion of the course lab: the sea repeats after this time; 0 is off",
        log_from=1.0, title="Lab's repeat period",
    )  # fmt: skip

    foam: bool = in_foam(True, doc="Foam where the surface is most compressed")
    foam_by_wind: bool = in_foam(True, doc="Foam cover as measured at this wind speed; less on damped seas")
    foam_threshold: float = in_foam(0.5, -1.0, 1.0, "", "Jacobian below which there is foam")
    foam_fade: float = in_foam(4.0, 0.1, 60.0, "s", "Time in which foam fades", log_from=0.1, title="Foam lifetime")
    drops: int = in_foam(1500, 1, 5000, "", "Largest number of drops shown", log_from=1, title="Drops shown")
    rings: float = in_foam(1.0, 0.0, 5.0, "", "Strength of the rings that drops make; 0 is off", title="Drop rings")

    length: float = in_grid(
        192.0, 32.0, 4096.0, "m", "Side of the square tile that repeats", log_from=32.0, affects="start",
        title="Tile side",
    )  # fmt: skip
    size: str = in_grid(
        "256", choices={n: f"{n} × {n}" for n in SIZES}, doc="Grid on which the sea is solved", title="Solved grid"
    )
    mesh: str = in_grid(
        "128", choices={n: f"{n} × {n}" for n in MESHES}, doc="Grid that is drawn, at most as fine as the solved one",
        title="Drawn grid",
    )  # fmt: skip
    seed: int = in_grid(
        4, 0, 999, "", "Seed of the random numbers: another sea in the same weather", affects="start",
        title="Random seed",
    )  # fmt: skip

    speed: float = speed_parameter(0.01, 8.0)
    slow_motion: bool = parameter(
        True, doc="Time slows while a crest higher than the significant height passes the wave gauge", affects="look",
        group="Time", title="Slow motion at a high crest",
    )  # fmt: skip
    frame_rate: float = parameter(30.0, 5.0, 60.0, "Hz", "Frames per second", affects="look", group="Time")

    grid: bool = in_look(False, doc="Lines of the drawn grid (key G)")
    gauge: bool = in_look(True, doc="Draw the wave gauge, a buoy", title="Wave gauge")
    sky: str = in_look("park", choices=SKY_TITLES, doc="Sky and its light")
    sun: float = in_look(18.0, -180.0, 180.0, "°", "Direction of the sun, from +x towards +y", title="Sun direction")
    clouds: float = in_look(0.4, 0.0, 1.0, "", "Fraction of the sky covered by clouds", title="Cloud cover")
    daylight: float = in_look(0.85, 0.05, 3.0, "", "Brightness", title="Brightness")
    visibility: float = in_look(3000.0, 50.0, 20000.0, "m", "Distance at which haze hides the sea", log_from=50.0)

    statistics: bool = in_plots(True, doc="Measure the sea as drawn, and compare it with theory")
    plot_wave_gauge: bool = in_plots(
        False, doc="Height at the wave gauge over time; click the water to place the gauge", title="Wave gauge"
    )
    plot_wave_spectrum: bool = in_plots(False, doc="Spectrum at the wave gauge beside theory", title="Wave spectrum")

    spectrum_file: str = ""  # a measured spectrum; named on the command line only, never by a browser
    spectrum_time: str = ""  # of its record, "" for the last one
    spectrum_missing: str = ""  # numbers for a missing value in it, "none", or "" for its own rule


PRESETS: dict[str, dict[str, Any]] = {
    "Earth breeze": {},
    "Storm arriving": {
        "spectrum": "jonswap", "wind_speed": 24.0, "fetch": 200e3, "start": "calm", "transition": 20.0, "rain": 15.0,
        "length": 600.0, "choppiness": 1.2, "clouds": 1.0, "daylight": 0.7, "visibility": 1200.0, "drops": 3000,
        "view": "bridge",
    },
    "Storm over": {
        "wind_speed": 7.0, "start": "storm", "transition": 20.0, "length": 384.0, "sky": "sunset", "clouds": 0.45,
    },
    "Light planet": {
        "planet_mass": 0.01, "length": 1024.0, "wind_speed": 10.0, "visibility": 6000.0, "sky": "dawn", "view": "mast",
    },
    "Heavy planet": {"planet_mass": 100.0, "length": 128.0, "wind_speed": 10.0, "visibility": 1500.0, "view": "mast"},
    "Rain shower": {
        "rain": 30.0, "length": 40.0, "wind_speed": 0.5, "wind_direction": 70.0, "mesh": "256", "rings": 0.8,
        "frame_rate": 24.0, "view": "deck", "drops": 1500, "foam": False, "clouds": 1.0, "sun": 8.0,
    },
    "Peregrine breather": {
        "order": 4, "start": "breather", "spectrum": "regular", "wave_height": 1.27, "wave_period": 5.06,
        "wind_direction": 0.0, "wind_speed": 4.0, "length": 960.0, "mesh": "256", "speed": 8.0, "sun": 150.0,
        "foam_by_wind": False, "foam_threshold": 0.6, "view": "gauge", "plot_wave_gauge": True,
    },
    "Steep waves split into groups": {
        "order": 4, "start": "groups", "spectrum": "regular", "wave_height": 1.4, "wave_period": 5.06,
        "wind_direction": 0.0, "wind_speed": 4.0, "length": 960.0, "mesh": "256", "speed": 8.0, "sun": 150.0,
        "foam_by_wind": False, "foam_threshold": 0.6, "view": "platform", "plot_wave_gauge": True,
    },
    "Draupner": {
        "order": 3, "start": "rogue", "spectrum": "sea_state", "hs": 8.4, "tp": 15.0, "second_height": 8.4,
        "second_period": 15.0, "wind_direction": -60.0, "second_direction": 60.0, "spreading": "cos2s",
        "spread_exponent": 25.0, "wind_speed": 20.0, "deep": False, "depth": 70.0, "length": 1200.0, "size": "128",
        "seed": 1, "foam_by_wind": False, "foam_threshold": 0.3, "foam_fade": 1.0, "speed": 2.0, "view": "gauge",
        "plot_wave_gauge": True,
        "clouds": 1.0, "daylight": 1.7, "visibility": 3000.0,
    },
    "Steep storm": {
        "order": 3, "spectrum": "jonswap", "wind_speed": 25.0, "fetch": 60e3, "length": 512.0, "size": "128",
        "start": "rogue", "plot_wave_gauge": True,
        "foam_by_wind": False, "foam_threshold": 0.57, "foam_fade": 2.0, "view": "gauge", "clouds": 0.9,
        "daylight": 1.1, "visibility": 2000.0,
    },
}  # fmt: skip

ABOUT = {  # preset -> a sentence: its subject and something to try
    "Earth breeze": "Waves of a breeze on the Earth: turn the wind up, or choose another planet.",
    "Storm arriving": "A storm raises waves, foam and rain on a calm sea within 20 s.",
    "Storm over": "A storm dies down within 20 s, at sunset.",
    "Light planet": "On a planet of 1/100 of the Earth's mass the same wind makes higher, longer waves.",
    "Heavy planet": "On a planet of 100 times the Earth's mass the same wind makes lower, shorter waves.",
    "Rain shower": "Rain on nearly calm water: watch the rings spread.",
    "Peregrine breather": "Regular waves gather within a minute into one that is three times as high, at the staff.",
    "Steep waves split into groups": "Regular, steep waves split into groups within a minute; at order 1 they do not.",
    "Draupner": "A crossing sea of 11.9 m makes a crest of 18.5 m after 60 s, as was measured in 1995.",
    "Steep storm": "Steep waves of a short fetch break. After 20 s a high crest comes to the staff.",
}


class RogueRecord(NamedTuple):
    """A measured rogue wave."""

    height: float  # [m] significant
    crest: float  # [m]
    period: tuple[float, float]  # [s] of the wave, from and to


DRAUPNER = RogueRecord(11.9, 18.5, (12.0, 13.0))  # 1 January 1995, from the laser of the platform (Haver 2004)


class RainSettings(NamedTuple):
    """Parameters of the rainfall: a change of one restarts it."""

    rate: float  # [mm/h]
    drops: int  # largest number of drops drawn
    ring_strength: float
    wind: tuple[float, float]  # [m/s]
    gravity: float  # [m/s2]
    size: int  # grid points of the sea along a side
    amplitude: float  # factor on every drawn height


def marches(params: SquareSeaParams) -> bool:
    """True if the sea is solved step by step; the sum of linear waves is known at all times."""
    return params.order > 1 or params.start in MARCHING_STARTS


def is_draupner(params: SquareSeaParams) -> bool:
    """True if the sea is that of the Draupner preset, however it is drawn."""
    return params.start == "rogue" and sea_of(params) == draupner_sea()


def sea_of(params: SquareSeaParams) -> tuple[object, ...]:
    """The parameters and conditions that determine the heights of its waves."""
    return params.start, params.order, params.length, params.amplitude, params.seed, conditions(params)


@functools.cache
def draupner_sea() -> tuple[object, ...]:
    """`sea_of` the Draupner preset."""
    return sea_of(SquareSeaParams(**PRESETS["Draupner"]))


def acting(params: SquareSeaParams) -> SquareSeaParams:
    """The parameters, with those replaced that have no effect on a solved sea."""
    return dataclasses.replace(params, **LINEAR_ONLY) if marches(params) else params


def solved_points(p: SquareSeaParams) -> int:
    """Points along a side of the solved grid; of long-crested waves, along x alone."""
    size = int(p.size)
    if not marches(p) or p.start in LONG_CRESTED_STARTS:
        return size
    return min(size, MAX_POINTS if p.order <= 3 else MAX_POINTS_OF_HIGH_ORDER)


def gauge_home(params: SquareSeaParams) -> tuple[float, float]:
    """Initial place of the wave gauge [m], until a click moves it: near the camera, or at a coming high wave."""
    x, y = (
        math.copysign(min(abs(share) * params.length, math.inf if marches(params) else limit), share)
        for share, limit in zip(GAUGE_OFFSET_SHARE, MAX_GAUGE_OFFSET, strict=True)
    )
    return 0.5 * params.length + x, 0.5 * params.length + y


def gravity(params: SquareSeaParams) -> float:
    """Gravity [m/s2] of the chosen planet."""
    if params.planet == "by gravity":
        return params.gravity
    if params.planet == "by mass":
        return gravity_of(params.planet_mass, params.radius_rule)
    return GRAVITIES[params.planet]


def conditions(params: SquareSeaParams, wind_speed: float | None = None) -> dict[str, Any]:
    """The arguments of `Sea` and `Sea.change`. wind_speed: U10 [m/s] in place of the one in `params`."""
    params = acting(params)
    wind, spectrum = params.wind_speed if wind_speed is None else wind_speed, chosen_spectrum(params)
    return {
        "spectrum": spectrum,
        "wind_speed": spectrum.wind_speed(wind),
        "wind_direction": math.radians(params.wind_direction),
        "gravity": gravity(params),
        "depth": math.inf if params.deep else params.depth,
        "tension": 0.0 if marches(params) else SURFACE_TENSION,
        "low_pass": params.low_pass,
        "viscosity": params.viscosity,
        "dispersion_scale": params.dispersion_scale,
        "loop_period": params.loop_period or None,
        **{name: value for name, value in spectrum_values(params).items() if spectrum.uses(name)},
    }


def rain_settings(params: SquareSeaParams) -> RainSettings:
    """Parameters of the rainfall."""
    p = acting(params)
    bearing = math.radians(p.wind_direction)
    wind = p.wind_speed * math.cos(bearing), p.wind_speed * math.sin(bearing)
    return RainSettings(p.rain, p.drops, p.rings, wind, gravity(p), int(p.size), p.amplitude)


def hidden(params: SquareSeaParams) -> set[str]:
    """Names of the parameters without effect beside the present others."""
    names = unused_waves(params)
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
        names |= {"drops", "rings"} | (set() if follows_wind(params) else {"wind_direction"})
    return names | (set(LINEAR_ONLY) if marches(params) else {"slow_motion"})
