"""Implicit steps of a stiff cloth of 64 x 64 particles, hanging and draped: the share of a core that real time takes.

The presets of the cloth scene, in a steady wind, at steps of 1/60 s, with stiffer structural springs. A correction of
Newton's method is one linear solve and one or two force evaluations.
"""

import dataclasses
import statistics
from typing import Any

from app.scenes.cloth.parameters import PRESETS, ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.timer import effort_clock
from sim.parameters import check_record
from sim.springs import State
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


def row(preset: str, stiffness: float, method: str, steps: int) -> dict[str, Any]:
    """Steps from rest on one thread, in processor time, which other programs on the machine do not lengthen."""
    params = {**PRESETS[preset], "rows": SIZE, "cols": SIZE, "integrator": method, "time_step": STEP}
    net = ClothScene(check_record(ClothParams, params)).net_during(0.0, STEP)  # with its wind
    families = tuple(f._replace(stiffness=stiffness) if sum(map(abs, f[:2])) == 1 else f for f in net.families)
    net = dataclasses.replace(net, families=families, threads=1)
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


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Every task."""
    return [row(*task, 15 if quick else 60) for task in TASKS]
