"""Run time and force evaluations against error on five ropes, with a ladder of steps or tolerances for every
integrator.

An error is the largest distance of any point from the reference at the end. The reference is dop853 at a tolerance of
1e-12; its uncertainty is the distance to a second method, dopri5. Errors within ten times of that are left out. A run
is one call for the whole motion, with compiled kernels; its time is the least of repeats. Runs that diverge are left
out.
"""

import functools
import math
import statistics
import time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rich.progress import track

from app.study.tables import front
from benchmarks.reference import RESOLUTION, Reference, largest_distances
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.state import State, advance

LONGEST_STEP = 1 / 15  # [s] of every ladder
TOLERANCES = tuple(10.0 ** (-0.5 * i) for i in range(4, 23))  # rtol; atol is a hundredth of it
REFERENCE_TOLERANCE = 1e-12  # rtol
MAX_ERROR = 0.5  # [m] a larger one means that the run diverged, or another motion altogether
COMPARED_ERROR = 1e-3  # [m] at which leapfrog is compared with the lab's Euler


class Problem(NamedTuple):
    """A rope, and how long it moves."""

    name: str
    net: Net
    duration: float  # [s]


LAB = functools.partial(rope, 10, gravity=10.0)
PROBLEMS = (
    Problem("lab default", LAB(), 2.0),
    Problem("stiff, 8e4 N/m", LAB(stiffness=8e4), 1.0),
    Problem("undamped, long", LAB(damping=0.0, drag=0.0), 4.0),
    Problem("very stiff, 8e6 N/m", LAB(stiffness=8e6), 1.0),
    Problem("drop on the floor", LAB(floor=-1.0), 1.5),
)


def run_adaptive(problem: Problem, name: str, rtol: float) -> tuple[NDArray[np.float64], int]:
    """Positions at the end (3, 1, points) [m] and force evaluations, in steps chosen for a tolerance; NaN: diverged."""
    net, march = problem.net, INTEGRATORS[name].march
    assert march is not None
    xs, vs = np.zeros((2, 2, net.x0.size))
    start, times, p = net.x0.reshape(-1).copy(), np.array([0.0, problem.duration]), net.kernel_view(1e-3)
    evals, _, filled, _ = march(
        start, np.zeros(net.x0.size), times, rtol, 0.01 * rtol, p, False, xs, vs, np.zeros((2, 2))
    )
    return xs[1].reshape(net.x0.shape) if filled == 2 else np.full(net.x0.shape, np.nan), evals


def run_steps(problem: Problem, name: str, steps: int) -> tuple[NDArray[np.float64], int]:
    """The same in equal steps."""
    state = State.at_rest(problem.net)
    advance(problem.net, state, INTEGRATORS[name], problem.duration / steps, steps)
    return state.x, state.force_evals


def truth_of(problem: Problem) -> Reference:
    """The reference solution."""
    one, other = ((run_adaptive(problem, name, REFERENCE_TOLERANCE)[0],) for name in ("dop853", "dopri5"))
    return Reference(one, largest_distances(one, Reference(other, 0.0))[0])


def methods_for(net: Net) -> list[str]:
    """The integrators that can run this net."""
    return [name for name, record in INTEGRATORS.items() if not (record.undamped_only and net.is_damped)]


def ladder(problem: Problem, name: str, truth: Reference, max_evaluations: int, repeats: int) -> list[dict[str, Any]]:
    """Rungs from coarse to fine, up to `max_evaluations` of the force, or to the uncertainty of the reference."""
    found = []
    adaptive = INTEGRATORS[name].adaptive
    coarsest = math.ceil(problem.duration / LONGEST_STEP)
    for i in range(len(TOLERANCES)):
        setting = TOLERANCES[i] if adaptive else coarsest * 2**i
        run = run_adaptive if adaptive else run_steps
        with np.errstate(all="ignore"):
            x, evals = run(problem, name, setting)  # type: ignore[arg-type]
            (error,) = largest_distances((x,), truth)
        if evals > max_evaluations or error < RESOLUTION * truth.uncertainty:
            break
        if not error < MAX_ERROR:
            continue
        times = []
        while len(times) < repeats and sum(times) < 0.05 * repeats:
            start = time.perf_counter()
            run(problem, name, setting)  # type: ignore[arg-type]
            times.append(time.perf_counter() - start)
        found.append(
            {
                "problem": problem.name,
                "method": name,
                "step [s]": None if adaptive else problem.duration / setting,
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
    """The ladder of every method on every problem; quick: shorter ladders, fewer repeats."""
    table = []
    truths = {problem.name: truth_of(problem) for problem in PROBLEMS}
    pairs = [(problem, name) for problem in PROBLEMS for name in methods_for(problem.net)]
    for problem, name in track(pairs, "rope", transient=True):
        table += ladder(problem, name, truths[problem.name], 10_000 if quick else 200_000, 2 if quick else 9)
    return table


def evaluations_at(table: list[dict[str, Any]], method: str, error: float) -> float:
    """Force evaluations that a method needs for an error [m], interpolated in logarithms; NaN outside its ladder."""
    own = sorted((row["error [m]"], row["force evaluations"]) for row in table if row["method"] == method)
    if not own or not own[0][0] <= error <= own[-1][0]:
        return math.nan
    errors, evals = np.log(np.array(own)).T
    return float(np.exp(np.interp(math.log(error), errors, evals)))


def findings(table: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Summary of the ladders: the uncertainty of the reference, the front, and leapfrog against the lab's Euler."""
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
            leapfrog, euler = (evaluations_at(own, name, COMPARED_ERROR) for name in ("leapfrog", "symplectic_euler"))
            if math.isfinite(euler / leapfrog):
                found[-1][f"Euler's force evaluations over leapfrog's at {COMPARED_ERROR:g} m"] = euler / leapfrog
    return found


def figures(table: list[dict[str, Any]]) -> dict[str, Any]:
    """A work-precision diagram of each problem, by file name."""
    from app.study.tables import work_precision

    drawn = {}
    for problem in PROBLEMS:
        own = [row for row in table if row["problem"] == problem.name]
        if own:
            name = problem.name.split(",")[0].replace(" ", "_")
            drawn[f"rope_{name}"] = work_precision(own, f"Rope of 10 points, {problem.name}, {problem.duration:g} s")
    return drawn
