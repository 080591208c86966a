"""The classical Runge-Kutta method of fourth order, the lab's eq. 6-7, in Nystroem form.

With x' = v the stage slopes of x are the stage velocities, so that
x_{n+1} = x + h v + h^2/6 (a1 + a2 + a3) and v_{n+1} = v + h/6 (a1 + 2 a2 + 2 a3 + a4).
"""

import numpy as np

from sim.jit import kernel
from sim.springs.analysis.amplification import changes_of_polynomial, stable_step_of_polynomial
from sim.springs.analysis.energy import add_power
from sim.springs.integrators import Integrator
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.vector_ops import set_sum

POLYNOMIAL = (1.0, 1.0, 1 / 2, 1 / 6, 1 / 24)


def stable_step(omega: float, rate: float) -> float:
    """Limit at which |1 + s + s^2/2 + s^3/6 + s^4/24| exceeds 1 on the ray of s = h lambda; 2 sqrt 2 undamped."""
    return stable_step_of_polynomial(POLYNOMIAL, omega, rate)


@kernel(noalias=True, inline=True)
def finish(x, v, a1, a2, a3, a4, h):
    for j in range(x.shape[0]):
        x[j] += h * (v[j] + h / 6.0 * (a1[j] + a2[j] + a3[j]))
    for j in range(x.shape[0]):
        v[j] += h / 6.0 * (a1[j] + a4[j] + 2.0 * (a2[j] + a3[j]))


@kernel(noalias=True)
def advance(x, v, ledger, t, h, steps, p, with_account):
    a1, a2, a3, a4 = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    xs, vs = np.empty_like(x), np.empty_like(x)
    f = make_scratch(p)
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        accelerate(x, v, now, p, True, f, a1)
        if with_account:
            add_power(x, v, now, p, True, h / 6.0, ledger)
        set_sum(xs, x, 0.5 * h, v)
        set_sum(vs, v, 0.5 * h, a1)
        set_pins(xs, vs, now + 0.5 * h, p)
        accelerate(xs, vs, now + 0.5 * h, p, True, f, a2)
        if with_account:
            add_power(xs, vs, now + 0.5 * h, p, True, h / 3.0, ledger)
        set_sum(xs, x, 0.5 * h, vs)
        set_sum(vs, v, 0.5 * h, a2)
        set_pins(xs, vs, now + 0.5 * h, p)
        accelerate(xs, vs, now + 0.5 * h, p, True, f, a3)
        if with_account:
            add_power(xs, vs, now + 0.5 * h, p, True, h / 3.0, ledger)
        set_sum(xs, x, h, vs)
        set_sum(vs, v, h, a3)
        set_pins(xs, vs, now + h, p)
        accelerate(xs, vs, now + h, p, True, f, a4)
        if with_account:
            add_power(xs, vs, now + h, p, True, h / 6.0, ledger)
        remember_places(x, p, True)
        finish(x, v, a1, a2, a3, a4, h)
        keep_apart(x, v, now + h, p, with_account, ledger)
    set_pins(x, v, t + steps * h, p)
    return 4 * steps


RECORD = Integrator(
    "rk4", 4, False, 4, stable_step, advance, "For accuracy: the lab's Runge-Kutta, errors under 0.1 mm.",
    changes_of_polynomial(POLYNOMIAL),
)  # fmt: skip
