"""Wavenumbers of a periodic rectangle and its linear waves.

Spectra are half planes (rows, columns) = (m, n/2), rows by ky in FFT order, columns by kx >= 0, so that waves along x
alone, m = 1, are one row. A field is the plain sum of its waves. The Nyquist row and column are 0, as in the sea of
linear waves.
"""

import math
from typing import NamedTuple

import numpy as np

from sim.ocean.tile.amplitudes import integers
from sim.water import Water


class Modes(NamedTuple):
    """The waves of a grid of (n, m) cells on one body of water."""

    size: tuple[int, int]  # (n, m) cells along x and y
    length: tuple[float, float]  # [m] along x and y
    water: Water
    kx: np.ndarray  # (columns,) [rad/m]
    ky: np.ndarray  # (rows,) [rad/m]
    k: np.ndarray  # (rows, columns) [rad/m]
    tanh: np.ndarray  # (rows, columns) tanh(k depth)
    omega: np.ndarray  # (rows, columns) [rad/s]
    weight: np.ndarray  # (columns,): 1 at kx = 0, else 2, as each of those stands for -k too

    def mean_product(self, a: np.ndarray, b: np.ndarray) -> float:
        """Mean over the rectangle of the product of two fields, from their spectra."""
        return float((np.real(a * np.conj(b)) @ self.weight).sum())


def make_modes(size: tuple[int, int], length: tuple[float, float], water: Water) -> Modes:
    """The waves of a rectangle; arguments as in the record."""
    columns, rows = size[0] // 2, size[1]
    kx = np.arange(columns) * (2.0 * math.pi / length[0])
    ky = integers(rows) * (2.0 * math.pi / length[1])
    k = np.hypot(ky[:, None], kx[None, :])
    tanh = np.tanh(np.minimum(k * water.depth, 100.0)) if math.isfinite(water.depth) else np.where(k > 0.0, 1.0, 0.0)
    weight = np.where(np.arange(columns) == 0, 1.0, 2.0)
    return Modes(size, length, water, kx, ky, k, tanh, water.omega(k), weight)


def spectrum_of(field: np.ndarray) -> np.ndarray:
    """Spectrum (m, n/2) of a field (n, m)."""
    n, m = field.shape
    spectrum = np.fft.rfft2(field.T)[:, : n // 2] / (n * m)
    if m > 1:
        spectrum[m // 2] = 0.0
    return np.ascontiguousarray(spectrum)
