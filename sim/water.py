"""The water that carries waves."""

import dataclasses
import math

import numpy as np

from sim import dispersion
from sim.validation import check_number, check_positive

# The defaults of the library, where nothing else is named.
EARTH_GRAVITY = 9.81  # [m/s2]
SEA_DENSITY = 1025.0  # [kg/m3] of sea water
FRESH_DENSITY = 1000.0  # [kg/m3]
SAME_WATER = 1e-3  # largest relative difference of two waters that count as one


@dataclasses.dataclass(frozen=True)
class Water:
    """A water of one density, by default the deep sea. Raises ValueError for a value that is not allowed."""

    depth: float = math.inf  # [m]
    gravity: float = EARTH_GRAVITY  # [m/s2]
    density: float = SEA_DENSITY  # [kg/m3]; 0: none

    def __post_init__(self) -> None:
        object.__setattr__(self, "depth", check_positive("depth", self.depth, "m", allow_infinite=True))
        object.__setattr__(self, "gravity", check_number("gravity", self.gravity, "m/s2", 0.0))
        object.__setattr__(self, "density", check_number("density", self.density, "kg/m3", 0.0))

    def __str__(self) -> str:
        return f"water {self.depth:g} m deep of {self.density:g} kg/m3 under a gravity of {self.gravity:g} m/s2"

    def omega(self, k: np.ndarray) -> np.ndarray:
        """Angular frequency [rad/s] of gravity waves of wavenumber k [rad/m]: sqrt(g k tanh kh) (Lamb, Art. 228)."""
        return dispersion.omega(np.asarray(k), self.gravity, self.depth)

    def wavenumber(self, omega: np.ndarray) -> np.ndarray:
        """Wavenumber [rad/m] of gravity waves of angular frequency omega [rad/s]."""
        return dispersion.wavenumber(omega, self.gravity, self.depth)

    def group_speed(self, k: np.ndarray) -> np.ndarray:
        """Group speed [m/s] of gravity waves of wavenumber k [rad/m]."""
        return dispersion.group_speed(np.asarray(k), self.gravity, self.depth)

    def is_same(self, other: "Water") -> bool:
        """True for waters that differ by at most `SAME_WATER`."""
        pairs = zip(dataclasses.astuple(self), dataclasses.astuple(other), strict=True)
        return all(math.isclose(a, b, rel_tol=SAME_WATER) for a, b in pairs)
