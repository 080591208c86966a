"""Maps over step and stiffness of the nonlinear rope at rest: whether a small disturbance decays, grows or explodes."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.study.pool import spread
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.analysis.growth import BOUNDED_GROWTH, EXPLODING, STABLE
from sim.springs.analysis.stability_map import MapRow, map_row

STEPS = (3e-4, 0.3)  # [s]
STIFFNESSES = (30.0, 1e6)  # [N/m]


class RopeMap(NamedTuple):
    """The map of one integrator."""

    name: str
    steps: NDArray[np.float64]  # (cols,) [s]
    stiffnesses: NDArray[np.float64]  # (rows,) [N/m]
    outcomes: NDArray[np.int64]  # (rows, cols) STABLE, BOUNDED_GROWTH or EXPLODING
    measured: NDArray[np.float64]  # (rows,) [s] of `MapRow`
    theory: NDArray[np.float64]  # (rows,) [s] critical_step
    accurate: NDArray[np.float64]  # (rows,) [s] accurate_step


def row(name: str, net: Net, stiffness: float, steps: NDArray[np.float64], max_steps: int) -> MapRow:
    """The row of one stiffness."""
    return map_row(INTEGRATORS[name], net.with_stiffness(stiffness), steps, max_steps, locate=True)


def measure(net: Net | None = None, quick: bool = False, workers: int = 0) -> list[RopeMap]:
    """All integrators that can run this rope (None: the lab's). workers: processes, 0: one on each core."""
    net = rope(gravity=10.0) if net is None else net
    rows, cols, max_steps = (8, 12, 1 << 12) if quick else (32, 48, 1 << 14)
    steps, stiffnesses = np.geomspace(*STEPS, cols), np.geomspace(*STIFFNESSES, rows)
    names = [name for name, record in INTEGRATORS.items() if not (record.undamped_only and net.is_damped)]
    tasks = [(name, net, float(k), steps, max_steps) for name in names for k in stiffnesses]
    map_rows = spread(row, tasks, "step and stiffness", workers)
    maps = []
    for i, name in enumerate(names):
        own = map_rows[i * rows : (i + 1) * rows]
        maps.append(RopeMap(name, steps, stiffnesses, *(np.array(column) for column in zip(*own, strict=True))))
    return maps


def rows(maps: list[RopeMap]) -> list[dict[str, Any]]:
    """The table: numbers of cells by outcome, and how far `critical_step` is from the measured limit."""
    table = []
    for m in maps:
        grows = m.outcomes != STABLE
        wrong = grows != (m.steps[None, :] > m.theory[:, None])
        within = (m.theory < m.steps[-1]) & (m.theory > m.steps[0]) & np.isfinite(m.measured)
        apart = np.abs(m.measured[within] / m.theory[within] - 1.0)
        table.append(
            {
                "integrator": m.name,
                "cells": grows.size,
                "stable": int((m.outcomes == STABLE).sum()),
                "bounded growth": int((m.outcomes == BOUNDED_GROWTH).sum()),
                "exploding": int((m.outcomes == EXPLODING).sum()),
                "disagree": int(wrong.sum()),
                "step off, median [%]": 100.0 * float(np.median(apart)) if len(apart) else None,
                "at most [%]": 100.0 * float(apart.max()) if len(apart) else None,
                "right in % of stable cells": right_share(m),
                "at k [N/m]": float(m.stiffnesses[within][int(apart.argmax())]) if len(apart) else None,
            }
        )
    return table


def right_share(m: RopeMap) -> float | None:
    """Percentage of the stable cells at which the method is right; None without stable cells."""
    stable = m.outcomes == STABLE
    right = stable & (m.steps[None, :] <= m.accurate[:, None])
    return 100.0 * float(right.sum()) / float(stable.sum()) if stable.any() else None


def boundary_rows(maps: list[RopeMap]) -> list[dict[str, Any]]:
    """The measured limit and `critical_step`, for each integrator and stiffness."""
    return [
        {
            "integrator": m.name,
            "stiffness [N/m]": float(k),
            "step measured [s]": float(a),
            "critical_step [s]": float(b),
            "accurate_step [s]": float(c),
        }
        for m in maps
        for k, a, b, c in zip(m.stiffnesses, m.measured, m.theory, m.accurate, strict=True)
    ]
