"""Waves counted in a record, beside the moments of its spectrum."""

import math

import numpy as np
import pytest

from sim.ocean import SPECTRA, Sea, zero_crossings
from sim.ocean.records.wave_gauge import WaveGauge


def gaussian_record(duration: float = 40000.0, **values) -> tuple[np.ndarray, np.ndarray]:
    """A record of the sea of `sea_state`, of waves of one frequency each, by one FFT."""
    step, n = 0.25, int(duration / 0.25)
    omega = 2.0 * math.pi * np.fft.rfftfreq(n, step)[1:]
    S = SPECTRA["sea_state"].frequency_density(omega, **values)
    random = np.random.default_rng(5)
    h = np.sqrt(S * omega[0]) * (random.normal(size=omega.size) + 1j * random.normal(size=omega.size))
    return step * np.arange(n), np.fft.irfft(np.concatenate([[0.0], h]), n) * n / 2.0


def test_waves_of_a_sine_are_those_it_has():
    t = np.arange(0.0, 300.0, 0.05)
    waves = zero_crossings(t, 3.0 + 0.8 * np.cos(2.0 * math.pi * t / 7.3))
    assert waves.mean_period == pytest.approx(7.3, rel=1e-5)
    assert waves.number == 40
    for height in (waves.significant_height, waves.mean_height, waves.largest_height):
        assert height == pytest.approx(1.6, rel=1e-3)


def test_the_highest_third_is_the_mean_of_the_highest_third():
    """Sines of one period each, of heights 1 to 9 m in disorder; the last one is not followed by a crossing."""
    sine = np.sin(2.0 * math.pi * (np.arange(40) + 0.5) / 40.0)
    eta = np.concatenate([0.5 * height * sine for height in (4, 9, 1, 6, 8, 2, 3, 7, 5, 3)])
    waves = zero_crossings(0.1 * np.arange(eta.size), eta)
    assert waves.number == 8  # from the first to the last upward crossing
    assert waves.mean_period == pytest.approx(4.0, rel=1e-2)
    assert waves.largest_height == pytest.approx(9.0, rel=0.01)
    assert waves.significant_height == pytest.approx((9.0 + 8.0 + 7.0) / 3.0, rel=0.01)
    assert waves.mean_height == pytest.approx((9 + 1 + 6 + 8 + 2 + 3 + 7 + 5) / 8.0, rel=0.01)


def test_a_gaussian_record_has_tz_and_the_height_of_theory():
    """About 6,000 waves: the mean period scatters by 0.4 %, the mean of a third of the heights by 0.9 %."""
    t, eta = gaussian_record(hs=3.0, tp=8.0, peak_enhancement=10.0)
    theory = SPECTRA["sea_state"].moments(hs=3.0, tp=8.0, peak_enhancement=10.0, cut_off=math.pi / 0.25)
    assert 4.0 * eta.std() == pytest.approx(theory.significant_height, rel=0.02)
    waves = zero_crossings(t, eta)
    assert waves.mean_period == pytest.approx(theory.zero_crossing_period, rel=0.015)
    assert 0.9 * theory.significant_height < waves.significant_height < 1.01 * theory.significant_height
    assert waves.largest_height > 1.5 * waves.significant_height


def test_a_record_without_a_whole_wave_has_none():
    for heights in ([], [1.0], [0.0, 1.0, 2.0], [1.0, 1.0, 1.0]):
        waves = zero_crossings(np.arange(len(heights)), heights)
        assert waves.number == 0
        assert math.isnan(waves.mean_period)


def test_the_gauge_counts_its_waves():
    sea, gauge = (
        Sea(64, 156.0, "regular", wave_height=1.0, wave_period=5.0, wind_speed=0.0, choppiness=0.0),
        WaveGauge(),
    )
    assert gauge.waves().number == 0
    for t in np.arange(0.0, 60.0, 0.25):
        gauge.read(sea, float(t), 1.0)
    assert gauge.waves().mean_period == pytest.approx(2.0 * math.pi / sea.waves_at().omega[0], rel=1e-3)
    assert gauge.waves().significant_height == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_the_spectrum_of_the_gauge_has_the_variance_of_its_trace(scale):
    """One wave: all of its energy a^2/2 lies within the bins of Hann's window about its frequency."""
    sea = Sea(64, 156.0, "regular", wave_height=1.0, wave_period=5.0, wind_speed=0.0, choppiness=0.0)
    gauge = WaveGauge()
    for t in np.arange(0.0, 300.0, 0.1):
        gauge.read(sea, float(t), scale)
    f, measured, theory = gauge.spectrum(sea, 300.0, scale)
    period = 2.0 * math.pi / sea.waves_at().omega[0]
    assert f[measured.argmax()] == pytest.approx(1.0 / period, abs=f[1] - f[0])
    variance = (0.5 * scale) ** 2 / 2.0
    assert measured.sum() * (f[1] - f[0]) == pytest.approx(variance, rel=0.01)
    assert theory.sum() * (f[1] - f[0]) == pytest.approx(variance, rel=1e-6)
