"""Growth of side bands on a steep wave, and of a breather: the instability that makes rogue waves."""

import math

import numpy as np
import pytest

from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from tests.naive_waves import side_band_growth

GRAVITY = 9.81
LENGTH = 50.0  # [m]
K = 2.0 * math.pi / LENGTH
FREQUENCY = math.sqrt(GRAVITY * K)


def dysthe_growth(steepness: float, p: float) -> float:
    """Growth over omega of the side bands k (1 +- p) on deep water by the fourth-order equation of Dysthe (1979,
    Proc. R. Soc. Lond. A 369:105), as two terms of a series in p."""
    return p / 8.0 * math.sqrt(8.0 * steepness**2 * (1.0 - p) - p * p)


@pytest.mark.parametrize(("steepness", "count"), [(0.1, 5), (0.1, 6), (0.1, 8), (0.05, 8), (0.05, 12)])
def test_the_exact_growth_agrees_with_dysthe_in_its_range(steepness, count):
    """The reference itself: Euler's equations linearised about the exact wave."""
    wave = stokes_wave(2.0 * steepness / K, LENGTH, order=12)
    growth, _, _ = side_band_growth(wave, 1.0 / count)
    assert growth / FREQUENCY == pytest.approx(dysthe_growth(steepness, 1.0 / count), rel=0.02)


@pytest.mark.parametrize(
    ("kh", "count", "order", "bound"),
    [
        (math.inf, 5, 3, 0.01), (math.inf, 6, 5, 1e-3), (3.0, 8, 3, 0.015), (2.0, 12, 3, 0.02),
        *(pytest.param(*case, 5, 1e-3, marks=pytest.mark.long) for case in ((math.inf, 8), (2.0, 12))),
    ],
)  # fmt: skip
def test_side_bands_grow_as_in_the_exact_equations(kh, count, order, bound):
    """k a = 0.1: the fastest disturbance of `count` waves in a row, small and pure, over 10 periods."""
    wave = stokes_wave(0.2 / K, LENGTH, kh / K, order=12)
    p, size = 1.0 / count, 16 * count
    growth, elevation, potential = side_band_growth(wave, p)
    x = np.arange(size) * LENGTH / 16
    waves = np.exp(1j * K * np.outer(x, np.arange(-10, 11) + p))
    small = 1e-4 * wave.height / np.abs(waves @ elevation).max()
    start = (wave.elevation(x) + small * (waves @ elevation).real, wave.potential(x) + small * (waves @ potential).real)
    period = LENGTH / wave.speed
    sea = NonlinearSea(length=LENGTH * count, order=order, depth=kh / K, start=start, breaking=False, step=period / 40)
    bands = []
    for t in (0.0, 10.0 * period):
        sea.advance(t)
        bands.append(np.abs(np.fft.rfft(sea.height[:, 0]))[[count - 1, count + 1]])
    found = np.log(bands[1] / bands[0]) / (10.0 * period)
    # Measured: 0.7 % above at order 3 (1.3 % at kh = 2), 0.01 % below at order 5 (0.02 %).
    assert found == pytest.approx(growth, rel=bound)


def breather(steepness: float, waves: int, rtol: float) -> float:
    """Largest envelope over the carrier of Peregrine's breather, which starts 1.5 of its times before its peak.

    Peregrine 1983 (J. Austral. Math. Soc. B 25:16) as in Chabchoub, Hoffmann and Akhmediev 2011 (Phys. Rev. Lett.
    106:204502), as free waves; bound waves come with the fade-in. The envelope is of waves from k/2 to 3 k/2.
    """
    size, a, rate = 8 * waves, steepness / K, steepness**2 * FREQUENCY
    x = (np.arange(size) - size // 2) * LENGTH / 8
    time = -1.5
    shape = 1.0 - 4.0 * (1.0 - 1j * time) / (1.0 + (2.0 * math.sqrt(2.0) * steepness * K * x) ** 2 + time**2)
    free = np.fft.fft(a * np.exp(1j * (K * x - 0.5 * time)) * shape)
    k = 2.0 * math.pi * np.fft.fftfreq(size, LENGTH / 8)
    onward = k > 0.0
    potential = np.where(onward, -1j * np.sqrt(GRAVITY / np.where(onward, k, 1.0)), 0.0) * free
    start = np.fft.ifft(np.where(onward, free, 0.0)).real, np.fft.ifft(potential).real
    fade = 10.0 * 2.0 * math.pi / FREQUENCY
    sea = NonlinearSea(length=LENGTH * waves, start=start, fade=fade, rtol=rtol, breaking=False)
    largest = 0.0
    for t in np.linspace(1.0, 2.0, 41) * 1.5 / rate:
        sea.advance(t)
        envelope = 2.0 * np.fft.ifft(np.where((k > 0.5 * K) & (k < 1.5 * K), np.fft.fft(sea.height[:, 0]), 0.0))
        largest = max(largest, float(np.abs(envelope).max()))
    return largest / a


@pytest.mark.long  # a long run; smaller disturbances of the exact equations come before it
def test_the_breather_grows_threefold():
    assert breather(0.03, 40, 1e-6) == pytest.approx(3.0, rel=0.05)  # measured: 2.89


@pytest.mark.stress
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(("steepness", "waves"), [(0.01, 120), (0.02, 60)])
def test_lower_breathers_come_nearer_to_it(steepness, waves):
    assert breather(steepness, waves, 1e-6) == pytest.approx(3.0, rel=0.05)
