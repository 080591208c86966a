"""Implicit Euler: v+ = v + h a(x+, v+), x+ = x + h v+, by Newton's method.

L-stable: holds at any stiffness, and pays for it with numerical damping, 1/(1 + (h omega)^2) of a mode's energy a step.
A step that Newton's method cannot take whole is taken in halves, quarters, ..., and in longer parts after an easy one.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.acceleration import set_pins
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.newton import MOST, make_work, solve_stage

FINEST = 16  # parts of a step, which are taken as they are


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
        done, size = 0, FINEST
        while done < FINEST:
            if is_stopped(p.stop):
                return evals
            part = h * size / FINEST
            after = t + (s + (done + size) / FINEST) * h
            for j in range(x.shape[0]):
                x0[j], v0[j] = x[j], v[j]
            taken, _, usable = solve_stage(x0, v0, part, after, p, x, v, work, MOST)
            evals += taken
            if not usable and size > 1:
                for j in range(x.shape[0]):
                    x[j], v[j] = x0[j], v0[j]
                size //= 2
                continue
            if with_account:
                add_power(x, v, after, p, True, part, ledger)
            done += size
            if taken <= MOST // 2 and done % (2 * size) == 0:
                size *= 2
    return evals


RECORD = Integrator(
    "implicit_euler", 1, False, 1, limit, advance, "For looks at any stiffness: damps what it cannot follow.",
    implicit=True, l_stable=True,
)  # fmt: skip
