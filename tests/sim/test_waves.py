"""The record of waves: its sums beside one wave after another, what it refuses, and seas that are asked alike."""

import dataclasses
import math

import numpy as np
import pytest

from sim.ocean import SPECTRA, RadialSea, Sea, draw_waves
from sim.ocean.nonlinear import NonlinearSea
from sim.water import Water
from sim.waves import DEEPEST, Waves, exponential
from tests.refusals import assert_refused

ONE = np.ones(1)
POINTS = np.array([[3.0, -40.0], [81.0, 12.0], [0.0, 0.0], [-7.5, 400.0]])
T = 86_412.5  # [s]


def some_waves(n: int = 13) -> Waves:
    random = np.random.default_rng(5)
    kx, ky, amplitude = random.uniform(-0.3, 0.3, n), random.uniform(-0.3, 0.3, n), random.uniform(0.0, 1.0, n)
    return Waves(kx, ky, amplitude, random.uniform(0.0, 6.3, n), water=Water(depth=25.0, gravity=3.7))


def angles(waves: Waves) -> np.ndarray:
    """theta (points, waves) [rad] in extended precision."""
    k = [np.asarray(one, np.longdouble) for one in (waves.kx, waves.ky)]
    return POINTS[:, :1] * k[0] + POINTS[:, 1:] * k[1] - np.asarray(waves.omega, np.longdouble) * T + waves.phase


def test_the_exponential_of_a_depth_is_that_of_math():
    x = np.linspace(-DEEPEST, 0.0, 401)
    formula = getattr(exponential, "py_func", exponential)  # the formula itself, which is expanded into other kernels
    np.testing.assert_allclose(formula(x), np.exp(x), rtol=0.0, atol=1e-13)
    assert formula(0.0) == 1.0


def test_elevation_and_responses_are_sums_over_the_waves():
    waves = some_waves()
    theta = angles(waves)
    assert waves.elevation(POINTS, T) == pytest.approx((waves.amplitude * np.cos(theta)).sum(axis=1), abs=1e-10)
    X = np.random.default_rng(6).normal(size=(len(theta[0]), 6, 2)) @ [1.0, 1.0j]
    wanted = (waves.amplitude[:, None] * (X * np.exp(1j * theta.astype(float))[:, :, None]).real).sum(axis=1)
    assert waves.response(POINTS, T, X) == pytest.approx(wanted, abs=1e-9)


def test_waves_have_the_frequencies_of_gravity_waves_on_their_water_where_none_are_given():
    waves = some_waves()
    assert waves.omega == pytest.approx(np.sqrt(3.7 * waves.k * np.tanh(25.0 * waves.k)))
    deep = dataclasses.replace(waves, omega=None, water=Water())
    assert deep.omega == pytest.approx(np.sqrt(9.81 * waves.k))


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("depth", lambda: Water(depth=0.0)),
        ("depth", lambda: Water(depth=math.nan)),
        ("gravity", lambda: Water(gravity=-9.81)),
        ("density", lambda: Water(density=math.inf)),
        ("ky", lambda: Waves(ONE, np.ones(2), ONE, ONE)),
        ("amplitude", lambda: Waves(ONE, ONE, math.nan * ONE, ONE)),
        ("phase", lambda: Waves(ONE, ONE, ONE, "early")),
        ("omega", lambda: Waves(ONE, ONE, ONE, ONE, np.ones((1, 1)))),
        ("kx", lambda: Waves(1.0, 1.0, 1.0, 0.0)),
        ("kx", lambda: Waves("east", ONE, ONE, ONE)),
        ("water", lambda: Waves(ONE, ONE, ONE, ONE, water=60.0)),
        ("X", lambda: some_waves().response(POINTS, 0.0, np.zeros((13, 3)))),
    ],
)
def test_what_is_no_water_and_what_are_no_waves_is_refused(name, make):
    assert_refused(name, make)


def seas() -> list[Sea | RadialSea | NonlinearSea]:
    jonswap = SPECTRA["jonswap"]
    tile = Sea(32, 160.0, "jonswap", wind_speed=8.0, fetch=2e4, precision="double")
    radial = RadialSea(draw_waves(jonswap, jonswap.conditions(wind_speed=8.0), 16))
    return [tile, radial, NonlinearSea(start=tile, order=1)]


@pytest.mark.parametrize("sea", seas(), ids=lambda sea: type(sea).__name__)
def test_all_seas_are_asked_alike(sea):
    """`height_at`, `kinematics`, `at` and `waves_at`, with points first."""
    height, residual = sea.height_at(POINTS, 3.0)
    assert height.shape == residual.shape == (len(POINTS),)
    assert residual.max() < 1e-6
    assert sea.at(POINTS, 3.0).height == pytest.approx(height, abs=1e-12)
    below = np.column_stack([POINTS, [-1.0, -2.0, -4.0, -8.0]])
    flow, same = sea.kinematics(below, 3.0), sea.waves_at(3.0).kinematics(below, 3.0)
    assert flow.velocity == pytest.approx(same.velocity, abs=1e-9)
    assert flow.acceleration == pytest.approx(same.acceleration, abs=1e-9)
    assert sea.waves_at(3.0).water == Water()
    assert sea.waves_at(3.0).significant_height == pytest.approx(sea.significant_height, rel=1e-9)


def test_a_phase_is_in_radians():
    quarter = Waves([0.05], [0.0], [1.0], [0.5 * math.pi])
    assert quarter.elevation([[0.0, 0.0]], 0.0)[0] == pytest.approx(0.0, abs=1e-15)
    assert quarter.elevation([[1.0, 0.0]], 0.0)[0] == pytest.approx(-math.sin(0.05))
