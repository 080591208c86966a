"""Quantities of the radial sea: bodies beside predictions, fluids, waves, light, spilled and released oil, the grid."""

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from app.scenes.quantities import Quantities, Quantity, for_tasks, slug
from app.scenes.radial_sea.bodies import BODY_KINDS, BodyKind
from app.scenes.radial_sea.oil.well_blowout import FALL_TIME, LANDING, NOZZLE
from app.scenes.radial_sea.parameters import weathered_oil
from sim.ocean.fluids.emulsions import arrhenius
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import diffuse_reflectance, normal_reflectance
from sim.ocean.fluids.oil_film import OPAQUE_THICKNESS
from sim.water import SEA_DENSITY

if TYPE_CHECKING:
    from app.scenes.radial_sea.bodies import BodyReading
    from app.scenes.radial_sea.oil.well_blowout import OilBudget
    from sim.ocean.weathering import WeatheredOil

LONG_WAVE = 10.0  # [m] length of the wave in statements about the speed of waves
SHORT_WAVE = 1.0  # [m] length of the wave in statements about viscosity
FILM_THICKNESS = 1e-4  # [m] of a film that lets light through
MIN_LIGHT = 0.1  # fraction of the light from the water below which a layer counts as opaque

OF_BODY: Quantities = {  # of a `BodyReading`
    "mean_draft": Quantity("m", "mean draft over the last minute", lambda body: body.mean_draft),
    "draft_at_rest": Quantity("m", "draft at rest by Archimedes", lambda body: body.prediction.draft),
    "draft": Quantity("m", "draft", lambda body: body.draft),
    "density": Quantity("kg/m³", "density", lambda body: body.density),
    "mass": Quantity("kg", "mass", lambda body: body.mass),
    "volume": Quantity("m³", "volume", lambda body: body.volume),
    "buoyancy": Quantity("N", "weight of the displaced fluids", lambda body: body.buoyancy),
    "mean_buoyancy": Quantity("N", "mean buoyancy over the last minute", lambda body: body.mean_lift[0]),
    "wet_volume_above": Quantity("m³", "wet volume in the upper fluid", lambda body: body.wet_volume[0]),
    "wet_volume_below": Quantity("m³", "wet volume in the lower fluid", lambda body: body.wet_volume[1]),
    "offset": Quantity("m", "horizontal distance from its moored position", lambda body: body.offset),
    "line_tension": Quantity("N", "largest tension of its mooring lines", lambda body: body.tension),
    "heave_period": Quantity("s", "heave period as measured", lambda body: body.period),
    "heave_period_theory": Quantity("s", "heave period by theory", lambda body: body.prediction.period),
    "draft_in_water": for_tasks("m", "draft at rest in water", lambda body: body.prediction.draft_in_water),
    "added_draft": for_tasks("m", "extra draft", lambda body: body.prediction.draft - body.prediction.draft_in_water),
    "deeper": for_tasks(
        "m", "deeper than in clean water", lambda body: body.mean_draft - body.prediction.draft_in_water
    ),
    "height": for_tasks("m", "height", lambda body: body.prediction.height),
    "fraction_below": for_tasks("1", "fraction below sea water", lambda body: body.mass / (body.volume * SEA_DENSITY)),
}

OF_SPILL: Quantities = {  # of a `WeatheredOil`
    "evaporated": Quantity("1", "Fraction of the spill that has evaporated", lambda spill: spill.evaporated),
    "dispersed": Quantity("1", "Fraction of the spill in drops in the water", lambda spill: spill.dispersed),
    "water_content": Quantity("1", "Fraction of water in the emulsion", lambda spill: spill.water_content),
    "slick_area": Quantity("m²", "Area of the spill", lambda spill: spill.area),
}
OF_OIL_BUDGET: Quantities = {  # of an `OilBudget`
    "oil_released": for_tasks("m³", "Oil released", lambda budget: budget.ejected),
    "oil_in_air": for_tasks("m³", "Oil in the air", lambda budget: budget.in_flight),
    "oil_on_sea": for_tasks("m³", "Oil on the sea", lambda budget: budget.fed),
    "slick_radius": for_tasks("m", "Radius of the slick", lambda budget: budget.radius),
}


def of_kind(kind: BodyKind) -> Quantities:
    """The quantities of the first body of a kind."""

    def of_first(value: "Callable[[BodyReading], float | None]") -> Callable[[Any], float | None]:
        return lambda now: next((value(body) for body in now.readings.bodies if body.kind == kind.name), None)

    return {
        f"{slug(kind.title)}_{name}": q._replace(meaning=f"{kind.title}: {q.meaning}", value=of_first(q.value))
        for name, q in OF_BODY.items()
    }


def of_spill(value: "Callable[[WeatheredOil], float | None]") -> Callable[[Any], float | None]:
    """A number of the spill at the time of the parameters; None without a spill to follow."""

    def of_weathered(now: Any) -> float | None:
        spill = weathered_oil(now.params)
        return None if spill is None else value(spill)

    return of_weathered


def of_oil_budget(value: "Callable[[OilBudget], float | None]") -> Callable[[Any], float | None]:
    """A number of the oil of the jet."""
    return lambda now: value(now.readings.oil_budget)


def of_column(value: Callable[[FluidColumn], float | None]) -> Callable[[Any], float | None]:
    """A number of the fluids."""
    return lambda now: value(now.readings.column)


class ColumnWaves(NamedTuple):
    """Speeds and decay of two waves in the fluids."""

    long_speed: float  # [m/s] of the long wave
    clean_speed: float  # [m/s] of the long wave on clean water
    short_decay: float  # [1/s] of the short wave


@functools.lru_cache(maxsize=4)
def waves_on(column: FluidColumn) -> ColumnWaves:
    """Waves on these fluids; cached, as the roots take long."""
    long, short = (np.array([2.0 * math.pi / length]) for length in (LONG_WAVE, SHORT_WAVE))
    clean = float(FluidColumn(water=column.water).omega(long)[0] / long[0])
    return ColumnWaves(float(column.roots(long)[0][0] / long[0]), clean, float(column.roots(short)[1][0]))


@functools.lru_cache(maxsize=4)
def sky_reflectance(index: float) -> float:
    """Light of a whole sky that a fluid of this refractive index reflects; cached, as it takes long."""
    return diffuse_reflectance(index)


def net_force(column: FluidColumn) -> float:
    """Upward force [N] on 1 m3 of oil in water, less its weight."""
    return (column.water.density - column.oil.density) * column.gravity


def added_draft(column: FluidColumn) -> float:
    """Extra draft [m] of a body with straight sides."""
    ratio = column.oil.density / column.water.density
    return column.thickness * (1.0 - ratio) if column.kind == "layer" else 0.0


def solution_viscosity(column: FluidColumn) -> float:
    """Viscosity [Pa s] of a solution by Arrhenius; NaN for fluids that are not mixed."""
    if column.kind != "mixed":
        return math.nan
    return arrhenius(column.oil.viscosity, column.water.viscosity, column.fraction)


def reflectance_ratio(column: FluidColumn) -> float:
    """Reflection of oil over that of water, of light straight down."""
    return normal_reflectance(column.oil.refractive_index) / normal_reflectance(column.water.refractive_index)


def light_of(fluid: str) -> Quantities:
    """Refractive index and reflectance of the oil or the water of the column."""

    def of_index(value: Callable[[float], float]) -> Callable[[Any], float | None]:
        return of_column(lambda column: value(getattr(column, fluid).refractive_index))

    return {
        f"{fluid}_index": for_tasks("1", f"Refractive index of the {fluid}", of_index(float)),
        f"{fluid}_reflectance": for_tasks(
            "1", f"Light that {fluid} reflects straight up", of_index(normal_reflectance)
        ),
        f"{fluid}_sky_reflectance": for_tasks(
            "1", f"Light of a whole sky that {fluid} reflects", of_index(sky_reflectance)
        ),
    }


def left(now: float, clean: float) -> float:
    """The fraction of a number that the oil leaves; NaN on a level sea."""
    return now / clean if clean > 0.0 else math.nan


def square_points(now: Any) -> float:
    """Points of a square grid as fine as the radial grid in its middle."""
    grid = now.frame.grid
    return (2.0 * round(float(grid.radii[-1]) / float(grid.spacing[0])) + 1.0) ** 2


QUANTITIES: Quantities = {name: quantity for kind in BODY_KINDS for name, quantity in of_kind(kind).items()} | {
    **{name: one._replace(value=of_spill(one.value)) for name, one in OF_SPILL.items()},
    "oil_viscosity": Quantity("Pa·s", "Viscosity of the chosen oil", of_column(lambda column: column.oil.viscosity)),
    "oil_density": Quantity("kg/m³", "Density of the chosen oil", of_column(lambda column: column.oil.density)),
    "significant_height": Quantity("m", "Significant height of the waves", lambda now: now.readings.height),
    "clean_height": Quantity(
        "m", "Significant height of the waves without the oil", lambda now: now.readings.clean_height
    ),
    "mean_square_slope": Quantity("1", "Mean square slope of the waves", lambda now: now.readings.slope),
    "clean_slope": Quantity(
        "1", "Mean square slope of the waves without the oil", lambda now: now.readings.clean_slope
    ),
    "middle_period": Quantity(
        "s", "Period above which half of the energy lies", lambda now: now.readings.middle_period
    ),
    # As set, or as thin as the spill has spread.
    "layer_thickness": for_tasks("m", "Layer thickness", of_column(lambda column: column.thickness)),
    "water_density": for_tasks("kg/m³", "Density of the water", of_column(lambda column: column.water.density)),
    "surface_density": for_tasks(
        "kg/m³", "Density of the fluid on top", of_column(lambda column: column.surface.density)
    ),
    "net_force": for_tasks("N", "Upward force on 1 m³ of oil in water, less its weight", of_column(net_force)),
    "added_draft": for_tasks("m", "Extra draft of a body with straight sides", of_column(added_draft)),
    "water_viscosity": for_tasks("Pa·s", "Viscosity of the water", of_column(lambda column: column.water.viscosity)),
    "surface_viscosity": for_tasks(
        "Pa·s", "Viscosity of the fluid on top", of_column(lambda column: column.surface.viscosity)
    ),
    "solution_viscosity": for_tasks("Pa·s", "Viscosity of a solution, by Arrhenius", of_column(solution_viscosity)),
    "height_left": for_tasks(
        "1",
        "Fraction of the height that the oil leaves",
        lambda now: left(now.readings.height, now.readings.clean_height),
    ),
    "slope_left": for_tasks(
        "1",
        "Fraction of the mean square slope that the oil leaves",
        lambda now: left(now.readings.slope, now.readings.clean_slope),
    ),
    "long_wave_speed": for_tasks(
        "m/s", f"Speed of a wave of {LONG_WAVE:g} m", of_column(lambda column: waves_on(column).long_speed)
    ),
    "clean_wave_speed": for_tasks(
        "m/s",
        f"Speed of a wave of {LONG_WAVE:g} m on clean water",
        of_column(lambda column: waves_on(column).clean_speed),
    ),
    "short_wave_lifetime": for_tasks(
        "s",
        f"Time in which a wave of {SHORT_WAVE:g} m falls to 37 %",
        of_column(lambda column: 1.0 / waves_on(column).short_decay),
    ),
    "waves_age": for_tasks("s", "Time for which the oil has damped the waves", lambda now: now.readings.age),
    **light_of("oil"),
    **light_of("water"),
    "reflectance_ratio": for_tasks("1", "Reflection of oil over that of water", of_column(reflectance_ratio)),
    "film_light": for_tasks(
        "1", "Light through a film of 0.1 mm", lambda now: math.exp(-FILM_THICKNESS / OPAQUE_THICKNESS)
    ),
    "opaque_thickness": for_tasks("m", "Least opaque thickness", lambda now: -OPAQUE_THICKNESS * math.log(MIN_LIGHT)),
    "nozzle_height": for_tasks("m", "Height of the nozzle", lambda now: NOZZLE[2]),
    "flight_time": for_tasks("s", "Flight time of a drop to sea level", lambda now: FALL_TIME),
    "flight_distance": for_tasks(
        "m",
        "Range of a drop",
        lambda now: math.hypot(LANDING[0] - NOZZLE[0], LANDING[1] - NOZZLE[1]),
    ),
    **{name: one._replace(value=of_oil_budget(one.value)) for name, one in OF_OIL_BUDGET.items()},
    "grid_points": for_tasks("1", "Points of the radial grid", lambda now: len(now.frame.grid)),
    "inner_spacing": for_tasks("m", "Spacing in the middle", lambda now: float(now.frame.grid.spacing[0])),
    "rim_spacing": for_tasks("m", "Spacing at the rim", lambda now: float(now.frame.grid.spacing[-2])),
    "grid_radius": for_tasks("m", "Radius of the grid", lambda now: float(now.frame.grid.radii[-1])),
    "square_points": for_tasks("1", "Points of an equally fine square grid", square_points),
}
