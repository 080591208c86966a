"""The cloth task, C(n), its reference, and our ladders of steps on it.

C(n): n x n particles, 1 m, 1 kg, level, four corners pinned; structural springs 981, shear 490, bend 98 N/m, damping
0.002 N s/m each; 0.25 s from rest. Errors are the largest distance of any particle from the reference at the end.
"""

import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.springs import INTEGRATORS, Net, cloth
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

END = 0.25  # [s]
LADDER = (0.95, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.025)  # of the critical step
LONG = (8, 32, 128, 512, 2048, 8192)  # steps of methods without one
FLOOR = 10.0  # errors within so many times of the reference's own say nothing


class Reference(NamedTuple):
    """Positions (3, n, n) [m] at the end, and how far they may be off [m]."""

    x: NDArray[np.float64]
    uncertainty: float


def task_cloth(n: int, damping_model: str = "isotropic") -> Net:
    """C(n)."""
    return cloth(
        n, n, 1.0, 1.0, 1.0, 981.0, 490.0, 98.0, 0.002, pinned="all corners", damping_model=damping_model
    )  # fmt: skip


def run(net: Net, name: str, steps: int) -> State:
    """The whole motion in one call."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], END / steps, steps)
    return state


def seconds(call: Callable[[], Any]) -> float:
    """Processor time, which what else runs on the machine does not lengthen."""
    start = time.thread_time()
    call()
    return time.thread_time() - start


def expected(net: Net, name: str, steps: int) -> float:
    """About how long the whole motion takes [s], by its first sixteenth: of a solver that iterates, the easiest."""
    state, first = State.at_rest(net), math.ceil(steps / 16)
    return seconds(lambda: advance(net, state, INTEGRATORS[name], END / steps, first)) * steps / first


def reference(net: Net) -> Reference:
    """dop853 at a quarter of its critical step, taken to be as good as dopri5 at a fifth of its own agrees with it."""
    one, other = (
        run(net, name, steps_for(END, part * critical_step(net, name))).x
        for name, part in (("dop853", 0.25), ("dopri5", 0.2))
    )
    return Reference(one, error_of(one, Reference(other, 0.0)))


def error_of(x: NDArray[np.float64], truth: Reference) -> float:
    """Largest distance [m] of any particle; not finite where the run diverged."""
    return float(np.linalg.norm(x - truth.x, axis=0).max())


def steps_of(net: Net, name: str) -> list[int]:
    """The rungs of a method, coarse to fine."""
    critical = critical_step(net, name)
    if math.isinf(critical):
        return list(LONG)
    return [steps_for(END, fraction * critical) for fraction in LADDER]
