"""Run time against error on the benchmark rope, ours and, on demand, what a user would pick instead.

R(N): N links, 1 m, 1 kg, EA 981 N, released horizontally, 1 s. A method is a ladder of steps, fractions of its own
critical step; its error is the largest distance of any point from the reference at t = 0.5 s and at t = 1 s. Times are
those of one call for the whole second, without the error's; medians of repeats.
"""

import dataclasses
import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.bench.kernels import task_rope
from sim.springs import INTEGRATORS, Net
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

METHODS = ("symplectic_euler", "leapfrog_lagged", "leapfrog", "rk4", "dopri5", "dop853")
LADDER = (0.95, 0.8, 0.4, 0.2, 0.1, 0.05, 0.025)  # of the critical step
REFINED = {16: 128, 128: 128, 1024: 16}  # steps of the reference within one of 0.8 times critical: good to 1e-11 m


class Reference(NamedTuple):
    """Positions (3, 1, points) [m], and how far they may be off [m]."""

    half: NDArray[np.float64]
    end: NDArray[np.float64]
    uncertainty: float


class Ours(NamedTuple):
    """One rung of a ladder, ready to run."""

    name: str
    net: Net
    h: float  # [s]
    steps: int

    def run(self) -> State:
        state = State.at_rest(self.net)
        advance(self.net, state, INTEGRATORS[self.name], self.h, self.steps)
        return state


def seconds(call: Callable[[], Any]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def refined(net: Net, h: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    state = State.at_rest(net)
    steps = steps_for(0.5, h)
    advance(net, state, INTEGRATORS["rk4"], 0.5 / steps, steps)
    half = state.x.copy()
    advance(net, state, INTEGRATORS["rk4"], 0.5 / steps, steps)
    return half, state.x


def reference(net: Net) -> Reference:
    """RK4 far below its critical step, and how far it is from twice that step, which is mostly round-off."""
    h = 0.8 * critical_step(net, "rk4") / REFINED.get(net.shape[1] - 1, 8)
    coarse, fine = refined(net, 2.0 * h), refined(net, h)
    off = max(float(np.abs(a - b).max()) for a, b in zip(coarse, fine, strict=True))
    return Reference(*fine, off)


def errors(half: NDArray[np.float64], end: NDArray[np.float64], truth: Reference) -> tuple[float, float]:
    """Largest distance [m] of any point at t = 0.5 s and t = 1 s."""
    return (
        float(np.linalg.norm(half - truth.half, axis=0).max()),
        float(np.linalg.norm(end - truth.end, axis=0).max()),
    )


def rung(net: Net, name: str, fraction: float) -> Ours:
    # An even number, so that half of them end at half a second.
    steps = 2 * steps_for(0.5, fraction * critical_step(net, name))
    return Ours(name, net, 1.0 / steps, steps)


def error_of(ours: Ours, truth: Reference) -> tuple[float, float]:
    half = ours._replace(steps=ours.steps // 2).run()
    end = half.copy()
    advance(ours.net, end, INTEGRATORS[ours.name], ours.h, ours.steps // 2)
    return errors(half.x, end.x, truth)


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Each method's ladder on R(16), R(128) and, unless quick, R(1024)."""
    table = []
    for links in (16, 128) if quick else (16, 128, 1024):
        net = task_rope(links)
        truth = reference(net)
        for name in METHODS:
            for fraction in LADDER:
                ours = rung(net, name, fraction)
                at_half, at_end = error_of(ours, truth)
                if at_end < 10.0 * truth.uncertainty:
                    break
                times = [seconds(ours.run)]
                while len(times) < (3 if quick else 7) and sum(times) < 5.0:
                    times.append(seconds(ours.run))
                table.append(
                    {
                        "task": f"R({links})",
                        "method": name,
                        "h / critical": fraction,
                        "steps": ours.steps,
                        "force evaluations": ours.steps * INTEGRATORS[name].evals,
                        "time [ms]": 1e3 * statistics.median(times),
                        "least [ms]": 1e3 * min(times),
                        "error at 0.5 s [m]": at_half,
                        "error at 1 s [m]": at_end,
                        "reference good to [m]": truth.uncertainty,
                    }
                )
    return table


def cheapest(net: Net, truth: Reference, limit: tuple[float, float]) -> tuple[Ours, tuple[float, float]] | None:
    """Our quickest method and step whose errors are both within `limit` [m]; None where none on the ladders is."""
    found = []
    for name in METHODS:
        for fraction in (*LADDER, 0.0125):
            ours = rung(net, name, fraction)
            error = error_of(ours, truth)
            if max(error) < 10.0 * truth.uncertainty:
                break  # finer than the reference can tell
            if error[0] <= limit[0] and error[1] <= limit[1]:
                # Between the rungs: the step at which the error should just be theirs.
                spare = min(theirs / own for theirs, own in zip(limit, error, strict=True))
                longer = rung(net, name, min(0.97 * fraction * spare ** (1.0 / INTEGRATORS[name].order), LADDER[0]))
                longer_error = error_of(longer, truth)
                if longer.h > ours.h and longer_error[0] <= limit[0] and longer_error[1] <= limit[1]:
                    ours, error = longer, longer_error
                found.append((seconds(ours.run), ours, error))
                break
    if not found:
        return None
    _, ours, error = min(found, key=lambda entry: entry[0])
    return ours, error


def peer_rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every peer that is installed against our quickest run at its error or less, the two timed in turns.

    A peer that damps along the links only is compared with the reference of that model.
    """
    from app.bench.rope_peers import PEERS, is_installed

    table: list[dict[str, Any]] = []
    for links in (16, 128) if quick else (16, 128, 1024):
        truths: dict[str, tuple[Net, Reference]] = {}
        for peer in PEERS:
            row: dict[str, Any] = {"task": f"R({links})", "peer": peer.name, "damping": peer.model}
            table.append(row)
            if not is_installed(peer) or links > peer.most_links:
                row["note"] = "not installed" if not is_installed(peer) else "left out: minutes a run"
                continue
            if peer.model not in truths:
                net = dataclasses.replace(task_rope(links), damping_model=peer.model)
                truths[peer.model] = net, reference(net)
            net, truth = truths[peer.model]
            run = peer.make(net, 0.8 * critical_step(net, "leapfrog"))
            limit = errors(run(0.5), run(1.0), truth)
            row |= {"error at 0.5 s [m]": limit[0], "error at 1 s [m]": limit[1]}
            best = cheapest(net, truth, limit) if limit[1] > 10.0 * truth.uncertainty else None
            once = seconds(lambda run=run: run(1.0))
            repeats = max(1, min(5 if quick else 15, int(4.0 / once)))
            theirs, mine = [], []
            for _ in range(repeats):
                theirs.append(seconds(lambda run=run: run(1.0)))
                if best is not None:
                    mine.append(seconds(best[0].run))
            row["peer [ms]"] = 1e3 * statistics.median(theirs)
            if best is None:
                row["note"] = f"no step of ours is as exact; the reference is good to {truth.uncertainty:.1e} m"
                continue
            ours, error = best
            row |= {
                "ours": ours.name,
                "steps": ours.steps,
                "ours [ms]": 1e3 * statistics.median(mine),
                "our error at 1 s [m]": error[1],
                "times as long as ours": statistics.median(theirs) / statistics.median(mine),
            }
    return table


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """Work-precision diagrams by file name, one for each task."""
    from app.bench.report import work_precision

    tasks = list(dict.fromkeys(row["task"] for row in table))
    return {
        f"rope_{task.strip('R()')}": work_precision([row for row in table if row["task"] == task], f"Rope {task}, 1 s")
        for task in tasks
    }
