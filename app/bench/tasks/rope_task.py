"""The rope task, R(N): our quickest run at the error of each peer, the two timed in turns.

R(N): N links, 1 m, 1 kg, EA 981 N, released horizontally, 1 s. Errors are the largest distance of any point from the
reference at t = 0.5 s and at t = 1 s. Times are those of one call for the whole second, medians of repeats.
"""

import dataclasses
import functools
import statistics
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from app.bench.cases.kernels import task_rope
from app.bench.installed import why_left_out
from app.bench.timing import in_turn
from sim.springs import INTEGRATORS, Net
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

METHODS = ("symplectic_euler", "leapfrog_lagged", "leapfrog", "rk4", "dop853")  # in steps of one length
LADDER = (0.95, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05, 0.025, 0.0125)  # of the critical step
ADAPTIVE = ("dopri5", "dop853")  # in steps of their own choosing
TOLERANCES = tuple(10.0 ** (-0.5 * i) for i in range(8, 23))  # rtol; atol is a hundredth of it
REFINED = {16: 128, 128: 128, 1024: 16}  # steps of the reference within one of 0.8 times critical: good to 1e-11 m


class Reference(NamedTuple):
    """Positions (3, 1, points) [m], and how far they may be off [m]."""

    half: NDArray[np.float64]
    end: NDArray[np.float64]
    uncertainty: float


class Ours(NamedTuple):
    """A way to run the task: steps of 1/steps [s], an even number, or a tolerance."""

    name: str
    net: Net
    steps: int
    rtol: float = 0.0

    def run(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions at half time and at the end, (3, 1, points) each [m]."""
        record = INTEGRATORS[self.name]
        if self.rtol == 0.0:
            state = State.at_rest(self.net)
            advance(self.net, state, record, 1.0 / self.steps, self.steps // 2)
            half = state.x.copy()
            advance(self.net, state, record, 1.0 / self.steps, self.steps // 2)
            return half, state.x
        assert record.march is not None
        size = self.net.x0.size
        xs, vs, ledger = np.zeros((3, size)), np.zeros((3, size)), np.zeros((3, 2))
        start, times, p = self.net.x0.reshape(-1).copy(), np.array([0.0, 0.5, 1.0]), self.net.kernel_view(1.0)
        record.march(start, np.zeros(size), times, self.rtol, 0.01 * self.rtol, p, False, xs, vs, ledger)
        half, end = xs[1:].reshape(2, *self.net.x0.shape)
        return half, end

    @property
    def setting(self) -> str:
        return f"rtol {self.rtol:.1e}" if self.rtol else f"{self.steps} steps"


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
    return Ours(name, net, 2 * steps_for(0.5, fraction * critical_step(net, name)))


class Tried:
    """What each of our runs of one net errs and takes, worked out when first asked for."""

    def __init__(self, net: Net, truth: Reference) -> None:
        self.net, self.truth = net, truth
        self.known: dict[Ours, tuple[float, tuple[float, float]]] = {}
        ladders = [[rung(net, name, fraction) for fraction in LADDER] for name in METHODS]
        ladders += [[Ours(name, net, 0, rtol) for rtol in TOLERANCES] for name in ADAPTIVE]
        self.ladders = ladders

    def result(self, ours: Ours) -> tuple[float, tuple[float, float]]:
        """Seconds and errors [m]."""
        key = ours._replace(net=None)  # type: ignore[arg-type]
        if key not in self.known:
            start = time.perf_counter()
            half, end = ours.run()
            took = time.perf_counter() - start
            self.known[key] = took, errors(half, end, self.truth)
        return self.known[key]

    def cheapest(self, limit: tuple[float, float]) -> Ours | None:
        """Our quickest run whose errors are both within `limit` [m]; None where none on the ladders is."""
        found = []
        for ladder in self.ladders:
            for ours in ladder:
                took, error = self.result(ours)
                if max(error) < 10.0 * self.truth.uncertainty:
                    break  # finer than the reference can tell
                if error[0] <= limit[0] and error[1] <= limit[1]:
                    found.append((took, ours))
                    break
        if not found:
            return None
        # A first run also loads the kernel: those that may be the quickest run again.
        best = [ours for _, ours in sorted(found, key=lambda entry: entry[0])[:4]]
        return min(best, key=lambda ours: min(seconds(ours.run) for _ in range(3)))


def peer_rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every peer that is installed against our quickest run at its error or less, the two timed in turns.

    A peer that damps along the links only is compared with the reference of that model.
    """
    from app.bench.peers.rope_peers import PEERS

    table: list[dict[str, Any]] = []
    tasks = [(links, peer) for links in ((16, 128) if quick else (16, 128, 1024)) for peer in PEERS]
    tried: dict[tuple[int, str], Tried] = {}
    for links, peer in track(tasks, "rope peers", transient=True):
        row: dict[str, Any] = {"task": f"R({links})", "peer": peer.name, "damping": peer.model}
        table.append(row)
        if absent := why_left_out(peer.package, links, peer.most_links):
            row["note"] = absent
            continue
        if (links, peer.model) not in tried:
            net = dataclasses.replace(task_rope(links), damping_model=peer.model)
            tried[links, peer.model] = Tried(net, reference(net))
        ours = tried[links, peer.model]
        run = peer.make(ours.net, 0.8 * critical_step(ours.net, "leapfrog"))
        limit = errors(run(0.5), run(1.0), ours.truth)
        row |= {"error at 0.5 s [m]": limit[0], "error at 1 s [m]": limit[1]}
        best = ours.cheapest(limit)
        once = seconds(lambda run=run: run(1.0))
        repeats = max(1, min(5 if quick else 15, int(4.0 / once)))
        calls: list[Callable[[], Any]] = [functools.partial(run, 1.0)]
        if best is not None:
            calls.append(best.run)
        theirs, *mine = in_turn(calls, repeats)
        row["peer [ms]"] = 1e3 * statistics.median(theirs)
        if best is None:
            row["note"] = f"no step of ours is as exact; the reference is good to {ours.truth.uncertainty:.1e} m"
            continue
        error = ours.result(best)[1]
        row |= {
            "ours": best.name,
            "with": best.setting,
            "ours [ms]": 1e3 * statistics.median(mine[0]),
            "our error at 1 s [m]": error[1],
            "times as long as ours": statistics.median(theirs) / statistics.median(mine[0]),
        }
    return table
