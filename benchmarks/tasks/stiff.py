"""A stiff cloth S(n) as a task of peers: C(n) with structural springs of 1e5 N/m, held along one edge.

From level it swings down, stretched. Held at its corners it would buckle, and runs that hardly differ would part.
"""

from collections.abc import Sequence

from app.formats.text_tables import Rows
from benchmarks.cases.springs.cloth import DURATION, benchmark_cloth, reference
from benchmarks.peers.cloth_engines import ENGINES
from benchmarks.peers.ladder import Task, tables
from benchmarks.peers.own_runs import OwnRuns
from benchmarks.tasks.cloth import QUICK_METHODS, ladders
from sim.springs import INTEGRATORS

STIFFNESS = 1e5  # [N/m]
METHODS = (*(name for name, record in INTEGRATORS.items() if record.implicit), *QUICK_METHODS)


def peer_task(n: int, damping: str) -> Task:
    """The stiff cloth by this damping model, with our own runs of it."""
    net = benchmark_cloth(n, damping, STIFFNESS, "edge")
    return Task(net, (DURATION,), OwnRuns(ladders(net, METHODS), reference(net)))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of engines; quick: the smaller cloth, every second rung."""
    return tables("S", (32, 64), ENGINES, peer_task, words, quick)
