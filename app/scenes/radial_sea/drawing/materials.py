"""Appearance of the fluids of the radial sea: colour, index and smoothness of water, of oil, and of both mixed."""

import dataclasses
import functools
import math
from typing import Any

import numpy as np

from app.render.colormap import rgb
from app.render.material import MAX_WATERLINES, RGB, Cutout, Material, Oil, SlickRegion, Waterline, blend
from app.scenes.radial_sea.frame import RadialFrame
from app.scenes.radial_sea.oil.well_blowout import FIRE, FIRE_WIDTH, RIG, Slick
from app.scenes.radial_sea.parameters import RadialSeaParams
from sim.floating import Hull
from sim.floating.motion.rotation import heading_angle
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.particles.plume import flame_height, radiated_light

LAB_SPECULAR = 0.4  # fraction of oil's reflection that is drawn with optics "lab"
RIPPLE_LENGTH = 0.9  # [m] of the wave that stands for all ripples of the material, in how they decay under oil
CALM_SLOPE, MAX_SLOPE = 0.02, 0.24  # rms slope of the ripples without wind, and the greatest
MIN_RIPPLE_SHARE = 0.12  # of the ripples' slope that oil leaves at least, so that the sea does not turn into a mirror
MIXTURE_SCATTER: RGB = (0.80, 0.47, 0.22)  # light that an emulsion scatters
MIXTURE_ROUGHNESS = 0.12
MIXTURE_BASE_SHARE = 0.5  # fraction of oil's colours in a mixture with hardly any oil; it grows with the fraction
MIXTURE_THICKNESS = 1e-3  # [m] of a film that shows as much of its colour as a mixture does: all
FIRE_COLOUR = (1.0, 0.45, 0.12)  # of the light of flames, linear
VISIBLE_SHARE = 0.02  # of what a flame radiates
SUN_IRRADIANCE, SUN_STRENGTH = 450.0, 5.0  # [W/m2] of visible sunlight, and what it is in the material
SPILL_RADIUS = 45.0  # [m] of the spill as drawn,
SPILL_MARGIN = 25.0  # [m] and at least so far beyond the bodies
LEG_DISTANCE, LEG_RADIUS = 14.33, 1.3  # [m] of the rig's legs at the water, from its middle (assets/make_models.py)
LEG_TOP, LEG_COLOUR = 15.0, "#eeb220"  # [m]
DECK_SIDES, DECK_HEIGHTS, DECK_COLOUR = (17.0, 15.0), (14.2, 34.0), "#8a8f8c"  # half sides, bottom and top [m]
MIRROR_COLOURS = {"buoy_red": "#c42422", "buoy_yellow": "#eeb220", "crate": "#a0763e", "ball": "#d86030"}
HULL_COLOUR = "#4084ba"  # of other hulls
HULL_CORNER = 0.1  # radius of the corners of a box over half its side
OIL_ROUGHNESS = 0.02
THICKNESS_RATIO = 1.01  # of two thicknesses of a slick for which the decay of ripples is found


def rgb_of(colour: str) -> np.ndarray:
    """(3,) sRGB in 0..1 of "#rrggbb"."""
    return np.array(rgb(colour)) / 255.0


@functools.cache
def colour_of(colour: str) -> RGB:
    """sRGB in 0..1 of "#rrggbb"."""
    red, green, blue = rgb_of(colour).tolist()
    return red, green, blue


LEGS = tuple(
    Waterline(
        (RIG[0] + i * LEG_DISTANCE, RIG[1] + j * LEG_DISTANCE),
        0.0,
        (0.0, 0.0),
        LEG_RADIUS,
        LEG_TOP,
        color=colour_of(LEG_COLOUR),
    )
    for i in (-1, 1)
    for j in (-1, 1)
)
DECKS = Waterline(
    RIG, 0.0, (DECK_SIDES[0] - 1.0, DECK_SIDES[1] - 1.0), 1.0, DECK_HEIGHTS[1], DECK_HEIGHTS[0], colour_of(DECK_COLOUR)
)


def ripple_slope(p: RadialSeaParams, column: FluidColumn, age: float) -> float:
    """Root mean square slope of the material's ripples: Cox and Munk's (1954), decayed for `age` [s] in the fluid."""
    clean = math.sqrt(0.003 + 0.00512 * p.wind_speed) if p.waves else CALM_SLOPE
    remaining = math.exp(-ripple_decay(column) * age) if age > 0.0 else 1.0
    return min(clean, MAX_SLOPE) * max(remaining, MIN_RIPPLE_SHARE)


@functools.lru_cache(maxsize=4)
def ripple_decay(column: FluidColumn) -> float:
    """Decay rate [1/s] of a wave of RIPPLE_LENGTH; cached, as each picture needs it."""
    return float(column.roots(np.array([2.0 * math.pi / RIPPLE_LENGTH]))[1][0])


def mixture_share(column: FluidColumn) -> float:
    """Fraction of oil's colours in those of a mixture."""
    return min(1.0, MIXTURE_BASE_SHARE + column.fraction)


def waterlines_of(frame: RadialFrame) -> list[Waterline]:
    """Upright positions of the rig's legs and the first bodies in the water; then the rig's decks."""
    lines = list(LEGS) if frame.params.rig else []
    room = MAX_WATERLINES - len(lines) - 1  # for bodies
    for kind, position, rotation in zip(frame.kinds, frame.positions.tolist(), frame.rotations, strict=True):
        if room == 0:
            break
        room -= 1
        sides, corner, height = footprint(frame.hulls[kind])
        colour = colour_of(MIRROR_COLOURS.get(kind, HULL_COLOUR))
        place, heading = (position[0], position[1]), heading_angle(rotation)
        lines.append(Waterline(place, heading, sides, corner, position[2] + height, color=colour))
    if frame.params.rig:
        lines.append(DECKS)
    return lines


@functools.lru_cache(maxsize=16)
def footprint(hull: Hull) -> tuple[tuple[float, float], float, float]:
    """Half sides without the corners, radius of the corners and height above the middle [m] of an upright hull."""
    a, b = (0.5 * np.ptp(hull.extents[:2], axis=1)).tolist()
    corner = HULL_CORNER * min(a, b) if hull.shape.collision == "box" else min(a, b)
    return (a - corner, b - corner), corner, float(hull.extents[2, 1])


def material_of(light: Material, frame: RadialFrame) -> Material:
    """The material of a frame under a sky (`app.render.skies.set_sky`), with its slick and its cutaway."""
    p, column, cutaway = frame.params, frame.column, frame.cutaway
    common: dict[str, Any] = {
        "ripple_slope": round(ripple_slope(p, column, 0.0), 3),
        "ripple_length": 1.6,
        "ripple_direction": math.radians(p.wind_direction),
        "wireframe": p.grid,
        "clouds": min(0.15 + 0.045 * p.wind_speed, 0.9),
        "cutout": None
        if cutaway is None
        else Cutout(cutaway.middle, cutaway.half_width, cutaway.direction, cutaway.length),
    }
    if frame.fire is not None:
        common |= fire_light(p.fire_power * 1e6)
    if column.kind == "water":
        return dataclasses.replace(
            light, **common, **({} if frame.slick is None else slick_look(p, column, frame.slick))
        )
    return dataclasses.replace(light, **common, **spill_look(frame))


def fire_light(power: float) -> dict[str, Any]:
    """Changes of a material by the light of a fire of this power [W] on the rig."""
    x, y, z = FIRE
    intensity = VISIBLE_SHARE * radiated_light(power) * SUN_STRENGTH / SUN_IRRADIANCE
    red, green, blue = (intensity * part for part in FIRE_COLOUR)
    return {"fire_place": (x, y, z + 0.5 * flame_height(power, FIRE_WIDTH)), "fire_light": (red, green, blue)}


def spill_look(frame: RadialFrame) -> dict[str, Any]:
    """Changes of a material inside a spill: a layer of oil, or oil and water mixed, which is brown and turbid.

    The spill of the simulation has no end. It is drawn as a slick around the bodies, so that one sees clean water too.
    """
    column = frame.column
    red, green, blue = rgb_of(column.oil.colour).tolist()
    colour: RGB = (red, green, blue)
    index, thickness, roughness = column.oil.refractive_index, column.thickness, OIL_ROUGHNESS
    if column.kind == "mixed":
        colour = blend(Material().deep_color, blend(colour, MIXTURE_SCATTER, 0.8), mixture_share(column))
        index, thickness, roughness = column.surface.refractive_index, MIXTURE_THICKNESS, MIXTURE_ROUGHNESS
    farthest = float(np.hypot(frame.positions[:, 0], frame.positions[:, 1]).max(initial=0.0))
    radius = max(SPILL_RADIUS, 5.0 * math.ceil((farthest + SPILL_MARGIN) / 5.0))
    p = frame.params
    calm = ripple_slope(p, column, frame.age) / ripple_slope(p, column, 0.0)
    return {
        "oil": Oil(colour, index, LAB_SPECULAR if p.optics == "lab" else 1.0),
        "slick": SlickRegion((0.0, 0.0), radius, thickness, roughness, round(calm, 2)),
    }


def slick_look(p: RadialSeaParams, column: FluidColumn, slick: Slick) -> dict[str, Any]:
    """Changes of a material under a slick of this oil."""
    # Rounded, as the decay of ripples is found again for each thickness.
    thickness = THICKNESS_RATIO ** round(math.log(slick.thickness) / math.log(THICKNESS_RATIO))
    layer = dataclasses.replace(column, thickness=thickness, fraction=0.0)
    calm = ripple_slope(p, layer, p.exposure) / ripple_slope(p, column, 0.0)
    red, green, blue = rgb_of(column.oil.colour).tolist()
    return {
        "oil": Oil((red, green, blue), column.oil.refractive_index),
        "slick": SlickRegion(slick.centre, round(slick.radius, 1), slick.thickness, OIL_ROUGHNESS, round(calm, 2)),
    }
