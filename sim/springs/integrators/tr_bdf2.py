"""TR-BDF2: a trapezoidal stage to t + gamma h, then BDF2 to t + h, gamma = 2 - sqrt 2 (Hosea & Shampine 1996).

Both stages have the same g = gamma h/2. L-stable and second order: what a mode loses a step is 0.0037 (h omega)^4 of
its amplitude, where implicit Euler takes (h omega)^2/2. A step that Newton's method cannot take whole is taken in
halves, quarters, ..., in longer parts again after an easy one.
"""

import math

import numpy as np

from sim.jit import is_stopped, kernel
from sim.springs.analysis.energy import add_power
from sim.springs.forces.acceleration import accelerate, make_scratch, set_pins
from sim.springs.integrators import Integrator
from sim.springs.integrators.implicit.newton import MOST, make_work, solve_stage

GAMMA = 2.0 - math.sqrt(2.0)
FINEST = 16  # parts of a step, which are taken as they are
W = math.sqrt(2.0) / 4.0  # weights of the quadrature: W, W, GAMMA/2


def limit(zeta: float) -> float:
    """No limit: A-stable, and R -> 0 at infinity."""
    return math.inf


@kernel
def advance(x, v, ledger, t, h, steps, p, with_account):
    work = make_work(p, False)
    f = make_scratch(p)
    a = np.empty_like(x)
    x0, v0, xs, vs = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    x1, v1 = np.empty_like(x), np.empty_like(x)
    # y2 = y1/(gamma (2 - gamma)) - y (1 - gamma)^2/(gamma (2 - gamma)) + g f2
    c1 = 1.0 / (GAMMA * (2.0 - GAMMA))
    c0 = 1.0 - c1
    evals = 0
    for s in range(steps):
        done, size = 0, FINEST
        while done < FINEST:
            if is_stopped(p.stop):
                return evals
            part = h * size / FINEST
            g = 0.5 * GAMMA * part
            now = t + (s + done / FINEST) * h
            after = t + (s + (done + size) / FINEST) * h
            set_pins(x, v, now, p)
            accelerate(x, v, now, p, True, f, a)
            # y1 = y + g (f + f1)
            for j in range(x.shape[0]):
                x0[j], v0[j] = x[j], v[j]
                xs[j] = x[j] + g * v[j]
                vs[j] = v[j] + g * a[j]
                v1[j] = v[j]
            first, _, usable = solve_stage(xs, vs, g, now + GAMMA * part, p, x1, v1, work, MOST)
            evals += 1 + first
            second = 0
            if usable or size == 1:
                for j in range(x.shape[0]):
                    xs[j] = c1 * x1[j] + c0 * x[j]
                    vs[j] = c1 * v1[j] + c0 * v[j]
                    v[j] = v1[j]
                second, _, usable = solve_stage(xs, vs, g, after, p, x, v, work, MOST)
                evals += second
            if not usable and size > 1:
                for j in range(x.shape[0]):
                    x[j], v[j] = x0[j], v0[j]
                size //= 2
                continue
            if with_account:
                add_power(x0, v0, now, p, True, W * part, ledger)
                add_power(x1, v1, now + GAMMA * part, p, True, W * part, ledger)
                add_power(x, v, after, p, True, g, ledger)
            done += size
            if max(first, second) <= MOST // 2 and done % (2 * size) == 0:
                size *= 2
    return evals


RECORD = Integrator(
    "tr_bdf2", 2, False, 3, limit, advance, "For stiff ropes with some accuracy: L-stable and second order.",
    implicit=True, l_stable=True, evals_outside_newton=1,
)  # fmt: skip
