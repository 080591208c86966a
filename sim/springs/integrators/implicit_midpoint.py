"""Implicit midpoint: x+ = x + h vm, v+ = v + h a(xm, vm) with xm = (x + x+)/2, vm = (v + v+)/2, by Newton's method.

A-stable: modes of any stiffness keep their energy, only their frequency is wrong, (2/h) atan(h omega/2). They keep it
for good: damping takes next to nothing of a mode that is far too stiff for the step. So that links that turn far within
a step keep theirs as well, their tensions are those of their mean lengths
(`sim.springs.integrators.implicit.mean_length`): without damping and contact the energy stays to round-off at any
stiffness, and the angular momentum too; for that the method gives up being symplectic. A step that Newton's method
cannot take whole is taken in halves, quarters, ..., in longer parts again after an easy one.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.acceleration import set_pins
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.newton import make_work, solve_stage

PATIENCE = 12  # corrections, after which halves are quicker than going on
FINEST = 64  # parts of a step, which are taken as they are


def limit(zeta: float) -> float:
    """No limit: |1 + s/2| <= |1 - s/2| for every s of negative real part."""
    return math.inf


@kernel
def advance(x, v, ledger, t, h, steps, p, with_account):
    work = make_work(p, True)
    xm, vm = np.empty_like(x), np.empty_like(v)
    evals = 0
    for s in range(steps):
        done, size = 0, FINEST
        while done < FINEST:
            if is_stopped(p.stop):
                return evals
            part = h * size / FINEST
            now = t + (s + done / FINEST) * h
            set_pins(x, v, now, p)
            # vm = v + part/2 a(x + part/2 vm, vm)
            for j in range(v.shape[0]):
                vm[j] = v[j]
            taken, settled, _ = solve_stage(x, v, 0.5 * part, now + 0.5 * part, p, xm, vm, work, PATIENCE)
            evals += taken
            if not settled and size > 1:
                size //= 2
                continue
            if with_account:
                add_power(xm, vm, now + 0.5 * part, p, True, part, ledger)
            for j in range(x.shape[0]):
                x[j] += part * vm[j]
                v[j] = 2.0 * vm[j] - v[j]
            done += size
            if taken <= PATIENCE // 2 and done % (2 * size) == 0:
                size *= 2
    set_pins(x, v, t + steps * h, p)
    return evals


RECORD = Integrator(
    "implicit_midpoint", 2, False, 1, limit, advance, "For energy at any stiffness: keeps it, damps nothing.",
    implicit=True,
)  # fmt: skip
