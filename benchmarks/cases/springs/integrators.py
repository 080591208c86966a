"""Every integrator: its declared properties, and the cost of a step on the lab's rope.

Ropes of 10 and 100 points that have swung for 0.3 s, with the lab's parameters and steps of 1/480 s; methods for
undamped ropes run without damping. Times are the least of repeats in turns.
"""

import dataclasses
import math
import time
from typing import Any

from sim.springs import INTEGRATORS, Net, rope
from sim.springs.integrators import Integrator
from sim.springs.state import State, advance

POINTS = (10, 100)
STEP = 1 / 480  # [s]
WARMUP_STEPS = 144  # before the timing
EVALUATIONS_PER_RUN = 40_000  # of the force on one point, in a timed run


class Timed:
    """One method on one rope: seconds and force evaluations of a step."""

    def __init__(self, record: Integrator, points: int) -> None:
        net = rope(points)
        if record.undamped_only:
            links = tuple(f._replace(damping=0.0) for f in net.families)
            net = dataclasses.replace(net, families=links, drag=0.0)
        self.net: Net = net
        self.record = record
        self.state = State.at_rest(net)
        advance(net, self.state, record, STEP, WARMUP_STEPS)
        self.steps = max(10, EVALUATIONS_PER_RUN // (points * record.evals * (10 if record.implicit else 1)))
        self.least = float("inf")  # [s] a step
        self.evals = 0.0  # a step

    def run(self) -> None:
        """Time some steps, and keep the least time."""
        state = self.state.copy()
        before = state.force_evals
        start = time.perf_counter()
        advance(self.net, state, self.record, STEP, self.steps)
        self.least = min(self.least, (time.perf_counter() - start) / self.steps)
        self.evals = (state.force_evals - before) / self.steps


def limit(record: Integrator, zeta: float) -> str:
    """The largest stable h omega at a damping ratio, in words."""
    value = record.limit(zeta)
    return "any" if math.isinf(value) else f"{value:.3g}"


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """A row a method: order, limits, symplectic, force evaluations and time a step."""
    timed = {(name, points): Timed(record, points) for name, record in INTEGRATORS.items() for points in POINTS}
    for _ in range(5 if quick else 100):
        for each in timed.values():
            each.run()
    table = []
    for name, record in INTEGRATORS.items():
        row: dict[str, Any] = {
            "method": name,
            "order": record.order,
            "undamped": record.undamped_order or record.order,
            "limit, ζ = 0": limit(record, 0.0),
            "limit, ζ = 0.25": "" if record.undamped_only else limit(record, 0.25),
            "symplectic": "yes" if record.symplectic else "",
            "evaluations a step": round(timed[name, POINTS[0]].evals, 2),
        }
        for points in POINTS:
            row[f"{points} points [µs a step]"] = 1e6 * timed[name, points].least
        table.append(row)
    return table
