"""Run time and force evaluations against error on five ropes, every integrator a ladder of steps or tolerances.

An error is the largest distance of any point from the reference at the end. The reference is dop853 at a tolerance of
1e-12, and is taken to be as good as a second method, dopri5, agrees with it; errors within ten times of that are left
out. A run is one call for the whole motion, kernels compiled, the least of repeats; what diverges is no point of a
curve. `--peers` runs the rope task of `app.bench.tasks.rope_task`.
"""

import math
import statistics
import time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from app.bench.tasks.rope_task import peer_rows
from app.experiments.tables import front
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.state import State, advance

__all__ = ["figures", "findings", "peer_rows", "rows"]

LONGEST = 1 / 15  # [s], the first step of every ladder
TOLERANCES = tuple(10.0 ** (-0.5 * i) for i in range(4, 23))  # rtol; atol is a hundredth of it
TIGHT = 1e-12  # rtol of the references
LEVEL = 2e-3  # [m], where leapfrog is held against the lab's Euler


class Problem(NamedTuple):
    name: str
    net: Net
    seconds: float


class Truth(NamedTuple):
    x: NDArray[np.float64]  # (3, 1, points) [m]
    uncertainty: float  # [m]


PROBLEMS = (
    Problem("lab default", rope(10), 2.0),
    Problem("stiff, 8e4 N/m", rope(10, stiffness=8e4), 1.0),
    Problem("undamped, long", rope(10, damping=0.0, drag=0.0), 4.0),
    Problem("very stiff, 8e6 N/m", rope(10, stiffness=8e6), 1.0),
    Problem("drop on the floor", rope(10, floor=-1.0), 1.5),
)


def marched(problem: Problem, name: str, rtol: float) -> tuple[NDArray[np.float64], int]:
    """Positions at the end [m] and force evaluations, steps chosen for a tolerance."""
    net, march = problem.net, INTEGRATORS[name].march
    assert march is not None
    xs, vs = np.zeros((2, 2, net.x0.size))
    start, times, p = net.x0.reshape(-1).copy(), np.array([0.0, problem.seconds]), net.kernel_view(1e-3)
    evals, _, filled, _ = march(
        start, np.zeros(net.x0.size), times, rtol, 0.01 * rtol, p, False, xs, vs, np.zeros((2, 2))
    )
    return xs[1].reshape(net.x0.shape) if filled == 2 else np.full(net.x0.shape, np.nan), evals


def stepped(problem: Problem, name: str, steps: int) -> tuple[NDArray[np.float64], int]:
    """The same in equal steps."""
    state = State.at_rest(problem.net)
    advance(problem.net, state, INTEGRATORS[name], problem.seconds / steps, steps)
    return state.x, state.force_evals


def truth_of(problem: Problem) -> Truth:
    one, other = (marched(problem, name, TIGHT)[0] for name in ("dop853", "dopri5"))
    return Truth(one, float(np.linalg.norm(one - other, axis=0).max()))


def methods_for(net: Net) -> list[str]:
    return [name for name, record in INTEGRATORS.items() if not (record.undamped_only and net.is_damped)]


def ladder(problem: Problem, name: str, truth: Truth, most: int, repeats: int) -> list[dict[str, Any]]:
    """Rungs from coarse to fine, until `most` force evaluations or the reference's own error."""
    found = []
    adaptive = INTEGRATORS[name].adaptive
    coarsest = math.ceil(problem.seconds / LONGEST)
    for i in range(len(TOLERANCES)):
        setting = TOLERANCES[i] if adaptive else coarsest * 2**i
        run = marched if adaptive else stepped
        with np.errstate(all="ignore"):
            x, evals = run(problem, name, setting)  # type: ignore[arg-type]
            error = float(np.linalg.norm(x - truth.x, axis=0).max())
        if evals > most or error < 10.0 * truth.uncertainty:
            break
        if not error < 0.5:
            continue  # diverged, or another motion altogether
        times = []
        while len(times) < repeats and sum(times) < 0.05 * repeats:
            start = time.perf_counter()
            run(problem, name, setting)  # type: ignore[arg-type]
            times.append(time.perf_counter() - start)
        found.append(
            {
                "problem": problem.name,
                "method": name,
                "step [s]": None if adaptive else problem.seconds / setting,
                "rtol": setting if adaptive else None,
                "force evaluations": evals,
                "time [ms]": 1e3 * statistics.median(times),
                "least [ms]": 1e3 * min(times),
                "error [m]": error,
                "reference good to [m]": truth.uncertainty,
            }
        )
    return found


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every method's ladder on every problem; quick: shorter ladders, fewer repeats."""
    table = []
    truths = {problem.name: truth_of(problem) for problem in PROBLEMS}
    pairs = [(problem, name) for problem in PROBLEMS for name in methods_for(problem.net)]
    for problem, name in track(pairs, "rope", transient=True):
        table += ladder(problem, name, truths[problem.name], 10_000 if quick else 200_000, 2 if quick else 9)
    return table


def evaluations_at(table: list[dict[str, Any]], method: str, error: float) -> float:
    """Force evaluations a method needs for an error [m], between rungs by their logarithms; NaN beyond them."""
    own = sorted((row["error [m]"], row["force evaluations"]) for row in table if row["method"] == method)
    if not own or not own[0][0] <= error <= own[-1][0]:
        return math.nan
    errors, evals = np.log(np.array(own)).T
    return float(np.exp(np.interp(math.log(error), errors, evals)))


def findings(table: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """What the ladders say: the reference's own error, the front, and leapfrog against the lab's Euler."""
    found = []
    for problem in PROBLEMS:
        own = [row for row in table if row["problem"] == problem.name]
        if own:
            found.append(
                {
                    "problem": problem.name,
                    "two references differ by [m]": own[0]["reference good to [m]"],
                    "on the front of time against error": ", ".join(front(own)),
                }
            )
            leapfrog, euler = (evaluations_at(own, name, LEVEL) for name in ("leapfrog", "symplectic_euler"))
            if math.isfinite(euler / leapfrog):
                found[-1][f"Euler's force evaluations over leapfrog's at {LEVEL:g} m"] = euler / leapfrog
    return found


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """A work-precision diagram of each problem by file name."""
    from app.experiments.tables import work_precision

    drawn = {}
    for problem in PROBLEMS:
        own = [row for row in table if row["problem"] == problem.name]
        if own:
            name = problem.name.split(",")[0].replace(" ", "_")
            drawn[f"rope_{name}"] = work_precision(own, f"Rope of 10 points, {problem.name}, {problem.seconds:g} s")
    return drawn
