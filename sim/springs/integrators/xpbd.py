"""XPBD in small steps: predict, one sweep over all constraints, velocities from what has moved (Macklin et al. 2019).

Each link has the compliance of its stiffness, so that the motion is the springs' own as h goes to 0, to first order. At
long steps it is the same physics softened: a sweep passes a pull on by one link or so, and what the sweep has not
settled acts as a lower stiffness. Never unstable, at a cost that does not depend on the stiffness.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.energy import account_size, add_power, close_damping, open_damping
from sim.springs.forces.acceleration import make_scratch, set_pins
from sim.springs.forces.damping import damp, is_odd, make_decay
from sim.springs.forces.wind import air_scratch_size, blow
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.xpbd_constraints import sweep


def limit(zeta: float) -> float:
    """No limit: a link alone takes a linear implicit Euler step, and its damping decays exactly."""
    return math.inf


@kernel(allocates=False)
def predict(x, v, h, p):
    """Gravity, then drift, of the free particles."""
    n = p.rows * p.cols
    for e in range(3):
        g = p.gx if e == 0 else p.gy if e == 1 else p.gz
        for j in range(n):
            if p.inverse_masses[j] > 0.0:
                v[e * n + j] += h * g
                x[e * n + j] += h * v[e * n + j]


@kernel(allocates=False)
def set_velocities(x, before, h, p, v):
    """v = (x - before) / h of the free particles."""
    n = p.rows * p.cols
    for e in range(3):
        for j in range(n):
            if p.inverse_masses[j] > 0.0:
                v[e * n + j] = (x[e * n + j] - before[e * n + j]) / h


@kernel
def advance(x, v, ledger, t, h, steps, p, with_account):
    before = np.empty_like(x)
    f, spare, middle = make_scratch(p), np.empty(air_scratch_size(x, p)), np.empty(air_scratch_size(x, p))
    decay = make_decay(p, 0.5 * h)
    undamped = np.empty(account_size(x, with_account))
    kinetic = 0.0
    set_pins(x, v, t, p)
    for s in range(steps):
        now, after, odd = t + s * h, t + (s + 1) * h, is_odd(t, h, s)
        if with_account:
            add_power(x, v, now, p, False, h, ledger)
            kinetic = open_damping(v, p, undamped)
        # Damping in halves before and after, as the leapfrog has it, keeps a fall's terminal speed to second order.
        by_sphere = damp(x, v, now, 0.5 * h, decay, p, odd)
        if with_account:
            close_damping(x, v, p, 0.5 * h, kinetic, by_sphere, undamped, ledger)
        for j in range(x.shape[0]):
            before[j] = x[j]
        predict(x, v, h, p)
        set_pins(x, v, after, p)
        sweep(x, after, h, p)
        set_velocities(x, before, h, p, v)
        blow(x, v, h, p, f, spare, middle, with_account, ledger)
        if with_account:
            kinetic = open_damping(v, p, undamped)
        by_sphere = damp(x, v, after, 0.5 * h, decay, p, not odd)
        if with_account:
            close_damping(x, v, p, 0.5 * h, kinetic, by_sphere, undamped, ledger)
    return steps


RECORD = Integrator(
    "xpbd", 1, False, 1, limit, advance, "For games: never unstable at one sweep a step, but soft in long steps.",
    softens=True,
)  # fmt: skip
