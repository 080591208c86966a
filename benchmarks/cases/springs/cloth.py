"""Run time and force evaluations against error on the cloth C(n), with a ladder of steps for every integrator.

C(n): n x n particles, 1 m, 1 kg, level, four corners pinned; structural springs 981, shear 490, bend 98 N/m, damping
0.002 N s/m each; 0.25 s from rest. Errors are the largest distance of any particle from the reference at the end.

Explicit methods take steps at fractions of their critical step; methods without one take a ladder of step counts. Some
rungs are left out, with the reason in their row: they would take too long, they diverge, or the reference is too
inexact for their error.

All sizes take some five minutes; `--quick` (32 x 32 particles, rungs of up to a quarter of a second) ten seconds.
"""

import dataclasses
import functools
import math
import statistics
from collections import Counter
from typing import Any

import numpy as np
from rich.progress import track

from app.scenes.timer import effort_clock
from app.study.tables import front
from benchmarks.reference import RESOLUTION, Positions, Reference, largest_distances
from benchmarks.timing import processor_time
from sim.frames import steps_for
from sim.springs import INTEGRATORS, Net, cloth
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

DURATION = 0.25  # [s]
STEP_LADDER = (0.95, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.025)  # time steps over the critical step
STEP_COUNTS = (8, 32, 128, 512, 2048, 8192)  # of methods that have no critical step
METHODS = tuple(name for name, record in INTEGRATORS.items() if not record.undamped_only)
MEASURED = ("force evaluations", "time [ms]", "least [ms]", "x real time", "error [m]", "reference good to [m]")
MAX_ERROR = 0.5  # [m] beyond this the motion is a different one


def benchmark_cloth(
    n: int, damping_model: str = "isotropic", stiffness: float = 981.0, pinned: str = "all corners"
) -> Net:
    """The cloth of C(n): particles and links are equal, as the peers take one number. stiffness: structural [N/m]."""
    net = cloth(n, n, 1.0, 1.0, 1.0, stiffness, 490.0, 98.0, 0.002, pinned=pinned, damping_model=damping_model)
    return dataclasses.replace(net, mass=1.0 / (n * n), mass_ratios=None, side_ratio=1.0)


def run(net: Net, name: str, steps: int) -> State:
    """The state after the whole motion, in one call."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], DURATION / steps, steps)
    return state


def positions(net: Net, name: str, steps: int) -> Positions:
    """Positions (3, n, n) [m] at the end."""
    return (run(net, name, steps).x,)


def expected_time(net: Net, name: str, steps: int) -> float:
    """Estimated time of the whole motion [s], from its first sixteenth, the easiest part for an iterative solver."""
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


def ladder(net: Net, name: str, truth: Reference, max_time: float, timing: float) -> list[dict[str, Any]]:
    """Rungs from coarse to fine, each timed for `timing` [s] or five times; none that takes over `max_time` [s]."""
    n, found = net.shape[0], []
    run(net, name, 1)  # loads the kernel
    for steps in step_counts(net, name):
        row: dict[str, Any] = {"task": f"C({n})", "method": name, "steps": steps, **dict.fromkeys(MEASURED)}
        found.append(row)
        expected = expected_time(net, name, steps)
        if expected > max_time:
            row["left out"] = f"over {max_time:g} s"
            if not INTEGRATORS[name].implicit:
                break  # finer rungs take longer, except with an iterative solver
            continue
        with np.errstate(all="ignore"):
            start = effort_clock()
            state = run(net, name, steps)
            times = [effort_clock() - start]
            (error,) = largest_distances((state.x,), truth)
        if not error < MAX_ERROR:
            row["left out"] = "diverged"
            continue
        if error < RESOLUTION * truth.uncertainty:
            row["left out"] = "finer than the reference can tell"
            break
        while len(times) < 5 and sum(times) < timing:
            times.append(processor_time(functools.partial(run, net, name, steps)))
        measured = (state.force_evals, 1e3 * statistics.median(times), 1e3 * min(times), DURATION / min(times), error)
        row |= dict(zip(MEASURED, (*measured, truth.uncertainty), strict=True))
    return found


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every method's ladder at each size; quick: the smallest cloth, shorter rungs, fewer repeats."""
    table, truths = [], {}
    tasks = [(n, name) for n in ((32,) if quick else (32, 64, 128)) for name in METHODS]
    for n, name in track(tasks, "cloth", transient=True):
        net = benchmark_cloth(n)
        if n not in truths:
            truths[n] = reference(net)
        table += ladder(net, name, truths[n], *((0.25, 0.1) if quick else (5.0, 1.0)))
    return table


def by_task(table: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """The rows of each task."""
    return {task: [row for row in table if row["task"] == task] for task in dict.fromkeys(row["task"] for row in table)}


def is_point(row: dict[str, Any]) -> bool:
    """True if a rung was measured."""
    return "left out" not in row


def findings(table: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Summary of the ladders: the reference's error, the front of time against error, and the methods left out."""
    found = []
    for task, own in by_task(table).items():
        points = [row for row in own if is_point(row)]
        omitted = Counter((row["left out"], row["method"]) for row in own if not is_point(row))
        reasons = dict.fromkeys(reason for reason, _ in omitted)
        found.append(
            {
                "task": task,
                "two references differ by [m]": points[0]["reference good to [m]"],
                "on the front of time against error": ", ".join(front(points)),
                "rungs left out": "; ".join(
                    f"{reason}: " + ", ".join(method for why, method in omitted if why == reason) for reason in reasons
                ),
            }
        )
    return found


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """Work-precision diagrams by file name, one for each size."""
    from app.study.tables import work_precision

    return {
        f"cloth_{task.strip('C()')}": work_precision(
            [row for row in own if is_point(row)],
            f"Cloth of {task.strip('C()')} x {task.strip('C()')} particles, 0.25 s",
        )
        for task, own in by_task(table).items()
    }
