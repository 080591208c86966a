"""Theory of high crests against samples, limits, and the figures that it is built on."""

import math

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.statistics.crest_heights import (
    forristall_crest,
    high_crests,
    moments_of,
    most_probable_highest,
    narrow_band_moments,
)


def test_the_highest_crest_of_gaussian_tiles() -> None:
    """The mode of the largest of 40 seas: their mean lies above it by about Euler's constant over it, in deviations."""
    conditions = {"spectrum": "jonswap", "wind_speed": 12.0, "fetch": 40e3, "choppiness": 0.0, "low_pass": 6.0}
    seas = [Sea(128, 300.0, seed=seed, **conditions) for seed in range(40)]
    found = np.array([sea.surface(0.0).height.max() for sea in seas])
    deviation = math.sqrt(float(seas[0].energy_at(0.0).sum()))
    theory = high_crests(seas[0]).linear / deviation
    assert 3.0 < theory < 4.5
    assert found.mean() / deviation == pytest.approx(theory + 0.5772 / theory, abs=0.15)


def test_the_highest_of_n_is_exceeded_once() -> None:
    for count, power in ((50.0, 0), (50.0, 1), (1e4, 1)):
        x = most_probable_highest(count, power)
        assert count * x**power * math.exp(-0.5 * x * x) == pytest.approx(1.0, rel=1e-6)
    assert most_probable_highest(0.0, 1) == 1.0


@pytest.mark.parametrize("is_long_crested", [False, True])
def test_low_waves_have_the_crests_of_rayleigh(is_long_crested: bool) -> None:
    """P = exp(-8 (crest/Hs)^2), in the limit of no steepness on deep water."""
    crest = forristall_crest(8.0, 1e-6, 10.0, 0.04, is_long_crested=is_long_crested)
    assert crest == pytest.approx(1e-6, rel=2e-4)


def test_a_steep_sea_by_hand() -> None:
    """Hs 10 m, T1 10 s, deep: S1 = 0.06405; exceeded by one crest in 1000."""
    alpha, beta = 0.3536 + 0.2568 * 0.064048, 2.0 - 1.7912 * 0.064048
    crest = forristall_crest(math.log(1000.0), 10.0, 10.0, 0.0402, is_long_crested=False)
    assert crest == pytest.approx(10.0 * alpha * math.log(1000.0) ** (1.0 / beta), rel=1e-5)
    assert crest == pytest.approx(10.3, abs=0.1)  # 9.3 m of linear waves


def test_moments_of_bound_waves_are_those_of_samples() -> None:
    x, y = np.random.default_rng(1).normal(size=(2, 1_000_000))
    k, deviation = 0.1, 1.2
    height = deviation * x + 0.5 * k * deviation**2 * (x * x - y * y)
    away = height - height.mean()
    sampled = moments_of(height)
    assert sampled == pytest.approx(((away**3).mean() / (away**2).mean() ** 1.5, (away**4).mean() / height.var() ** 2))
    assert moments_of(np.zeros((4, 4))) == (0.0, 3.0)
    skewness, kurtosis = narrow_band_moments(k, deviation, math.inf)
    assert skewness == pytest.approx(sampled[0], abs=0.01)
    assert kurtosis == pytest.approx(sampled[1], abs=0.03)
    shallow, _ = narrow_band_moments(k, deviation, 10.0)
    assert shallow > 1.5 * skewness


def test_a_level_sea_and_one_with_long_crests() -> None:
    assert high_crests(Sea(32, 100.0, wind_speed=0.0)) == (0.0, 0.0, 0.0, 3.0)
    wave = Sea(64, 400.0, "regular", wave_height=2.0, wave_period=5.0, wind_speed=0.0)
    found = high_crests(wave)
    count = 400.0 * float(np.sqrt((wave.energy_at(0.0) * (wave.k[:, None] ** 2 + wave.k**2)).sum())) / math.sqrt(0.5)
    wanted = math.sqrt(2.0 * math.log(count / (2.0 * math.pi)))
    assert found.linear == pytest.approx(wanted * math.sqrt(0.5), rel=1e-3)
    assert found.second_order > found.linear
