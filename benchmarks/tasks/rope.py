"""The rope R(N) as a task of peers: its reference, and our ladders of runs.

R(N): N links, 1 m, 1 kg, EA 981 N, released horizontally, 1 s. Errors are the largest distance of any point from the
reference at t = 0.5 s and at t = 1 s.
"""

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np

from app.formats.text_tables import Rows
from benchmarks.peers.ladder import Task, tables
from benchmarks.peers.own_runs import OwnRun, OwnRuns
from benchmarks.peers.rope import PEERS
from benchmarks.reference import Positions, Reference
from sim.frames import steps_for
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.stability import critical_step
from sim.springs.state import State, advance

FIXED_STEP_METHODS = ("symplectic_euler", "leapfrog_lagged", "leapfrog", "rk4", "dop853", "rkn8")
STEP_LADDER = (0.95, 0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05, 0.025, 0.0125)  # time steps over the critical step
ADAPTIVE_METHODS = ("dopri5", "dop853", "rkn8")
TOLERANCES = tuple(10.0 ** (-0.5 * i) for i in range(8, 23))  # rtol; atol is a hundredth of it
# Steps of the reference in 0.8 critical steps, by the number of links: its error is below 1e-11 m.
REFERENCE_REFINEMENT = {16: 128, 128: 128, 1024: 16}


def benchmark_rope(links: int) -> Net:
    """The rope of R(links): EA 981 N, b 0.002 N s and drag 0.2 kg/s in all, whatever the number of links."""
    points = links + 1
    return rope(points, 1.0, 1.0 / points, 981.0 * links, 0.002 * links, 0.2 / points, 9.81)


def run_steps(net: Net, name: str, steps: int) -> Positions:
    """Positions at half time and at the end, (3, 1, points) each [m]. steps: in all, an even number."""
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], 1.0 / steps, steps // 2)
    half = state.x.copy()
    advance(net, state, INTEGRATORS[name], 1.0 / steps, steps // 2)
    return half, state.x


def run_adaptive(net: Net, name: str, rtol: float) -> Positions:
    """The same with steps that the method chooses for a tolerance."""
    march = INTEGRATORS[name].march
    assert march is not None
    xs, vs = np.zeros((2, 3, net.x0.size))
    start, times = net.x0.reshape(-1).copy(), np.array([0.0, 0.5, 1.0])
    march(start, np.zeros(net.x0.size), times, rtol, 0.01 * rtol, net.kernel_view(1.0), False, xs, vs, np.zeros((3, 2)))
    half, end = xs[1:].reshape(2, *net.x0.shape)
    return half, end


def even_steps(time_step: float) -> int:
    """An even number of equal steps for 1 s, none longer than `time_step` [s]: half of them end at 0.5 s."""
    return 2 * steps_for(0.5, time_step)


def reference(net: Net) -> Reference:
    """RK4 far below its critical step. Its uncertainty is the distance to the same at twice the step (round-off)."""
    h = 0.8 * critical_step(net, "rk4") / REFERENCE_REFINEMENT.get(net.shape[1] - 1, 8)
    coarse, fine = run_steps(net, "rk4", even_steps(2.0 * h)), run_steps(net, "rk4", even_steps(h))
    return Reference(fine, max(float(np.abs(a - b).max()) for a, b in zip(coarse, fine, strict=True)))


def fixed_step_run(net: Net, name: str, fraction: float) -> OwnRun:
    """A run with steps of `fraction` times the critical step."""
    steps = even_steps(fraction * critical_step(net, name))
    return OwnRun(name, f"{steps} steps", functools.partial(run_steps, net, name, steps))


def adaptive_run(net: Net, name: str, rtol: float) -> OwnRun:
    """A run at a tolerance."""
    return OwnRun(name, f"rtol {rtol:.1e}", functools.partial(run_adaptive, net, name, rtol))


def ladders(net: Net) -> list[list[OwnRun]]:
    """Our runs of the task, a ladder for each method, coarse to fine; their kernels are loaded."""
    for name in FIXED_STEP_METHODS:
        run_steps(net, name, 2)
    for name in ADAPTIVE_METHODS:
        run_adaptive(net, name, TOLERANCES[0])
    return [
        *([fixed_step_run(net, name, fraction) for fraction in STEP_LADDER] for name in FIXED_STEP_METHODS),
        *([adaptive_run(net, name, rtol) for rtol in TOLERANCES] for name in ADAPTIVE_METHODS),
    ]


def peer_task(links: int, damping: str) -> Task:
    """The rope task by this damping model, with our own runs of it."""
    net = dataclasses.replace(benchmark_rope(links), damping_model=damping)
    return Task(net, (0.5, 1.0), OwnRuns(ladders(net), reference(net)))


def peer_rows(quick: bool = False, words: Sequence[str] = ()) -> Rows:
    """The ladders of peers; quick: two sizes, every second rung."""
    return tables("R", (16, 128, 1024), PEERS, peer_task, words, quick)
