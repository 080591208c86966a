"""The cloth: its force kernel against the same loop in C, the cloth task's error and time, and the drape in real time.

C(n): n x n particles, 1 m, 1 kg, level, four corners pinned; structural springs 981, shear 490, bend 98 N/m, damping
0.002 N s/m each. Errors are the largest distance of any particle from the reference at t = 0.25 s.
"""

import ctypes
import statistics
import time
from typing import Any

import numpy as np

from app.bench.kernels import build
from sim.jit import kernel
from sim.springs import INTEGRATORS, Net, cloth
from sim.springs.cloth_forces import accelerate_cloth, cloth_scratch
from sim.springs.stability import critical_step
from sim.springs.state import State, advance, steps_for

END = 0.25  # [s]
STEP = {32: 460e-6, 64: 230e-6, 128: 115e-6}  # [s], the peers' own
METHODS = ("symplectic_euler", "leapfrog_lagged", "leapfrog", "rk4", "dop853")


def task_cloth(n: int) -> Net:
    """C(n)."""
    return cloth(n, n, 1.0, 1.0, 1.0, 981.0, 490.0, 98.0, 0.002, pinned="all corners")


@kernel
def repeat(x, v, p, f, a, count):
    """The forces again and again, so that a call is long against its start."""
    for _ in range(count):
        accelerate_cloth(x, v, p, 1.0, p.drag, f, a)


def seconds(call: Any) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def kernel_row(n: int, library: ctypes.CDLL | None, repeats: int) -> dict[str, Any]:
    """One size: ours and C in turn."""
    net = task_cloth(n)
    p = net.forces(1.0)
    x = net.x0 + 0.1 / n * np.random.default_rng(0).standard_normal(net.x0.shape)
    v, mine, theirs = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    f = np.zeros(cloth_scratch(n))
    count = max(1, 400_000 // (n * n))

    def ours() -> None:
        repeat(x.reshape(-1), v.reshape(-1), p, f, mine.reshape(-1), count)

    def same_in_c() -> None:
        assert library is not None
        w, links = net.weights(), np.array([family[2:4] for family in net.families])
        rest, k = np.ascontiguousarray(links[:, 0]), np.ascontiguousarray(links[:, 1])
        arrays = [q.ctypes.data_as(ctypes.c_void_p) for q in (x, v, w, np.zeros(54 * (n + 4)), theirs, k, rest)]
        numbers = [ctypes.c_double(q) for q in (0.002, *(net.mass * g for g in net.gravity), net.drag)]
        library.cloth_forces(n, *arrays, *numbers, count)

    ours()
    times: tuple[list[float], list[float]] = [], []
    for _ in range(repeats):
        times[0].append(seconds(ours))
        if library is not None:
            times[1].append(seconds(same_in_c))
    scale = 1e9 / (count * n * n)
    own = statistics.median(times[0]) * scale
    row: dict[str, Any] = {"task": f"forces {n} x {n}", "ns per particle": own, "least ns": min(times[0]) * scale}
    if library is not None:
        c = statistics.median(times[1]) * scale
        row |= {"C ns per particle": c, "ratio to C": own / c, "difference": float(np.abs(mine - theirs).max())}
    return row


def run(net: Net, name: str, steps: int) -> State:
    state = State.at_rest(net)
    advance(net, state, INTEGRATORS[name], END / steps, steps)
    return state


def task_rows(n: int, repeats: int) -> list[dict[str, Any]]:
    """C(n) with each method at the peers' step, or the longest it holds."""
    net = task_cloth(n)
    truth = run(net, "dop853", steps_for(END, 0.4 * critical_step(net, "dop853")))
    rows = []
    for name in METHODS:
        step = STEP[n] if INTEGRATORS[name].order < 4 else 0.9 * critical_step(net, name)
        steps = steps_for(END, step)
        state = run(net, name, steps)
        times = [seconds(lambda name=name, steps=steps: run(net, name, steps)) for _ in range(repeats)]
        took = statistics.median(times)
        rows.append(
            {
                "task": f"C({n})",
                "method": name,
                "step [us]": 1e6 * END / steps,
                "ns per particle-step": 1e9 * took / (steps * n * n),
                "x real time": END / took,
                "error at 0.25 s [m]": float(np.linalg.norm(state.x - truth.x, axis=0).max()),
            }
        )
    return rows


def drape_row(frames: int) -> dict[str, Any]:
    """The drape preset with self-collision, as the scene runs it, picture and all."""
    from app.cloth_knobs import PRESETS, Params
    from app.scenes.cloth import Scene

    scene = Scene(Params(**PRESETS["Drape over the sphere"]))
    steps = round(1 / 60 / scene.step)
    times = []
    for _ in range(frames):
        start = time.perf_counter()
        scene.advance(steps)
        scene.picture()
        times.append(time.perf_counter() - start)
    settled = times[len(times) // 3 :]
    return {
        "task": "drape 64 x 64, self-collision",
        "method": scene.params.integrator,
        "frame [ms]": 1e3 * statistics.median(settled),
        "longest [ms]": 1e3 * max(settled),
        "x real time": 1 / 60 / statistics.median(settled),
    }


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Kernel, task, and drape."""
    library = build()
    sizes = (32, 64) if quick else (32, 64, 128)
    table = [kernel_row(n, library, 7 if quick else 21) for n in sizes]
    for n in sizes:
        table += task_rows(n, 3 if quick else 5)
    table.append(drape_row(150 if quick else 300))
    return table
