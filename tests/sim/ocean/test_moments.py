"""Moments and S(omega) of every spectrum against quadrature of its density in the plane."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from sim.ocean.spectra import SPECTRA, Conditions
from sim.ocean.spectra.record import wavenumber_of

CASES = [
    *((name, {}) for name in SPECTRA),
    ("jonswap", {"wind_speed": 20.0, "fetch": 3e4, "gravity": 3.7}),
    ("tma", {"depth": 8.0, "tension": 0.074}),
    ("sea_state", {"hs": 3.0, "tp": 11.0, "second_height": 1.0, "second_period": 5.0}),
    ("phillips", {"low_pass": 0.5, "depth": 15.0}),
    ("elfouhaily", {"inverse_wave_age": 2.0, "tension": 0.074}),
    ("pierson_moskowitz", {"low_pass": 0.2, "wind_speed": 4.0}),
    ("regular", {"second_height": 1.5}),
]


def peak_of(name: str, c: Conditions) -> float:
    """Declared peak [rad/s] of a spectrum."""
    peak = SPECTRA[name].peak
    assert peak is not None
    return peak(c)


def by_quadrature(name: str, n: int, cut_off: float = math.inf, **values: Any) -> float:
    """m_n of the density in the plane, summed over 180 directions and log k by scipy, without a formula of S(omega)."""
    spectrum = SPECTRA[name]
    c = spectrum.conditions(**values)
    theta = (np.arange(180) + 0.5) * (2.0 * math.pi / 180)

    def integrand(log_k: float) -> float:
        k = math.exp(log_k)
        S = spectrum(k * np.cos(theta), k * np.sin(theta), c).mean() * 2.0 * math.pi
        return float(S * k**2 * c.omega(np.asarray(k)) ** n)

    places = [c.second_period] if c.second_height else []
    peaks = [math.log(wavenumber_of(c, w)) for w in [peak_of(name, c), *(2.0 * math.pi / T for T in places)]]
    last = math.log(wavenumber_of(c, cut_off)) if math.isfinite(cut_off) else max(peaks) + 24.0
    cuts = sorted({min(peaks) - 5.0, *peaks, *(p + d for p in peaks for d in (-0.5, 0.5, 2.0, 6.0)), last})
    cuts = [cut for cut in cuts if cut <= last]
    total = sum(quad(integrand, a, b, epsabs=0.0, epsrel=2e-6, limit=200)[0] for a, b in itertools.pairwise(cuts))
    if spectrum.line is not None:
        kx, ky, m0 = spectrum.line(c)
        total += m0 * float(c.omega(np.asarray(math.hypot(kx, ky)))) ** n
    return total


@pytest.mark.parametrize(("name", "values"), CASES)
def test_moments_and_tz_are_those_of_the_plane_s_quadrature(name, values):
    spectrum = SPECTRA[name]
    c = spectrum.conditions(**values)
    found = spectrum.moments(**values)
    wanted = [by_quadrature(name, n, **values) for n in range(3)]
    assert found[:3] == pytest.approx(wanted, rel=1e-4)
    assert found.zero_crossing_period == pytest.approx(2.0 * math.pi * math.sqrt(wanted[0] / wanted[2]), rel=1e-4)
    assert found.mean_period == pytest.approx(2.0 * math.pi * wanted[0] / wanted[1], rel=1e-4)
    cut_off = 5.0 * peak_of(name, c)
    cut = spectrum.moments(c, cut_off)
    assert cut[3:5] == pytest.approx([by_quadrature(name, n, cut_off, **values) for n in (3, 4)], rel=1e-4)
    assert cut.cut_off == cut_off
    # a tail of omega^-5 has no fourth moment, unless the spectrum or the low-pass ends it
    assert math.isinf(found.m4) == (name not in ("elfouhaily", "regular") or c.second_height > 0) & (c.low_pass == 0.0)


def test_moments_of_pierson_and_moskowitz_are_their_closed_forms():
    """S = A w^-5 exp(-B w^-4): m_n = A/4 B^(n/4 - 1) Gamma(1 - n/4), Tp = 2 pi (4 B/5)^(-1/4)."""
    A, B = 0.0081 * 9.81**2, 0.74 * (9.81 / 12.0) ** 4
    found = SPECTRA["pierson_moskowitz"].moments(wind_speed=12.0)
    wanted = [A / 4.0 * B ** (n / 4.0 - 1.0) * math.gamma(1.0 - n / 4.0) for n in range(4)]
    assert found[:3] == pytest.approx(wanted[:3], rel=1e-7)
    assert found.m3 == pytest.approx(wanted[3], rel=1e-4)  # its tail is the last to fall
    assert found.peak_period == pytest.approx(2.0 * math.pi * (0.8 * B) ** -0.25, rel=1e-5)
    assert found.steepness == pytest.approx(4.0 * wanted[2] / (2.0 * math.pi * 9.81 * math.sqrt(wanted[0])), rel=1e-6)


@pytest.mark.parametrize(("name", "values"), CASES)
def test_s_of_omega_is_the_plane_s_density_over_all_directions(name, values):
    """With the formula of each spectrum, and without one, as for a spectrum of one's own."""
    spectrum = SPECTRA[name]
    c = spectrum.conditions(**values)
    w = peak_of(name, c) * np.array([0.6, 0.95, 1.0, 1.4, 3.0, 12.0])
    k = np.array([wavenumber_of(c, one) for one in w])
    theta = (np.arange(1440) + 0.5) * (2.0 * math.pi / 1440)
    plane = spectrum(k[:, None] * np.cos(theta), k[:, None] * np.sin(theta), c).mean(axis=1) * 2.0 * math.pi
    wanted = plane * k / c.group_speed(k)
    for one in (spectrum, spectrum._replace(frequency=None)):
        assert one.frequency_density(w, **values) == pytest.approx(wanted, rel=2e-4)
    assert spectrum.frequency_density(w[:, None], c).shape == (6, 1)


def test_a_level_sea_has_no_moments():
    found = SPECTRA["jonswap"].moments(wind_speed=0.0)
    assert found.m0 == 0.0
    assert math.isnan(found.zero_crossing_period)
    assert math.isnan(found.peak_period)


def test_moments_of_the_shallows_converge_as_in_deep_water():
    """S falls as w^-3 as long as waves feel the bottom, and as w^-5 beyond: m3 is finite, by quadrature, and m4 not."""
    found = SPECTRA["tma"].moments(depth=1e-6)
    c = SPECTRA["tma"].conditions(depth=1e-6)
    omega = np.geomspace(1e-2, 1e8, 400_001)
    S = SPECTRA["tma"].frequency_density(omega, c)
    assert found.m3 == pytest.approx(np.trapezoid(S * omega**4, np.log(omega)), rel=1e-3)
    assert math.isinf(found.m4)
