"""Implicit midpoint: x+ = x + h vm, v+ = v + h a(xm, vm) with xm = (x + x+)/2, vm = (v + v+)/2, by Newton's method.

A-stable and symplectic: modes of any stiffness keep their energy, only their frequency is wrong, (2/h) atan(h omega/2).
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.energy import add_power
from sim.springs.forces import set_pins
from sim.springs.integrators import Integrator
from sim.springs.newton import make_work, solve_stage


def limit(zeta: float) -> float:
    """No limit: |1 + s/2| <= |1 - s/2| for every s of negative real part."""
    return math.inf


@kernel
def advance(x, v, ledger, t, h, steps, p, with_ledger):
    work = make_work(p)
    xm, vm = np.empty_like(x), np.empty_like(v)
    evals = 0
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        # vm = v + h/2 a(x + h/2 vm, vm)
        vm[:] = v
        evals += solve_stage(x, v, 0.5 * h, now + 0.5 * h, p, xm, vm, work)
        if with_ledger:
            add_power(xm, vm, now + 0.5 * h, p, True, h, ledger)
        for j in range(x.shape[0]):
            x[j] += h * vm[j]
            v[j] = 2.0 * vm[j] - v[j]
    set_pins(x, v, t + steps * h, p)
    return evals


RECORD = Integrator(
    "implicit_midpoint", 2, True, 1, limit, advance, "For energy at any stiffness: symplectic, damps nothing.",
    implicit=True,
)  # fmt: skip
