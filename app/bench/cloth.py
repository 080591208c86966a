"""Run time against error on the benchmark cloth, every method that applies, and what a user would pick instead.

C(n): n x n particles, 1 m, 1 kg, level, four corners pinned; structural springs 981, shear 490, bend 98 N/m, damping
0.002 N s/m each. Errors are the largest distance of any particle from the reference at t = 0.25 s. Explicit methods
take a ladder of fractions of their critical step, implicit ones, which have none, a ladder of steps.
"""

import math
import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.bench.installed import is_installed
from sim.springs import INTEGRATORS, Net, cloth
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

END = 0.25  # [s]
METHODS = tuple(name for name, record in INTEGRATORS.items() if not record.undamped_only)
LADDER = (0.95, 0.6, 0.4, 0.2, 0.1, 0.05, 0.025)  # of the critical step
LONG = (8, 16, 32, 64, 128, 256, 512)  # steps of methods without one
PEER_STEP = 0.8  # of leapfrog's critical step, which peers take
BEST = ("symplectic_euler", "leapfrog", "rk4", "dopri5", "dop853")  # those that a peer may have to face


class Reference(NamedTuple):
    """Positions (3, n, n) [m] at the end, and how far they may be off [m]."""

    x: NDArray[np.float64]
    uncertainty: float


def task_cloth(n: int) -> Net:
    """C(n)."""
    return cloth(n, n, 1.0, 1.0, 1.0, 981.0, 490.0, 98.0, 0.002, pinned="all corners")


def run(net: Net, name: str, steps: int) -> State:
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], END / steps, steps)
    return state


def reference(net: Net) -> Reference:
    """dop853 at a quarter of its critical step, and its distance from RK4, another method, far below its own."""
    x = run(net, "dop853", steps_for(END, 0.25 * critical_step(net, "dop853"))).x
    other = run(net, "rk4", steps_for(END, 0.05 * critical_step(net, "rk4"))).x
    return Reference(x, float(np.abs(x - other).max()))


def error_of(x: NDArray[np.float64], truth: Reference) -> float:
    """Largest distance [m] of any particle."""
    return float(np.linalg.norm(x - truth.x, axis=0).max())


def steps_of(net: Net, name: str) -> list[int]:
    """The rungs of a method, coarse to fine."""
    critical = critical_step(net, name)
    if critical == 0.0:
        return list(LONG[2:])  # explicit Euler holds no undamped mode; short runs end before it shows
    if math.isinf(critical):
        return list(LONG)
    return [steps_for(END, fraction * critical) for fraction in LADDER]


def seconds(call: Callable[[], Any]) -> float:
    """Processor time, which what else runs on the machine does not lengthen."""
    start = time.thread_time()
    call()
    return time.thread_time() - start


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Each method's ladder; a method ends where its rungs take longer than is worth waiting for."""
    table = []
    for n in (32,) if quick else (32, 64, 128):
        net = task_cloth(n)
        truth = reference(net)
        for name in METHODS:
            for steps in steps_of(net, name):
                state = run(net, name, steps)
                error = error_of(state.x, truth)
                if not math.isfinite(error) or error > 1.0:
                    continue
                if error < 3.0 * truth.uncertainty:
                    break
                times = [seconds(lambda name=name, steps=steps, net=net: run(net, name, steps))]
                while len(times) < 5 and sum(times) < (0.3 if quick else 2.0):
                    times.append(seconds(lambda name=name, steps=steps, net=net: run(net, name, steps)))
                table.append(
                    {
                        "task": f"C({n})",
                        "method": name,
                        "step [us]": 1e6 * END / steps,
                        "force evaluations": state.force_evals,
                        "time [ms]": 1e3 * statistics.median(times),
                        "least [ms]": 1e3 * min(times),
                        "ns per particle-step": 1e9 * min(times) / (steps * n * n),
                        "x real time": END / min(times),
                        "error at 0.25 s [m]": error,
                        "reference good to [m]": truth.uncertainty,
                    }
                )
                if min(times) > (1.0 if quick else 8.0):
                    break
    return table


def cheapest(net: Net, truth: Reference, limit: float) -> tuple[str, int, float] | None:
    """(method, steps, error) of our quickest run with an error of at most `limit` [m], or None."""
    found = []
    for name in BEST:
        for steps in steps_of(net, name):
            error = error_of(run(net, name, steps).x, truth)
            if error <= limit:
                found.append((seconds(lambda name=name, steps=steps: run(net, name, steps)), name, steps, error))
                break
    return min(found)[1:] if found else None


def timed_in_turn(
    one: Callable[[], Any], other: Callable[[], Any], most: int, enough: float = 20.0
) -> tuple[list[float], list[float]]:
    """Wall times [s] of two calls, taken in turn, until `most` of each or `enough` seconds."""
    times: tuple[list[float], list[float]] = [], []
    while len(times[0]) < most and sum(times[0]) < enough:
        for call, own in zip((one, other), times, strict=True):
            start = time.perf_counter()
            call()
            own.append(time.perf_counter() - start)
    return times


def peer_rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every peer that is installed against our quickest run at its error or less, the two in turn, in wall time."""
    from app.bench.cloth_peers import PEERS

    table: list[dict[str, Any]] = []
    for n in (32,) if quick else (32, 64, 128):
        net = task_cloth(n)
        truth = reference(net)
        step = PEER_STEP * critical_step(net, "leapfrog")
        for peer in PEERS:
            row: dict[str, Any] = {"task": f"C({n})", "peer": peer.name}
            table.append(row)
            if not is_installed(peer.package):
                row["note"] = "not installed"
                continue
            theirs_run = peer.make(net, peer.step or step)
            error = error_of(theirs_run(END), truth)
            row |= {"step [us]": 1e6 * (peer.step or step), "error at 0.25 s [m]": error}
            best = cheapest(net, truth, error)
            if best is None:
                row["note"] = "no rung of ours is as exact"
                continue
            name, steps, own_error = best
            theirs, ours = timed_in_turn(
                lambda again=theirs_run: again(END),
                lambda net=net, name=name, steps=steps: run(net, name, steps),
                5 if quick else 9,
            )
            row |= {
                "peer [ms]": 1e3 * min(theirs),
                "ours": name,
                "our steps": steps,
                "ours [ms]": 1e3 * min(ours),
                "our error [m]": own_error,
                "times as long as ours": min(theirs) / min(ours),
            }
    return table


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """Work-precision diagrams by file name, one for each size."""
    from app.bench.report import work_precision

    tasks = list(dict.fromkeys(row["task"] for row in table))
    return {
        f"cloth_{task.strip('C()')}": work_precision(
            [row for row in table if row["task"] == task], f"Cloth {task}, 0.25 s", "error at 0.25 s [m]"
        )
        for task in tasks
    }
