"""PEFRL, a symplectic splitting of fourth order with small errors (Omelyan, Mryglod & Folk 2002, eq. 20).

Drifts and kicks in turn, symmetric: X(xi) K((1-2 lambda)/2) X(chi) K(lambda) X(1-2(chi+xi)) K(lambda) X(chi) ...
Some of them run backwards, where damping would drive: a damped net is refused.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.amplification import changes_of_matrix, limit_of
from sim.springs.analysis.energy import add_power
from sim.springs.integrators import Integrator
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.points.vector_ops import add_scaled

XI = 0.1786178958448091
LAMBDA = -0.2123418310626054
CHI = -0.06626458266981849
DRIFTS = (XI, CHI, 1.0 - 2.0 * (CHI + XI), CHI, XI)
KICKS = (0.5 - LAMBDA, LAMBDA, LAMBDA, 0.5 - LAMBDA)


def half_trace(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Half the trace of the matrix of a step of x'' = -x with h = z; its determinant is 1."""
    x, v = np.multiply.outer([1.0, 0.0], z**0), np.multiply.outer([0.0, 1.0], z**0)  # from (1, 0) and from (0, 1)
    for i, drift in enumerate(DRIFTS):
        x = x + drift * z * v
        if i < len(KICKS):
            v = v - KICKS[i] * z * x
    return 0.5 * (x[0] + v[1])


def growth(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Size of the largest eigenvalue of that step."""
    half = np.maximum(1.0, abs(half_trace(z)))
    return half + np.sqrt(half * half - 1.0)


UNDAMPED_LIMIT = limit_of(growth)


def stable_step(omega: float, rate: float) -> float:
    """Limit at which half the trace of the step matrix leaves -1..1; unstable with damping."""
    if rate > 2e-9 * omega:
        return 0.0
    return UNDAMPED_LIMIT / omega if omega > 0.0 else math.inf


def changes(omega: NDArray[np.float64], rate: NDArray[np.float64], h: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Without damping, which it refuses: the determinant is 1."""
    missing = 2.0 - 2.0 * half_trace(h * omega)
    return changes_of_matrix(-missing, missing)


@kernel(noalias=True)
def advance(x, v, ledger, t, h, steps, p, with_account):
    a = np.empty_like(x)
    f = make_scratch(p)
    for s in range(steps):
        now = t + s * h
        set_pins(x, v, now, p)
        remember_places(x, p, True)
        for i in range(4):
            add_scaled(x, DRIFTS[i] * h, v)
            now += DRIFTS[i] * h
            set_pins(x, v, now, p)
            accelerate(x, v, now, p, False, f, a)
            if with_account:
                add_power(x, v, now, p, False, KICKS[i] * h, ledger)
            add_scaled(v, KICKS[i] * h, a)
        add_scaled(x, DRIFTS[4] * h, v)
        keep_apart(x, v, t + (s + 1) * h, p, with_account, ledger)
    set_pins(x, v, t + steps * h, p)
    return 4 * steps


RECORD = Integrator(
    "pefrl", 4, True, 4, stable_step, advance,
    "For long undamped motions: symplectic, fourth order; refuses damping.", changes, undamped_only=True,
)  # fmt: skip
