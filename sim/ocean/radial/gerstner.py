"""Single waves drawn from a spectrum, each with an equal part of its energy, so that their sum's Hs is the spectrum's.

A sum of n waves resolves no part of the spectrum with less than 1/n of the energy. Its slopes are those of the long
waves; shorter ones belong to the material (roughness, ripples). For the whole spectrum at once there is the FFT sea.
"""

import math
from typing import Any

import numpy as np

from sim.ocean.spectra import Conditions, Spectrum
from sim.ocean.spectra.record import named_spectrum, wavenumber_of
from sim.validation import argument_error, check_number, is_whole_number
from sim.waves import Waves

MAX_WAVES = 4096
DECADES = (-1.7, 4.0)  # of wavenumber about the peak that are looked at: beyond lie 1e-8 of the energy
CELLS, BEARINGS = 1500, 120  # of the polar grid over which energy is shared out
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def waves_under(
    conditions: Conditions, kx: np.ndarray, ky: np.ndarray, amplitude: np.ndarray, phase: np.ndarray
) -> Waves:
    """`Waves` with the frequencies that they have under these conditions."""
    return Waves(kx, ky, amplitude, phase, conditions.omega(np.hypot(kx, ky)), conditions.water)


def draw_waves(
    spectrum: str | Spectrum[Any], conditions: Conditions | None = None, count: int = 64, seed: int = 0, **values: Any
) -> Waves:
    """`count` waves of equal energy m0/count from a spectrum: a = sqrt(2 m0/count).

    The energy, as a function of wavenumber, is cut into `count` equal parts; each gives the wavenumber of its middle
    and a bearing drawn from the spreading there (by a golden-ratio sequence, so that few waves already spread evenly).
    Without wind all amplitudes are 0. A regular wave is one wave, and those of the second system, if there is one, are
    the other `count`. All are on the water of the conditions, which come as a record or by name, as in
    `Spectrum.moments`. Raises ValueError for an unknown spectrum, a condition that it does not use, a count that is not
    1 to 4096 or a seed that is not whole.

    >>> waves = draw_waves("jonswap", count=32, wind_speed=12.0)
    >>> waves.amplitude.shape
    (32,)
    """
    spectrum = named_spectrum(spectrum)
    own = spectrum.conditions_of(conditions, values)
    if not is_whole_number(count) or not 1 <= count <= MAX_WAVES:
        raise argument_error("count", count, f"a whole number from 1 to {MAX_WAVES}")
    if not is_whole_number(seed):
        raise argument_error("seed", seed, "a whole number")
    random = np.random.default_rng(seed)
    if spectrum.line is not None and own.second_height == 0.0:
        kx, ky, m0 = spectrum.line(own)
        return waves_under(own, *(np.array([one]) for one in (kx, ky, math.sqrt(2.0 * m0), 0.0)))
    k = np.geomspace(*energy_range(spectrum, own), CELLS)
    theta = np.arange(BEARINGS) * (2.0 * math.pi / BEARINGS)
    S = spectrum(k[:, None] * np.cos(theta), k[:, None] * np.sin(theta), own)
    # m0 = int int S k dk dtheta = int int S k^2 dln k dtheta
    cells = S * (k**2)[:, None] * (math.log(k[1] / k[0]) * 2.0 * math.pi / BEARINGS)
    below = np.concatenate([[0.0], np.cumsum(0.5 * (cells.sum(axis=1)[1:] + cells.sum(axis=1)[:-1]))])
    m0 = float(below[-1])
    phase = 2.0 * math.pi * random.uniform(size=count)
    if m0 <= 0.0:
        k = np.full(count, peak_wavenumber(spectrum, own))
        return waves_under(own, k, np.zeros(count), np.zeros(count), phase)
    middles = (np.arange(count) + 0.5) / count * m0
    log_k = np.interp(middles, below, np.log(k))
    rows = np.clip(np.searchsorted(k, np.exp(log_k)), 0, CELLS - 1)
    # Bearings are cells centred on theta: cumulative energy at their edges.
    share = np.concatenate([np.zeros((count, 1)), np.cumsum(cells[rows], axis=1)], axis=1)
    edges = (np.arange(BEARINGS + 1) - 0.5) * (2.0 * math.pi / BEARINGS)
    at = (random.uniform() + np.arange(count) * GOLDEN) % 1.0
    bearing = np.array([np.interp(u * row[-1], row, edges) for u, row in zip(at, share, strict=True)])
    wavenumber = np.exp(log_k)
    amplitude = np.full(count, math.sqrt(2.0 * m0 / count))
    if spectrum.line is not None:
        kx, ky, m0 = spectrum.line(own)
        both = np.append(wavenumber * np.cos(bearing), kx), np.append(wavenumber * np.sin(bearing), ky)
        order = np.argsort(np.hypot(*both), kind="stable")
        single = math.sqrt(2.0 * m0)
        of_all = (*both, np.append(amplitude, single), np.append(phase, 0.0))
        return waves_under(own, *(values[order] for values in of_all))
    return waves_under(own, wavenumber * np.cos(bearing), wavenumber * np.sin(bearing), amplitude, phase)


def energy_range(spectrum: Spectrum[Any], conditions: Conditions) -> tuple[float, float]:
    """Smallest and largest wavenumber [rad/m] considered: less than 1e-8 of the energy lies outside."""
    low = high = peak_wavenumber(spectrum, conditions)
    if conditions.second_height > 0.0:
        second = wavenumber_of(conditions, 2.0 * math.pi / conditions.second_period)
        low, high = min(low, second), max(high, second)
    return low * 10.0 ** DECADES[0], high * 10.0 ** DECADES[1]


def peak_wavenumber(spectrum: Spectrum[Any], conditions: Conditions) -> float:
    """Wavenumber [rad/m] about which the spectrum's energy lies; that of 10 m/s if there is no wind."""
    if spectrum.peak is None or spectrum.is_level(conditions):
        return conditions.gravity / 10.0**2
    return wavenumber_of(conditions, spectrum.peak(conditions))


def widened(k: np.ndarray, length: float) -> np.ndarray:
    """Factor (n,) by which waves of wavenumber k (n,) [rad/m] are lower, averaged over a disc of diameter length [m].

    The mean of a wave over a disc of radius r is 2 J1(kr)/(kr) = 1 - (kr)^2/8 + ...; exp(-(kr)^2/8) begins alike and
    does not oscillate.
    """
    r = 0.5 * check_number("length", length, "m", 0.0, 1e4)
    return np.exp(-((k * r) ** 2) / 8.0)
