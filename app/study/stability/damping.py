"""The limit of the step over damping, none to far beyond critical: measured in runs, beside `critical_step`."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.study.pool import spread
from sim.springs import INTEGRATORS, Net, cloth, rope
from sim.springs.analysis.growth import STABLE, outcome, step_growth
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.analysis.stability_map import limit_between
from sim.springs.integrators import Integrator
from sim.springs.stability import critical_step, top_modes
from sim.springs.state import State

MAX_DAMPING = 1e5  # [N s/m], the end of the slider
REST_DAMPING = 7.0  # [N s/m] at which a network comes to rest soon; the rest position depends on no damping
FIRST, LAST = 0.2, 3.0  # of critical_step, between which growth is looked for
COARSE = 1.2  # ratio of two steps that are tried
GROWS = 1e-7  # a step, above round-off
UNLIMITED = (0.01, 0.1, 1.0)  # steps [s] at which methods without a limit are tried
NEVER_STABLE = 0.02  # h omega at which a method that is never stable is seen to grow


def networks() -> dict[str, Callable[[float, float], Net]]:
    """Networks of a few points by name, each from its damping [N s/m] and drag [N s/m]."""
    return {
        "rope": lambda b, drag: rope(6, damping=b, drag=drag),
        "rope, axial damping": lambda b, drag: rope(6, damping=b, drag=drag, damping_model="axial"),
        "cloth": lambda b, drag: cloth(3, 4, damping=b, drag=drag),
    }


class DampingRow(NamedTuple):
    """The limits of one integrator and network over damping."""

    net: str
    name: str
    dampings: NDArray[np.float64]  # (n,) [N s/m]
    measured: NDArray[np.float64]  # (n,) [s]; inf: nothing grows; 0: growth at every step; NaN: damping is refused
    theory: NDArray[np.float64]  # (n,) [s] critical_step


def at_rest(name: str, damping: float) -> tuple[Net, State]:
    """A network at rest. Without damping it has no drag either, so that nothing damps."""
    make = networks()[name]
    net = make(damping, 1.0 if damping > 0.0 else 0.0)
    state = State.at_rest(net)
    state.x[:] = find_rest_positions(make(REST_DAMPING, 1.0))
    return net, state


def measured_step(record: Integrator, net: Net, state: State, theory: float) -> float:
    """The step [s] at which a small disturbance of a network at rest begins to grow, 0 or infinity too."""
    if math.isinf(theory):
        tried = [outcome(record, net, h, state.x, 1 << 10) for h in UNLIMITED]
        return UNLIMITED[[verdict != STABLE for verdict in tried].index(True)] if any(tried) else math.inf
    if theory == 0.0:
        h = NEVER_STABLE / max(mode.omega for mode in top_modes(net, state.x))
        return 0.0 if step_growth(record, net, h, state.x) > GROWS else h
    h = FIRST * theory
    while step_growth(record, net, h, state.x) <= GROWS:
        h *= COARSE
        if h > LAST * theory:
            return math.inf
    return limit_between(h / COARSE, h, lambda middle: step_growth(record, net, middle, state.x) > GROWS)


def limits(net_name: str, name: str, damping: float) -> tuple[float, float]:
    """(measured limit [s], critical_step [s]); NaN if the method refuses the damping."""
    record = INTEGRATORS[name]
    net, state = at_rest(net_name, damping)
    if record.undamped_only and net.is_damped:
        return math.nan, math.nan
    theory = critical_step(net, name, state)
    return measured_step(record, net, state, theory), theory


def measure(quick: bool = False, workers: int = 0) -> list[DampingRow]:
    """All integrators and networks. workers: processes, 0 for one on each core."""
    dampings = np.array([0.0, *(np.geomspace(10.0, MAX_DAMPING, 3) if quick else np.geomspace(1.0, MAX_DAMPING, 11))])
    pairs = [(net, name) for net in networks() for name in INTEGRATORS]
    step_pairs = spread(limits, [(*pair, float(b)) for pair in pairs for b in dampings], "step and damping", workers)
    table = np.array(step_pairs).reshape(len(pairs), len(dampings), 2)
    return [DampingRow(*pair, dampings, *values.T) for pair, values in zip(pairs, table, strict=True)]


def deviations(row: DampingRow) -> NDArray[np.float64]:
    """Relative distance (n,) of the measured limit from theory: 0 if neither has one, NaN where damping is refused."""
    equal = row.measured == row.theory
    either = np.where(equal, 1.0, row.theory)
    return np.where(equal, 0.0, np.abs(np.where(equal, 1.0, row.measured) / np.where(either > 0.0, either, 1e-9) - 1.0))


def rows(damping_rows: list[DampingRow]) -> list[dict[str, Any]]:
    """The table: how far `critical_step` is from the measured limit, for each network and integrator."""
    table = []
    for row in damping_rows:
        apart = deviations(row)
        table.append(
            {
                "network": row.net,
                "integrator": row.name,
                "step off at most [%]": 100.0 * float(np.nanmax(apart)),
                "at damping [N s/m]": float(row.dampings[int(np.nanargmax(apart))]),
            }
        )
    return table


def curve_rows(damping_rows: list[DampingRow]) -> list[dict[str, Any]]:
    """The measured limit and `critical_step`, for each network, integrator and damping."""
    return [
        {
            "network": row.net,
            "integrator": row.name,
            "damping [N s/m]": float(b),
            "step measured [s]": float(a),
            "critical_step [s]": float(c),
        }
        for row in damping_rows
        for b, a, c in zip(row.dampings, row.measured, row.theory, strict=True)
        if not math.isnan(a)
    ]
