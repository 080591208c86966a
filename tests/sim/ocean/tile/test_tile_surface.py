"""The square sea asked as the radial one is: where its water moves, and where it is pressed together."""

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.radial.gerstner import draw_waves
from sim.ocean.radial.radial import RadialSea
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.spectra import SPECTRA
from sim.ocean.tile.tile_surface import particles, sample_mesh


def tile(choppiness: float = 1.0) -> Sea:
    return Sea(size=64, length=128.0, spectrum="jonswap", wind_speed=8.0, choppiness=choppiness)


POINTS = np.array([[3.0, 4.0], [-20.0, 31.0], [60.0, -5.5]])


def test_what_rides_the_surface_goes_where_its_velocity_says() -> None:
    sea, dt = tile(), 0.02
    at = sea.at(POINTS, 5.0)
    cell = sea.length / sea.size
    before, after = (at.label + particles(sea.surface(5.0 + s), cell, at.label)[:, :2] for s in (-dt, dt))
    np.testing.assert_allclose((after - before) / (2 * dt), at.velocity[:, :2], rtol=0, atol=2e-3)
    assert np.abs(at.velocity[:, :2]).max() > 0.2
    here = at.label + particles(sea.surface(5.0), cell, at.label)[:, :2]
    np.testing.assert_allclose(here, POINTS, atol=1e-3)
    # and stays on the surface: w = d eta/dt + u . grad eta
    rise = at.interface_rise + (at.velocity[:, :2] * at.slope).sum(axis=1)
    np.testing.assert_allclose(at.velocity[:, 2], rise, atol=0.02)


def test_without_choppiness_nothing_moves_along() -> None:
    at = tile(0.0).at(POINTS, 5.0)
    assert (at.velocity[:, :2] == 0.0).all()
    np.testing.assert_allclose(at.velocity[:, 2], at.interface_rise, atol=1e-6)


def test_the_jacobian_is_that_of_the_mesh() -> None:
    sea, grid = tile(), RadialGrid(64, 64, 0.3, 60.0)
    surface = sea.on(grid, 3.0)
    own = sea.surface(3.0).jacobian
    # crests are pressed together and troughs drawn apart, as much as in the transform's own field
    near = surface.jacobian[: 40 * grid.spokes]
    assert near.min() > own.min() - 0.05
    assert near.max() < own.max() + 0.05
    assert np.corrcoef(near, surface.vertices[: 40 * grid.spokes, 2])[0, 1] < -0.5
    level = Sea(size=64, length=128.0, wind_speed=0.0).on(grid, 0.0)
    np.testing.assert_array_equal(level.jacobian, 1.0)


def test_the_mean_level_of_the_mesh_is_that_of_still_water_also_where_it_is_lowered_to_a_share() -> None:
    sea = tile()
    D, h = (np.ascontiguousarray(f) for f in (sea.surface(3.0).displacement, sea.surface(3.0).height))
    x, y = (c.ravel().astype(np.float32) for c in np.meshgrid(*[np.arange(128) + 0.25] * 2, indexing="ij"))
    slopes, jacobian = np.empty((x.size, 2), np.float32), np.empty(x.size, np.float32)
    mean = sea.surface(3.0).mean_height
    assert mean > 0.01
    for share in (1.0, 0.5):
        vertices = np.empty((x.size, 3), np.float32)
        sample_mesh(x, y, np.full(x.size, share, np.float32), 0.0, 0.0, 2.0, 2.0, mean, h, D[..., 0], D[..., 1],
                    D[..., 0], D[..., 1], vertices, slopes, jacobian)  # fmt: skip
        # Between grid points the waves of a few cells are too flat, and gather less.
        assert float((vertices[:, 2] * jacobian).mean()) == pytest.approx(0.0, abs=0.08 * share**2 * mean)


def test_oil_that_has_passed_leaves_the_same_height_on_the_radial_and_the_fft_sea() -> None:
    """Within 1 %, and never above what was left, when clean water comes back and when the wind changes."""
    jonswap = SPECTRA["jonswap"]
    wind = jonswap.conditions(wind_speed=6.0, fetch=5e3)
    oil = FluidColumn(oil=fluids()["IFO 180"], thickness=0.5)
    radial = RadialSea(draw_waves(jonswap, wind, 400))
    fft = Sea(256, 100.0, "jonswap", wind_speed=6.0, fetch=5e3, amplitudes="fixed")
    assert fft.significant_height == pytest.approx(radial.significant_height, rel=0.01)
    radial.change(5.0, column=oil)
    radial.expose(600.0)
    fft.change(5.0, decay=lambda k: oil.roots(k)[1])
    fft.expose(600.0)
    left = radial.significant_height
    assert left < 0.6 * radial.waves.significant_height
    assert fft.significant_height_at(5.0) == pytest.approx(left, rel=0.01)
    radial.change(6.0, column=FluidColumn())
    fft.change(6.0, decay=None)
    assert radial.significant_height <= left * (1.0 + 1e-12)
    # A second of oil passed on the clock of the FFT sea, and none of the sum's.
    assert fft.significant_height_at(6.0) == pytest.approx(left, rel=0.01)
    tile = Sea(256, 100.0, "jonswap", wind_speed=6.0, fetch=5e3, amplitudes="fixed")
    for column, duration in radial.past.items():
        tile.expose(duration, column)
    assert tile.significant_height == pytest.approx(left, rel=0.01)
    turned = jonswap.conditions(wind_speed=6.0, fetch=5e3, wind_direction=2.0)
    radial.change(7.0, draw_waves(jonswap, turned, 400), fade=0.0)
    fft.change(7.0, wind_direction=2.0)
    assert radial.significant_height == pytest.approx(left, rel=0.01)
    assert fft.significant_height_at(7.0) == pytest.approx(left, rel=0.01)


def test_the_mean_square_slope_is_that_of_the_surface() -> None:
    sea = tile(0.0)
    slopes = [np.square(sea.surface(t).slope).sum(axis=-1).mean() for t in np.arange(0.0, 40.0, 5.0)]
    assert sea.mean_square_slope == pytest.approx(np.mean(slopes), rel=0.1)


def test_a_grid_about_a_neighbouring_tile_shows_the_same_sea_there() -> None:
    sea, grid = tile(), RadialGrid(24, 24, 0.5, 60.0)
    here, there = sea.on(grid, 3.0), sea.on(grid, 3.0, (2.0 * 128.0, -128.0))
    np.testing.assert_allclose(there.vertices - here.vertices, np.tile([256.0, -128.0, 0.0], (len(grid), 1)), atol=1e-3)
    aside = sea.on(grid, 3.0, (10.0, -7.0))
    height, _ = sea.height_at(aside.vertices[:1, :2].astype(float), 3.0)
    assert aside.vertices[0, 2] == pytest.approx(height[0], abs=0.02)
