"""Random wave amplitudes tied to the integer wavenumber, so that another resolution draws the same sea.

h0(k) = (xi1 + i xi2)/2 sqrt(S(k) dk^2) (Tessendorf 2001, eq. 42, with the dk^2 that makes Var = sum S dk^2), where xi1,
xi2 come from a hash of (seed, nx, ny): no generator state, no loop order. Full planes are in FFT order, k_n = n dk,
n = 0 ... N/2 - 1, -N/2 ... -1. The mean and the two Nyquist lines, which cannot travel on the grid, are 0.
"""

import math
import warnings
from typing import Any

import numpy as np

from sim.interruption import pieces
from sim.numerics.angles import within_half_turn
from sim.validation import ApproximationWarning
from sim.water import Water
from sim.waves import Waves

KINDS = ("random", "fixed")
PIECE = 32768  # wavenumbers at a time: the solve yields in between

# Finaliser of splitmix64 (Steele, Lea, Flood 2014) and its increment.
_STEP, _MIX1, _MIX2 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)


def integers(size: int) -> np.ndarray:
    """The integer wavenumbers in FFT order: 0 ... N/2 - 1, -N/2 ... -1, shape (size,)."""
    return np.fft.fftfreq(size, 1.0 / size).round().astype(np.int64)


def resolved(size: int) -> np.ndarray:
    """(size, size) bool: neither the mean nor on a Nyquist line."""
    n = integers(size)
    inner = n != -size // 2
    mask = inner[:, None] & inner[None, :]
    mask[0, 0] = False
    return mask


def unit_amplitudes(size: int, seed: int, kind: str) -> np.ndarray:
    """(xi1 + i xi2)/2 of each wavenumber, complex (size, size); |.|^2 is 1/2 on average, or exactly for "fixed"."""
    n, there = integers(size), resolved(size)
    plane = np.empty((size, size), complex)
    with np.errstate(over="ignore"):
        key = _mixed(np.uint64(seed % 2**64) + _STEP)
    for rows in pieces(size, max(1, PIECE // size)):
        with np.errstate(over="ignore"):
            row = _mixed(key ^ n[rows].astype(np.uint64))[:, None]
            cell = _mixed(row + _STEP * n.astype(np.uint64)[None, :])
            first, second = _uniform(_mixed(cell + _STEP)), _uniform(_mixed(cell + _STEP + _STEP))
        # Box-Muller; "fixed" keeps the phase and replaces the radius by its root mean square.
        radius = np.sqrt(-2.0 * np.log(first)) if kind == "random" else np.sqrt(2.0)
        plane[rows] = np.where(there[rows], 0.5 * radius * np.exp(2j * np.pi * second), 0.0)
    return plane


def fold(h0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(even, odd), complex (N, N/2 + 1), with h(k, t) = even cos(omega t) + odd sin(omega t) on the half plane ky >= 0.

    h(k, t) = h0(k) e^(-i omega t) + conj(h0(-k)) e^(i omega t): Hermitian whatever h0 is.
    """
    size, half = len(h0), h0.shape[1] // 2 + 1
    even, odd = np.empty((2, size, half), complex)
    opposite = -np.arange(size) % size
    for rows in pieces(size, max(1, PIECE // size)):
        onward, backward = h0[rows, :half], np.conj(h0[np.ix_(opposite[rows], opposite[:half])])
        even[rows], odd[rows] = onward + backward, -1j * (onward - backward)
    return even, odd


def with_line(S: np.ndarray, unit: np.ndarray, line: tuple[float, float, float], dk: float) -> np.ndarray:
    """Give the energy of one regular wave to the tile's wave that is nearest to it, which is drawn as high as that.

    S [m4] and unit amplitudes, (size, size); S is changed, and the other amplitudes are returned. line: kx, ky [rad/m]
    and m0 [m2]. Of a wave that is longer than the tile, or too short for its grid, the nearest is the longest, or
    the shortest, of about its direction, and an ApproximationWarning says so.
    """
    kx, ky, m0 = line
    longest, shortest = 1.0, len(S) // 2 - 1.0
    n = max(abs(kx), abs(ky)) / dk
    beyond = "longer than the tile" if n < 0.5 else "too short for the grid" if n > shortest + 0.5 else ""
    if beyond and m0 > 0.0:
        own, tile = 2.0 * math.pi / math.hypot(kx, ky), 2.0 * math.pi / dk
        words = f"a wave of {own:.3g} m is {beyond} of {tile:.6g} m and {len(S)} cells a side"
        warnings.warn(f"{words}; the sea has the nearest that fits", ApproximationWarning, stacklevel=2)
    fitted = min(max(n, longest), shortest) / n
    i, j = round(fitted * kx / dk), round(fitted * ky / dk)
    S[i, j] += m0 / dk**2
    unit = unit.copy()
    unit[i, j] *= math.sqrt(0.5) / abs(unit[i, j])
    return unit


def waves_of_tile(k: np.ndarray, h0: np.ndarray, omega: np.ndarray, base: float, water: Water) -> Waves:
    """The waves of a tile that have an amplitude.

    k: (n,) [rad/m] in FFT order. h0, omega: (n, n) [m], [rad/s], with the phases of time `base` [s].
    """
    there = h0 != 0.0
    h0, omega = h0[there], omega[there]
    kx, ky = (np.broadcast_to(along, there.shape)[there] for along in (k[:, None], k[None, :]))
    phase = within_half_turn(np.angle(h0) + omega * base)
    return Waves(kx, ky, 2.0 * np.abs(h0), phase, omega, water)


def _mixed(z: Any) -> Any:
    z = (z ^ (z >> np.uint64(30))) * _MIX1
    z = (z ^ (z >> np.uint64(27))) * _MIX2
    return z ^ (z >> np.uint64(31))


def _uniform(z: np.ndarray) -> np.ndarray:
    """The top 53 bits as a number in (0, 1]."""
    return ((z >> np.uint64(11)).astype(np.float64) + 1.0) * 2.0**-53
