"""How a fluid of the radial sea looks: colour, index and smoothness of water, oil, and both mixed."""

import dataclasses
import math
from typing import Any

import numpy as np

from app.render.material import RGB, Cutout, Material, SlickRegion
from app.scenes.radial_sea.frame import RadialFrame
from app.scenes.radial_sea.parameters import Params
from app.scenes.radial_sea.well_blowout import Slick
from sim.ocean.fluid_column import FluidColumn

LAB_SPECULAR = 0.4  # share of the reflection that the lab's mode keeps of oil
RIPPLE = 0.9  # [m] wave that stands for the ripples of the material
MOUSSE: RGB = (0.40, 0.26, 0.14)  # what an emulsion scatters


def rgb_of(colour: str) -> np.ndarray:
    """(3,) sRGB in 0..1 of "#rrggbb"."""
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0


def blend(a: RGB | np.ndarray, b: RGB | np.ndarray, share: float) -> RGB:
    x, y, z = ((1.0 - share) * np.asarray(a) + share * np.asarray(b)).tolist()
    return x, y, z


def ripple_slope(p: Params, column: FluidColumn, age: float) -> float:
    """Root mean square slope of the material's ripples: Cox and Munk's, less what `age` [s] of the fluid took."""
    clean = math.sqrt(0.003 + 0.00512 * p.wind_speed) if p.waves else 0.02
    k = np.array([2.0 * math.pi / RIPPLE])
    kept = math.exp(-float(column.roots(k)[1][0]) * age)
    return min(clean, 0.24) * max(kept, 0.12)


def material_of(light: Material, picture: RadialFrame) -> Material:
    """The material under a sky (`app.render.skies.set_sky`), with a slick on clean water and a cutaway in it."""
    p, column, section = picture.params, picture.column, picture.section
    common = {
        "ripple_slope": round(ripple_slope(p, column, picture.age), 3),
        "ripple_length": 1.6 if column.kind == "water" else 2.4,
        "ripple_direction": math.radians(p.wind_direction),
        "wireframe": p.grid,
        "reflection_factor": LAB_SPECULAR if p.optics == "lab" and p.spill != "none" else 1.0,
        "refractive_index": column.surface.refractive_index,
        "clouds": min(0.15 + 0.045 * p.wind_speed, 0.9),
        "cutout": None if section is None else Cutout(section.middle, section.half, section.way, section.length),
    }
    if column.kind == "water":
        patch = None if picture.slick is None else slick_patch(light, p, column, picture.slick)
        return dataclasses.replace(light, **common, slick=patch)
    return dataclasses.replace(light, **common, **oil_colours(light, column))


def oil_colours(light: Material, column: FluidColumn) -> dict[str, Any]:
    """Body colours. Oil sends nearly no light back from below; a mixture is brown and turbid."""
    oil = rgb_of(column.oil.colour)
    if column.kind == "mixed":
        share = min(1.0, 0.35 + column.fraction)
        deep = blend(light.deep_color, blend(oil, MOUSSE, 0.45), share)
        return {
            "deep_color": deep,
            "scatter_color": blend(light.scatter_color, MOUSSE, share),
            "foam_color": (0.80, 0.72, 0.60),
            "roughness": 0.06,
        }
    # A thin layer lets some of the water's colour through: light is halved every few millimetres of crude.
    seen = 1.0 - math.exp(-column.thickness / 0.004)
    deep, scatter = blend(light.deep_color, oil, seen), blend(light.scatter_color, 1.3 * oil, seen)
    foam = blend(light.foam_color, (0.45, 0.36, 0.26), seen)
    return {"deep_color": deep, "scatter_color": scatter, "foam_color": foam, "roughness": 0.02}


def slick_patch(light: Material, p: Params, column: FluidColumn, slick: Slick) -> SlickRegion:
    """A slick of this oil, drawn as if it were thick: what thin oil shows of the water is left out."""
    layer = dataclasses.replace(column, thickness=max(slick.thickness, 0.05), fraction=0.0)
    colours = oil_colours(light, layer)
    calm = ripple_slope(p, layer, p.exposure) / ripple_slope(p, column, 0.0)
    return SlickRegion(
        slick.centre, round(slick.radius, 1), colours["deep_color"], colours["scatter_color"],
        column.oil.refractive_index, colours["roughness"], round(calm, 2),
    )  # fmt: skip
