"""Appearance of water, as data: its colours, optics, ripples and sky, and the way of these numbers to the shader."""

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim.ocean.fluids.oil_film import EXTINCTION, light_through
from sim.validation import argument_error

RGB = tuple[float, float, float]
HAZE_DISTANCE = 3000.0  # [m]
RAIN_HEIGHT = 350.0  # [m] of the clouds from which rain falls

# Uniforms of the water shader, three numbers each, in the order in which they travel. The script takes the names from
# here; `js/sea/water_shader.js` declares each of them with its meaning.
WATER_UNIFORMS = (
    "deepColor", "scatterColor", "foamColor", "sunDirection", "sunLight", "optics", "lens", "ripple", "skyline",
    "skyFold", "skyTint", "skyLow", "skyHigh", "clouds", "wind", "seaState", "grid", "ringLaw", "gridMiddle", "shown",
    "wireColor", "slick", "slickOptics", "oilColor", "oilFilm", "oilExtinction", "cutout", "cutoutDirection",
    "rainRings", "rainVeil", "firePlace", "fireLight", "gaugePlace",
)  # fmt: skip
MAX_WATERLINES = 13  # that the shader of the water mirrors, and draws foam and shade around
# The same for the shader of rain and spray, `js/sea/rain.js`.
RAIN_UNIFORMS = ("rain", "streak", "dropSizes", "dropMotion", "spray")


@dataclass(frozen=True)
class SlickRegion:
    """A round slick of the material's oil on the water; towards its edge it thins out to a sheen."""

    centre: tuple[float, float]  # (x, y) [m]
    radius: float  # [m]
    thickness: float  # [m]
    roughness: float  # rms slope
    ripple_factor: float  # on the slope of the ripples, 0 to 1


@dataclass(frozen=True)
class Oil:
    """Oil in a slick, which lets the less light through the thicker it is (`sim/ocean/fluids/oil_film.py`)."""

    color: RGB  # sRGB of a thick layer, in 0..1
    refractive_index: float
    reflection_factor: float = 1.0  # on what the oil mirrors; 1 is physics, the oil of the course lab is below


@dataclass(frozen=True)
class Waterline:
    """Something upright in or above the water: a rectangle with round corners, seen from above."""

    centre: tuple[float, float]  # (x, y) [m]
    heading: float  # [rad] of its first side against x
    half_sides: tuple[float, float]  # [m] without the corners
    corner: float  # radius of the corners [m]; a circle has no sides
    top: float = 0.0  # [m] above still water
    bottom: float = 0.0  # [m] above still water; 0 where it reaches into it
    color: RGB = (0.5, 0.5, 0.5)  # sRGB in 0..1 of its mirror image


@dataclass(frozen=True)
class Cutout:
    """A rectangle in which no surface is drawn, so that one looks into the sea. Its walls are drawn by others."""

    centre: tuple[float, float]  # (x, y) [m] of the middle of one side
    half_width: float  # [m] half the length of that side
    direction: tuple[float, float]  # unit vector from that side to the opposite one
    length: float  # [m] from that side to the opposite one


@dataclass(frozen=True)
class Material:
    """Appearance and lighting of a fluid. Colours are sRGB in 0..1, angles in radians, z up."""

    deep_color: RGB = (0.0, 0.20, 0.31)  # of the light that comes back from deep water
    scatter_color: RGB = (0.10, 0.52, 0.50)  # of the light that crests, and water full of bubbles, scatter
    foam_color: RGB = (0.93, 0.95, 0.96)
    refractive_index: float = 1.333  # of the water; sets the Fresnel reflectance where no oil is on it
    roughness: float = 0.03  # rms slope of what neither the mesh nor the ripples show
    reflection_factor: float = 1.0  # on every reflection; 1 is physics

    ripple_slope: float = 0.2  # rms slope of the ripples, which are too short for the mesh
    ripple_length: float = 1.6  # [m] of the longest ripple
    ripple_shortest: float = 0.05  # [m] of the shortest ripple
    ripple_direction: float = 0.0  # [rad] towards which ripples, foam and clouds move
    gravity: float = 9.81  # [m/s2]; sets the speed of the ripples
    foam_scale: float = 2.0  # [m] size of a patch of bubbles

    sun_direction: tuple[float, float, float] = (0.6, 0.3, 0.5)  # towards the sun, of any length
    sun_color: RGB = (1.0, 0.9, 0.75)
    sun_strength: float = 6.0  # irradiance, in units of the sky photograph's radiance
    sun_disc: float = 1.0  # fraction of the sun's disc and glitter that is visible, 0 to 1
    clouds: float = 0.4  # cloud cover, 0 to 1
    cloud_size: float = 2.2  # horizontal size of a cloud, in heights of the cloud layer
    cloud_darkness: float = 0.3  # fraction of its light that thick cloud takes away, 0 to 1

    haze_distance: float = HAZE_DISTANCE  # [m] at which a share 1 - 1/e of the sea is lost in the sky
    exposure: float = 1.0  # factor on all light
    # Of the sky photograph, which was taken on land: the height [rad] of the land towards the sun and away from it,
    # and the slope at the horizon of the photograph's elevation over the drawn elevation.
    skyline: tuple[float, float, float] = (0.06, 0.2, 0.6)
    # Fraction of the photograph's azimuths that is used, blur of the haze's colour (0 to 1), and the radiance that is
    # reduced to its half, so that no place of the photograph is too bright.
    sky_fold: tuple[float, float, float] = (1.0, 0.3, 12.0)
    sky_tint: RGB = (1.0, 1.0, 1.0)  # colour filter on the photograph, linear, any value from 0
    # Mean radiance of the photograph, linear, at the horizon and overhead: a browser that cannot draw into floats has a
    # sky of these instead.
    sky_low: RGB = (0.75, 0.80, 0.85)
    sky_high: RGB = (0.20, 0.40, 0.70)
    draw_sky: bool = True

    # Drops that make a ring [1/(m2 s)] (0: no rain), wavelength [m] and speed [m/s] of the rings.
    rain_rings: tuple[float, float, float] = (0.0, 0.017, 0.23)
    rain_extinction: float = 0.0  # [1/m] of light by the rain in the air

    fire_place: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m] of a fire that lights the sea
    fire_light: RGB = (0.0, 0.0, 0.0)  # its radiant intensity, linear, in units of the sun's irradiance times m2
    # x, y [m] of the place around which the tile itself is drawn, and 1; 0 without such a place.
    gauge_place: tuple[float, float, float] = (0.0, 0.0, 0.0)

    wireframe: bool = False  # draw the simulated grid
    wire_color: RGB = (0.95, 0.55, 0.1)
    oil: Oil | None = None
    slick: SlickRegion | None = None  # of that oil
    cutout: Cutout | None = None

    def seen_color(self, thickness: float) -> RGB:
        """Colour of the light from below through this much oil [m], for drawings in one colour."""
        if self.oil is None:
            return self.deep_color
        through = light_through(thickness)
        red, green, blue = (through * self.deep_color + (1.0 - through) * self.oil.color).tolist()
        return red, green, blue


@functools.lru_cache(maxsize=64)
def linear(color: RGB) -> tuple[float, float, float]:
    """Linear light of an sRGB colour in 0..1 (IEC 61966-2-1, to within 1 %)."""
    red, green, blue = (min(max(c, 0.0), 1.0) ** 2.2 for c in color)
    return red, green, blue


def blend(a: RGB | np.ndarray, b: RGB | np.ndarray, share: float) -> RGB:
    """The colour `share` of the way from a to b."""
    x, y, z = ((1.0 - share) * np.asarray(a) + share * np.asarray(b)).tolist()
    return x, y, z


def as_bytes(color: RGB) -> tuple[int, int, int]:
    """An sRGB colour in 0..1 as 0..255."""
    red, green, blue = (round(255 * min(max(c, 0.0), 1.0)) for c in color)
    return red, green, blue


def as_linear_bytes(color: RGB) -> tuple[int, int, int]:
    """An sRGB colour in 0..1 as 0..255 of linear light, as viser takes colours of instances."""
    return as_bytes(linear(color))


def waterline_table(waterlines: Sequence[Waterline]) -> np.ndarray:
    """The uniforms of the waterlines, twelve numbers each in the order of the shader, as (4 MAX_WATERLINES, 3) float32.

    A corner of 0 means none. Raises ValueError for more than MAX_WATERLINES.
    """
    if len(waterlines) > MAX_WATERLINES:
        raise argument_error("waterlines", len(waterlines), f"at most {MAX_WATERLINES}")
    table = np.zeros((MAX_WATERLINES, 12), np.float32)
    for k, line in enumerate(waterlines):
        place = *line.centre, math.cos(line.heading), math.sin(line.heading)
        table[k] = *place, *line.half_sides, line.corner, line.top, *linear(line.color), line.bottom
    return table.reshape(-1, 3)


class Grid(NamedTuple):
    """The simulated grid of a sea, as the shader reads it."""

    rows: int  # of vertices; of rings, with the middle
    columns: int  # of vertices; spokes
    size: float  # [m] side of the tile, or radius of the last ring
    # Exponent of the radii of the rings (0: geometric), radius of the first [m] (0: a tile), ratio of their steps.
    ring_law: tuple[float, float, float] = (0.0, 0.0, 0.0)


def uniform_table(
    material: Material, sea_state: tuple[float, float, float], grid: Grid, middle: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """The uniforms of the water shader, (len(WATER_UNIFORMS), 3) float32, in their order.

    sea_state: time [s], significant height [m], mean square slope. middle: x, y [m] of the middle of the rings.
    """
    m, oil, slick, cutout = material, material.oil, material.slick, material.cutout
    sun = np.asarray(m.sun_direction, float)
    nothing = (0.0, 0.0, 0.0)
    values: dict[str, Sequence[float] | np.ndarray] = {
        "deepColor": linear(m.deep_color),
        "scatterColor": linear(m.scatter_color),
        "foamColor": linear(m.foam_color),
        "sunDirection": sun / max(float(np.linalg.norm(sun)), 1e-9),
        "sunLight": [c * m.sun_strength for c in linear(m.sun_color)],
        "optics": (m.refractive_index, m.roughness, m.reflection_factor),
        "lens": (1.0 / (1.0 / m.haze_distance + m.rain_extinction), m.exposure, m.sun_disc),
        "ripple": (m.ripple_slope, m.ripple_length, m.ripple_shortest),
        "skyline": m.skyline,
        "skyFold": m.sky_fold,
        "skyTint": m.sky_tint,
        "skyLow": m.sky_low,
        "skyHigh": m.sky_high,
        "clouds": (m.clouds, m.cloud_size, m.cloud_darkness),
        "wind": (m.ripple_direction, m.gravity, m.foam_scale),
        "seaState": sea_state,
        "grid": grid[:3],
        "ringLaw": grid.ring_law,
        "gridMiddle": (*middle, 0.0),
        "shown": (float(m.draw_sky), float(m.wireframe), 0.0),
        "wireColor": linear(m.wire_color),
        "slick": nothing if slick is None else (*slick.centre, slick.radius),
        "slickOptics": nothing if slick is None else (slick.thickness, slick.roughness, slick.ripple_factor),
        "oilColor": nothing if oil is None else linear(oil.color),
        "oilFilm": nothing if oil is None else (oil.refractive_index, m.refractive_index, oil.reflection_factor),
        "oilExtinction": EXTINCTION,
        "firePlace": m.fire_place,
        "fireLight": m.fire_light,
        "gaugePlace": m.gauge_place,
        "rainRings": m.rain_rings,
        "rainVeil": (m.rain_extinction, RAIN_HEIGHT, 0.0),
        "cutout": nothing if cutout is None else (*cutout.centre, cutout.half_width),
        "cutoutDirection": nothing if cutout is None else (*cutout.direction, cutout.length),
    }
    return np.array([values[name] for name in WATER_UNIFORMS], np.float32)
