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
from sim.ocean.tile.tile_surface import sample_mesh


def tile(choppiness: float = 1.0) -> Sea:
    return Sea(size=64, length=128.0, spectrum="jonswap", wind_speed=8.0, choppiness=choppiness)


POINTS = np.array([[3.0, 4.0], [-20.0, 31.0], [60.0, -5.5]])
CORNERS = 4.0 * np.array([[0.0, 0.0], [3.0, 17.0], [-5.0, 8.0], [20.0, 31.0]])  # of cells, where fields are exact
STILL = np.column_stack([CORNERS, np.zeros(4)])


def test_what_rides_the_surface_goes_where_its_velocity_says() -> None:
    """In deep water, where the drawn displacement is that of the water."""
    sea, dt, rows = tile(), 0.01, ([1, 40, 13], [5, 22, 60])
    label = 2.0 * np.column_stack(rows)

    def ridden(t: float) -> np.ndarray:
        surface = sea.surface(t)
        height = surface.height[rows] - surface.mean_height
        return np.column_stack([label + surface.displacement[rows], height]).astype(float)

    before, here, after = (ridden(5.0 + s) for s in (-dt, 0.0, dt))
    at = sea.at(here[:, :2], 5.0)
    np.testing.assert_allclose(at.label, label, atol=1e-5)
    np.testing.assert_allclose((after - before) / (2 * dt), at.velocity, rtol=0, atol=1e-3)
    np.testing.assert_allclose((after - 2 * here + before)[:, 2] / dt**2, at.acceleration, rtol=0, atol=2e-2)
    assert np.abs(at.velocity[:, :2]).max() > 0.2
    assert np.abs(at.acceleration).max() > 0.3


@pytest.mark.parametrize("choppiness", [0.0, 1.0])
def test_slopes_at_points_are_those_of_the_heights(choppiness: float) -> None:
    sea, d = Sea(64, 128.0, "jonswap", wind_speed=8.0, choppiness=choppiness, precision="double", low_pass=12.0), 1e-3
    around = [sea.height_at(POINTS + step, 5.0)[0] for step in ((d, 0.0), (-d, 0.0), (0.0, d), (0.0, -d))]
    slope = np.column_stack([around[0] - around[1], around[2] - around[3]]) / (2 * d)
    np.testing.assert_allclose(sea.at(POINTS, 5.0).slope, slope, rtol=0, atol=0.02 * np.abs(slope).max())


def test_rings_move_the_water_of_the_surface() -> None:
    sea = Sea(64, 128.0, wind_speed=0.0, depth=4.0, precision="double", choppiness=0.0)
    sea.ripples.add(0.0, [[64.0, 64.0]], width=5.0, volume=20.0)
    # The spreading hump takes its volume with it: eta_t = -h div of the mean velocity, and W = eta_t.
    places, dt = np.array([[64.0, 64.0], [70.0, 64.0], [64.0, 50.0]]), 1e-3
    before, now, after = (sea.height_at(places, 1.0 + s)[0] for s in (-dt, 0.0, dt))
    at = sea.at(places, 1.0)
    np.testing.assert_allclose(at.velocity[:, 2], (after - before) / (2 * dt), rtol=0, atol=1e-6)
    np.testing.assert_allclose(at.acceleration, (after - 2 * now + before) / dt**2, rtol=0, atol=1e-5)
    assert np.abs(at.velocity[:, 2]).max() > 0.01
    assert at.velocity[1, 0] > 10.0 * abs(at.velocity[1, 1])
    assert at.velocity[2, 1] < -10.0 * abs(at.velocity[2, 0])


@pytest.mark.parametrize("choppiness", [0.0, 1.0])
@pytest.mark.parametrize("medium", [{"viscosity": 1e-3}, {"relax": 5.0}, {"relax": 5.0, "viscosity": 1e-3}])
def test_a_sea_that_decays_or_relaxes_moves_as_its_waves_from_its_own_first_instant_on(medium, choppiness) -> None:
    viscosity = medium.get("viscosity", 0.0)
    sea = Sea(32, 128.0, "sea_state", hs=1e-6, tp=6.0, choppiness=choppiness, precision="double", viscosity=viscosity)
    at = [(0.0, sea.at(CORNERS, 0.0))]
    kinematics = [sea.kinematics(STILL, 0.0)]
    if "relax" in medium:
        sea.change(7.0, relax=medium["relax"], hs=3e-6, depth=6.0)
    for t in (7.0, 9.0, 30.0):
        at.append((t, sea.at(CORNERS, t)))
        kinematics.append(sea.kinematics(STILL, t))
    for (t, surface), water in zip(at, kinematics, strict=True):
        greatest = np.abs(water.velocity).max()
        assert surface.velocity == pytest.approx(water.velocity, abs=1e-6 * greatest), t
        assert surface.acceleration == pytest.approx(
            water.acceleration[:, 2], abs=1e-6 * np.abs(water.acceleration).max()
        )


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
