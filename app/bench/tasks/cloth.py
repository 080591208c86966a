"""The cloth task C(n), its reference, and our ladders of runs.

C(n): n x n particles, 1 m, 1 kg, level, four corners pinned; structural springs 981, shear 490, bend 98 N/m, damping
0.002 N s/m each; 0.25 s from rest. Errors are the largest distance of any particle from the reference at the end.
"""

import functools
import math

from app.bench.own_runs import OwnRun, Positions, Reference, largest_distances
from app.bench.timing import processor_time
from sim.springs import INTEGRATORS, Net, cloth
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

DURATION = 0.25  # [s]
STEP_LADDER = (0.95, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.025)  # time steps over the critical step
STEP_COUNTS = (8, 32, 128, 512, 2048, 8192)  # of methods that have no critical step
# Methods that may be quickest at the error of a peer.
QUICK_METHODS = ("leapfrog_lagged", "leapfrog", "rk4", "dopri5", "dop853", "symplectic_euler")


def benchmark_cloth(n: int, damping_model: str = "isotropic") -> Net:
    """The cloth of C(n)."""
    return cloth(
        n, n, 1.0, 1.0, 1.0, 981.0, 490.0, 98.0, 0.002, pinned="all corners", damping_model=damping_model
    )  # fmt: skip


def run(net: Net, name: str, steps: int) -> State:
    """The state after the whole motion, in one call."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], DURATION / steps, steps)
    return state


def positions(net: Net, name: str, steps: int) -> Positions:
    """Positions (3, n, n) [m] at the end."""
    return (run(net, name, steps).x,)


def expected_time(net: Net, name: str, steps: int) -> float:
    """About how long the whole motion takes [s], from its first sixteenth: for a solver that iterates, the easiest."""
    state, first = State.at_rest(net), math.ceil(steps / 16)
    return processor_time(lambda: advance(net, state, INTEGRATORS[name], DURATION / steps, first)) * steps / first


def reference(net: Net) -> Reference:
    """dop853 at a quarter of its critical step; its uncertainty is the distance to dopri5 at a fifth of its own."""
    one, other = (
        positions(net, name, steps_for(DURATION, fraction * critical_step(net, name)))
        for name, fraction in (("dop853", 0.25), ("dopri5", 0.2))
    )
    return Reference(one, largest_distances(one, Reference(other, 0.0))[0])


def step_counts(net: Net, name: str) -> list[int]:
    """The steps of a method's ladder, coarse to fine."""
    critical = critical_step(net, name)
    if math.isinf(critical):
        return list(STEP_COUNTS)
    return [steps_for(DURATION, fraction * critical) for fraction in STEP_LADDER]


def ladders(net: Net) -> list[list[OwnRun]]:
    """Our runs of the task, a ladder for each quick method; their kernels are loaded."""
    found = []
    for name in QUICK_METHODS:
        run(net, name, 1)
        found.append(
            [
                OwnRun(
                    name,
                    f"{steps} steps",
                    functools.partial(positions, net, name, steps),
                    functools.partial(expected_time, net, name, steps),
                )
                for steps in step_counts(net, name)
            ]
        )
    return found
