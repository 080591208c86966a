"""The rope's kernels against the same algorithm in C, interleaved in one run."""

import ctypes
import importlib.resources
import shutil
import statistics
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from sim.springs import INTEGRATORS, rope
from sim.springs.net import Net

FLAGS = ["-O3", "-march=native", "-ffast-math", "-shared", "-fPIC"]


def build(name: str = "kernels") -> ctypes.CDLL | None:
    """The C loops of a source beside this file, or None where there is no compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        return None
    source = importlib.resources.files("app.bench.native").joinpath(f"{name}.c").read_text()
    folder = Path(tempfile.mkdtemp(prefix="springtide-"))
    try:
        (folder / f"{name}.c").write_text(source)
        subprocess.run([compiler, *FLAGS, f"{name}.c", "-o", f"{name}.so", "-lm"], cwd=folder, check=True)
        return ctypes.CDLL(str(folder / f"{name}.so"))
    finally:
        shutil.rmtree(folder)


def task_rope(links: int) -> Net:
    """The benchmark rope: 1 m, 1 kg, EA 981 N, b 0.002 N s, drag 0.2 kg/s, whatever the number of links."""
    points = links + 1
    return rope(points, 1.0, 1.0 / points, 981.0 * links, 0.002 * links, 0.2 / points, 9.81)


def run_ours(net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
    x, v, ledger = net.x0.copy(), np.zeros_like(net.x0), np.zeros(2)
    p = net.kernel_view(h)
    start = time.perf_counter()
    INTEGRATORS[name].advance(x.reshape(-1), v.reshape(-1), ledger, 0.0, h, steps, p, False)
    return time.perf_counter() - start, x


def run_c(library: ctypes.CDLL, net: Net, name: str, h: float, steps: int) -> tuple[float, np.ndarray]:
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
    """ns a point and step of ours and of C, and their ratio (median over interleaved repeats)."""
    library = build()
    table = []
    for links in (16, 128, 1024):
        net = task_rope(links)
        for name in ("leapfrog", "rk4"):
            h = 0.8 * 1.94e-3 * 16 / links
            steps = (400_000 if quick else 2_000_000) // (links * INTEGRATORS[name].evals)
            repeats = 7 if quick else 21
            run_ours(net, name, h, 10)
            ours, floor, difference = [], [], float("nan")
            for _ in range(repeats):
                seconds, x = run_ours(net, name, h, steps)
                ours.append(seconds)
                if library is not None:
                    seconds, y = run_c(library, net, name, h, steps)
                    floor.append(seconds)
                    difference = float(np.abs(x - y).max())
            scale = 1e9 / (steps * (links + 1))
            mine = statistics.median(ours) * scale
            c = statistics.median(floor) * scale if floor else float("nan")
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
