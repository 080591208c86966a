"""The water below waves: against the sum of potentials one by one, and by the laws that it must obey."""

import dataclasses
import math
import warnings

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.radial.gerstner import draw_waves
from sim.ocean.radial.radial import RadialSea
from sim.ocean.spectra import SPECTRA
from sim.water import Water
from sim.waves import Waves
from tests.naive_ocean import flow_of_waves, sum_of_waves

DEPTHS = (math.inf, 80.0, 6.0)  # [m]
T = 37.3  # [s]
STEP = 1e-3  # [m], [s] of the differences, of fourth order


def sea_of(depth: float, **more) -> Sea:
    return Sea(32, 200.0, "tma", wind_speed=9.0, depth=depth, precision="double", **more)


def points_below(n: int = 40, depth: float = 60.0, seed: int = 3) -> np.ndarray:
    random = np.random.default_rng(seed)
    return np.column_stack([random.uniform(-500.0, 500.0, (n, 2)), -random.uniform(0.01, min(depth, 60.0) - 0.01, n)])


def derivative(function, step: float = STEP) -> np.ndarray:
    """Of a function of one number, at 0, of fourth order."""
    return (8.0 * (function(step) - function(-step)) - function(2.0 * step) + function(-2.0 * step)) / (12.0 * step)


@pytest.mark.parametrize("depth", DEPTHS)
def test_the_flow_is_the_sum_of_potentials(depth):
    waves, points = sea_of(depth).waves_at(), points_below(depth=depth)
    for found, wanted in zip(waves.kinematics(points, T), flow_of_waves(waves, points, T), strict=True):
        assert found == pytest.approx(wanted, abs=1e-11 * np.abs(wanted).max())


@pytest.mark.parametrize("depth", DEPTHS)
def test_water_keeps_its_volume_does_not_rotate_and_obeys_bernoulli(depth):
    sea, points = sea_of(depth), points_below(depth=depth)
    flow, axes = sea.kinematics(points, T), np.eye(3)
    gradient = np.stack([derivative(lambda d, e=e: sea.kinematics(points + d * e, T).velocity) for e in axes])
    size = np.abs(gradient).max()
    assert np.abs(gradient[0, :, 0] + gradient[1, :, 1] + gradient[2, :, 2]).max() < 1e-6 * size
    curl = np.stack([gradient[i, :, j] - gradient[j, :, i] for i, j in ((0, 1), (1, 2), (2, 0))])
    assert np.abs(curl).max() < 1e-6 * size
    # rho du/dt = -grad p: Bernoulli's equation without the square of the velocity
    force = np.stack([derivative(lambda d, e=e: sea.kinematics(points + d * e, T).pressure) for e in axes], axis=1)
    largest = np.abs(flow.acceleration).max()
    assert -force / sea.conditions.density == pytest.approx(flow.acceleration, abs=1e-6 * largest)
    rate = derivative(lambda d: sea.kinematics(points, T + d).velocity)
    assert rate == pytest.approx(flow.acceleration, abs=1e-6 * largest)


@pytest.mark.parametrize("depth", DEPTHS)
def test_at_z_0_the_flow_is_that_of_the_surface(depth):
    """The pressure is the weight of the elevation, and the water rises with it."""
    sea = sea_of(depth, choppiness=0.0)
    x, y = np.random.default_rng(1).uniform(0.0, 200.0, (2, 20))
    flow = sea.kinematics(np.column_stack([x, y, np.zeros(20)]), T)
    height = sum_of_waves(sea, T, x, y)["height"]
    weight = sea.conditions.density * sea.conditions.gravity
    assert flow.pressure == pytest.approx(weight * height, abs=1e-6 * weight * np.abs(height).max())
    rise = derivative(lambda d: sum_of_waves(sea, T + d, x, y)["height"])
    assert flow.velocity[:, 2] == pytest.approx(rise, abs=1e-6 * np.abs(rise).max())


def test_one_wave_has_its_closed_form():
    """H = 2 m on deep water: circles of radius 1 m e^(kz)."""
    sea = Sea(64, 400.0, "regular", wave_height=2.0, wave_period=8.0, wind_speed=0.0)
    (kx,), (omega,) = sea.waves_at().kx, sea.waves_at().omega
    flow = sea.kinematics([[10.0, 0.0, 0.0], [10.0, 0.0, -20.0], [10.0, 0.0, -1e4]], 5.0)
    speed, gain = np.linalg.norm(flow.velocity, axis=1), np.linalg.norm(flow.acceleration, axis=1)
    assert speed[:2] == pytest.approx(omega * np.exp(kx * np.array([0.0, -20.0])), rel=1e-12)
    assert gain == pytest.approx(omega * speed, rel=1e-12)
    assert omega**2 == pytest.approx(9.81 * kx)
    assert speed[2] < 1e-15


def test_at_the_bottom_and_below_it_water_moves_along_the_bottom():
    flow = sea_of(6.0).kinematics([[3.0, 4.0, -6.0], [3.0, 4.0, -7.0]], T)
    assert np.abs(flow.velocity[:, 2]).max() < 1e-12
    assert np.abs(flow.velocity[0, :2]).max() > 0.01
    assert (flow.velocity[0] == flow.velocity[1]).all()


@pytest.mark.parametrize("depth", [math.inf, 20.0])
def test_stretching_gives_the_surface_what_linear_theory_has_at_z_0(depth):
    sea = sea_of(depth, choppiness=0.0)
    x, y = np.random.default_rng(2).uniform(0.0, 200.0, (2, 30))
    eta = sum_of_waves(sea, T, x, y)["height"]
    still = sea.kinematics(np.column_stack([x, y, 0.0 * x]), T)
    for found, wanted in zip(sea.kinematics(np.column_stack([x, y, eta]), T, "wheeler"), still, strict=True):
        assert found == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    above = sea.kinematics(np.column_stack([x, y, 0.0 * x + 2.0]), T, stretching="constant")
    assert (above.velocity == still.velocity).all()
    bottom = np.column_stack([x, y, 0.0 * x - min(depth, 1e3)])
    for found, wanted in zip(sea.kinematics(bottom, T, "wheeler"), sea.kinematics(bottom, T), strict=True):
        assert found == pytest.approx(wanted, abs=1e-9)
    middle = np.column_stack([x, y, eta - 5.0]) if math.isinf(depth) else np.column_stack([x, y, (eta - 20.0) / 2.0])
    level = -5.0 if math.isinf(depth) else -10.0
    wanted = sea.kinematics(np.column_stack([x, y, 0.0 * x + level]), T)
    assert sea.kinematics(middle, T, "wheeler").velocity == pytest.approx(wanted.velocity, abs=1e-9)


def test_the_largest_waves_state_what_they_leave_out():
    waves = sea_of(80.0).waves_at()
    few = waves.largest(100)
    assert len(few.kx) == 100
    total = 0.5 * np.square(waves.amplitude).sum()
    assert few.elevation_error**2 + 0.5 * np.square(few.amplitude).sum() == pytest.approx(total, rel=1e-12)
    again, once = few.largest(40), waves.largest(40)
    assert again.elevation_error == pytest.approx(once.elevation_error, rel=1e-12)
    assert again.velocity_error == pytest.approx(once.velocity_error, rel=1e-12)
    points = points_below(4000)
    points[:, 2] = 0.0
    missed = waves.kinematics(points, T).velocity[:, 2] - few.kinematics(points, T).velocity[:, 2]
    assert missed.std() == pytest.approx(few.velocity_error, rel=0.05)
    assert waves.largest(10**6).elevation_error == 0.0


def test_a_sum_of_waves_has_the_flow_of_its_surface():
    """Without choppiness its surface is the elevation; at z = 0 its water rises as the surface does."""
    c = SPECTRA["jonswap"].conditions(wind_speed=8.0)
    sea = RadialSea(draw_waves(SPECTRA["jonswap"], c, 30), choppiness=0.0)
    sea.change(10.0, column=FluidColumn(fraction=0.1))
    points = points_below(10)
    points[:, 2] = 0.0
    flow, above = sea.kinematics(points, T), sea.at(points[:, :2], T)
    assert flow.velocity[:, 2] == pytest.approx(above.velocity[:, 2], abs=1e-6)
    assert flow.acceleration[:, 2] == pytest.approx(above.acceleration, abs=1e-6)
    sea.change(20.0, column=FluidColumn(thickness=0.2))
    with pytest.raises(ValueError, match="column: 'layer'"):
        sea.kinematics(points, T)


def test_waves_drawn_from_a_spectrum_have_its_height_at_any_depth():
    c = SPECTRA["tma"].conditions(wind_speed=12.0, depth=10.0)
    waves = draw_waves(SPECTRA["tma"], c, 50)
    assert waves.significant_height == pytest.approx(4.0 * math.sqrt(SPECTRA["tma"].moments(c).m0), rel=0.01)
    assert np.abs(waves.kinematics([[1.0, 2.0, -10.0]], T).velocity[0, 2]) < 1e-12


def test_a_change_of_the_wind_leaves_the_flow_continuous():
    sea, points = sea_of(80.0), points_below(10)
    before = sea.kinematics(points, 30.0).velocity
    sea.change(30.0, relax=5.0, wind_speed=15.0)
    assert sea.kinematics(points, 30.0).velocity == pytest.approx(before, abs=1e-9)
    for found, wanted in zip(
        sea.kinematics(points, 60.0), flow_of_waves(sea.waves_at(60.0), points, 60.0), strict=True
    ):
        assert found == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert 2.0 * math.sqrt(2.0) * np.linalg.norm(sea.waves_at(60.0).amplitude) == pytest.approx(
        sea.significant_height_at(60.0)
    )


def test_a_wave_without_a_wavenumber_moves_no_water():
    two = np.array([0.0, 0.1])
    waves = Waves(two, 0.0 * two, np.array([0.5, 1.0]), 0.0 * two, np.array([0.3, 0.99]), Water(50.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        both = waves.kinematics([[3.0, 2.0, -4.0]], 1.0)
    names = ("kx", "ky", "amplitude", "omega", "phase")
    alone = dataclasses.replace(waves, **{name: getattr(waves, name)[1:] for name in names})
    for found, known in zip(both, alone.kinematics([[3.0, 2.0, -4.0]], 1.0), strict=True):
        assert found == pytest.approx(known, rel=1e-12)


@pytest.mark.parametrize(("kh", "within"), [(1e-3, 1e-9), (1e-6, 2e-7), (1e-9, 1e-4)])
def test_water_in_the_shallows_moves_as_long_waves_do(kh, within):
    """u = a w/(k h), and w = a w (1 + z/h) sin."""
    depth, one = 10.0, np.ones(1)
    k, w = kh / depth, 0.01
    waves = Waves(k * one, 0.0 * one, one, 0.5 * math.pi * one, w * one, Water(depth))
    flow = waves.kinematics([[0.0, 0.0, -5.0]], 0.0)
    assert flow.velocity[0, 2] == pytest.approx(w * 0.5, rel=max(within, kh**2))
    level = dataclasses.replace(waves, phase=0.0 * one).kinematics([[0.0, 0.0, -5.0]], 0.0).velocity[0, 0]
    assert level == pytest.approx(w / kh, rel=max(1e-9, kh**2))
