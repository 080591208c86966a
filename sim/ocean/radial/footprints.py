"""Waves as hulls of some width feel them: averaged over it."""

import numpy as np

from sim.ocean.radial.gerstner import widened

MAX_KEPT = 8  # sets of hulls


class Footprints:
    """Factors of one set of wavenumbers, kept for the same hulls, because each step needs theirs."""

    def __init__(self, k: np.ndarray) -> None:
        """k (waves,) [rad/m]."""
        self.k = k
        self.by_size: dict[bytes, np.ndarray] = {}

    def factors(self, size: np.ndarray) -> np.ndarray:
        """Factors (n, waves) on the waves under hulls of diameters (n,) [m]."""
        key = size.tobytes()
        if key not in self.by_size:
            if len(self.by_size) > MAX_KEPT:
                self.by_size.clear()
            unique, which = np.unique(size, return_inverse=True)
            rows = np.array([widened(self.k, float(s)) for s in unique]).reshape(len(unique), len(self.k))
            self.by_size[key] = rows[which]
        return self.by_size[key]
