"""Symplectic (semi-implicit) Euler, the lab code's "Euler": v += h a(x, v), then x += h v with the new v."""

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.amplification import changes_of_matrix
from sim.springs.analysis.energy import add_power
from sim.springs.integrators import Integrator
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.vector_ops import add_scaled


def stable_step(omega: float, rate: float) -> float:
    """h^2 omega^2 + 2 h rate < 4 by the Jury conditions of the 2 x 2 step matrix."""
    slope = rate + math.hypot(rate, 2.0 * omega)
    return 4.0 / slope if slope > 0.0 else math.inf


def changes(omega: NDArray[np.float64], rate: NDArray[np.float64], h: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Eigenvalues, less 1, of the step [[1 - z^2, h (1 - h rate)], [-h omega^2, 1 - h rate]], z = h omega."""
    square = (h * omega) ** 2
    return changes_of_matrix(-h * rate - square, square)


@kernel(noalias=True, inline=True)
def kick_and_drift(x, v, h, a):
    """v += h a, then x += h v: one pass, as long ropes wait for memory."""
    for j in range(x.shape[0]):
        v[j] += h * a[j]
        x[j] += h * v[j]


@kernel(noalias=True)
def take_euler_steps(by_new_velocity, x, v, ledger, t, h, steps, p, with_account):
    """`advance` of an integrator. by_new_velocity: x += h v with the velocity at the end of the step, not its start.

    Both methods share one kernel, as its forces take long to compile.
    """
    a = np.empty_like(x)
    f = make_scratch(p)
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        accelerate(x, v, now, p, True, f, a)
        if with_account:
            add_power(x, v, now, p, True, h, ledger)
        remember_places(x, p, True)
        if by_new_velocity:
            kick_and_drift(x, v, h, a)
        else:
            add_scaled(x, h, v)
            add_scaled(v, h, a)
        keep_apart(x, v, now + h, p, with_account, ledger)
    set_pins(x, v, t + steps * h, p)
    return steps


advance = partial(take_euler_steps, True)
RECORD = Integrator(
    "symplectic_euler",
    1,
    True,
    1,
    stable_step,
    advance,
    "For the lab's code, which calls it Euler: cheap, stable, first order.",
    changes,
)
