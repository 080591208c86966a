"""Tension of the links of a rope."""

import numpy as np
from numpy.typing import NDArray

from sim.springs.forces.links import set_tensions
from sim.springs.net import Net


def rope_tension(net: Net, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n - 1,) tension of each link of a rope [N], negative if compressed, at positions x (3, 1, n) [m]."""
    tension = np.empty(net.shape[1] - 1)
    set_tensions(np.ascontiguousarray(x).reshape(-1), np.zeros(x.size), net.kernel_view(1.0), tension)
    return tension
