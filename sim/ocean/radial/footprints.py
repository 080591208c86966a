"""Waves as hulls of some width feel them: averaged over it."""

import numpy as np

from sim.ocean.radial.gerstner import widened

MAX_KEPT = 8  # sets of hulls


class Footprints:
    """Factors of one set of wavenumbers, kept for the same hulls, because each step needs theirs."""

    def __init__(self, k: np.ndarray) -> None:
        """k (waves,) [rad/m]."""
        self.k = k
        self.kept: dict[bytes, np.ndarray] = {}

    def factors(self, size: np.ndarray) -> np.ndarray:
        """Factors (n, waves) on the waves under hulls of diameters (n,) [m]."""
        key = size.tobytes()
        if key not in self.kept:
            if len(self.kept) > MAX_KEPT:
                self.kept.clear()
            unique, which = np.unique(size, return_inverse=True)
            rows = np.array([widened(self.k, float(s)) for s in unique]).reshape(len(unique), len(self.k))
            self.kept[key] = rows[which]
        return self.kept[key]
