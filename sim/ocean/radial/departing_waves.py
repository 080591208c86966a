"""Waves that fade out while those of another wind take over."""

import dataclasses
import math

import numpy as np

from sim.waves import Waves


@dataclasses.dataclass(frozen=True, eq=False)
class DepartingWaves:
    """The waves of before a change. Energies add, as the two seas are independent."""

    waves: Waves  # as high as at the change
    ratio: np.ndarray  # (n,) height of the interface over the surface's in each
    began: float  # [s]
    duration: float  # [s]

    def share_taken(self, t: float) -> float:
        """Fraction of the energy that the other waves have at time t [s]."""
        return min(max((t - self.began) / self.duration, 0.0), 1.0) if self.duration > 0.0 else 1.0

    def joined_by(self, others: Waves, t: float) -> Waves:
        """The waves, then the others that take over, as high as at time t [s]."""
        share, own = self.share_taken(t), self.waves
        heights = own.amplitude * math.sqrt(1.0 - share), others.amplitude * math.sqrt(share)
        names = ("kx", "ky", "phase", "omega")
        both = {name: np.append(getattr(own, name), getattr(others, name)) for name in names}
        return dataclasses.replace(others, amplitude=np.append(*heights), **both)
