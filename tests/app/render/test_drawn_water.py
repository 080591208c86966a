"""Water as browsers without shaders see it, and the photograph of the sky above it, without a browser."""

import dataclasses
import math

import numpy as np
import pytest
import viser

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
