"""Foam: the measured cover, the slope of a sea, and the threshold that gives a Gaussian sea this cover."""

import math
from statistics import NormalDist

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.statistics.foam import slope_and_frequency, threshold, whitecaps


def test_the_cover_is_that_of_monahan_and_o_muircheartaigh():
    assert whitecaps(10.0) == pytest.approx(0.00987, abs=5e-6)
    assert whitecaps(20.0) / whitecaps(10.0) == pytest.approx(2.0**3.41, rel=1e-12)
    assert whitecaps(33.0) < 0.6 == whitecaps(34.0) == whitecaps(100.0)
    assert whitecaps(0.0) == 0.0


def test_the_pace_of_one_wave_is_its_steepness_and_frequency():
    sea = Sea(64, 100.0, "regular", wave_height=1.0, wave_period=4.0)
    slope, frequency = slope_and_frequency(sea, 0.0)
    k = (2.0 * math.pi / 4.0) ** 2 / 9.81
    assert slope == pytest.approx((0.5 * k) ** 2 / 2.0, rel=0.05)  # its wavelength fits the tile
    assert frequency == pytest.approx(2.0 * math.pi / 4.0, rel=0.02)
    assert slope_and_frequency(Sea(16, 50.0, wind_speed=0.0), 0.0) == (0.0, 0.0)


@pytest.mark.parametrize("cover", [0.001, 0.05, 0.5])
def test_foam_that_does_not_last_covers_the_tail_of_the_jacobian(cover):
    assert threshold(cover, 0.2, 1.5, 0.0) == pytest.approx(1.0 + 0.2 * NormalDist().inv_cdf(cover), abs=1e-9)
    assert threshold(0.0, 0.2, 1.5, 0.0) == threshold(cover, 0.0, 1.5, 0.0) == -math.inf


@pytest.mark.parametrize(("cover", "lasting"), [(0.02, 2.0), (0.02, 10.0), (0.1, 5.0)])
def test_foam_that_lasts_covers_as_much_of_a_gaussian_process_over_time(cover, lasting):
    """4000 records of 120 s: the point is foam while J is below the threshold, and for `lasting` after."""
    rng, step, count = np.random.default_rng(3), 0.05, 2400
    omega = np.sqrt(rng.uniform(0.04, 16.0, (60, 1)))  # [rad/s] a broad band: passages come at random
    frequency = math.sqrt(float(np.mean(omega**2)))
    level = threshold(cover, 0.2, frequency, lasting)
    t, foamy = step * np.arange(count), 0.0
    for _ in range(40):
        amplitude, phase = rng.rayleigh(1.0, (100, 60)), rng.uniform(0.0, 2.0 * math.pi, (100, 60))
        waves = (amplitude * np.exp(1j * phase)) @ np.exp(1j * omega * t)
        below = 1.0 + 0.2 * waves.real / math.sqrt(60.0) < level
        last = np.maximum.accumulate(np.where(below, t, -math.inf), axis=1)
        foamy += float((t - last <= lasting)[:, t > lasting].mean()) / 40.0
    assert foamy == pytest.approx(cover, rel=0.1)
