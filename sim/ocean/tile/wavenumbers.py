"""The wavenumbers of a tile, in the layouts that its spectra have.

Full planes (size, size) are in FFT order; a quarter plane (size/2, size/2) is over |kx|, |ky|.
"""

import math

import numpy as np

from sim.interruption import raise_if_stopped
from sim.ocean.tile.amplitudes import integers
from sim.ocean.tile.transforms import PRECISIONS


class Wavenumbers:
    """Wavenumbers of one tile, and factors on its spectra by them. No array is changed in place."""

    def __init__(self, size: int, length: float, precision: str) -> None:
        """length [m]; precision: a name in `PRECISIONS`, of the factors of the transforms."""
        self.size, self.length = size, length
        self.real, self.wide = PRECISIONS[precision]
        self.k = integers(size) * (2.0 * math.pi / length)  # [rad/m], FFT order
        self.folded = np.abs(integers(size)) % (size // 2)  # |n|, with the Nyquist index, of amplitude 0, sent to 0
        axis = self.k[: size // 2]
        self.quarter = np.hypot(axis[:, None], axis[None, :])
        inverse = np.divide(1.0, self.quarter, out=np.zeros_like(self.quarter), where=self.quarter > 0.0)
        # Factors of the transforms, by |k| on a quarter plane and by kx or ky on a row.
        self.radial: dict[str, np.ndarray] = {
            "1": np.ones_like(self.quarter, self.real),
            "1/k": inverse.astype(self.real),
            "k": self.quarter.astype(self.real),
        }
        self.rows: dict[str, np.ndarray] = {
            "1": np.ones(size, self.real),
            "k": self.k.astype(self.real),
            "k2": (self.k**2).astype(self.real),
        }

    def full(self, quarter: np.ndarray) -> np.ndarray:
        """A quarter plane laid out over the full plane."""
        return quarter[self.folded[:, None], self.folded[None, :]]

    def folded_sum(self, plane: np.ndarray) -> np.ndarray:
        """The sum of a full plane over the waves of each |kx|, |ky|: a quarter plane."""
        sums = np.zeros_like(self.quarter)
        raise_if_stopped()
        np.add.at(sums, np.ix_(self.folded, self.folded), plane)
        return sums
