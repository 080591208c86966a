"""Run time and force evaluations against error on the benchmark cloth, with a ladder of steps for every integrator.

Explicit methods take steps at fractions of their critical step; methods without one take a ladder of step counts. Some
rungs are left out, and their row says why: they would take too long, they diverge, or the reference is not good enough
to tell their error. With `--peers`, each peer is compared with our quickest run at its error or less, on one thread.

All sizes take some five minutes; `--quick` (32 x 32 particles, rungs of up to a quarter of a second) ten seconds.
"""

import functools
import statistics
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.progress import track

from app.bench.own_runs import RESOLUTION, OwnRuns, Reference, largest_distances
from app.bench.peers.cloth import SCRIPTS
from app.bench.peers.cloth_engines import ENGINES, OTHER_TASKS
from app.bench.peers.ladder import Task
from app.bench.peers.ladder import tables as peer_ladders
from app.bench.tasks.cloth import (
    DURATION,
    benchmark_cloth,
    expected_time,
    ladders,
    reference,
    run,
    step_counts,
)
from app.bench.timing import processor_time
from app.experiments.tables import Rows, front
from sim.springs import INTEGRATORS, Net

METHODS = tuple(name for name, record in INTEGRATORS.items() if not record.undamped_only)
MEASURED = ("force evaluations", "time [ms]", "least [ms]", "x real time", "error [m]", "reference good to [m]")
MAX_ERROR = 0.5  # [m] a larger one means another motion altogether
PEERS = SCRIPTS + ENGINES


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
                break  # finer rungs take longer, except with a solver that iterates
            continue
        with np.errstate(all="ignore"):
            start = time.thread_time()
            state = run(net, name, steps)
            times = [time.thread_time() - start]
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
    """Whether a rung was measured."""
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
    """Work-precision diagrams by file name, one for each size."""
    from app.experiments.tables import work_precision

    return {
        f"cloth_{task.strip('C()')}": work_precision(
            [row for row in own if is_point(row)],
            f"Cloth of {task.strip('C()')} x {task.strip('C()')} particles, 0.25 s",
        )
        for task, own in by_task(table).items()
    }


def peer_task(n: int, damping: str) -> Task:
    """The cloth task by this damping model, with our own runs of it."""
    net = benchmark_cloth(n, damping)
    return Task(net, (DURATION,), OwnRuns(ladders(net), reference(net)))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers, and programs that cannot be given the task; quick: two sizes, every second rung."""
    table = peer_ladders("C", (32, 64, 128), PEERS, peer_task, words, quick)
    return table + [{"task": "another", "peer": name, "note": why} for name, why in OTHER_TASKS.items() if not words]
