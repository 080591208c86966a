"""The slick: Fay's three regimes, and waves that lose amplitude on their way under it."""

import math

import numpy as np
import pytest

from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.fluids.slick import SlickCover, slick_radius, spreading_coefficient
from sim.ocean.radial.gerstner import draw_waves
from sim.ocean.radial.radial import RadialSea, phases_at
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.spectra import SPECTRA
from sim.waves import Waves


def test_fay_s_regimes_have_their_powers_and_meet_where_he_says():
    """Inertia V^(1/4) t^(1/2), viscosity V^(1/3) t^(1/4), tension t^(3/4), and their constants at the two crossings."""
    water, nu, spreading, volume = 1025.0, 1.19e-6, 0.0276, 100.0
    lift = (1.0 - 866.0 / water) * 9.81

    def radius(v, t):
        return slick_radius(v, t, 866.0, spreading=spreading)

    # Inertia ends at 2.62 (V/(lift nu))^(1/3), at a radius of 1.84 (V^5 lift/nu^2)^(1/12): 17 min, 107 m.
    first = (1.45 / 1.14) ** 4 * (volume / (lift * nu)) ** (1 / 3)
    met = 1.45**2 / 1.14 * (volume**5 * lift / nu**2) ** (1 / 12)
    # Tension takes over when 1.45 (.. t^1.5)^(1/6) = 2.30 (.. t^3)^(1/4): 65 min.
    second = (1.45 / 2.30) ** 2 * (lift * volume**2) ** (1 / 3) * (water / spreading) * nu ** (1 / 3)
    assert first == pytest.approx(17.0 * 60.0, rel=0.05)
    assert second == pytest.approx(65.0 * 60.0, rel=0.05)
    for t, size, in_time, in_volume in (
        (0.5 * first, 0.5**0.5 * met, 1 / 2, 1 / 4),
        (2.0 * first, 2.0**0.25 * met, 1 / 4, 1 / 3),
        (2.0 * second, 2.0**0.75 * (second / first) ** 0.25 * met, 3 / 4, 0.0),
    ):
        assert radius(volume, t) == pytest.approx(size, rel=1e-9)
        assert math.log(radius(volume, 1.1 * t) / radius(volume, t)) / math.log(1.1) == pytest.approx(in_time)
        assert math.log(radius(1.1 * volume, t) / radius(volume, t)) / math.log(1.1) == pytest.approx(in_volume)
    assert math.pi * radius(1.0, 1e9) ** 2 == pytest.approx(1e5)


def test_spreading_coefficients_of_the_table():
    water = fluids()["sea water"]
    assert spreading_coefficient(fluids()["Alaska North Slope 2002"], water) == pytest.approx(0.0742 - 0.0264 - 0.0202)
    assert spreading_coefficient(fluids()["Brent"], water) == 0.0  # its tension against air is not known
    sticky = fluids()["Maya"]._replace(interface_tension=0.06)
    assert spreading_coefficient(sticky, water) == 0.0


def test_paths_under_a_slick_are_those_of_small_steps_against_the_wave():
    slick = SlickCover((3.0, -2.0), 10.0, FluidColumn(thickness=0.01))
    rng = np.random.default_rng(5)
    points, angle = rng.uniform(-30.0, 30.0, (40, 2)), rng.uniform(0.0, 2.0 * math.pi, 7)
    kx, ky = 0.7 * np.cos(angle), 0.7 * np.sin(angle)
    found = slick.paths(points, kx, ky)
    back = np.arange(0.005, 100.0, 0.01)  # [m] from where a wave has come
    for i, (x, y) in enumerate(points):
        for j, a in enumerate(angle):
            inside = np.hypot(x - back * math.cos(a) - 3.0, y - back * math.sin(a) + 2.0) < 10.0
            assert found[i, j] == pytest.approx(0.01 * inside.sum(), abs=0.03)
    assert found.max() > 15.0
    assert (found == 0.0).any()


def test_a_wave_loses_its_decay_rate_over_its_group_speed():
    inside, clean = FluidColumn(oil=fluids()["IFO 180"], thickness=0.05), FluidColumn()
    k = 2.0 * math.pi / np.array([0.5, 2.0, 20.0])
    found = SlickCover((0.0, 0.0), 1.0, inside).attenuation(k, clean)
    step = 1e-5 * k
    speed = (clean.omega(k + step) - clean.omega(k - step)) / (2.0 * step)
    assert found == pytest.approx((inside.roots(k)[1] - clean.roots(k)[1]) / speed, rel=1e-6)
    assert found[0] > found[1] > found[2] > 0.0
    # A slick that damps less than what is around it gives nothing back.
    assert (SlickCover((0.0, 0.0), 1.0, clean).attenuation(k, inside) == 0.0).all()


def test_a_sea_under_a_slick_is_the_sum_of_its_calmed_waves():
    waves = draw_waves(SPECTRA["jonswap"], SPECTRA["jonswap"].conditions(wind_speed=4.0, fetch=3000.0), 25)
    values = waves.kx, waves.ky, waves.amplitude, waves.phase
    waves = Waves(*(one[::-1] for one in values))  # not in the order in which they are drawn
    sea, grid, t = RadialSea(waves, choppiness=0.0), RadialGrid(160, 128, 0.05, 200.0), 7.3
    sea.slick = SlickCover((6.0, 4.0), 25.0, FluidColumn(oil=fluids()["IFO 180"], thickness=0.03))
    found = sea.waves_at(t)
    kx, ky, amplitude, phase = found.kx, found.ky, found.amplitude, phases_at(found, t)
    assert sea.losses(np.hypot(kx, ky)).max() * 25.0 > 1.0  # the shortest wave hardly gets through

    def naive(x: float, y: float) -> float:
        share = np.exp(-sea.losses(np.hypot(kx, ky)) * sea.slick.paths(np.array([[x, y]]), kx, ky)[0])
        return float((share * amplitude * np.cos(kx * x + ky * y + phase)).sum())

    points = np.array([[6.0, 4.0], [30.0, 20.0], [-40.0, 10.0], [60.0, 30.0]])
    assert sea.at(points, t).height == pytest.approx([naive(x, y) for x, y in points], abs=1e-6)
    sea.choppiness = 0.8
    k = np.hypot(kx, ky)
    for centre in ((0.0, 0.0), (12.0, -5.0)):
        surface = sea.on(grid, t, centre)
        near = np.flatnonzero(np.hypot(grid.x, grid.y) < 2.0)[::251]  # where no wave is left out
        assert len(near) > 10
        for i in near:
            x, y = float(grid.x[i]) + centre[0], float(grid.y[i]) + centre[1]
            a = amplitude * np.exp(-sea.losses(k) * sea.slick.paths(np.array([[x, y]]), kx, ky)[0])
            turned = kx * x + ky * y + phase
            up, level = a * np.cos(turned), 0.8 * a * np.sin(turned) / k
            expected = x - (kx * level).sum(), y - (ky * level).sum(), (up + 0.4 * k * a * a).sum()
            assert surface.vertices[i] == pytest.approx(expected, abs=3e-5)
            press = 0.8 * up / k
            strain = 1.0 - (kx * kx * press).sum(), 1.0 - (ky * ky * press).sum(), (kx * ky * press).sum()
            assert surface.jacobian[i] == pytest.approx(strain[0] * strain[1] - strain[2] ** 2, abs=1e-4)
    calm = sea.on(grid, t)
    sea.slick = None
    rough = sea.on(grid, t)
    inside = np.hypot(grid.x - 6.0, grid.y - 4.0) < 15.0
    assert np.square(calm.slope[inside]).mean() < 0.8 * np.square(rough.slope[inside]).mean()
    upwave = grid.x * waves.kx.sum() + grid.y * waves.ky.sum() < -80.0 * math.hypot(waves.kx.sum(), waves.ky.sum())
    assert calm.vertices[upwave] == pytest.approx(rough.vertices[upwave], abs=1e-3)


def test_slope_and_motion_are_calmed_as_the_height_is():
    k = 2.0 * math.pi / 2.0
    sea = RadialSea(Waves(np.array([k]), np.zeros(1), np.array([0.02]), np.zeros(1)), choppiness=0.0)
    points, t = np.array([[0.0, 0.0], [0.37, 0.0], [-0.4, 0.2]]), 1.1
    rough = sea.at(points, t)
    sea.slick = SlickCover((8.0, 0.0), 10.0, FluidColumn(oil=fluids()["IFO 180"], thickness=0.05))
    calm = sea.at(points, t)
    share = np.exp(-sea.losses(np.array([k]))[0] * sea.slick.paths(points, np.array([k]), np.zeros(1))[:, 0])
    assert 0.5 < share.max() < 0.999
    for name in ("height", "acceleration", "interface"):
        assert getattr(calm, name) == pytest.approx(share * getattr(rough, name), rel=1e-9)
    for name in ("slope", "velocity"):
        assert getattr(calm, name) == pytest.approx(share[:, None] * getattr(rough, name), rel=1e-9)
