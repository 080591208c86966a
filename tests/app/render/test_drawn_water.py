"""Water as browsers without shaders see it, and the photograph of the sky above it, without a browser."""

import dataclasses
import io
import math
from importlib import resources

import numpy as np
import pytest
import viser
from PIL import Image

from app.render.injection import disable_shaders
from app.render.material import Material, SlickRegion, blend
from app.render.skies import SKIES, drawn_elevation
from app.render.water import DrawnWater, Tile

SIZE, LENGTH = 16, 40.0
SLICK = SlickRegion((10.0, 15.0), 6.0, 0.1, 0.05, 0.5)


def draw(water: DrawnWater, material: Material) -> None:
    """A level sea of this material."""
    x = np.arange(SIZE) / SIZE * LENGTH
    vertices = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((SIZE, SIZE))], axis=-1)
    water.set_material(material)
    water.set_surface(vertices, np.zeros((SIZE, SIZE, 2)), np.zeros((SIZE, SIZE)))


def test_slick_and_grid_are_drawn_plainly_where_they_are(server: viser.ViserServer) -> None:
    disable_shaders(server)
    water = DrawnWater(server, "/sea", Tile(SIZE, SIZE, LENGTH), Material())
    draw(water, Material())
    assert water._plain_meshes.keys() == {"plain_foam", "plain_sea"}
    draw(water, dataclasses.replace(Material(), slick=SLICK, wireframe=True))
    slick, wire = water._plain_meshes["plain_slick"], water._plain_meshes["plain_wire"]
    assert (slick.wireframe, wire.wireframe, wire.visible) == (False, True, True)
    raised = slick.vertices[:, 2] > 0.0
    away = np.hypot(slick.vertices[:, 0] - 10.0, slick.vertices[:, 1] - 15.0)
    assert raised.any()
    assert np.array_equal(raised, away < 6.0)
    draw(water, Material())
    assert not (water._plain_meshes["plain_slick"].vertices[:, 2] > 0.0).any()
    assert not water._plain_meshes["plain_wire"].visible


def test_a_blend_of_colours_lies_between_them() -> None:
    one, other = (0.2, 0.5, 1.0), (0.6, 0.1, 0.0)
    assert blend(one, other, 0.0) == one
    assert blend(one, other, 1.0) == pytest.approx(other)
    assert blend(one, other, 0.25) == pytest.approx((0.3, 0.4, 0.75))


@pytest.mark.parametrize("name", SKIES)
def test_the_sun_is_drawn_where_the_shader_shows_that_of_the_photograph(name: str) -> None:
    photo = SKIES[name]
    e, g, land = math.degrees(drawn_elevation(photo)), photo.stretch, photo.land_near
    assert land + e * (g + (90.0 - land - 90.0 * g) * e / 8100.0) == pytest.approx(photo.sun_height, abs=1e-9)
    assert land + 90.0 * (g + (90.0 - land - 90.0 * g) / 90.0) == pytest.approx(90.0)


# Of viser, by the name of the sky.
MAPS = {"park": "rooitou_park", "sunset": "venice_sunset", "dawn": "kiara_1_dawn", "night": "dikhololo_night"}
LIGHT = np.array([0.3, 0.5, 0.2])  # the weights of the shader


def photographed(name: str) -> np.ndarray:
    """Radiance (height, width, 3) of a photograph of viser's: a JPEG, and its logarithmic gain in another behind it."""
    data = (resources.files(viser) / f"_assets/hdri/{MAPS[name]}_1k.jpg").read_bytes()
    parts = [data.index(b"\xff\xd8\xff"), data.rindex(b"\xff\xd8\xff")]
    seen, gain = (np.asarray(Image.open(io.BytesIO(data[at:])).convert("RGB"), float) / 255.0 for at in parts)
    largest = float(data.split(b'GainMapMax="')[1].split(b'"')[0])
    return np.maximum((seen**2.2 + 1.0 / 64.0) * 2.0 ** (largest * gain) - 1.0 / 64.0, 0.0)


@pytest.mark.parametrize("name", SKIES)
def test_the_sky_by_formula_is_as_bright_as_that_of_the_photograph(name: str) -> None:
    """Mean over bearings, more towards the sun, at each elevation; what is bright is reduced as in the shader."""
    photo, image = SKIES[name], photographed(name)
    height, width, _ = image.shape
    bearing, drawn = np.meshgrid(np.linspace(-np.pi, np.pi, 180, endpoint=False), np.radians(np.arange(2.0, 85.0, 2.0)))
    land = (
        np.radians(photo.land_near + (photo.land_far - photo.land_near) * (0.5 - 0.5 * np.cos(bearing))) * 2.0 / np.pi
    )
    e = drawn * 2.0 / np.pi
    up = land + e * (photo.stretch + (1.0 - land - photo.stretch) * e)  # in right angles
    column = np.floor((photo.sun_column + bearing * photo.fold / (2.0 * np.pi)) * width).astype(int) % width
    light = image[((1.0 - up) * height / 2.0).astype(int), column]
    share = np.sqrt(np.sin(up * np.pi / 2.0))[..., None]
    formed = (1.0 - share) * np.array(photo.low) + share * np.array(photo.high)
    seen, alike = (c / (1.0 + c @ LIGHT / photo.limit)[..., None] for c in (light, formed))
    weights = 1.0 + np.cos(bearing[0])
    alike, seen = (np.average(c, axis=1, weights=weights) for c in (alike, seen))
    assert (np.sqrt(((alike - seen) ** 2).mean(0)) < seen.mean(0) / 3.0).all()
