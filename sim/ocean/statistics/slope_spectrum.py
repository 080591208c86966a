"""Slope variance of a tile's waves by wavenumber, which low-pass and viscosity reduce."""

from typing import Any

import numpy as np

from sim.ocean.spectra import Conditions, Spectrum
from sim.ocean.tile.amplitudes import resolved
from sim.ocean.tile.wavenumbers import Wavenumbers


class SlopeSpectrum:
    """Mean square slope of the waves that one wind would raise."""

    def __init__(self, numbers: Wavenumbers, spectrum: Spectrum[Any], conditions: Conditions) -> None:
        """conditions: without a low-pass."""
        self.numbers, self.spectrum, self.conditions = numbers, spectrum, conditions
        S = spectrum(numbers.k[:, None], numbers.k[None, :], conditions)
        self.slope = numbers.folded_sum(S * resolved(numbers.size)) * numbers.quarter**2  # a quarter plane, over dk^2

    def share_left(self, low_pass: float, lost: np.ndarray) -> float:
        """Fraction that is left; 1 on a level sea.

        low_pass [m]: of the conditions. lost, a quarter plane: -ln of the fraction of each amplitude that is left.
        """
        whole = float(self.slope.sum())
        passed = np.exp(-((self.numbers.quarter * low_pass) ** 2))
        return float((self.slope * passed * np.exp(-2.0 * lost)).sum()) / whole if whole > 0.0 else 1.0
