"""Run time and force evaluations against error on the benchmark cloth, every integrator a ladder of steps.

Explicit methods take a ladder of fractions of their critical step, those that have none a ladder of steps. The
reference is dop853, as good as another method, dopri5, agrees with it. A rung that would take too long, that diverges,
or whose error the reference cannot tell is left out, and its row says so. `--peers` runs
`app.bench.peers.cloth_rivals`.

The whole takes some five minutes; `--quick`, 32 x 32 particles and rungs of up to a quarter of a second, ten seconds.
"""

import statistics
import time
from collections import Counter
from typing import Any

import numpy as np
from rich.progress import track

from app.bench.peers.cloth_rivals import peer_rows
from app.bench.tasks.cloth_task import (  # fmt: skip
    END,
    FLOOR,
    Reference,
    error_of,
    expected,
    reference,
    run,
    seconds,
    steps_of,
    task_cloth,
)
from app.experiments.tables import front
from sim.springs import INTEGRATORS, Net

__all__ = ["figures", "findings", "peer_rows", "rows"]

METHODS = tuple(name for name, record in INTEGRATORS.items() if not record.undamped_only)
MEASURED = ("force evaluations", "time [ms]", "least [ms]", "x real time", "error [m]", "reference good to [m]")
LOST = 0.5  # [m]: another motion altogether


def ladder(net: Net, name: str, truth: Reference, most: float, enough: float) -> list[dict[str, Any]]:
    """Rungs from coarse to fine, each timed again until `enough` [s] or five times; none that takes over `most` [s]."""
    n, found = net.shape[0], []
    run(net, name, 1)  # loads the kernel
    for steps in steps_of(net, name):
        row: dict[str, Any] = {"task": f"C({n})", "method": name, "steps": steps, **dict.fromkeys(MEASURED)}
        found.append(row)
        about = expected(net, name, steps)
        if about > most:
            row["left out"] = f"over {most:g} s"
            if not INTEGRATORS[name].implicit:
                break  # finer ones take longer; of a solver that iterates, not always
            continue
        with np.errstate(all="ignore"):
            start = time.thread_time()
            state = run(net, name, steps)
            times = [time.thread_time() - start]
            error = error_of(state.x, truth)
        if not error < LOST:
            row["left out"] = "diverged"
            continue
        if error < FLOOR * truth.uncertainty:
            row["left out"] = "finer than the reference can tell"
            break
        while len(times) < 5 and sum(times) < enough:
            times.append(seconds(lambda steps=steps: run(net, name, steps)))
        measured = (state.force_evals, 1e3 * statistics.median(times), 1e3 * min(times), END / min(times), error)
        row |= dict(zip(MEASURED, (*measured, truth.uncertainty), strict=True))
    return found


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every method's ladder at each size; quick: the smallest cloth, shorter rungs, fewer repeats."""
    table, truths = [], {}
    tasks = [(n, name) for n in ((32,) if quick else (32, 64, 128)) for name in METHODS]
    for n, name in track(tasks, "cloth", transient=True):
        net = task_cloth(n)
        if n not in truths:
            truths[n] = reference(net)
        table += ladder(net, name, truths[n], *((0.25, 0.1) if quick else (5.0, 1.0)))
    return table


def by_task(table: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    return {task: [row for row in table if row["task"] == task] for task in dict.fromkeys(row["task"] for row in table)}


def is_point(row: dict[str, Any]) -> bool:
    return "left out" not in row


def findings(table: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """What the ladders say: the reference's own error, the front of time against error, and what was left out."""
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
    """WorkCount-precision diagrams by file name, one for each size."""
    from app.experiments.tables import work_precision

    return {
        f"cloth_{task.strip('C()')}": work_precision(
            [row for row in own if is_point(row)],
            f"Cloth of {task.strip('C()')} x {task.strip('C()')} particles, 0.25 s",
        )
        for task, own in by_task(table).items()
    }
