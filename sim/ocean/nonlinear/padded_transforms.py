"""Transforms between half-plane spectra and a finer grid, on which products of fields do not alias.

A product of M fields of n waves has M n waves. On a grid of (M + 1)/2 n cells, those that alias fall on waves that are
cut off afterwards (Ducrozet et al. 2016, Comput. Phys. Commun. 203:245). Only rows and columns with waves are
transformed: at M = 3 that takes 0.75 of the time of a whole transform.
"""

from typing import Any

import numpy as np

from sim.jit import kernel
from sim.ocean.tile.buffer_pool import ALIGNMENT
from sim.ocean.tile.transforms import make_plan

FACTORS = (2, 3, 5, 7)  # for which FFTW has fast code


def padded_size(size: int, order: int) -> int:
    """Cells along one side of the grid for products of `order` fields: a multiple of 8 with small factors only."""
    if size == 1:
        return 1
    cells = -(-size * (order + 1) // 16)
    while not is_smooth(cells):
        cells += 1
    return 8 * cells


def is_smooth(number: int) -> bool:
    """True if `number` is a product of `FACTORS`."""
    for factor in FACTORS:
        while number % factor == 0:
            number //= factor
    return number == 1


def aligned(shape: tuple[int, ...], dtype: type) -> np.ndarray:
    """Zeros, aligned for vector instructions."""
    count = int(np.prod(shape)) * np.dtype(dtype).itemsize
    block = np.zeros(count + ALIGNMENT, np.uint8)
    start = -block.ctypes.data % ALIGNMENT
    return block[start : start + count].view(dtype).reshape(shape)


class Work:
    """Work done so far by the transforms that share it."""

    count = 0  # transforms


class PaddedTransforms:
    """The transforms of spectra with as many columns as given. Not for two threads at once."""

    def __init__(self, shape: tuple[int, int], columns: int, work: Work) -> None:
        """shape (rows, cells): of the grid, along y and x."""
        self.shape = rows, cells = shape
        self.work = work
        # Unwritten entries stay 0: rows between those of a spectrum in `spectrum`, the last columns of `_half`.
        self._half = aligned((rows, cells // 2 + 1), np.complex128)
        self.spectrum = self._half[:, :columns] if rows == 1 else aligned((rows, columns), np.complex128)
        self._other = aligned((rows, cells // 2 + 1), np.complex128)
        self.result = self._other[:, :columns] if rows == 1 else aligned((rows, columns), np.complex128)
        self._grid = aligned(self.shape, np.float64)
        self._rows_back = make_plan(self._half, self._grid, (1,), "FFTW_BACKWARD")
        self._rows = make_plan(self._grid, self._other, (1,), "FFTW_FORWARD")
        self._columns_back = self._columns = None
        if rows > 1:
            self._columns_back = make_plan(self.spectrum, self._half[:, :columns], (0,), "FFTW_BACKWARD")
            self._columns = make_plan(self._other[:, :columns], self.result, (0,), "FFTW_FORWARD")
        self._half[...] = 0.0
        self.spectrum[...] = 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the shapes and the account of the work: plans belong to a process."""
        return PaddedTransforms, (self.shape, self.spectrum.shape[1], self.work)

    def set_grid(self, plane: np.ndarray) -> None:
        """Set a plane to the field of `spectrum`."""
        if self._columns_back is not None:
            self._columns_back.execute()
        self._rows_back.update_arrays(self._half, plane.reshape(self.shape))
        self._rows_back.execute()
        self.work.count += 1

    def field_of(self, spectrum: np.ndarray) -> np.ndarray:
        """New field (cells, rows) [x, y] of a spectrum as high as the grid."""
        self.spectrum[...] = spectrum
        self.set_grid(self._grid.ravel())
        return np.array(self._grid.T, order="C")

    def set_result(self, plane: np.ndarray) -> None:
        """Set `result` to the spectrum of a plane, not divided by the number of cells."""
        self._rows.update_arrays(plane.reshape(self.shape), self._other)
        self._rows.execute()
        if self._columns is not None:
            self._columns.execute()
        self.work.count += 1


@kernel(noalias=True)
def set_multiple(h, factor, out):
    """Set the spectrum of a padded grid to factor(k) h(k), all (rows, 2 columns): real and imaginary parts."""
    rows, shift = h.shape[0], out.shape[0] - h.shape[0]
    for i in range(rows):
        o = i if 2 * i < rows else i + shift
        for j in range(h.shape[1]):
            out[o, j] = factor[i, j] * h[i, j]


@kernel(noalias=True)
def add_multiple(h, factor, out):
    """Add factor(k) h(k) to a spectrum of the same shape."""
    for i in range(h.shape[0]):
        for j in range(h.shape[1]):
            out[i, j] += factor[i, j] * h[i, j]


@kernel(noalias=True)
def set_derivative(h, row, column, out):
    """Set the same to i row(ky) column(kx) h(k)."""
    rows, shift = h.shape[0], out.shape[0] - h.shape[0]
    for i in range(rows):
        o = i if 2 * i < rows else i + shift
        for j in range(column.size):
            f = row[i] * column[j]
            out[o, 2 * j] = -f * h[i, 2 * j + 1]
            out[o, 2 * j + 1] = f * h[i, 2 * j]


@kernel(noalias=True)
def set_truncated(result, scale, out):
    """Set a spectrum to that of a padded grid times scale; the Nyquist row to 0. Both as real views."""
    rows, shift = out.shape[0], result.shape[0] - out.shape[0]
    for i in range(rows):
        o = i if 2 * i < rows else i + shift
        factor = 0.0 if 2 * i == rows else scale
        for j in range(out.shape[1]):
            out[i, j] = factor * result[o, j]
