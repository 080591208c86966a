"""Explicit Euler, the lab text's eq. 5: x += h v, v += h a(x, v), both from the old state.

Unstable without damping at every step size: a mode's energy grows by 1 + (h omega)^2 a step. Offered for comparison.
"""

import math
from functools import partial

from sim.springs.analysis.amplification import changes_of_function, fastest
from sim.springs.integrators import Integrator
from sim.springs.integrators.symplectic_euler import take_euler_steps


def stable_step(omega: float, rate: float) -> float:
    """h omega^2 < rate below critical damping: |1 + h s|^2 = 1 - h rate + h^2 omega^2 of the complex pair s; beyond,
    h < 2/|s| of the faster real root."""
    if rate > 2.0 * omega:
        return 2.0 / fastest(omega, rate)
    return rate / omega**2 if omega > 0.0 else math.inf


RECORD = Integrator(
    "explicit_euler", 1, False, 1, stable_step, partial(take_euler_steps, False),
    "To see an instability: the lab text's Euler, never stable undamped.", changes_of_function(lambda s: s),
)  # fmt: skip
