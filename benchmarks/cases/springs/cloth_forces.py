"""The cloth's force kernel: one thread against the same loop in C, and two threads against one.

The time of one thread is its processor time, which other programs on the machine do not lengthen. The time of two
threads is wall time, the least of many repeats, because it depends on both cores being free.
"""

import ctypes
import dataclasses
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from app.scenes.timer import effort_clock
from benchmarks.cases.springs.cloth import benchmark_cloth
from benchmarks.native.build import build
from sim.jit import MAX_THREADS, kernel, set_threads
from sim.springs.forces.cloth_forces import accelerate_cloth, cloth_scratch_size


@kernel
def repeat(x, v, p, f, a, count):
    """Compute the forces `count` times, so that a call is long compared with its start. x v a: (3 n^2,)."""
    for _ in range(count):
        accelerate_cloth(x, v, p, 1.0, p.drag, f, a)


def timed(call: Callable[[], None], clock: Callable[[], float]) -> float:
    """The time of a call [s] on this clock."""
    start = clock()
    call()
    return clock() - start


def row(n: int, library: ctypes.CDLL | None, repeats: int) -> dict[str, Any]:
    """One size: ours and C in turn, then one and two threads in turn."""
    net = benchmark_cloth(n)
    x = net.x0 + 0.1 / n * np.random.default_rng(0).standard_normal(net.x0.shape)
    v = np.zeros_like(x)
    count = max(1, 100_000 // (n * n))

    def made(threads: int) -> tuple[Callable[[], None], np.ndarray]:
        p = dataclasses.replace(net, threads=threads).kernel_view(1.0)
        f, a = np.zeros(p.bands * cloth_scratch_size(n)), np.zeros_like(x)
        return lambda: repeat(x.reshape(-1), v.reshape(-1), p, f, a.reshape(-1), count), a

    one, mine = made(1)
    two, shared = made(2)
    theirs, f = np.zeros_like(x), np.zeros(54 * (n + 4))
    w, links = net.inverse_masses(), np.array([family[2:4] for family in net.families])
    rest, k = np.ascontiguousarray(links[:, 0]), np.ascontiguousarray(links[:, 1])
    arrays = [q.ctypes.data_as(ctypes.c_void_p) for q in (x, v, w, f, theirs, k, rest)]
    numbers = [ctypes.c_double(q) for q in (0.002, *(net.mass * g for g in net.gravity), net.drag)]

    def in_c() -> None:
        assert library is not None
        library.cloth_forces(n, *arrays, *numbers, count)

    set_threads(min(2, MAX_THREADS))
    one()
    two()
    times: dict[str, list[float]] = {"ours": [], "c": [], "one": [], "two": []}
    for _ in range(repeats):
        times["ours"].append(timed(one, effort_clock))
        if library is not None:
            times["c"].append(timed(in_c, effort_clock))
        times["one"].append(timed(one, time.perf_counter))
        times["two"].append(timed(two, time.perf_counter))
    scale = 1e9 / (count * n * n)
    found = {
        "particles": f"{n} x {n}",
        "ns a particle": scale * min(times["ours"]),
        "median": scale * statistics.median(times["ours"]),
        "two threads": scale * min(times["two"]),
        "one over two": min(times["one"]) / min(times["two"]),
        "two differ by": float(np.abs(mine - shared).max()),
    }
    if library is not None:
        ratio = statistics.median(a / b for a, b in zip(times["ours"], times["c"], strict=True))
        found |= {
            "C, ns": scale * min(times["c"]),
            "ratio to C": ratio,
            "C differs by [m/s^2]": float(np.abs(mine - theirs).max()),
        }
    return found


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """32, 48, 64 and 128 particles square."""
    library = build("kernels")
    return [row(n, library, 60 if quick else 300) for n in (32, 48, 64, 128)]
