"""The steep wave of constant form: against Stokes's series, Fenton's equations, and its own invariants."""

import math

import numpy as np
import pytest

from sim.ocean.dispersion import phase_speed
from sim.ocean.nonlinear import stokes_wave
from sim.validation import ConvergenceError

LENGTH, GRAVITY = 50.0, 9.81
K = 2.0 * math.pi / LENGTH


@pytest.mark.parametrize("steepness", [0.01, 0.05, 0.1])
def test_the_speed_on_deep_water_is_that_of_the_fifth_order_series(steepness):
    wave = stokes_wave(2.0 * steepness / K, LENGTH, order=10)
    # Fenton 1985, J. Waterway Port Coastal Ocean Eng. 111:216, Table 1 at kd = inf: e = kH/2; the next term is e^6/4
    series = 1.0 + steepness**2 / 2.0 + steepness**4 / 8.0
    assert wave.speed / phase_speed(K) == pytest.approx(series, abs=0.5 * steepness**6 + 1e-12)


@pytest.mark.parametrize("depth", [4.0, 10.0, math.inf])
def test_it_is_a_streamline_of_constant_pressure(depth):
    """Between the points where the equations are solved, too; the potential is that of this flow."""
    wave = stokes_wave(0.7, LENGTH, depth, order=20)
    x = np.linspace(0.0, LENGTH, 173)
    eta = wave.elevation(x)
    j = K * np.arange(1, 21)
    far = 0.0 if math.isinf(depth) else 1.0
    d = 0.0 if math.isinf(depth) else depth
    up = np.exp(np.outer(eta, j))
    down = far * np.exp(-np.outer(eta + 2.0 * d, j))
    scale = 1.0 + far * np.exp(-2.0 * j * d)
    u = ((up + down) / scale * np.cos(np.outer(x, j))) @ (j * wave.sines) - wave.speed
    w = ((up - down) / scale * np.sin(np.outer(x, j))) @ (j * wave.sines)
    head = 0.5 * (u * u + w * w) + GRAVITY * eta
    assert np.ptp(head) < 1e-7 * head.mean()
    step = 1e-4
    slope = (wave.elevation(x + step) - wave.elevation(x - step)) / (2.0 * step)
    assert w == pytest.approx(u * slope, abs=1e-6)
    along = (wave.potential(x + step) - wave.potential(x - step)) / (2.0 * step)
    assert along == pytest.approx(u + wave.speed + w * slope, abs=1e-6)


def test_height_mean_and_motion():
    wave = stokes_wave(4.0, LENGTH, 20.0, order=20)
    x = np.arange(64) * LENGTH / 64
    assert np.ptp(wave.elevation(x)) == pytest.approx(4.0, abs=1e-9)
    assert wave.elevation(x).mean() == pytest.approx(0.0, abs=1e-9)
    assert wave.elevation(x + 3.0 * wave.speed, 3.0) == pytest.approx(wave.elevation(x), abs=1e-9)
    assert wave.potential(x + 3.0 * wave.speed, 3.0) == pytest.approx(wave.potential(x), abs=1e-9)


def test_a_steep_wave_needs_more_terms():
    """k a = 0.4, height over length 0.127: the highest wave has 0.141."""
    speeds = [stokes_wave(0.8 / K, LENGTH, order=order).speed for order in (7, 15, 30)]
    assert speeds[1] == pytest.approx(speeds[2], rel=2e-6)
    assert speeds[0] == pytest.approx(speeds[2], rel=3e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"height": 0.0}, "height: 0.0"),
        ({"height": 7.5}, "below the highest wave, here about 7.06 m"),
        ({"height": math.nan}, "height: nan"),
        ({"wavelength": -1.0}, "wavelength: -1.0"),
        ({"depth": 0.0}, "depth: 0.0"),
        ({"order": 0}, "order: 0"),
        ({"order": 2.5}, "order: 2.5"),
        ({"gravity": 0.0}, "gravity: 0.0"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(ValueError, match=message):
        stokes_wave(**({"height": 1.0, "wavelength": LENGTH} | arguments))


def test_a_wave_that_newton_does_not_find_says_so():
    """Close below the highest wave, where few terms cannot hold the crest."""
    with pytest.raises(ConvergenceError, match=r"wave of constant form, 7 terms, k H = .*no solution after"):
        stokes_wave(0.1405 * LENGTH, LENGTH, order=7)
