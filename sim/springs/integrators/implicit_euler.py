"""Implicit Euler: v+ = v + h a(x+, v+), x+ = x + h v+, by Newton's method.

L-stable: holds at any stiffness, and pays for it with numerical damping, 1/(1 + (h omega)^2) of a mode's energy a step.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.acceleration import set_pins
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.newton import MOST, make_work, solve_stage


def limit(zeta: float) -> float:
    """No limit: |1 - s| >= 1 for every s of negative real part."""
    return math.inf


@kernel
def advance(x, v, ledger, t, h, steps, p, with_account):
    work = make_work(p, False)
    x0, v0 = np.empty_like(x), np.empty_like(v)
    evals = 0
    set_pins(x, v, t, p)
    for s in range(steps):
        after = t + (s + 1) * h
        x0[:] = x
        v0[:] = v
        evals += solve_stage(x0, v0, h, after, p, x, v, work, MOST)[0]
        if with_account:
            add_power(x, v, after, p, True, h, ledger)
    return evals


RECORD = Integrator(
    "implicit_euler", 1, False, 1, limit, advance, "For looks at any stiffness: damps what it cannot follow.",
    implicit=True, l_stable=True,
)  # fmt: skip
