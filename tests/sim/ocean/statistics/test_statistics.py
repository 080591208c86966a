"""Theory, drawn amplitudes and drawn fields agree, within the band one tile allows."""

import math

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.spectra import SPECTRA
from sim.ocean.statistics.statistics import (
    _peak_period,
    beaufort,
    drawn,
    expected,
    height_scatter,
    measured,
    open_sea_height,
    theory,
)
from tests.naive_ocean import plane_integral


def test_theory_of_pierson_moskowitz():
    found = theory(SPECTRA["pierson_moskowitz"], SPECTRA["pierson_moskowitz"].conditions(wind_direction=0.5))
    assert found.significant_height == pytest.approx(2.13298, rel=1e-4)
    assert found.peak_period == pytest.approx(2 * math.pi / 0.86050, rel=4e-3)
    assert found.direction == pytest.approx(0.5, abs=1e-3)


def test_the_tile_that_holds_the_peak_has_the_theorys_statistics():
    sea = Sea(512, 900.0, amplitudes="fixed", wind_direction=-1.0)
    k_max = math.pi * 512 / 900.0
    whole, tile = theory(sea.spectrum, sea.conditions, k_max=k_max), expected(sea)
    assert tile.significant_height == pytest.approx(whole.significant_height, rel=5e-3)
    assert tile.peak_period == pytest.approx(whole.peak_period, rel=0.05)  # bins 6 % wide; the highest wave alone
    assert tile.direction == pytest.approx(-1.0, abs=0.02)
    # The corners of the square hold a little more than the circle.
    assert whole.mean_square_slope < tile.mean_square_slope < 1.06 * whole.mean_square_slope


def test_a_drawn_field_measures_as_its_amplitudes():
    sea = Sea(256, 600.0, seed=2, amplitudes="fixed", wind_direction=2.0, precision="double")
    of_field = measured(sea.surface(5.0).height, 600.0, sea.conditions, sea.surface(4.9).height, 0.1)
    of_waves = drawn(sea)
    # No wave of this spectrum runs against another, so a snapshot has the energy of the amplitudes.
    assert of_field.significant_height == pytest.approx(of_waves.significant_height, rel=1e-9)
    assert of_field.peak_period == pytest.approx(of_waves.peak_period, rel=0.012)  # other bins, 6 % wide
    assert of_field.direction == pytest.approx(2.0, abs=2e-4)
    assert of_waves.direction == pytest.approx(2.0, abs=2e-4)
    slope = sea.surface(5.0).slope
    assert of_field.mean_square_slope == pytest.approx(float(np.square(slope).sum(-1).mean()), rel=1e-9)
    assert of_field.significant_height == pytest.approx(4 * sea.surface(5.0).height.std(), rel=1e-9)


def test_the_direction_of_two_systems_is_that_of_their_energy():
    """A swell that crosses a wind sea: short waves turn faster, and count no more for it."""
    sea = Sea(256, 1200.0, "sea_state", hs=1.5, tp=5.0, wind_direction=-1.3, second_height=2.0, second_direction=0.8)
    before, now = sea.surface(0.0).height, sea.surface(0.1).height
    found = measured(now, 1200.0, sea.conditions, before, 0.1)
    assert found.direction == pytest.approx(drawn(sea).direction, abs=0.01)


def test_one_snapshot_tells_no_direction():
    sea = Sea(32, 300.0)
    assert math.isnan(measured(sea.surface(0.0).height, 300.0, sea.conditions).direction)


@pytest.mark.parametrize(("length", "scatter"), [(250.0, 0.073), (500.0, 0.036)])
def test_scatter_of_a_tile_is_the_published_one(length, scatter):
    assert height_scatter(Sea(256, length, "pierson_moskowitz")) == pytest.approx(scatter, abs=5e-4)  # as printed


@pytest.mark.parametrize("amplitudes", ["random", "fixed"])
def test_scatter_is_what_seeds_show(amplitudes):
    options = {"spectrum": "phillips", "wind_speed": 8.0, "amplitudes": amplitudes}
    heights = [4.0 * Sea(32, 120.0, seed=seed, **options).surface(3.0).height.std() for seed in range(400)]
    predicted = height_scatter(Sea(32, 120.0, **options))
    assert np.std(heights) / np.mean(heights) == pytest.approx(predicted, rel=0.07)  # two standard errors of 400 seeds


def test_flat_sea_has_no_period_and_no_scatter():
    sea = Sea(16, 50.0, wind_speed=0.0)
    for found in (expected(sea), drawn(sea), theory(sea.spectrum, sea.conditions)):
        assert found.significant_height == found.mean_square_slope == 0.0
        assert math.isnan(found.peak_period)
        assert math.isnan(found.direction)
    assert height_scatter(sea) == 0.0


@pytest.mark.parametrize(
    ("speed", "force", "name"),
    [
        (0.0, 0, "calm"),
        (0.3, 1, "light air"),
        (10.0, 5, "fresh breeze"),
        (20.7, 8, "gale"),
        (60.0, 12, "hurricane force"),
    ],
)
def test_beaufort(speed, force, name):
    assert beaufort(speed) == (force, name)


# Each spectrum by itself, and JONSWAP's with what may come to it; all of both under -m stress.
@pytest.mark.parametrize(
    ("name", "values"),
    [
        pytest.param(name, values, marks=[] if not values or name == "jonswap" else pytest.mark.stress)
        for values in (
            {},
            {"depth": 6.0},
            {"low_pass": 3.0},
            {"second_height": 1.5},
            {"wind_speed": 0.0, "second_height": 1.5},
        )
        for name in SPECTRA
    ],
)
def test_the_height_of_an_open_sea_is_the_integral(name, values):
    c = SPECTRA[name].conditions(**values)
    expected = plane_integral(SPECTRA[name], c)
    if SPECTRA[name].line is not None:
        k = (2.0 * math.pi / 6.0) ** 2 / 9.81
        expected += 1.0 / 8.0 * math.exp(-((k * c.low_pass) ** 2))
    assert open_sea_height(SPECTRA[name], c) == pytest.approx(4.0 * math.sqrt(expected), rel=2e-3, abs=1e-12)


def test_the_peak_period_weighs_frequencies_by_the_fourth_power_of_their_energy():
    """Young 1995: omega_p = sum omega S^4 / sum S^4, which is 5/4 of S = omega exp(-omega)."""
    omega = np.linspace(0.05, 12.0, 200_001)
    found = _peak_period(omega, omega * np.exp(-omega))
    assert found == pytest.approx(2.0 * math.pi / 1.25, rel=5e-3)
    assert math.isnan(_peak_period(omega, 0.0 * omega))
