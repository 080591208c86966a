"""Explicit Euler, the lab text's eq. 5: x += h v, v += h a(x, v), both from the old state.

Unstable without damping at every step size: a mode's energy grows by 1 + (h omega)^2 a step. Shown to be understood.
"""

import math
from functools import partial

from sim.springs.integrators import Integrator
from sim.springs.integrators.symplectic_euler import take_euler_steps


def limit(zeta: float) -> float:
    """z = 2 zeta for zeta <= 1: |1 + h s|^2 = 1 - 2 zeta z + z^2 of the complex pair s; the faster real root beyond."""
    return 2.0 * zeta if zeta <= 1.0 else 2.0 * (zeta - math.sqrt(zeta * zeta - 1.0))


RECORD = Integrator(
    "explicit_euler", 1, False, 1, limit, partial(take_euler_steps, False),
    "To see an instability: the lab text's Euler, never stable undamped.",
)  # fmt: skip
