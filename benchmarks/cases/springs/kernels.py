"""The kernels of the rope against the same algorithm in C, in turns.

Times are of the processor, and the ratio is the median of those of pairs: what else the machine does counts little.
"""

import ctypes
import statistics
from collections.abc import Iterator
from typing import Any

import numpy as np

from app.scenes.timer import effort_clock
from benchmarks.native.build import build
from benchmarks.tasks.rope import benchmark_rope
from sim.springs import INTEGRATORS
from sim.springs.net import Net

LINKS = (9, 16, 128, 1024)
C_LOOPS = {
    "symplectic_euler": "symplectic_euler",
    "leapfrog_lagged": "symplectic_euler",  # the same steps from another start
    "leapfrog": "leapfrog",
    "rk4": "rk4",
}


def run_ours(net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
    """Processor time [s] of some steps of ours, and the positions after them, (3, 1, points) [m]."""
    x, v, account = net.x0.copy(), np.zeros_like(net.x0), np.zeros(3)
    p = net.kernel_view(h)
    start = effort_clock()
    INTEGRATORS[name].advance(x.reshape(-1), v.reshape(-1), account, 0.0, h, steps, p, False)
    return effort_clock() - start, x


def run_c(library: ctypes.CDLL, net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
    """The same of the loop in C."""
    x, v = net.x0.copy(), np.zeros_like(net.x0)
    n = x.shape[2]
    w, scratch = net.inverse_masses(), np.zeros(7 * x.size + 64)
    link = net.families[0]
    numbers = (link.stiffness, link.damping, link.rest, *(net.mass * g for g in net.gravity), net.drag, net.mass, h)
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, v, w, scratch)]
    start = effort_clock()
    getattr(library, C_LOOPS[name])(n, *pointers, *(ctypes.c_double(q) for q in numbers), steps)
    return effort_clock() - start, x


def cases(work: int) -> Iterator[tuple[Net, str, float, int]]:
    """Each rope and method: net, method, time step [s], and steps, of which longer ropes and dearer methods take fewer.

    work: evaluations of the force of a link.
    """
    for links in LINKS:
        net, h = benchmark_rope(links), 0.8 * 1.94e-3 * 16 / links
        for name in C_LOOPS:
            run_ours(net, name, h, 10)  # compiles it
            yield net, name, h, work // (links * INTEGRATORS[name].evals)


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Nanoseconds per point and step of ours and of C, medians of repeats in turns, and the ratio."""
    library = build("kernels")
    table = []
    for net, name, h, steps in cases(400_000 if quick else 2_000_000):
        points = net.x0.shape[2]
        ours, theirs, difference = [], [], float("nan")
        for _ in range(7 if quick else 21):
            seconds, x = run_ours(net, name, h, steps)
            ours.append(seconds)
            if library is not None:
                seconds, y = run_c(library, net, name, h, steps)
                theirs.append(seconds)
                difference = float(np.abs(x - y).max())
        scale = 1e9 / (steps * points)
        ratios = [mine / c for mine, c in zip(ours, theirs, strict=False)]
        table.append(
            {
                "integrator": name,
                "points": points,
                "ns per point-step": statistics.median(ours) * scale,
                "C ns per point-step": statistics.median(theirs) * scale if theirs else float("nan"),
                "ratio": statistics.median(ratios) if ratios else float("nan"),
                "difference [m]": difference,
            }
        )
    return table
