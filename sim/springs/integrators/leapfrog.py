"""Leapfrog (velocity Verlet) with damping split off: D(h/2) K(h/2) X(h) K(h/2) D'(h/2).

K kicks with the forces of position alone, X drifts, D is the exact damping of `sim.springs.damping`, D' the
same in reverse order, and the two change places from step to step; air blows in the middle of X. A symmetric
composition: second order with damping, stable for h omega < 2 at any damping but the air's. One force evaluation a
step, as the force at the end of a step opens the next. Of a rope, D' of a step and D of the next are one pass.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sim.jit import kernel
from sim.springs.analysis.amplification import changes_of_matrix
from sim.springs.analysis.energy import add_power
from sim.springs.damping import is_odd, make_decay
from sim.springs.forces.air import air_scratch_size, drift
from sim.springs.integrators import Integrator
from sim.springs.kicks.apart import keep_apart, remember_places
from sim.springs.kicks.kick import SPLIT, WEAK, kick, make_kick_room
from sim.springs.points.acceleration import accelerate, make_scratch, set_pins
from sim.springs.rope_gap import cross_gap, gaps_merge, make_gap


def stable_step(omega: float, rate: float) -> float:
    """2/omega, a bound at every damping rate: damping only lowers the invariant of the undamped step."""
    return 2.0 / omega if omega > 0.0 else math.inf


def changes(omega: NDArray[np.float64], rate: NDArray[np.float64], h: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Eigenvalues of a step of kick, drift and kick, less 1, with z = h omega and y = h rate/2.

    Damping that is taken apart keeps exp(-y) of v, and its kick is h/2. Inside the kick it keeps R(y), and the kick is
    (1 - R)/rate (`sim.springs.kicks.formula`). Of a net the strongest rate decides between them; by Gershgorin's bound
    for one point it is twice the rate.
    """
    y = 0.5 * h * rate
    inside = 1.0 / (1.0 + y + 0.5 * y * y)
    is_apart = 2.0 * h * rate <= WEAK
    lost = np.where(is_apart, -np.expm1(-2.0 * y), y * (1.0 + 0.5 * y) * inside * (1.0 + inside))
    square = 0.5 * (h * omega) ** 2 * np.where(is_apart, 2.0 - lost, (1.0 + 0.5 * y) * inside * (1.0 + inside))
    return changes_of_matrix(-lost - square, square)


@kernel(noalias=True)
def advance(x, v, ledger, t, h, steps, p, with_account):
    a = np.empty_like(x)
    f = make_scratch(p)
    decay = make_decay(p, 0.5 * h)
    room = make_kick_room(x, p, h, with_account)
    merged = gaps_merge(p) and room.kind == SPLIT and not with_account
    gap = make_gap(p, decay)
    spare = np.empty(air_scratch_size(x, p))
    middle = np.empty_like(spare)
    set_pins(x, v, t, p)
    accelerate(x, v, t, p, False, f, a)
    for s in range(steps):
        now, odd = t + s * h, is_odd(t, h, s)
        if with_account:
            add_power(x, v, now, p, False, 0.5 * h, ledger)
        if s == 0 or not merged:
            kick(x, v, a, now, 0.5 * h, decay, room, p, odd, False, with_account, ledger)
        remember_places(x, p, True)
        drift(x, v, h, p, f, spare, middle, with_account, ledger)
        set_pins(x, v, now + h, p)
        keep_apart(x, v, now + h, p, with_account, ledger)
        accelerate(x, v, now + h, p, False, f, a)
        if merged and s + 1 < steps:
            cross_gap(v, a, 0.5 * h, gap, p, not odd)
            continue
        kick(x, v, a, now + h, 0.5 * h, decay, room, p, not odd, True, with_account, ledger)
        if with_account:
            add_power(x, v, now + h, p, False, 0.5 * h, ledger)
    return steps + 1


RECORD = Integrator(
    "leapfrog", 2, True, 1, stable_step, advance,
    "The best choice in real time: second order for one force evaluation.", changes,
)  # fmt: skip
