"""Dispersion against the closed forms and numbers of Lamb's chapters, and against independent roots."""

import math
import subprocess
import sys

import numpy as np
import pytest

from sim.ocean.dispersion import (
    CRITICAL,
    damped_root,
    film_decay,
    group_speed,
    mode_ratios,
    omega,
    phase_speed,
    two_layer,
    viscous_root,
)
from tests.naive_ocean import two_layer_determinant, viscous_roots

INF = math.inf
WATER = {"tension": 0.0728, "density": 998.2}


def wavenumber(length: float) -> float:
    return 2.0 * math.pi / length


@pytest.mark.parametrize(
    ("length", "options", "expected"),
    [
        (100.0, {}, 0.785099),
        (1.0, {}, 7.850990),
        (100.0, {"depth": 10.0}, 0.585882),
        (0.01, WATER, 155.738),
    ],
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
    assert film_decay(wavenumber(1.0), 1e-6) == pytest.approx(6.2244e-3, rel=1e-5)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: omega(1.0, gravity=0.0), "gravity"),
        (lambda: omega(1.0, depth=-1.0), "depth"),
        (lambda: omega(1.0, depth=math.nan), "depth"),
        (lambda: omega(1.0, tension=-1.0), "tension"),
        (lambda: omega(1.0, density=INF), "density"),
        (lambda: omega([1.0, -2.0]), "k"),
        (lambda: omega(math.nan), "k"),
        (lambda: two_layer(1.0, 1025.0, 1.0, 850.0), "lower_density"),
        (lambda: two_layer(1.0, 850.0, 0.0, 1025.0), "thickness"),
        (lambda: viscous_root(1.0, -1e-6), "viscosity"),
        (lambda: viscous_root(1.0, "thick"), "viscosity"),
    ],
)
def test_bad_arguments_are_refused_by_name(call, name):
    with pytest.raises(ValueError, match=rf"^{name}: .* is not allowed; allowed: "):
        call()


def test_closed_forms_need_no_transforms():
    code = "import sys, sim.ocean.dispersion; sys.exit('pyfftw' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
