"""The cloth task C(n): our quickest run at the error of each peer or less, the two timed in turn.

Ours is one thread. Times are wall times of the whole 0.25 s, the least of repeats. A peer that damps along the links
only is held against the reference of that model. What cannot be given the same task is listed with the reason.
"""

import functools
import math
import time
from typing import Any, NamedTuple

from rich.progress import track

from app.bench.installed import why_left_out
from app.bench.peers.cloth_engines import ENGINES, OTHER_TASKS
from app.bench.peers.cloth_peers import PEERS
from app.bench.tasks.cloth_task import END, FLOOR, Reference, error_of, expected, reference, run, steps_of, task_cloth
from app.bench.timing import in_turn
from sim.springs import Net
from sim.springs.stability import critical_step

PEER_STEP = 0.8  # of leapfrog's critical step, which peers take that have none of their own
BEST = ("leapfrog_lagged", "leapfrog", "rk4", "dopri5", "dop853", "symplectic_euler")  # that a peer may have to face


class Best(NamedTuple):
    seconds: float
    name: str
    steps: int
    error: float  # [m]


class Tried:
    """What our runs of one net err and take, each worked out when first asked for."""

    def __init__(self, net: Net, truth: Reference) -> None:
        self.net, self.truth = net, truth
        self.known: dict[tuple[str, int], tuple[float, float]] = {}
        for name in BEST:
            run(net, name, 1)  # loads the kernel

    def result(self, name: str, steps: int, most: float) -> tuple[float, float]:
        """Seconds and error [m]; NaN for one that would take far over `most` [s]."""
        if (name, steps) not in self.known:
            about = expected(self.net, name, steps)
            if about > 2.0 * most:
                return about, math.nan
            start = time.thread_time()
            x = run(self.net, name, steps).x
            self.known[name, steps] = time.thread_time() - start, error_of(x, self.truth)
        return self.known[name, steps]

    def cheapest(self, limit: float) -> Best | None:
        """Our quickest run with an error of at most `limit` [m]; None where none on the ladders is."""
        best = Best(math.inf, "", 0, math.nan)
        for name in BEST:
            for steps in steps_of(self.net, name):
                took, error = self.result(name, steps, best.seconds)
                if took >= best.seconds or error < FLOOR * self.truth.uncertainty:
                    break
                if error <= limit:
                    best = Best(took, name, steps, error)
                    break
        return best if best.name else None


def peer_rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every peer that is installed, at each size; quick: the smallest."""
    table: list[dict[str, Any]] = []
    sizes = (32,) if quick else (32, 64, 128)
    tried: dict[tuple[int, str], Tried] = {}
    for n, peer in track([(n, peer) for n in sizes for peer in PEERS + ENGINES], "cloth peers", transient=True):
        row: dict[str, Any] = {"task": f"C({n})", "peer": peer.name, "damping": peer.damping}
        table.append(row)
        if absent := why_left_out(peer.package, n, peer.largest):
            row["note"] = absent
            continue
        if (n, peer.damping) not in tried:
            net = task_cloth(n, peer.damping)
            tried[n, peer.damping] = Tried(net, reference(net))
        ours = tried[n, peer.damping]
        step = peer.step or PEER_STEP * critical_step(ours.net, "leapfrog")
        theirs_run = peer.make(ours.net, step)
        theirs_run(2.0 * step)  # compiles
        error = error_of(theirs_run(END), ours.truth)
        row |= {"step [us]": 1e6 * step, "error [m]": error}
        if not error < 1.0:
            row["note"] = "diverged"
            continue
        best = ours.cheapest(error)
        calls: list[functools.partial[Any]] = [functools.partial(theirs_run, END)]
        if best is not None:
            calls.append(functools.partial(run, ours.net, best.name, best.steps))
        theirs, *own = in_turn(calls, 5 if quick else 9, enough=10.0)
        row["peer [ms]"] = 1e3 * min(theirs)
        if best is None:
            row["note"] = "no rung of ours is as exact"
            continue
        row |= {
            "ours": best.name,
            "our steps": best.steps,
            "ours [ms]": 1e3 * min(own[0]),
            "our error [m]": best.error,
            "times as long as ours": min(theirs) / min(own[0]),
        }
    return table + [{"task": "another", "peer": name, "note": why} for name, why in OTHER_TASKS.items()]
