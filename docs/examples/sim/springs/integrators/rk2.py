"""The explicit midpoint rule, a Runge-Kutta method of second order."""

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.amplification import changes_of_polynomial, stable_step_of_polynomial
from sim.springs.analysis.energy import add_power
from sim.springs.integrators import Integrator
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.vector_ops import set_sum

POLYNOMIAL = (1.0, 1.0, 1 / 2)


def stable_step(omega: float, rate: float) -> float:
    """Step at which |1 + s + s^2/2| leaves 1; never stable undamped."""
    return stable_step_of_polynomial(POLYNOMIAL, omega, rate) if rate > 0.0 else 0.0


@kernel(noalias=True)
def advance(x, v, ledger, t, h, steps, p, with_account):
    """Advance flat x, v (3 rows cols,) by `steps` steps of h [s]; returns the force evaluations."""
    a, xm, vm = np.empty_like(x), np.empty_like(x), np.empty_like(x)
    f = make_scratch(p)
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        accelerate(x, v, now, p, True, f, a)
        set_sum(xm, x, 0.5 * h, v)  # xm = x + h/2 v
        set_sum(vm, v, 0.5 * h, a)
        set_pins(xm, vm, now + 0.5 * h, p)
        accelerate(xm, vm, now + 0.5 * h, p, True, f, a)
        if with_account:
            add_power(xm, vm, now + 0.5 * h, p, True, h, ledger)
        set_sum(x, x, h, vm)
        set_sum(v, v, h, a)
    set_pins(x, v, t + steps * h, p)
    return 2 * steps


RECORD = Integrator(
    "rk2", 2, False, 2, stable_step, advance, "To see second order without a splitting.",
    changes_of_polynomial(POLYNOMIAL),
)  # fmt: skip
