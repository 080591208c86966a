"""Expected largest values: against drawn records and the closed forms of a Rayleigh distribution."""

import math

import numpy as np
import pytest

from sim.numerics.extreme_values import LEAST_PEAKS, Peaks, expected_largest, weibull_of


@pytest.mark.parametrize("shape", [0.8, 1.0, 2.0, 3.5])
def test_the_fit_finds_the_distribution_that_was_drawn(shape):
    heights = 3.0 * np.random.default_rng(1).weibull(shape, 100_000)
    assert weibull_of(heights) == pytest.approx((3.0, shape), rel=0.01)


@pytest.mark.parametrize("shape", [1.0, 2.0])
@pytest.mark.parametrize("count", [100, 1000])
def test_the_expected_largest_is_the_mean_of_many_records(shape, count):
    rng = np.random.default_rng(2)
    mean = rng.weibull(shape, (4000, count)).max(axis=1).mean()
    assert expected_largest(rng.weibull(shape, 100_000), count) == pytest.approx(mean, rel=0.01)
    few = rng.weibull(shape, (200, count))
    found = np.array([expected_largest(one, count) for one in few])
    assert found.mean() == pytest.approx(mean, rel=0.02)


def narrow(duration: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a Gaussian process of a narrow band about 0.1 Hz: standard deviation 2, mean 7."""
    rng = np.random.default_rng(seed)
    t, omega = np.arange(0.0, duration, 0.25), 2.0 * math.pi * rng.normal(0.1, 0.008, 400)
    phase = rng.uniform(0.0, 2.0 * math.pi, 400)
    total = np.zeros_like(t)
    for w, p in zip(omega, phase, strict=True):
        total += np.cos(w * t + p)
    return t, 7.0 + 2.0 * total / math.sqrt(200.0)


def test_twenty_minutes_of_a_narrow_band_give_the_largest_of_three_hours():
    """Rayleigh: mean + sd sqrt(2 ln N) (1 + gamma/(2 ln N)) with N = 1080 waves."""
    found = []
    for seed in range(8):
        t, values = narrow(3600.0, seed)
        record = Peaks(2)
        for value in values:
            record.add(np.array([value, -value]), 0.25)
        assert record.count == pytest.approx([0.1 * t[-1]] * 2, rel=0.06)
        up, down = record.expected_largest(10800.0)
        found += [up - 7.0, down + 7.0]
    many = math.log(1080.0)
    exact = 2.0 * math.sqrt(2.0 * many) * (1.0 + 0.5772 / (2.0 * many))
    assert np.mean(found) == pytest.approx(exact, rel=0.05)
    assert np.std(found) < 0.15 * exact


def test_few_peaks_give_no_number():
    record = Peaks(1)
    assert math.isnan(record.expected_largest(10800.0)[0])
    for i in range(40 * (LEAST_PEAKS - 1)):
        record.add(np.array([math.sin(2.0 * math.pi * i / 40.0 - 1e-3)]), 0.1)
    assert record.count[0] == LEAST_PEAKS - 2  # the first upcrossing begins the first, and the last one is not over
    assert math.isnan(record.expected_largest(10800.0)[0])


def test_a_regular_signal_has_its_own_height_as_the_largest():
    record = Peaks(1)
    for i in range(40 * 50):
        record.add(np.array([4.0 + math.sin(2.0 * math.pi * i / 40.0 - 1e-3)]), 0.1)
    assert record.expected_largest(10800.0)[0] == pytest.approx(5.0, abs=0.05)
