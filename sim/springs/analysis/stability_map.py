"""Maps of stability over the time step: a spring network at rest, disturbed and run, beside theory.

Theory is its critical step, and the step up to which the method is right.
A map has a row for each network, as of a range of stiffnesses. It is measured and drawn row after row.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.numerics.root import narrowed
from sim.springs.analysis.growth import STABLE, outcome
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.integrators import Integrator
from sim.springs.net import Net
from sim.springs.stability import accurate_step, critical_step
from sim.springs.state import State

LIMIT_RESOLUTION = 1.005  # ratio of two steps between which a limit is located
LOWEST_STEP = 0.3  # of the first step, at which the search begins if that grows already
LONGER = 16  # times as many steps tell at the limit as at a step of the map: growth is slow there


class MapRow(NamedTuple):
    """One network of a map."""

    outcomes: NDArray[np.int64]  # (steps,) STABLE, BOUNDED_GROWTH or EXPLODING
    measured: float  # step [s] at which a disturbance begins to grow; inf: none does; NaN: not located
    critical: float  # critical_step [s]
    accurate: float  # accurate_step [s]


def map_row(
    method: Integrator, net: Net, steps: NDArray[np.float64], max_steps: int, *, locate: bool = False
) -> MapRow:
    """Growth of a small disturbance of a network at rest at each of `steps` (n,) [s], ascending.

    max_steps: of a run that neither grows nor decays. locate: find the step at which growth begins, too. Raises
    ConvergenceError if the network does not come to rest.
    """
    state = State.at_rest(net)
    state.x[:] = find_rest_positions(net)
    outcomes = np.array([outcome(method, net, float(h), state.x, max_steps) for h in steps])
    measured = math.nan
    if locate:
        measured = located(
            steps, outcomes != STABLE, lambda h: outcome(method, net, h, state.x, LONGER * max_steps) != STABLE
        )
    return MapRow(outcomes, measured, critical_step(net, method, state), accurate_step(net, method, state))


def located(steps: NDArray[np.float64], grows: NDArray[np.bool_], grows_at: Callable[[float], bool]) -> float:
    """The step [s] at which growth begins: the first of ascending `steps` (n,) that grows, refined; inf if none does.

    grows: (n,) of the steps. grows_at: of any other step.
    """
    if not grows.any():
        return math.inf
    first = int(grows.argmax())
    return limit_between(
        float(steps[first - 1]) if first else LOWEST_STEP * float(steps[0]), float(steps[first]), grows_at
    )


def limit_between(low: float, high: float, grows_at: Callable[[float], bool]) -> float:
    """The step [s] between a stable one and one that grows, to `LIMIT_RESOLUTION`."""
    ends = narrowed(
        lambda s: 1.0 if grows_at(math.exp(s)) else -1.0, math.log(low), math.log(high), math.log(LIMIT_RESOLUTION)
    )
    return math.exp(0.5 * sum(ends))
