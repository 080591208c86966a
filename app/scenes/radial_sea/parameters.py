"""The parameters of the radial sea, its presets, and the parameters without effect at present."""

import dataclasses
import functools
import math
from typing import Any

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
from sim.floating.hulls.hull import MeshReading
from sim.ocean.fluids.emulsions import MIXTURE_LAWS
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import Fluid, fluids
from sim.ocean.radial.radial_grid import LAWS
from sim.ocean.spectra import SPECTRA, Conditions, Spectrum
from sim.ocean.weathering import Spill, WeatheredOil, can_weather, oil_at, weather
from sim.parameters import parameter, with_parameters

OILS = tuple(name for name in fluids() if "water" not in name)
CAMERA_TARGETS = ("free", "first buoy", "second buoy", "box", "cutaway", "from above", "rig")
WATER = "sea water"
MIN_FILM = 1e-6  # [m] least thickness of a layer of oil: a thinner spill is gone
OWN_DENSITIES = ("density_1", "density_2", "density_3")  # parameters: densities of the first bodies
LEVEL_SPECTRUM = "pierson_moskowitz"  # makes no waves without wind
in_bodies = functools.partial(parameter, group="Bodies")
in_oil = functools.partial(parameter, group="Oil")
in_rig = functools.partial(parameter, group="Rig")
in_spill = functools.partial(parameter, group="Spill over hours")


@dataclasses.dataclass(frozen=True)
@with_parameters(SPECTRUM_PARAMETERS, group="Waves")
class RadialSeaParams:
    """The parameters, with those of all spectra; the defaults are clean water in a moderate breeze."""

    wind_speed: float = in_main(7.0, 0.5, 25.0, "m/s", "Wind speed 10 m above the sea")
    spill: str = in_main(
        "none", choices={"none": "No oil", "layer": "Layer of oil", "mixed": "Entirely mixed"},
        doc="Layer: oil floats on the water. Entirely mixed: oil and water are one fluid, as the lab assumes",
        title="Oil spill",
    )  # fmt: skip
    oil: str = in_main("Alaska North Slope 2002", choices=OILS, doc="Kind of oil, from NOAA's records")
    thickness: float = in_main(
        0.2, 0.0, 2.0, "m", "Thickness d of the layer of oil", log_from=1e-5, title="Layer thickness"
    )
    fraction: float = in_main(0.5, 0.01, 0.99, "", "Fraction of oil in the mixture, by volume", title="Fraction of oil")
    cutaway: bool = in_main(
        False, doc="Cut the sea open beside the first buoy, to see the oil, the interface, and the hull in both fluids",
        affects="look", title="Cutaway",
    )  # fmt: skip
    follow: str = in_main(
        "free", choices=CAMERA_TARGETS, doc="Target that the camera follows", affects="look",
        title="Camera follows",
    )  # fmt: skip

    waves: bool = in_waves(True, doc="Waves; without them the sea is level")
    wind_direction: float = in_main(25.0, -180.0, 180.0, "°", "Direction that the wind blows to, from +x towards +y")
    spectrum: str = in_waves("jonswap", choices=SPECTRUM_TITLES, doc="Spectrum of the waves")
    wave_count: int = in_waves(
        96, 8, 512, "", "Number of waves in the sum, each of the same energy; the panel shows their height and slope",
        log_from=8, title="Number of waves",
    )  # fmt: skip
    choppiness: float = in_waves(
        1.0, 0.0, 1.5, "", "Factor on the horizontal motion, which sharpens the crests; 1 is physics"
    )

    mixture_law: str = in_oil(
        "pal_rhodes",
        choices={
            "pal_rhodes": "Pal-Rhodes (emulsion)",
            "mooney": "Mooney (emulsion)",
            "taylor": "Taylor (thin emulsion)",
            "arrhenius": "Arrhenius (solution)",
            "kendall_monroe": "Kendall-Monroe (solution)",
        },
        doc="Viscosity of the mixture",
        title="Mixture law",
    )
    continuous: str = in_oil(
        "plentiful",
        choices={"plentiful": "The more plentiful", "water": "Water: oil in water", "oil": "Oil: water in oil"},
        doc="Fluid around the drops of an emulsion. Spills at sea form water-in-oil emulsions (mousse)",
        title="Continuous fluid",
    )  # fmt: skip
    film: bool = in_oil(False, doc="A surface film that cannot be stretched, which damps ripples", title="Surface film")
    exposure: float = in_oil(
        60.0, 0.0, 3600.0, "s", "Time for which the oil has damped the waves at the start", log_from=1.0,
        title="Age at the start",
    )  # fmt: skip
    ageing: bool = in_oil(True, doc="Keep damping the waves as time passes", title="Keep damping")
    optics: str = in_oil(
        "physical", choices={"physical": "Physical", "lab": "Lab: oil reflects less"},
        doc="Physical: Fresnel reflection by the fluid's refractive index. Lab: reflections of oil are scaled down",
        affects="look", title="Reflections",
    )  # fmt: skip

    spill_volume: float = in_spill(
        100.0, 1.0, 1e5, "m³", "Volume of oil spilled, all at once", log_from=1.0, title="Volume spilled"
    )
    temperature: float = in_spill(
        15.0, 0.0, 30.0, "°C", "Temperature of the oil; the water's density stays as at 15 °C"
    )
    spill_hours: float = in_spill(
        0.0, 0.0, 120.0, "h",
        "Time since the spill, during which the oil evaporates, takes up water and thickens",
        title="Time since the spill",
    )  # fmt: skip
    spread: bool = in_spill(
        False, doc="Use the thickness to which the oil has spread by then, instead of the one set",
        title="Thickness as spread",
    )  # fmt: skip

    bodies: int = in_main(3, 0, 200, "", "Number of floating bodies: two buoys, a box, then all kinds in turn")
    density: float = in_main(450.0, 50.0, 1020.0, "kg/m³", "Density of the bodies")
    own_densities: bool = in_bodies(False, doc="Separate densities for the first three bodies", title="Own densities")
    density_1: float = in_bodies(
        300.0, 50.0, 1020.0, "kg/m³", "Density of the first body, the red buoy", title="Red buoy"
    )
    density_2: float = in_bodies(
        600.0, 50.0, 1020.0, "kg/m³", "Density of the second body, the yellow buoy", title="Yellow buoy"
    )
    density_3: float = in_bodies(900.0, 50.0, 1020.0, "kg/m³", "Density of the third body, the box", title="Box")
    size: float = in_main(1.5, 0.3, 4.0, "", "Size of the bodies; at 1 the box is 1.2 m wide")
    ripples: bool = in_bodies(True, doc="Moving bodies radiate waves", title="Radiated waves")
    mooring: bool = in_bodies(
        True, doc="Four elastic lines from the keel of each body to anchors on the bed, 60 m deep"
    )
    pull: float = in_bodies(
        6.0, 0.5, 50.0, "", "Largest force with which the mouse pulls a body, over its weight", affects="look",
        title="Mouse force",
    )  # fmt: skip

    rig: bool = in_rig(True, doc="The oil rig")
    fire: bool = in_rig(False, doc="The rig burns")
    fire_power: float = in_rig(400.0, 10.0, 2000.0, "MW", "Power of the fire", log_from=10.0)
    jet: bool = in_rig(False, doc="A jet of oil shoots from the rig and feeds a slick", title="Jet of oil")
    jet_flow: float = in_rig(2.0, 0.05, 20.0, "m³/s", "Flow of the jet", log_from=0.05)
    particles: int = in_rig(4000, 100, 20000, "", "Particles of the fire; the jet has half as many", log_from=100)

    surface: str = in_grid(
        "sum", choices={"sum": "Sum of waves (radial)", "fft": "FFT (the square sea)"},
        doc="Method that computes the surface; both are drawn on the same radial grid",
    )  # fmt: skip
    centre: str = in_grid(
        "fixed", choices={"fixed": "At the bodies", "camera": "Below the camera"},
        doc="Centre of the dense part of the grid", affects="look", title="Grid centre",
    )  # fmt: skip
    rings: int = in_grid(128, 16, 256, "", "Rings of the grid", affects="look")
    spokes: int = in_grid(128, 16, 256, "", "Points on a ring", affects="look")
    ring_law: str = in_grid(
        "geometric", choices={LAWS[0]: "Geometric", LAWS[1]: "Power (lab)"},
        doc="Law by which the spacing of the rings grows outwards", affects="look", title="Ring spacing",
    )  # fmt: skip
    compare: bool = in_grid(
        False, doc="Time both surfaces every 2 s, for the table 'Radial or square'", affects="look",
        title="Compare surfaces",
    )  # fmt: skip

    time_step: float = parameter(1 / 60, 1 / 500, 1 / 20, "s", "Step of the bodies' motion", group="Time")
    speed: float = speed_parameter(0.05, 4.0)

    sky: str = in_look("park", choices=SKY_TITLES, doc="Sky and its light")
    grid: bool = in_look(False, doc="Lines of the grid (key G)")
    plot_draft: bool = in_plots(False, doc="Drafts of the first three bodies over time", title="Drafts")
    plot_surface: bool = in_plots(
        False, doc="Height of the sea at the first buoy, and of the buoy, over time", title="Buoy and sea"
    )
    plot_budget: bool = in_plots(False, doc="Fate of the spilled oil over five days", title="Oil budget")

    # Files are named on the command line only, never by a browser.
    hull: str = ""  # a mesh that floats too
    hull_unit: str = ""  # fields of `MeshReading`
    hull_weld: float = 0.0  # [m]
    hull_mirror: str = ""
    hull_cap: str = ""
    spectrum_file: str = ""  # a measured spectrum
    spectrum_time: str = ""  # of its record, "" for the last one
    spectrum_missing: str = ""  # numbers for a missing value in it, "none", or "" for its own rule


PRESETS: dict[str, dict[str, Any]] = {
    "Clear water": {},
    "Light crude spill 0.2 m": {
        "spill": "layer", "thickness": 0.2, "exposure": 60.0, "cutaway": True, "follow": "cutaway", "wind_speed": 5.0,
    },
    "Heavy fuel oil": {
        "spill": "layer", "oil": "IFO 180", "thickness": 0.5, "exposure": 600.0, "follow": "from above",
        "sky": "sunset",  # oil mirrors the sky: under a blue one it looks like water
    },
    "Entirely mixed": {"spill": "mixed", "oil": "Arabian Light", "fraction": 0.4, "follow": "from above"},
    "Storm with buoys": {"wind_speed": 17.0, "bodies": 12, "wave_count": 160, "size": 2.0, "follow": "from above"},
    "Burning rig": {"fire": True, "jet": True, "follow": "rig", "sky": "dawn", "wind_speed": 6.0},
    "A day after a spill": {
        "spill": "layer", "oil": "Arabian Light", "spill_hours": 24.0, "spread": True, "exposure": 3600.0,
        "plot_budget": True, "follow": "from above", "sky": "sunset",
    },
}  # fmt: skip

ABOUT = {  # preset -> a sentence: its subject and something to try
    "Clear water": "Buoys and a box float on clean water: push one under and let go.",
    "Light crude spill 0.2 m": "Light crude oil on the sea: compare how deep bodies float with clean water.",
    "Heavy fuel oil": "Half a metre of heavy fuel oil: see which waves it has damped.",
    "Entirely mixed": "Oil mixed into the water: the bodies float in a fluid of another density.",
    "Storm with buoys": "Twelve bodies in a storm: hold one against the waves.",
    "Burning rig": "A burning rig blows oil onto the sea: see the slick calm the waves.",
    "A day after a spill": "A spill of crude oil after a day: the chart shows where the oil has gone.",
}


def hidden(params: RadialSeaParams) -> set[str]:
    """The parameters without effect beside the present others."""
    names = unused_waves(params)
    if params.spill != "layer":
        names |= {"thickness", "temperature"}
    if spill_of(params) is None:
        names |= {"spill_volume", "spill_hours", "spread", "plot_budget"}
    elif params.spread:
        names.add("thickness")
    if params.spill != "mixed":
        names |= {"fraction", "mixture_law", "continuous"}
    elif not MIXTURE_LAWS[params.mixture_law].is_emulsion:
        names.add("continuous")
    if params.spill == "none":
        names |= {"film", "exposure", "ageing", "optics"}
        if not (params.rig and params.jet):
            names.add("oil")
    if not params.waves:
        names |= {"spectrum", *SPECTRUM_PARAMETERS, "wave_count", "choppiness", "exposure", "ageing", "film"}
        if not (params.rig and params.fire):  # the wind still blows the smoke
            names |= {"wind_direction"} | ({"wind_speed"} if spill_of(params) is None else set())
    elif not follows_wind(params) and not (params.rig and params.fire):
        names.add("wind_direction")
    if params.bodies == 0:
        names |= {"density", "own_densities", "size", "ripples", "mooring", "pull"}
    names |= {name for i, name in enumerate(OWN_DENSITIES) if not params.own_densities or i >= params.bodies}
    if not params.rig:
        names |= {"fire", "jet"}
    if not (params.rig and params.fire):
        names.add("fire_power")
    if not (params.rig and params.jet):
        names.add("jet_flow")
    if not (params.rig and (params.fire or params.jet)):
        names.add("particles")
    is_regular = params.spectrum == "regular" and not params.spectrum_file
    if is_regular and spectrum_values(params)["second_height"] == 0.0:
        names.add("wave_count")
    return names


def reading_of(params: RadialSeaParams) -> MeshReading:
    """The way in which the mesh file of the hull is read."""
    return MeshReading(params.hull_unit, params.hull_weld, params.hull_mirror, params.hull_cap)


def own_densities_of(params: RadialSeaParams) -> tuple[float, ...]:
    """Densities [kg/m3] of the first bodies, if they have their own."""
    return tuple(getattr(params, name) for name in OWN_DENSITIES) if params.own_densities else ()


def densities_of(params: RadialSeaParams) -> tuple[float, ...]:
    """Densities of the parameters [kg/m3]; equal ones make equal bodies."""
    return (params.density, *own_densities_of(params))


def spill_of(params: RadialSeaParams) -> Spill | None:
    """The spill that floats on the sea.

    None without a layer of oil, or if the oil's record has no distillation data.
    """
    if params.spill != "layer" or not can_weather(params.oil):
        return None
    return Spill(
        oil=params.oil, volume=params.spill_volume, wind_speed=params.wind_speed, temperature=params.temperature,
        water=WATER,
    )  # fmt: skip


def weathered_oil(params: RadialSeaParams) -> WeatheredOil | None:
    """The oil of the spill at its present age; None without a spill to follow."""
    spill = spill_of(params)
    return None if spill is None else spill_at(spill, params.spill_hours)


@functools.lru_cache(maxsize=8)
def spill_at(spill: Spill, hours: float) -> WeatheredOil:
    """A spill after a number of hours; cached, as several quantities and the fluids read it."""
    return weather(spill).at(hours)


def oil_of(params: RadialSeaParams) -> Fluid:
    """The oil in force: of a layer at its set temperature and age, otherwise fresh and at 15 degrees."""
    if params.spill != "layer":
        return fluids()[params.oil]
    weathered = weathered_oil(params) if params.spill_hours > 0.0 else None
    return oil_at(params.oil, params.temperature) if weathered is None else weathered.fluid(params.oil)


def thickness_of(params: RadialSeaParams) -> float:
    """Thickness [m] of the layer of oil: as set, or as thin as it has spread."""
    if params.spill != "layer":
        return 0.0
    weathered = weathered_oil(params) if params.spread else None
    if weathered is None:
        return params.thickness
    return weathered.thickness if weathered.thickness >= MIN_FILM else 0.0


def column_of(params: RadialSeaParams) -> FluidColumn:
    """The fluids that the parameters describe."""
    return FluidColumn(
        oil=oil_of(params),
        thickness=thickness_of(params),
        fraction=params.fraction if params.spill == "mixed" else 0.0,
        law=params.mixture_law,
        continuous=params.continuous,
        film=params.film and params.spill != "none",
    )


def spectrum_of(params: RadialSeaParams) -> Spectrum:
    """The spectrum of the waves; for a level sea one that makes no waves without wind."""
    return chosen_spectrum(params) if params.waves else SPECTRA[LEVEL_SPECTRUM]


def conditions_of(params: RadialSeaParams) -> Conditions:
    """The conditions under which the spectrum is evaluated."""
    spectrum = spectrum_of(params)
    values = spectrum_values(params) | {"wind_direction": math.radians(params.wind_direction)}
    if params.waves:
        return spectrum.conditions_from(values | {"wind_speed": spectrum.wind_speed(params.wind_speed)})
    return spectrum.conditions_from(values | {"wind_speed": 0.0, "second_height": 0.0})


def exposure_of(params: RadialSeaParams) -> float:
    """Time [s] for which the waves have run under oil at the start."""
    return params.exposure if params.spill != "none" else 0.0
