"""Tension of the links of a rope."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.forces.links import TINY
from sim.springs.laws import tension as tension_of
from sim.springs.net import Net


@kernel(allocates=False)
def set_tension(x, law, stiffness, rest, tension):
    """Of flat positions (3 n,); tension: (n - 1,)."""
    links = tension.shape[0]
    n = links + 1
    for j in range(links):
        rx, ry, rz = x[j + 1] - x[j], x[n + j + 1] - x[n + j], x[2 * n + j + 1] - x[2 * n + j]
        tension[j] = tension_of(law, stiffness, rest, math.sqrt(rx * rx + ry * ry + rz * rz + TINY))


def rope_tension(net: Net, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n - 1,) tension of each link of a rope [N], negative where pressed, at positions x (3, 1, n) [m]."""
    link, tension = net.families[0], np.empty(net.shape[1] - 1)
    set_tension(x.reshape(-1), net.law, link.stiffness, link.rest, tension)
    return tension
