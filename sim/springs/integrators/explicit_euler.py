"""Explicit Euler, the lab text's eq. 5: x += h v, v += h a(x, v), both from the old state.

Unstable without damping at every step size: a mode's energy grows by 1 + (h omega)^2 a step. Shown to be understood.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.acceleration import accelerate, make_scratch, set_pins
from sim.springs.integrators import Integrator
from sim.springs.vector_ops import add_scaled


def limit(zeta: float) -> float:
    """z = 2 zeta for zeta <= 1: |1 + h s|^2 = 1 - 2 zeta z + z^2 of the complex pair s; the faster real root beyond."""
    return 2.0 * zeta if zeta <= 1.0 else 2.0 * (zeta - math.sqrt(zeta * zeta - 1.0))


@kernel(noalias=True)
def advance(x, v, ledger, t, h, steps, p, with_account):
    a = np.empty_like(x)
    f = make_scratch(p)
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        accelerate(x, v, now, p, True, f, a)
        if with_account:
            add_power(x, v, now, p, True, h, ledger)
        add_scaled(x, h, v)
        add_scaled(v, h, a)
    set_pins(x, v, t + steps * h, p)
    return steps


RECORD = Integrator(
    "explicit_euler", 1, False, 1, limit, advance, "To see an instability: the lab text's Euler, never stable undamped."
)
