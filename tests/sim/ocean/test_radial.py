"""The sum of waves: its energy, its accuracy after a month, its grid, what it does on oil."""

import dataclasses
import math

import numpy as np
import pytest

from sim.ocean.dispersion import mode_ratios, two_layer, viscous_root
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.radial.gerstner import draw_waves, widened
from sim.ocean.radial.radial import RadialSea
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.spectra import SPECTRA
from sim.waves import Waves
from tests.naive_ocean import plane_integral
from tests.refusals import assert_refused

MONTH = 30 * 24 * 3600.0
WIND = SPECTRA["jonswap"].conditions(wind_speed=8.0)


def sea_of(count: int = 64, **column) -> RadialSea:
    return RadialSea(draw_waves(SPECTRA["jonswap"], WIND, count), FluidColumn(**column))


def naive(sea: RadialSea, x: np.ndarray, y: np.ndarray, t: float, weights: np.ndarray | None = None) -> np.ndarray:
    """(n, 3) of labels x, y: each wave in turn, in extended precision."""
    out = np.zeros((len(x), 3), np.longdouble)
    for i in range(len(sea.waves.kx)):
        k = np.hypot(sea.waves.kx[i], sea.waves.ky[i])
        phase = (
            np.longdouble(sea.waves.kx[i]) * x
            + np.longdouble(sea.waves.ky[i]) * y
            - np.longdouble(sea.rate[i]) * np.longdouble(t)
            + sea.waves.phase[i]
        )
        a = sea.amplitude[i] * (1.0 if weights is None else weights[:, i])
        out[:, 0] -= sea.waves.kx[i] / k * a * np.sin(phase)
        out[:, 1] -= sea.waves.ky[i] / k * a * np.sin(phase)
        out[:, 2] += a * np.cos(phase) + 0.5 * k * a * a
    out[:, 0] += x
    out[:, 1] += y
    return out.astype(float)


@pytest.mark.parametrize("name", sorted(name for name, s in SPECTRA.items() if s.line is None))
@pytest.mark.parametrize("count", [64, 200])
def test_the_sum_has_the_height_of_its_spectrum_within_a_percent(name: str, count: int) -> None:
    wind = SPECTRA[name].conditions(wind_speed=8.0)
    expected = 4.0 * math.sqrt(plane_integral(SPECTRA[name], wind))
    assert draw_waves(SPECTRA[name], wind, count).significant_height == pytest.approx(expected, rel=0.01)


def test_conditions_come_by_name_or_as_a_record() -> None:
    record = SPECTRA["tma"].conditions(wind_speed=9.0, depth=25.0)
    one = draw_waves(SPECTRA["tma"], record, 16, seed=3)
    for other in (
        draw_waves("tma", record, 16, seed=3),
        draw_waves("tma", count=16, seed=3, wind_speed=9.0, depth=25.0),
        draw_waves("tma", SPECTRA["tma"].conditions(wind_speed=9.0), 16, seed=3, depth=25.0),
    ):
        assert other.water == one.water
        for name in ("kx", "ky", "amplitude", "phase", "omega"):
            np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
    assert_refused("spectrum", lambda: draw_waves("tmma"), "tma")
    assert_refused("hs", lambda: draw_waves("tma", hs=2.0), "sea_state")
    assert_refused("depth", lambda: draw_waves("tma", depth=-1.0))


def test_the_drawn_surface_has_that_height_too() -> None:
    sea = sea_of()
    samples = np.concatenate([sea.at([[x, 0.0]], 0.0).height for x in np.linspace(0.0, 4e5, 3000)])
    assert 4.0 * samples.std() == pytest.approx(sea.significant_height, rel=0.06)  # a sample's own scatter is 3 %


@pytest.mark.parametrize("t", [0.0, 17.3, MONTH])
def test_it_agrees_with_a_naive_sum_to_1e_5_m_after_a_month(t: float) -> None:
    sea = sea_of()
    grid = RadialGrid(64, 64)
    drawn = sea.on(grid, t).vertices
    order = np.argsort(sea.waves.k, kind="stable")
    shown = np.zeros((len(grid), len(order)))
    bands = np.diff(grid.start.astype(int))
    shown[:, order] = np.repeat(grid.weights(sea.waves.k[order]), bands, axis=0)
    near = grid.x.astype(float) ** 2 + grid.y.astype(float) ** 2 < 200.0**2
    expected = naive(sea, grid.x.astype(float), grid.y.astype(float), t, shown)
    np.testing.assert_allclose(drawn[near], expected[near], atol=1e-5)
    np.testing.assert_allclose(drawn[:, 2], expected[:, 2], atol=1e-5)  # x itself is no finer than 1e-4 m at 4 km


def test_it_agrees_far_from_the_origin_too() -> None:
    sea, grid = sea_of(), RadialGrid(16, 16, inner=0.4, radius=40.0)
    centre = (70000.0, -30000.0)
    drawn = sea.on(grid, 3.0, centre).vertices
    weights = np.repeat(grid.weights(sea.waves.k), np.diff(grid.start.astype(int)), axis=0)
    x, y = grid.x.astype(float) + centre[0], grid.y.astype(float) + centre[1]
    np.testing.assert_allclose(drawn[:, 2], naive(sea, x, y, 3.0, weights)[:, 2], atol=1e-5)


def test_slopes_are_those_of_the_displaced_surface() -> None:
    sea = sea_of()
    where = np.random.default_rng(1).uniform(-50, 50, (20, 2))
    at, e = sea.at(where, 5.0), 1e-4
    for axis in range(2):
        step = np.eye(2)[axis] * e
        difference = (sea.at(where + step, 5.0).height - sea.at(where - step, 5.0).height) / (2 * e)
        np.testing.assert_allclose(at.slope[:, axis], difference, atol=1e-5)


def test_points_of_the_mesh_lie_on_the_surface_that_is_asked() -> None:
    sea, grid = sea_of(), RadialGrid()
    surface = sea.on(grid, 40.0)
    full = int((grid.weights(sea.waves.k) == 1.0).all(axis=1).sum()) * grid.spokes
    assert full >= 5 * grid.spokes
    at = sea.at(surface.vertices[: full - grid.spokes, :2], 40.0)
    np.testing.assert_allclose(at.height, surface.vertices[: full - grid.spokes, 2], atol=2e-5)
    np.testing.assert_allclose(at.slope, surface.slope[: full - grid.spokes], atol=2e-5)
    assert at.residual.max() < 1e-6


def test_velocity_and_acceleration_are_those_of_what_rides_the_surface() -> None:
    sea, t, e = sea_of(), 8.0, 1e-3
    label = np.array([[3.0, -2.0]])
    path = np.array([naive(sea, label[:, 0], label[:, 1], t + s * e)[0] for s in (-1, 0, 1)])
    at = sea.at(path[1:2, :2], t)
    np.testing.assert_allclose(at.label, label, atol=1e-6)
    np.testing.assert_allclose(at.velocity[0], (path[2] - path[0]) / (2 * e), atol=1e-5)
    assert at.acceleration[0] == pytest.approx((path[2] - 2 * path[1] + path[0])[2] / e**2, abs=1e-3)


def test_one_gerstner_wave_is_a_trochoid() -> None:
    k, a = 0.5, 0.4
    sea = RadialSea(Waves(np.array([k]), np.zeros(1), np.array([a]), np.zeros(1)))
    label = np.linspace(0.0, 2 * math.pi / k, 50)
    x, z = label - a * np.sin(k * label), a * np.cos(k * label) + 0.5 * k * a * a  # about still water: Lamb, Art. 251
    at = sea.at(np.column_stack([x, np.zeros(50)]), 0.0)
    np.testing.assert_allclose(at.height, z, atol=1e-7)
    speed = sea.rate[0] * a
    np.testing.assert_allclose(np.hypot(at.velocity[:, 0], at.velocity[:, 2]), speed, rtol=1e-6)


@pytest.mark.parametrize("choppiness", [1.0, 0.5])
def test_the_mean_level_of_the_sum_and_of_its_interface_is_that_of_still_water(choppiness: float) -> None:
    """Over whole lengths of both waves, at points and on the mesh, with a hull's footprint too."""
    k, a = np.array([0.4, 0.5]), np.array([0.3, 0.25])
    waves = Waves(k, np.zeros(2), a, np.array([0.6, 1.9]))
    sea = RadialSea(waves, FluidColumn(thickness=0.5), choppiness=choppiness)
    x = (np.arange(4000) + 0.5) * 20.0 * math.pi / 4000
    for size in (0.0, 3.0):
        at = sea.at(np.column_stack([x, 0.0 * x]), 3.0, size)
        assert at.height.mean() == pytest.approx(0.0, abs=1e-4)
        assert at.interface.mean() == pytest.approx(0.0, abs=1e-4)
    assert 0.5 * choppiness * (k * a**2).sum() > 0.01
    grid = RadialGrid(64, 64, 0.3, 60.0)
    surface = sea.on(grid, 3.0)
    near = slice(0, 20 * grid.spokes)
    points = sea.at(surface.vertices[near, :2].astype(float), 3.0)
    np.testing.assert_allclose(points.height, surface.vertices[near, 2], atol=2e-5)


def test_a_wave_shorter_than_two_cells_is_skipped_and_counted() -> None:
    grid, sea = RadialGrid(), sea_of()
    sea.on(grid, 0.0)
    cells = 2 * math.pi / sea.waves.k / grid.spacing[:, None]
    pairs = ((cells > 2.0).sum(axis=1) * np.diff(grid.start.astype(int))).sum()
    assert sea.evaluated == pairs
    assert sea.evaluated + sea.skipped == len(grid) * 64
    assert grid.weights(sea.waves.k)[cells <= 2.0].max() == 0.0
    assert grid.weights(sea.waves.k)[cells >= 4.0].min() == 1.0


@pytest.mark.parametrize("law", ["geometric", "power"])
def test_the_grid_is_one_disc_seen_from_above(law: str) -> None:
    grid = RadialGrid(20, 24, inner=0.5, radius=300.0, law=law)
    a, b, c = (np.stack([grid.x, grid.y], axis=1)[grid.faces[:, i]].astype(float) for i in range(3))
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert area.min() > 0.0
    assert area.sum() == pytest.approx(24 / 2 * math.sin(2 * math.pi / 24) * 300.0**2, rel=1e-5)
    assert grid.radii[-1] == pytest.approx(300.0)
    assert (np.diff(grid.radii) > 0).all()


def test_geometric_rings_keep_their_proportions() -> None:
    steps = np.diff(RadialGrid(60, 24).radii)
    np.testing.assert_allclose(steps[1:] / steps[:-1], steps[1] / steps[0], rtol=1e-6)


def test_waves_on_a_layer_are_the_exact_surface_mode() -> None:
    oil = fluids()["Maya"]
    sea = sea_of(oil=oil, thickness=0.5)
    k = sea.waves.k
    tensions = (oil.surface_tension or 0.0, oil.interface_tension or 0.0)
    exact, _ = two_layer(k, oil.density, 0.5, 1025.0, 9.81, math.inf, *tensions)
    np.testing.assert_allclose(sea.rate, exact, rtol=1e-4)  # viscosity lowers it a little
    at = sea.at([[1.0, 2.0]], 0.0)
    ratio = mode_ratios(k, oil.density, 0.5, 1025.0, 9.81, math.inf, *tensions).surface
    np.testing.assert_allclose(ratio, np.exp(-0.5 * k), rtol=1e-3)
    phase = sea.waves.kx * at.label[0, 0] + sea.waves.ky * at.label[0, 1] + sea.waves.phase
    gathered = 0.5 * k * sea.amplitude**2
    assert at.interface[0] == pytest.approx((ratio * (sea.amplitude * np.cos(phase) + gathered)).sum(), abs=1e-6)


def test_on_a_thick_layer_waves_decay_at_the_exact_viscous_root() -> None:
    oil = fluids()["IFO 180"]
    column = FluidColumn(oil=oil, thickness=1e4)
    k = np.array([0.1, 1.0, 10.0])
    _, exact = viscous_root(k, oil.kinematic_viscosity)
    np.testing.assert_allclose(column.roots(k)[1], exact, rtol=3e-2)  # the root here has the surface tension too
    np.testing.assert_allclose(column.roots(k[:2])[1], exact[:2], rtol=1e-3)


def test_heavy_oil_takes_the_short_waves_and_leaves_the_long_ones() -> None:
    waves = draw_waves(SPECTRA["jonswap"], WIND, 128)
    oil = FluidColumn(oil=fluids()["IFO 180"], thickness=0.5)
    clean, covered = RadialSea(waves), RadialSea(waves, oil, exposure=600.0)
    ratio = covered.amplitude / clean.amplitude
    assert (np.diff(ratio) <= 1e-12).all()
    assert ratio[0] > 0.99
    assert ratio[-1] < 0.7
    np.testing.assert_allclose(covered.rate[0], clean.rate[0], rtol=1e-4)  # the speed is what it was


def test_a_film_calms_more_than_thin_oil() -> None:
    k = np.logspace(-1, 2, 20)
    bare, film = FluidColumn(thickness=1e-3), FluidColumn(thickness=1e-3, film=True)
    assert (film.roots(k)[1] >= bare.roots(k)[1]).all()
    assert film.roots(k)[1][10] > 5 * bare.roots(k)[1][10]


def test_oil_poured_in_lets_phases_run_on() -> None:
    sea = sea_of()
    where = [[2.0, 3.0]]
    before = sea.at(where, 100.0)
    sea.change(100.0, column=FluidColumn(thickness=0.2))
    after = sea.at(where, 100.0)
    np.testing.assert_allclose(after.height, before.height, atol=1e-9)


def test_other_waves_take_over_smoothly_and_wholly() -> None:
    sea = sea_of()
    storm = draw_waves(SPECTRA["jonswap"], SPECTRA["jonswap"].conditions(wind_speed=20.0), 80)
    before = sea.at([[0.0, 0.0]], 50.0).height
    sea.change(50.0, waves=storm, fade=2.0)
    np.testing.assert_allclose(sea.at([[0.0, 0.0]], 50.0 + 1e-9).height, before, atol=1e-3)
    old, new = sea_of().amplitude, storm.amplitude
    for t, share in ((50.5, 0.25), (51.0, 0.5), (51.5, 0.75)):  # of the energy
        amplitude = np.concatenate([old * math.sqrt(1.0 - share), new * math.sqrt(share)])
        np.testing.assert_allclose(sea.waves_at(t).amplitude, amplitude, rtol=1e-12)
    grid = RadialGrid(32, 32)
    sea.on(grid, 51.0)
    sea.change(51.5, column=FluidColumn(thickness=0.3))
    assert len(sea.waves_at(51.6).kx) == 64 + 80
    assert len(sea.waves_at(52.1).kx) == 80
    assert sea.significant_height == pytest.approx(storm.significant_height)


def test_a_wide_hull_feels_the_mean_over_its_width() -> None:
    k = np.array([0.5, 4.0])
    x = np.linspace(-1.0, 1.0, 201)
    X, Y = np.meshgrid(x, x)
    inside = np.hypot(X, Y) < 1.0
    exact = np.array([np.cos(one * X[inside]).mean() for one in k])
    np.testing.assert_allclose(widened(k, 2.0), exact, atol=0.2)
    assert widened(k, 2.0)[0] == pytest.approx(exact[0], abs=1e-3)
    assert (widened(k, 0.0) == 1.0).all()


def test_no_wind_is_a_level_sea() -> None:
    sea = RadialSea(draw_waves(SPECTRA["jonswap"], SPECTRA["jonswap"].conditions(wind_speed=0.0), 64))
    surface = sea.on(RadialGrid(8, 8), 9.0)
    assert np.abs(surface.vertices[:, 2]).max() == 0.0
    assert np.isfinite(surface.slope).all()


def test_exposure_adds_up_and_is_that_of_having_run_longer() -> None:
    waves, oil = draw_waves(SPECTRA["jonswap"], WIND, 64), FluidColumn(oil=fluids()["IFO 180"], thickness=0.3)
    grown, longer = RadialSea(waves, oil, exposure=10.0), RadialSea(waves, oil, exposure=300.0)
    grown.expose(290.0)
    np.testing.assert_allclose(grown.amplitude, longer.amplitude, rtol=1e-12)
    assert grown.past == longer.past == {oil: 300.0}
    assert grown.significant_height < RadialSea(waves, oil, exposure=10.0).significant_height
    np.testing.assert_allclose(grown.at([[1.0, 2.0]], 7.0).height, longer.at([[1.0, 2.0]], 7.0).height, atol=1e-12)
    with pytest.raises(ValueError, match="duration"):
        grown.expose(-1.0)


def test_what_oil_took_stays_taken_when_the_water_or_the_waves_change() -> None:
    """-ln of what is left adds up over the media; other waves of the same length have lost as much."""
    wind = SPECTRA["jonswap"].conditions(wind_speed=5.0, fetch=3e3)
    waves, oil = draw_waves(SPECTRA["jonswap"], wind, 64), FluidColumn(oil=fluids()["IFO 180"], thickness=0.5)
    thin, clean = FluidColumn(oil=fluids()["Maya"], thickness=0.05), FluidColumn()
    sea = RadialSea(waves, oil, exposure=1200.0)
    left = sea.significant_height
    assert left < 0.6 * waves.significant_height
    sea.change(10.0, column=clean)
    assert sea.significant_height == pytest.approx(left, rel=1e-12)
    sea.change(20.0, column=thin)
    sea.expose(300.0)
    lost = 1200.0 * oil.roots(waves.k)[1] + 300.0 * thin.roots(waves.k)[1]
    np.testing.assert_allclose(sea.amplitude, waves.amplitude * np.exp(-lost), rtol=1e-9)
    other = draw_waves(SPECTRA["jonswap"], dataclasses.replace(wind, wind_direction=1.0), 32)
    sea.change(30.0, other, clean, fade=0.0)
    lost = 1200.0 * oil.roots(other.k)[1] + 300.0 * thin.roots(other.k)[1]
    np.testing.assert_allclose(sea.amplitude, other.amplitude * np.exp(-lost), rtol=1e-9)
    sea.change(40.0, column=oil, exposure=60.0)  # set anew
    np.testing.assert_allclose(sea.amplitude, other.amplitude * np.exp(-60.0 * oil.roots(other.k)[1]), rtol=1e-9)
    assert sea.past == {oil: 60.0}


@pytest.mark.parametrize("name", [name for name, s in SPECTRA.items() if s.line is None])
@pytest.mark.parametrize("direction", [0.0, 2.0, -1.2])
def test_waves_run_where_their_spectrum_says_and_spread_as_it_does(name: str, direction: float) -> None:
    """The waves' mean of e^(i bearing) against that of the spectrum by an integral, m0 and the mean wavenumber too."""
    c = SPECTRA[name].conditions(wind_speed=9.0, wind_direction=direction)
    waves = draw_waves(SPECTRA[name], c, 400)
    mean = (np.exp(1j * np.arctan2(waves.ky, waves.kx)) * waves.amplitude**2).sum() / (waves.amplitude**2).sum()
    log_k, step = np.linspace(math.log(1e-3), math.log(100.0), 2000, retstep=True)
    k, theta = np.exp(log_k)[:, None], (np.arange(180) + 0.5) * (2.0 * math.pi / 180)
    cells = SPECTRA[name](k * np.cos(theta), k * np.sin(theta), c) * k**2
    expected = (cells * np.exp(1j * theta)).sum() / cells.sum()
    assert abs(mean - expected) < 0.02
    two = (np.exp(2j * np.arctan2(waves.ky, waves.kx)) * waves.amplitude**2).sum() / (waves.amplitude**2).sum()
    assert abs(two - (cells * np.exp(2j * theta)).sum() / cells.sum()) < 0.04
    assert waves.significant_height == pytest.approx(
        4.0 * math.sqrt(cells.sum() * step * 2.0 * math.pi / 180), rel=2e-3
    )


def test_a_regular_wave_is_one_wave_of_its_height_and_period() -> None:
    c = SPECTRA["regular"].conditions(wave_height=1.2, wave_period=5.0, wind_direction=0.6, wind_speed=0.0)
    sea = RadialSea(draw_waves(SPECTRA["regular"], c, 64))
    height = [float(sea.at([[0.0, 0.0]], t).height[0]) for t in np.linspace(0.0, 5.0, 201)]
    assert len(sea.waves.kx) == 1
    # The trochoid of a deep wave: H from trough to crest, sqrt(2) H for 4 sqrt(m0).
    assert max(height) - min(height) == pytest.approx(1.2, rel=1e-3)
    assert sea.at([[0.0, 0.0]], 5.0).height[0] == pytest.approx(height[0], abs=1e-3)
    assert sea.significant_height == pytest.approx(math.sqrt(2.0) * 1.2)
    assert sea.waves.k[0] == pytest.approx((2 * math.pi / 5.0) ** 2 / 9.81, rel=1e-9)
    assert math.atan2(sea.waves.ky[0], sea.waves.kx[0]) == pytest.approx(0.6)
    crossing = draw_waves(SPECTRA["regular"], dataclasses.replace(c, second_height=1.0), 64)
    assert len(crossing.kx) == 65
    assert crossing.significant_height == pytest.approx(math.hypot(math.sqrt(2.0) * 1.2, 1.0), rel=1e-3)
    assert (np.diff(crossing.k) >= 0.0).all()
