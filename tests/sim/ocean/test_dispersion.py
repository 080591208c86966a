"""Dispersion against the closed forms and numbers of Lamb's chapters, and against independent roots."""

import math

import numpy as np
import pytest

from sim.ocean.dispersion import (
    CRITICAL,
    CRITICAL_FILM,
    damped_root,
    group_speed,
    mode_ratios,
    omega,
    phase_speed,
    two_layer,
    viscous_root,
    viscous_two_layer,
)
from sim.ocean.dispersion import wavenumber as wavenumber_at
from sim.ocean.fluids.fluids import fluids
from sim.ocean.spectra import SPECTRA
from sim.water import Water
from tests.naive_ocean import film_roots, layer_roots, two_layer_determinant, viscous_roots
from tests.refusals import assert_refused

INF = math.inf
WATER = {"tension": 0.0728, "density": 998.2}


def wavenumber(length: float) -> float:
    return 2.0 * math.pi / length


@pytest.mark.parametrize(
    ("length", "options", "expected"),
    [(100.0, {}, 0.785099), (1.0, {}, 7.850990), (100.0, {"depth": 10.0}, 0.585882), (0.01, WATER, 155.738)],
)
def test_omega_is_lambs(length, options, expected):
    assert omega(wavenumber(length), **options) == pytest.approx(
        expected, rel=1e-6, abs=5e-4 if expected > 100.0 else 0.0
    )


def test_speeds_are_those_of_the_table():
    assert 2 * math.pi / omega(wavenumber(100.0)) == pytest.approx(8.0030, abs=5e-5)
    assert phase_speed(wavenumber(100.0)) == pytest.approx(12.4952, abs=5e-5)
    assert phase_speed(wavenumber(100.0), depth=10.0) == pytest.approx(9.3246, abs=5e-5)


def test_slowest_capillary_waves():
    k = np.linspace(50.0, 800.0, 200001)
    c, cg = phase_speed(k, **WATER), group_speed(k, **WATER)
    assert c.min() == pytest.approx((4 * 9.81 * 0.0728 / 998.2) ** 0.25, rel=1e-9)
    assert c.min() == pytest.approx(0.23129, abs=5e-6)
    assert 2 * math.pi / k[c.argmin()] == pytest.approx(17.13e-3, abs=5e-6)
    assert cg.min() == pytest.approx(0.1777, abs=5e-5)
    assert 2 * math.pi / k[cg.argmin()] == pytest.approx(43.6e-3, abs=5e-5)


@pytest.mark.parametrize("options", [{}, {"depth": 3.0}, WATER, {"depth": 0.02, **WATER}])
def test_group_speed_is_the_derivative(options):
    k = np.geomspace(0.01, 500.0, 50)
    step = 1e-5 * k
    slope = (omega(k + step, **options) - omega(k - step, **options)) / (2 * step)
    assert group_speed(k, **options) == pytest.approx(slope, rel=1e-8)


def test_limits_neither_overflow_nor_divide():
    assert omega(0.0) == 0.0
    assert omega(1e6, depth=1e6) == omega(1e6)
    for speed in (phase_speed, group_speed):
        assert speed(0.0, depth=10.0) == pytest.approx(math.sqrt(98.1), rel=1e-12)
    assert np.isfinite(two_layer(np.array([0.0, 1e5]), 850.0, 1e3, 1025.0)).all()
    assert np.isfinite(two_layer(1.0, 850.0, INF, 1025.0)).all()
    assert mode_ratios([0.0, 1.0], 850.0, INF, 1025.0).surface == pytest.approx([0.0, 0.0])
    assert viscous_root(0.0, 1e-3) == (0.0, 0.0)
    assert viscous_root(2.0, 0.0) == (omega(2.0), 0.0)


LAYERS = [
    ((10.0, 850.0, 1.0, 1025.0, 9.81, INF), 2.482701, 0.633172),
    ((10.0, 850.0, 0.01, 1025.0, 9.81, INF), 2.482701, 0.081104),
    ((10.0, 850.0, 1.0, 1025.0, 9.81, 5.0), 2.481199, 0.632746),
    ((100.0, 850.0, 2.0, 1025.0, 9.81, 20.0), 0.735296, 0.108246),
    ((1.0, 920.0, 0.05, 1025.0, 9.81, INF, 0.030, 0.025), 7.851692, 1.228918),
    ((10.0, 850.0, INF, 1025.0, 9.81, INF), 2.482701, 0.758478),
]


@pytest.mark.parametrize(("arguments", "surface", "interface"), LAYERS)
def test_two_layers_have_the_tables_modes(arguments, surface, interface):
    found = two_layer(wavenumber(arguments[0]), *arguments[1:])
    assert found == pytest.approx((surface, interface), abs=1e-6)


def test_modes_make_the_determinant_vanish():
    rng = np.random.default_rng(1)
    for _ in range(50):
        k, d, h2 = rng.uniform(0.05, 2.0), rng.uniform(0.05, 3.0), rng.uniform(0.5, 20.0)
        rho1, rho2 = rng.uniform(700.0, 950.0), rng.uniform(960.0, 1100.0)
        for w in two_layer(k, rho1, d, rho2, depth=h2):
            assert abs(two_layer_determinant(w, k, rho1, d, rho2, 9.81, h2)) < 1e-11


def test_deep_surface_mode_ignores_the_layer():
    k = np.geomspace(0.01, 30.0, 40)
    assert two_layer(k, 850.0, 0.3, 1025.0)[0] == pytest.approx(omega(k), rel=1e-13)
    expected = np.sqrt(9.81 * k * 175.0 / (1025.0 / np.tanh(0.3 * k) + 850.0))
    assert two_layer(k, 850.0, 0.3, 1025.0)[1] == pytest.approx(expected, rel=1e-12)


def test_equal_fluids_are_one():
    surface, interface = two_layer(0.5, 900.0, 2.0, 900.0, depth=3.0)
    assert surface == pytest.approx(omega(0.5, depth=5.0), rel=1e-14)
    assert interface == 0.0


def test_mode_ratios_are_exponential_on_deep_water():
    ratios = mode_ratios(wavenumber(10.0), 850.0, 1.0, 1025.0)
    kd = wavenumber(10.0)
    assert ratios.surface == pytest.approx(math.exp(-kd), rel=1e-12)
    assert ratios.interface == pytest.approx(-(1025 / 850 - 1) * math.exp(-kd), rel=1e-12)
    assert ratios == pytest.approx((0.5335, -0.1098), abs=5e-5)


def test_long_interfacial_wave_speed():
    k = 1e-5  # c_i = sqrt(g d (rho2 - rho1)/rho2)
    assert two_layer(k, 850.0, 1.0, 1025.0)[1] / k == pytest.approx(math.sqrt(9.81 * 175 / 1025), rel=1e-4)
    k = wavenumber(10.0)
    assert two_layer(k, 850.0, 1.0, 1025.0)[1] / k == pytest.approx(1.0077, abs=5e-5)


@pytest.mark.parametrize(
    ("length", "viscosity", "decay", "shift"),
    [
        (1.0, 1e-6, 7.8832e-5, -1.6e-8),
        (1.0, 1e-3, 0.074988, -0.00050),
        (1.0, 1e-2, 0.66119, -0.0155),
        (0.1, 1e-3, 5.4924, -0.082),
    ],
)
def test_viscous_roots_of_the_table(length, viscosity, decay, shift):
    k = wavenumber(length)
    w, rate = viscous_root(k, viscosity)
    assert rate == pytest.approx(decay, rel=1e-5)
    assert w / omega(k) - 1.0 == pytest.approx(shift, abs=5e-2 * abs(shift))


@pytest.mark.parametrize("theta", [1e-4, 0.01, 0.1, 0.5, 1.0, 1.3, 1.311, 1.312, 1.5, 3.0, 30.0])
def test_viscous_root_is_the_slowest_root_of_the_quartic(theta):
    w, rate = damped_root(1.0, theta)
    roots = viscous_roots(theta)
    s = roots[np.argmax(roots.real)]
    assert float(rate) == pytest.approx(-s.real, rel=1e-7)
    assert float(w) == pytest.approx(abs(s.imag), abs=1e-7)
    assert (float(w) == 0.0) == (theta > CRITICAL)


def test_viscous_limits_keep_their_digits():
    thin = np.array([1e-14, 1e-11, 1e-8])
    assert damped_root(np.ones(3), thin)[1] == pytest.approx(2 * thin - math.sqrt(2) * thin**1.5, rel=1e-9)
    thick = np.array([1e4, 1e7])
    assert damped_root(np.ones(2), thick)[1] == pytest.approx(0.5 / thick, rel=1e-7)


def test_film_damps_as_lamb_says():
    k = wavenumber(1.0)
    assert k * math.sqrt(1e-6 * omega(k) / 8.0) == pytest.approx(6.2244e-3, rel=1e-5)  # Art. 351
    assert viscous_root(k, 1e-6, film=True)[1] == pytest.approx(6.2244e-3, rel=2e-3)
    assert viscous_root(k, 1e-12, film=True)[1] == pytest.approx(6.2244e-6, rel=1e-5)


@pytest.mark.parametrize("theta", [1e-8, 1e-4, 0.01, 0.5, 1.27, 1.2704, 3.0, 30.0])
def test_film_root_is_the_slowest_root_of_its_quartic(theta):
    w, rate = damped_root(1.0, theta, film=True)
    roots = film_roots(theta)
    s = roots[np.argmax(roots.real)]
    assert float(rate) == pytest.approx(-s.real, rel=1e-6)
    assert float(w) == pytest.approx(abs(s.imag), abs=1e-7)
    assert (float(w) == 0.0) == (theta > CRITICAL_FILM)


OILS = ("diesel 2002", "Alaska North Slope 2002", "Maya", "IFO 120", "IFO 180", "Bunker C Zalinski")
THICKNESSES = (1e-3, 0.01, 0.1, 1.0)  # [m]
LENGTHS = (0.3, 1.0, 3.0, 10.0, 30.0, 60.0)  # [m]


def test_waves_on_a_layer_are_the_root_of_the_six_conditions():
    water, k = fluids()["sea water"], 2.0 * math.pi / np.array(LENGTHS)
    oils = [fluids()[name] for name in OILS]
    found = [
        viscous_two_layer(
            k, oil.density, oil.viscosity, d, water.density, water.viscosity, 9.81,
            oil.surface_tension or 0.0, oil.interface_tension or 0.0,
        )
        for oil in oils
        for d in THICKNESSES
    ]  # fmt: skip
    w, rate = (np.concatenate(part) for part in zip(*found, strict=True))
    each = len(THICKNESSES) * len(LENGTHS)

    def of_oils(name):
        return np.repeat([getattr(oil, name) or 0.0 for oil in oils], each)

    s = layer_roots(
        np.tile(k, len(w) // len(k)), np.tile(np.repeat(THICKNESSES, len(k)), len(oils)),
        (of_oils("density"), water.density), (of_oils("viscosity"), water.viscosity), 9.81,
        (of_oils("surface_tension"), of_oils("interface_tension")), steps=30,
    )  # fmt: skip
    np.testing.assert_allclose(w, s.imag.astype(float), rtol=1e-9)
    np.testing.assert_allclose(rate, -s.real.astype(float), rtol=1e-9)


def test_a_layer_of_the_same_fluid_is_one_fluid():
    k = np.geomspace(0.05, 300.0, 40)
    for viscosity, film in ((1e-6, False), (2e-2, False), (1e-6, True), (2e-2, True)):
        natural = omega(k, tension=0.05, density=1000.0)
        w, rate = viscous_two_layer(
            k, 1000.0, 1e3 * viscosity, 0.1, 1000.0, 1e3 * viscosity, surface_tension=0.05, film=film
        )
        expected = damped_root(natural, viscosity * k**2, film)
        np.testing.assert_allclose(w, expected[0], rtol=1e-6)
        np.testing.assert_allclose(rate, expected[1], rtol=1e-6)


def test_thin_and_thick_layers_have_their_limits():
    k, water, oil = wavenumber(30.0), fluids()["sea water"], fluids()["IFO 180"]
    arguments = (water.density, water.viscosity)
    thin = viscous_two_layer(k, oil.density, oil.viscosity, 1e-3, *arguments)[1]
    # 2 nu k^2 below, and the extension of the layer: 4 mu d k^3 (k/omega)^2 g/rho/2 = 2 mu d k^3/rho
    bare = 2.0 * k**2 * water.kinematic_viscosity + 2.0 * oil.viscosity * 1e-3 * k**3 / water.density
    assert thin == pytest.approx(bare, rel=0.05)
    thick = viscous_two_layer(k, oil.density, oil.viscosity, 1e3, *arguments)[1]
    assert thick == pytest.approx(viscous_root(k, oil.kinematic_viscosity)[1], rel=1e-9)
    assert viscous_two_layer(0.0, oil.density, oil.viscosity, 1.0, *arguments) == (0.0, 0.0)


@pytest.mark.parametrize("depth", [math.inf, 1e-3, 0.3, 20.0, 1e4])
@pytest.mark.parametrize("tension", [0.0, 1e-6, 0.073, 50.0])
def test_the_wavenumber_of_a_frequency_is_the_one_that_has_it(depth, tension):
    """Over 14 decades: from shallow water over deep water to ripples."""
    k = np.geomspace(1e-8, 1e6, 999)
    assert wavenumber_at(omega(k, 9.81, depth, tension), 9.81, depth, tension) == pytest.approx(k, rel=2e-15)


def test_a_wavenumber_has_the_shape_of_its_frequency_and_stays_0_for_still_water():
    assert wavenumber_at(0.0, depth=5.0) == 0.0
    assert wavenumber_at([[0.0, 1.0]], depth=5.0).shape == (1, 2)
    assert isinstance(float(wavenumber_at(2.0)), float)
    assert wavenumber_at(2.0) == pytest.approx(4.0 / 9.81, rel=1e-15)
    for bad in (-1.0, math.nan, math.inf, "1"):
        assert_refused("omega", lambda bad=bad: wavenumber_at(bad))


def test_water_and_conditions_have_the_same_dispersion():
    water, conditions = Water(depth=7.0), SPECTRA["jonswap"].conditions(depth=7.0)
    k = np.geomspace(1e-3, 10.0, 50)
    for found in (water.omega(k), conditions.omega(k)):
        assert np.array_equal(found, omega(k, depth=7.0))
    for found in (water.group_speed(k), conditions.group_speed(k)):
        assert np.array_equal(found, group_speed(k, depth=7.0))
    for found in (water.wavenumber(water.omega(k)), conditions.wavenumber(water.omega(k))):
        assert found == pytest.approx(k, rel=2e-15)
