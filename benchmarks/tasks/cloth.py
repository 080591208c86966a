"""The cloth C(n) of `benchmarks/cases/springs/cloth.py` as a task of peers. Ours run on one thread."""

import functools
from collections.abc import Sequence

from app.formats.text_tables import Rows
from benchmarks.cases.springs.cloth import (
    DURATION,
    benchmark_cloth,
    expected_time,
    positions,
    reference,
    run,
    step_counts,
)
from benchmarks.peers.cloth import SCRIPTS
from benchmarks.peers.cloth_engines import ENGINES, OTHER_TASKS
from benchmarks.peers.ladder import Task, tables
from benchmarks.peers.own_runs import OwnRun, OwnRuns
from sim.springs import Net

# Methods that may be the quickest at a peer's error.
QUICK_METHODS = ("leapfrog_lagged", "leapfrog", "rk4", "dopri5", "dop853", "symplectic_euler")


def ladders(net: Net, methods: Sequence[str] = QUICK_METHODS) -> list[list[OwnRun]]:
    """Our runs of the task, a ladder for each method; their kernels are loaded."""
    found = []
    for name in methods:
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


def peer_task(n: int, damping: str) -> Task:
    """The cloth task by this damping model, with our own runs of it."""
    net = benchmark_cloth(n, damping)
    return Task(net, (DURATION,), OwnRuns(ladders(net), reference(net)))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers, and programs that cannot do the task; quick: two sizes, every second rung."""
    table = tables("C", (32, 64, 128), SCRIPTS + ENGINES, peer_task, words, quick)
    return table + [{"task": "another", "peer": name, "note": why} for name, why in OTHER_TASKS.items() if not words]
