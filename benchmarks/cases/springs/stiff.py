"""Implicit steps of a stiff cloth of 64 x 64 particles, hanging and draped: fraction of a core for real time.

The presets of the cloth scene, in a steady wind, at steps of 1/60 s, with stiffer structural springs. A correction of
the solver is one product with its factors and one or two force evaluations. The last rows time SciPy's sparse direct
solver on the same matrix.
"""

import dataclasses
import statistics
from typing import Any

import numpy as np

from app.scenes.cloth.parameters import PRESETS, ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.timer import effort_clock
from sim.parameters import check_record
from sim.springs import Net, State
from sim.springs.integrators.implicit import steps
from sim.springs.integrators.implicit.blocks import set_near_blocks
from sim.springs.integrators.implicit.dissection import DIRECTIONS, factorise, solve
from sim.springs.state import advance

STEP = 1 / 60  # [s]
SIZE = 64  # rows and columns
STIFFNESS = (800.0, 1e5, 1e6)  # [N/m]
TASKS = [
    *(("Curtain", k, "implicit_euler") for k in STIFFNESS),
    *(("Drape over the sphere", k, "implicit_euler") for k in STIFFNESS),
    ("Curtain", 1e5, "tr_bdf2"),
    ("Curtain", 1e5, "implicit_midpoint"),
]


def net_of(preset: str, stiffness: float, method: str) -> Net:
    """A preset's net on one thread, with its wind."""
    params = {**PRESETS[preset], "rows": SIZE, "cols": SIZE, "integrator": method, "time_step": STEP}
    net = ClothScene(check_record(ClothParams, params)).net_during(0.0, STEP)
    families = tuple(f._replace(stiffness=stiffness) if sum(map(abs, f[:2])) == 1 else f for f in net.families)
    return dataclasses.replace(net, families=families, threads=1)


def row(preset: str, stiffness: float, method: str, steps: int) -> dict[str, Any]:
    """Steps from rest on one thread, in processor time, which other programs do not affect."""
    net = net_of(preset, stiffness, method)
    state, times, evals = State.at_rest(net), [], []
    advance(net, state.copy(), method, STEP, 1)  # loads the kernel
    for _ in range(steps):
        before, start = state.force_evals, effort_clock()
        advance(net, state, method, STEP, 1)
        times.append(effort_clock() - start)
        evals.append(state.force_evals - before)
    # The last two thirds: the cloth lies on the sphere and on itself, or hangs and buckles.
    later = times[steps // 3 :]
    return {
        "preset": preset,
        "stiffness [N/m]": stiffness,
        "integrator": method,
        "step [ms]": 1e3 * statistics.median(later),
        "longest [ms]": 1e3 * max(times),
        "cores for real time": statistics.median(later) / STEP,
        "force evaluations a step": statistics.fmean(evals[steps // 3 :]),
    }


def sparse_matrix(p: Any, diagonal: np.ndarray, beside: np.ndarray) -> Any:
    """The matrix that `factorise` takes, (3 n, 3 n) of x, y, z of each particle in turn."""
    from scipy.sparse import coo_array

    n, free = p.rows * p.cols, p.inverse_masses > 0.0
    whole = np.array([0, 1, 2, 1, 3, 4, 2, 4, 5])  # of six numbers, those of the nine
    number = np.arange(n).reshape(p.rows, p.cols)
    own = np.where(free[:, None], diagonal.reshape(n, 6)[:, whole], np.eye(3).ravel())
    blocks = [(number.ravel(), number.ravel(), own)]
    for way, (di, dj) in enumerate(DIRECTIONS):
        a = number[: p.rows - di, max(0, -dj) : p.cols - max(0, dj)].ravel()
        b = number[di:, max(0, dj) : p.cols + min(0, dj)].ravel()
        a, b = a[free[a] & free[b]], b[free[a] & free[b]]
        block = -beside.reshape(n, 4, 6)[a, way][:, whole]
        blocks += [(a, b, block), (b, a, block)]
    a, b, values = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    i, j = np.divmod(np.arange(9), 3)
    places = ((3 * a[:, None] + i).ravel(), (3 * b[:, None] + j).ravel())
    return coo_array((values.ravel(), places), shape=(3 * n, 3 * n)).tocsc()


def matrix_at(net: Net, state: State) -> tuple[Any, Any, Any]:
    """(kernels' view, solver, matrix) of a net at a state."""
    p = net.kernel_view(STEP)
    work = steps.make_work(p, False)
    steps.set_blocks(state.x.ravel(), STEP, state.t, p, state.x.ravel(), state.v.ravel(), work)
    solver = work.solver
    set_near_blocks(p, work.links, work.points, solver.diagonal, solver.beside)
    return p, solver, sparse_matrix(p, solver.diagonal, solver.beside)


def linear_row(stiffness: float, repeats: int) -> dict[str, Any]:
    """Least times of factors and of a solve, ours and SciPy's `splu` in the order of least fill of A + A^T."""
    from scipy.sparse.linalg import splu

    net = net_of("Curtain", stiffness, "implicit_euler")
    state = State.at_rest(net)
    advance(net, state, "implicit_euler", STEP, 20)
    p, solver, matrix = matrix_at(net, state)
    r, z = np.random.default_rng(0).standard_normal((2, 3 * SIZE * SIZE))
    r.reshape(3, -1)[:, p.inverse_masses == 0.0] = 0.0

    def ours() -> Any:
        factorise(solver.diagonal, solver.beside, p.inverse_masses, solver.grid)

    def theirs() -> Any:
        return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    factors, by_particle = theirs(), r.reshape(3, -1).T.ravel()
    tasks = {
        "factors [ms]": ours,
        "splu [ms]": theirs,
        "solve [ms]": lambda: solve(solver.grid, r, z),
        "solve of splu [ms]": lambda: factors.solve(by_particle),
    }
    least = dict.fromkeys(tasks, np.inf)
    for _ in range(repeats):
        for name, task in tasks.items():
            start = effort_clock()
            task()
            least[name] = min(least[name], 1e3 * (effort_clock() - start))
    apart = np.abs(z.reshape(3, -1).T.ravel() - factors.solve(by_particle)).max() / np.abs(z).max()
    return {"preset": "Curtain", "stiffness [N/m]": stiffness, **least, "apart, relative": apart}


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every task."""
    linear = [linear_row(stiffness, 2 if quick else 8) for stiffness in STIFFNESS]
    return [*(row(*task, 15 if quick else 60) for task in TASKS), *linear]
