"""Values of the radial sea for the tasks of the lab: fluids, drafts, waves, light, oil of the jet, the grid."""

import functools
import math
from typing import TYPE_CHECKING

import numpy as np

from app.messages import Snapshot
from app.scenes.contract import Measure
from app.scenes.measures import slug
from app.scenes.radial_sea.well_blowout import FALL_TIME, LANDING, NOZZLE
from sim.ocean.emulsions import arrhenius
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.fluids import diffuse_reflectance, normal_reflectance
from sim.ocean.oil_film import OPAQUE_THICKNESS

if TYPE_CHECKING:
    from app.scenes.radial_sea.bodies import BodyReading
    from app.scenes.radial_sea.frame import RadialFrame, RadialReadings

LONG_WAVE = 10.0  # [m] length of the wave in statements about the speed of waves
SHORT_WAVE = 1.0  # [m] length of the wave in statements about viscosity
FILM_THICKNESS = 1e-4  # [m] of a film that lets light through
MIN_LIGHT = 0.1  # share of the light from the water below which a layer counts as opaque


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot."""
    readings: RadialReadings = snapshot.readings
    frame: RadialFrame = snapshot.frame
    found = fluid_values(readings.column) | wave_values(readings) | light_values(readings.column) | jet_values(readings)
    for body in reversed(readings.bodies):  # of each kind the first
        found |= body_values(body)
    points, inner, radius = len(frame.grid), float(frame.grid.spacing[0]), float(frame.grid.radii[-1])
    return found | {
        "grid_points": Measure(points, "1", "Points of the radial grid"),
        "inner_spacing": Measure(inner, "m", "Spacing in the middle"),
        "rim_spacing": Measure(float(frame.grid.spacing[-2]), "m", "Spacing at the rim"),
        "grid_radius": Measure(radius, "m", "Radius of the grid"),
        "square_points": Measure((2.0 * round(radius / inner) + 1.0) ** 2, "1", "Points of a square grid as fine"),
    }


def fluid_values(column: FluidColumn) -> dict[str, Measure]:
    """Densities, the force that sorts the fluids, viscosities."""
    oil, water, top = column.oil, column.water, column.surface
    force = (water.density - oil.density) * column.gravity
    solution = arrhenius(oil.viscosity, water.viscosity, column.fraction) if column.kind == "mixed" else math.nan
    added = column.thickness * (1.0 - oil.density / water.density) if column.kind == "layer" else 0.0
    return {
        "thickness": Measure(column.thickness, "m", "Layer thickness"),  # as set, or as thin as the spill has spread
        "oil_density": Measure(oil.density, "kg/m³", "Density of the oil"),
        "water_density": Measure(water.density, "kg/m³", "Density of the water"),
        "surface_density": Measure(top.density, "kg/m³", "Density of the fluid on top"),
        "net_force": Measure(force, "N", "Upward force on 1 m³ of oil in water, less its weight"),
        "added_draft": Measure(added, "m", "Extra draft of a body with straight sides"),
        "oil_viscosity": Measure(oil.viscosity, "Pa·s", "Viscosity of the oil"),
        "water_viscosity": Measure(water.viscosity, "Pa·s", "Viscosity of the water"),
        "surface_viscosity": Measure(top.viscosity, "Pa·s", "Viscosity of the fluid on top"),
        "solution_viscosity": Measure(solution, "Pa·s", "Viscosity of a solution, by Arrhenius"),
    }


@functools.lru_cache(maxsize=4)
def speeds_and_decay(column: FluidColumn) -> tuple[float, float, float]:
    """Speeds [m/s] of the long wave here and on clean water, decay [1/s] of the short one; kept, they take long."""
    long, short = (np.array([2.0 * math.pi / length]) for length in (LONG_WAVE, SHORT_WAVE))
    clean = float(FluidColumn(water=column.water).omega(long)[0] / long[0])
    return float(column.roots(long)[0][0] / long[0]), clean, float(column.roots(short)[1][0])


def wave_values(readings: "RadialReadings") -> dict[str, Measure]:
    """Heights, and the decay of a long and a short wave in the fluids."""
    column = readings.column
    speed, clean, decay = speeds_and_decay(column)
    height_left = readings.height / readings.clean_height if readings.clean_height > 0.0 else math.nan
    slope_left = readings.slope / readings.clean_slope if readings.clean_slope > 0.0 else math.nan
    return {
        "significant_height": Measure(readings.height, "m", "Significant height"),
        "clean_height": Measure(readings.clean_height, "m", "Significant height without oil"),
        "height_left": Measure(height_left, "1", "Share of the height that the oil leaves"),
        "slope_left": Measure(slope_left, "1", "Share of the mean square slope that the oil leaves"),
        "long_wave_speed": Measure(speed, "m/s", f"Speed of a wave of {LONG_WAVE:g} m"),
        "clean_wave_speed": Measure(clean, "m/s", f"Speed of a wave of {LONG_WAVE:g} m on clean water"),
        "short_wave_lifetime": Measure(1.0 / decay, "s", f"Time in which a wave of {SHORT_WAVE:g} m falls to 37 %"),
        "waves_age": Measure(readings.age, "s", "Time for which the oil has damped the waves"),
    }


@functools.lru_cache(maxsize=4)
def light_values(column: FluidColumn) -> dict[str, Measure]:
    """Light reflected by the surface and returned through a layer; cached, as the light of a whole sky takes long."""
    oil, water = column.oil.refractive_index, column.water.refractive_index
    at_oil, at_water = normal_reflectance(oil), normal_reflectance(water)
    return {
        "oil_index": Measure(oil, "1", "Refractive index of the oil"),
        "water_index": Measure(water, "1", "Refractive index of the water"),
        "oil_reflectance": Measure(at_oil, "1", "Light that oil reflects straight up"),
        "water_reflectance": Measure(at_water, "1", "Light that water reflects straight up"),
        "reflectance_ratio": Measure(at_oil / at_water, "1", "Reflection of oil over that of water"),
        "oil_sky_reflectance": Measure(diffuse_reflectance(oil), "1", "Light of a whole sky that oil reflects"),
        "water_sky_reflectance": Measure(diffuse_reflectance(water), "1", "Light of a whole sky that water reflects"),
        "film_light": Measure(math.exp(-FILM_THICKNESS / OPAQUE_THICKNESS), "1", "Light through a film of 0.1 mm"),
        "opaque_thickness": Measure(-OPAQUE_THICKNESS * math.log(MIN_LIGHT), "m", "Thickness that is opaque"),
    }


def body_values(body: "BodyReading") -> dict[str, Measure]:
    """Weight and draft of one body."""
    name, p = slug(body.title), body.prediction
    return {
        f"{name}_draft_at_rest": Measure(p.draft, "m", f"{body.title}: draft at rest by Archimedes"),
        f"{name}_draft_in_water": Measure(p.draft_in_water, "m", f"{body.title}: draft at rest in water"),
        f"{name}_added_draft": Measure(p.draft - p.draft_in_water, "m", f"{body.title}: extra draft"),
        f"{name}_deeper": Measure(body.mean_draft - p.draft_in_water, "m", f"{body.title}: deeper than in clean water"),
        f"{name}_mean_draft": Measure(body.mean_draft, "m", f"{body.title}: mean draft over a minute"),
        f"{name}_height": Measure(p.height, "m", f"{body.title}: height"),
        f"{name}_density": Measure(body.density, "kg/m³", f"{body.title}: density"),
        f"{name}_volume": Measure(body.volume, "m³", f"{body.title}: volume"),
        f"{name}_mass": Measure(body.mass, "kg", f"{body.title}: mass"),
        f"{name}_share": Measure(body.mass / (body.volume * 1025.0), "1", f"{body.title}: share below sea water"),
    }


def jet_values(readings: "RadialReadings") -> dict[str, Measure]:
    """The flight of the oil, and where it is."""
    budget = readings.oil_budget
    reach = math.hypot(LANDING[0] - NOZZLE[0], LANDING[1] - NOZZLE[1])
    return {
        "nozzle_height": Measure(NOZZLE[2], "m", "Height of the nozzle"),
        "flight_time": Measure(FALL_TIME, "s", "Flight of a drop to the level of the sea"),
        "flight_distance": Measure(reach, "m", "Distance that a drop flies"),
        "oil_released": Measure(budget.ejected, "m³", "Oil released"),
        "oil_in_air": Measure(budget.in_flight, "m³", "Oil in the air"),
        "oil_on_sea": Measure(budget.fed, "m³", "Oil on the sea"),
        "slick_radius": Measure(budget.radius, "m", "Radius of the slick"),
    }
