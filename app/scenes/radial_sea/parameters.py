"""The parameters of the radial sea, its presets, and which parameters mean nothing just now."""

import dataclasses
import math
from typing import Any

from app.scenes.spectrum_parameters import SPECTRUM_PARAMETERS, spectrum_values
from sim.ocean.emulsions import MIXTURE_LAWS
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.fluids import Fluid, fluids
from sim.ocean.radial_grid import LAWS
from sim.ocean.spectra import SPECTRA, Conditions, Spectrum
from sim.ocean.weathering import Spill, WeatheredOil, can_weather, oil_at, weather
from sim.parameters import parameter, with_parameters

OILS = tuple(name for name in fluids() if "water" not in name)
CAMERA_TARGETS = ("free", "first buoy", "second buoy", "box", "cutaway", "from above", "rig")
SPECTRUM_TITLES = {
    name: SPECTRA[name].title for name in sorted(SPECTRA, key=["pierson_moskowitz", "phillips", *SPECTRA].index)
}
WATER = "sea water"
MIN_FILM = 1e-6  # [m] of oil that counts as a layer: thinner, the spill is gone
OWN_DENSITIES = ("density_1", "density_2", "density_3")  # parameters: densities of the first bodies
LEVEL_SPECTRUM = "pierson_moskowitz"  # makes no waves without wind
SKY_TITLES = {"park": "Day", "sunset": "Sunset", "dawn": "Dawn", "night": "Night"}


@dataclasses.dataclass(frozen=True)
@with_parameters(SPECTRUM_PARAMETERS, group="Waves")
class Params:
    """The parameters, with those of all spectra; the defaults are clean water in a moderate breeze."""

    wind_speed: float = parameter(
        7.0,
        0.5,
        25.0,
        "m/s",
        "Wind speed 10 m above the sea",
        group="Main",
    )
    spill: str = parameter(
        "none",
        choices={"none": "No oil", "layer": "Layer of oil", "mixed": "Entirely mixed"},
        doc="Layer: oil floats on the water. Entirely mixed: oil and water are one fluid, as the lab assumes",
        group="Main",
        title="Oil spill",
    )
    oil: str = parameter("Alaska North Slope 2002", choices=OILS, doc="Kind of oil, from NOAA's records", group="Main")
    thickness: float = parameter(
        0.2, 0.0, 2.0, "m", "Thickness d of the layer of oil", log_from=1e-5, group="Main", title="Layer thickness"
    )
    fraction: float = parameter(
        0.5, 0.01, 0.99, "", "Share of oil in the mixture, by volume", group="Main", title="Share of oil"
    )
    cutaway: bool = parameter(
        False,
        doc="Cut the sea open beside the first buoy, to see the oil, the interface, and the hull in both",
        group="Main",
        affects="look",
        title="Cutaway",
    )
    follow: str = parameter(
        "free",
        choices=CAMERA_TARGETS,
        doc="What the camera looks at and moves with",
        group="Main",
        affects="look",
        title="Camera follows",
    )

    waves: bool = parameter(True, doc="Waves; without them the sea is level", group="Waves")
    wind_direction: float = parameter(
        25.0, -180.0, 180.0, "°", "Where the wind goes to, from +x towards +y", group="Main"
    )
    spectrum: str = parameter(
        "jonswap", choices=SPECTRUM_TITLES, doc="Spectrum that the waves are drawn from", group="Waves"
    )
    wave_count: int = parameter(
        96, 8, 512, "", "Number of waves in the sum; each has the same energy", log_from=8, group="Waves",
        title="Number of waves",
    )  # fmt: skip
    choppiness: float = parameter(
        1.0, 0.0, 1.5, "", "Factor on the horizontal motion, which sharpens the crests; 1 is physics", group="Waves"
    )

    mixture_law: str = parameter(
        "pal_rhodes",
        choices={
            "pal_rhodes": "Pal-Rhodes (emulsion)",
            "mooney": "Mooney (emulsion)",
            "taylor": "Taylor (thin emulsion)",
            "arrhenius": "Arrhenius (solution)",
            "kendall_monroe": "Kendall-Monroe (solution)",
        },
        doc="Viscosity of the mixture",
        group="Oil",
        title="Mixture law",
    )
    continuous: str = parameter(
        "plentiful",
        choices={"plentiful": "The more plentiful", "water": "Water: oil in water", "oil": "Oil: water in oil"},
        doc="Fluid of an emulsion that the drops of the other are in. Spills at sea become water in oil (mousse)",
        group="Oil",
        title="Continuous fluid",
    )
    film: bool = parameter(
        False, doc="A surface film that cannot be stretched, which damps ripples", group="Oil", title="Surface film"
    )
    exposure: float = parameter(
        60.0,
        0.0,
        3600.0,
        "s",
        "For how long the oil has damped the waves at the start",
        log_from=1.0,
        group="Oil",
        title="Age at the start",
    )
    ageing: bool = parameter(True, doc="Keep damping the waves as time passes", group="Oil", title="Keep damping")
    optics: str = parameter(
        "physical",
        choices={"physical": "Physical", "lab": "Lab: oil reflects less"},
        doc="Physical: Fresnel reflection by the fluid's refractive index. Lab: reflections of oil are scaled down",
        group="Oil",
        affects="look",
        title="Reflections",
    )

    spill_volume: float = parameter(
        100.0, 1.0, 1e5, "m³", "Oil that was spilled, all at once", log_from=1.0, group="Spill over hours",
        title="Volume spilled",
    )  # fmt: skip
    temperature: float = parameter(
        15.0, 0.0, 30.0, "°C", "Temperature of the oil; the water's density stays that of 15 °C",
        group="Spill over hours",
    )  # fmt: skip
    spill_hours: float = parameter(
        0.0,
        0.0,
        120.0,
        "h",
        "Time since the spill: the oil evaporates, takes up water and thickens, and floats here as it is by then",
        group="Spill over hours",
        title="Time since the spill",
    )
    spread: bool = parameter(
        False,
        doc="The layer is as thin as the oil has spread by then, instead of as thick as set",
        group="Spill over hours",
        title="Thickness as spread",
    )

    bodies: int = parameter(
        3, 0, 200, "", "Number of floating bodies: two buoys, a box, then all kinds in turn", group="Main"
    )
    density: float = parameter(450.0, 50.0, 1020.0, "kg/m³", "Density of the bodies", group="Main")
    own_densities: bool = parameter(
        False, doc="Densities of their own for the first three bodies", group="Bodies", title="Own densities"
    )
    density_1: float = parameter(
        300.0, 50.0, 1020.0, "kg/m³", "Density of the first body, the red buoy", group="Bodies", title="Red buoy"
    )
    density_2: float = parameter(
        600.0, 50.0, 1020.0, "kg/m³", "Density of the second body, the yellow buoy", group="Bodies",
        title="Yellow buoy",
    )  # fmt: skip
    density_3: float = parameter(
        900.0, 50.0, 1020.0, "kg/m³", "Density of the third body, the box", group="Bodies", title="Box"
    )
    size: float = parameter(1.5, 0.3, 4.0, "", "Size of the bodies; at 1 the box is 1.2 m wide", group="Main")
    ripples: bool = parameter(
        True, doc="Bodies that move make waves of their own", group="Bodies", title="Radiated waves"
    )
    mooring: bool = parameter(
        True, doc="Four elastic lines from the keel of each body to anchors on the bed, 60 m deep", group="Bodies"
    )
    pull: float = parameter(
        6.0,
        0.5,
        50.0,
        "",
        "Largest force with which the mouse pulls a body, in weights of the body",
        group="Bodies",
        affects="look",
        title="Mouse force",
    )

    rig: bool = parameter(True, doc="The oil rig", group="Rig")
    fire: bool = parameter(False, doc="The rig burns", group="Rig")
    fire_power: float = parameter(400.0, 10.0, 2000.0, "MW", "Power of the fire", log_from=10.0, group="Rig")
    jet: bool = parameter(
        False, doc="A jet of oil shoots from the rig and feeds a slick", group="Rig", title="Jet of oil"
    )
    jet_flow: float = parameter(2.0, 0.05, 20.0, "m³/s", "Flow of the jet", log_from=0.05, group="Rig")
    particles: int = parameter(
        4000, 100, 20000, "", "Particles of the fire; the jet has half as many", log_from=100, group="Rig"
    )

    surface: str = parameter(
        "sum",
        choices={"sum": "Sum of waves (radial)", "fft": "FFT (the square sea)"},
        doc="How the surface is computed; both are drawn on the same radial grid",
        group="Grid",
    )
    centre: str = parameter(
        "fixed",
        choices={"fixed": "At the bodies", "camera": "Below the camera"},
        doc="Where the grid is dense",
        group="Grid",
        affects="look",
        title="Grid centre",
    )
    rings: int = parameter(128, 16, 256, "", "Rings of the grid", group="Grid", affects="look")
    spokes: int = parameter(128, 16, 256, "", "Points on a ring", group="Grid", affects="look")
    ring_law: str = parameter(
        "geometric",
        choices={LAWS[0]: "Geometric", LAWS[1]: "Power (lab)"},
        doc="How the spacing of the rings grows outwards",
        group="Grid",
        affects="look",
        title="Ring spacing",
    )
    compare: bool = parameter(
        False,
        doc="Time both surfaces every 2 s, for the table 'Radial or square'",
        group="Grid",
        affects="look",
        title="Compare surfaces",
    )

    time_step: float = parameter(1 / 60, 1 / 500, 1 / 20, "s", "Step of the bodies' motion", group="Time")
    speed: float = parameter(
        1.0, 0.05, 4.0, "", "Simulated time over real time: 0.1 is slow motion", log_from=0.05, group="Time",
        affects="look",
    )  # fmt: skip

    sky: str = parameter("park", choices=SKY_TITLES, doc="Sky and its light", group="Look", affects="look")
    grid: bool = parameter(False, doc="Lines of the grid (key G)", group="Look", affects="look")
    plot_draft: bool = parameter(
        False, doc="Drafts of the first three bodies over time", group="Plots", affects="look", title="Drafts"
    )
    plot_surface: bool = parameter(
        False,
        doc="Height of the sea at the first buoy, and of the buoy, over time",
        group="Plots",
        affects="look",
        title="Buoy and sea",
    )
    plot_budget: bool = parameter(
        False,
        doc="Where the oil of the spill is, over five days",
        group="Plots",
        affects="look",
        title="Oil budget",
    )

    hull: str = ""  # a mesh file that floats too; it is named on the command line only, never by a browser


PRESETS: dict[str, dict[str, Any]] = {
    "Clear water": {},
    "Light crude spill 0.2 m": {
        "spill": "layer",
        "thickness": 0.2,
        "exposure": 60.0,
        "cutaway": True,
        "follow": "cutaway",
        "wind_speed": 5.0,
    },
    "Heavy fuel oil": {
        "spill": "layer",
        "oil": "IFO 180",
        "thickness": 0.5,
        "exposure": 600.0,
        "follow": "from above",
        "sky": "sunset",  # oil mirrors the sky: under a blue one it looks like water
    },
    "Entirely mixed": {"spill": "mixed", "oil": "Arabian Light", "fraction": 0.4, "follow": "from above"},
    "Storm with buoys": {"wind_speed": 17.0, "bodies": 12, "wave_count": 160, "size": 2.0, "follow": "from above"},
    "Burning rig": {"fire": True, "jet": True, "follow": "rig", "sky": "dawn", "wind_speed": 6.0},
    "A day after a spill": {
        "spill": "layer",
        "oil": "Arabian Light",
        "spill_hours": 24.0,
        "spread": True,
        "exposure": 3600.0,
        "plot_budget": True,
        "follow": "from above",
        "sky": "sunset",
    },
}

ABOUT = {  # preset -> what it shows and what to try
    "Clear water": "Buoys and a box float on clean water: push one under and let go.",
    "Light crude spill 0.2 m": "Light crude oil on the sea: compare how deep bodies float with clean water.",
    "Heavy fuel oil": "Half a metre of heavy fuel oil: see which waves it has damped.",
    "Entirely mixed": "Oil mixed into the water: the bodies float in a fluid of another density.",
    "Storm with buoys": "Twelve bodies in a storm: hold one against the waves.",
    "Burning rig": "A burning rig blows oil onto the sea: see the slick calm the waves.",
    "A day after a spill": "A spill of crude oil after a day: the chart shows where the oil has gone.",
}


def hidden(params: Params) -> set[str]:
    """The parameters that mean nothing with the others as they are."""
    names = SPECTRA[params.spectrum].unused(spectrum_values(params))
    if params.spill != "layer":
        names.add("thickness")
    if spill_of(params) is None:
        names |= {"spill_volume", "spill_hours", "spread", "plot_budget"}
    elif params.spread:
        names.add("thickness")
    if params.spill != "layer":
        names.add("temperature")
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
    if params.surface == "fft" or (params.spectrum == "regular" and spectrum_values(params)["second_height"] == 0.0):
        names.add("wave_count")
    return names


def own_densities_of(params: Params) -> tuple[float, ...]:
    """Densities [kg/m3] of the first bodies, where they have their own."""
    return tuple(getattr(params, name) for name in OWN_DENSITIES) if params.own_densities else ()


def densities_of(params: Params) -> tuple[float, ...]:
    """Densities of the parameters [kg/m3]; equal ones make equal bodies."""
    return (params.density, *own_densities_of(params))


def spill_of(params: Params) -> Spill | None:
    """The spill that floats on the sea.

    None without a layer of oil, or where the oil's record does not tell how it evaporates.
    """
    if params.spill != "layer" or not can_weather(params.oil):
        return None
    return Spill(
        oil=params.oil,
        volume=params.spill_volume,
        wind_speed=params.wind_speed,
        temperature=params.temperature,
        water=WATER,
    )


def weathered_oil(params: Params) -> WeatheredOil | None:
    """The oil of the spill as it is by then; None where there is no spill to follow."""
    spill = spill_of(params)
    return None if spill is None else weather(spill).at(params.spill_hours)


def oil_of(params: Params) -> Fluid:
    """The oil in force: of a layer as warm and as old as set, else at 15 degrees and fresh."""
    if params.spill != "layer":
        return fluids()[params.oil]
    weathered = weathered_oil(params) if params.spill_hours > 0.0 else None
    return oil_at(params.oil, params.temperature) if weathered is None else weathered.fluid(params.oil)


def thickness_of(params: Params) -> float:
    """Thickness [m] of the layer of oil: as set, or as thin as it has spread."""
    if params.spill != "layer":
        return 0.0
    weathered = weathered_oil(params) if params.spread else None
    if weathered is None:
        return params.thickness
    return weathered.thickness if weathered.thickness >= MIN_FILM else 0.0


def column_of(params: Params) -> FluidColumn:
    """The fluids that the parameters describe."""
    return FluidColumn(
        oil=oil_of(params),
        thickness=thickness_of(params),
        fraction=params.fraction if params.spill == "mixed" else 0.0,
        law=params.mixture_law,
        continuous=params.continuous,
        film=params.film and params.spill != "none",
    )


def spectrum_of(params: Params) -> Spectrum:
    """The spectrum of the waves; one that makes none without wind where there are to be none."""
    return SPECTRA[params.spectrum if params.waves else LEVEL_SPECTRUM]


def conditions_of(params: Params) -> Conditions:
    """The conditions under which the spectrum is evaluated."""
    spectrum = spectrum_of(params)
    values = spectrum_values(params) | {"wind_direction": math.radians(params.wind_direction)}
    if params.waves:
        return spectrum.conditions_from(values | {"wind_speed": spectrum.wind_speed(params.wind_speed)})
    return spectrum.conditions_from(values | {"wind_speed": 0.0, "second_height": 0.0})


def exposure_of(params: Params) -> float:
    """For how long the waves have run under oil at the start [s]."""
    return params.exposure if params.spill != "none" else 0.0
