"""The kernels of the rope against the same algorithm in C, in turns."""

import ctypes
import statistics
import time
from typing import Any

import numpy as np

from app.bench.native.build import build
from app.bench.tasks.rope import benchmark_rope
from sim.springs import INTEGRATORS
from sim.springs.net import Net


def run_ours(net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
    """Wall time [s] of some steps of ours, and the positions after them, (3, 1, points) [m]."""
    x, v, account = net.x0.copy(), np.zeros_like(net.x0), np.zeros(2)
    p = net.kernel_view(h)
    start = time.perf_counter()
    INTEGRATORS[name].advance(x.reshape(-1), v.reshape(-1), account, 0.0, h, steps, p, False)
    return time.perf_counter() - start, x


def run_c(library: ctypes.CDLL, net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
    """The same of the loop in C."""
    x, v = net.x0.copy(), np.zeros_like(net.x0)
    n = x.shape[2]
    w, scratch = net.inverse_masses(), np.zeros(7 * x.size + 64)
    link = net.families[0]
    numbers = (link.stiffness, link.damping, link.rest, *(net.mass * g for g in net.gravity), net.drag, net.mass, h)
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, v, w, scratch)]
    start = time.perf_counter()
    getattr(library, name)(n, *pointers, *(ctypes.c_double(q) for q in numbers), steps)
    return time.perf_counter() - start, x


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Nanoseconds per point and step of ours and of C, and their ratio; medians of repeats in turns."""
    library = build("kernels")
    table = []
    for links in (16, 128, 1024):
        net = benchmark_rope(links)
        for name in ("leapfrog", "rk4"):
            h = 0.8 * 1.94e-3 * 16 / links
            steps = (400_000 if quick else 2_000_000) // (links * INTEGRATORS[name].evals)
            repeats = 7 if quick else 21
            run_ours(net, name, h, 10)
            ours, theirs, difference = [], [], float("nan")
            for _ in range(repeats):
                seconds, x = run_ours(net, name, h, steps)
                ours.append(seconds)
                if library is not None:
                    seconds, y = run_c(library, net, name, h, steps)
                    theirs.append(seconds)
                    difference = float(np.abs(x - y).max())
            scale = 1e9 / (steps * (links + 1))
            mine = statistics.median(ours) * scale
            c = statistics.median(theirs) * scale if theirs else float("nan")
            table.append(
                {
                    "integrator": name,
                    "points": links + 1,
                    "ns per point-step": mine,
                    "C ns per point-step": c,
                    "ratio": mine / c,
                    "difference [m]": difference,
                }
            )
    return table
