"""Maps over h omega and zeta of the linear oscillator: measured growth, its boundary, and theory's."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.experiments.pool import spread
from sim.springs import INTEGRATORS
from sim.springs.analysis.growth import growth, measured_limit

FARTHEST = 4.0  # h omega
HIGHEST = 2.0  # zeta
NEAR = 0.02  # of the boundary: cells nearer than this to it may go either way
ABOUT = 0.02  # h omega: a boundary below this counts as one at 0


class LinearMap(NamedTuple):
    """One integrator."""

    name: str
    zetas: NDArray[np.float64]  # (rows,)
    steps: NDArray[np.float64]  # (cols,) h omega
    rates: NDArray[np.float64]  # (rows, cols) logarithm of the amplitude per step; NaN where damping is refused
    measured: NDArray[np.float64]  # (rows,) h omega at which growth begins; inf: nowhere
    theory: NDArray[np.float64]  # (rows,)


def row(name: str, zeta: float, steps: NDArray[np.float64], most: int) -> tuple[NDArray[np.float64], float]:
    """Growth rates at each step, and where growth begins."""
    record = INTEGRATORS[name]
    if record.undamped_only and zeta > 0.0:
        return np.full(len(steps), math.nan), math.nan
    rates = np.array([growth(record, zeta, float(z), most) for z in steps])
    return rates, measured_limit(record, zeta, steps, rates, 8 * most)


def measure(quick: bool = False, workers: int = 0) -> list[LinearMap]:
    """Every integrator there is."""
    rows, cols, most = (9, 24, 1 << 16) if quick else (41, 100, 1 << 18)
    zetas, steps = np.linspace(0.0, HIGHEST, rows), FARTHEST * (np.arange(cols) + 0.5) / cols
    tasks = [(name, float(zeta), steps, most) for name in INTEGRATORS for zeta in zetas]
    found = spread(row, tasks, "h ω and ζ", workers)
    maps = []
    for i, (name, record) in enumerate(INTEGRATORS.items()):
        own = found[i * rows : (i + 1) * rows]
        theory = np.array([record.limit(float(zeta)) for zeta in zetas])
        maps.append(
            LinearMap(
                name, zetas, steps, np.array([rates for rates, _ in own]), np.array([limit for _, limit in own]), theory
            )
        )
    return maps


def deviations(found: LinearMap) -> NDArray[np.float64]:
    """How far the measured boundary is from theory's (rows,), in parts of theory's; NaN where neither has one."""
    measured, theory = found.measured, found.theory
    seen = theory <= found.steps[-1]
    apart = np.full(len(theory), math.nan)
    for i in np.flatnonzero(np.isfinite(found.rates[:, 0])):
        if seen[i] or math.isfinite(measured[i]):
            near_0 = max(measured[i], theory[i]) < ABOUT
            apart[i] = 0.0 if near_0 else abs(measured[i] - theory[i]) / max(min(measured[i], theory[i]), 1e-9)
    return apart


def disagreements(found: LinearMap) -> tuple[int, int, int]:
    """(cells that grow below theory's limit or hold above it, those of them that are not within 2 % of it, cells that
    hold again beyond others that grow: a limit is the first there is, and says nothing of them)."""
    z, limit = found.steps[None, :], found.theory[:, None]
    grows = found.rates > 0.0
    again = ~grows & np.logical_or.accumulate(grows, axis=1)
    wrong = (grows != (z > limit)) & ~again & ~np.isnan(found.rates)
    return int(wrong.sum()), int((wrong & (np.abs(z - limit) > NEAR * limit)).sum()), int(again.sum())


def extra_damping(found: LinearMap) -> NDArray[np.float64]:
    """Damping ratio (rows, cols) that the method adds to the oscillator's own, of the slower of its two modes."""
    zeta = found.zetas[:, None]
    own = np.where(zeta > 1.0, zeta - np.sqrt(np.maximum(zeta**2 - 1.0, 0.0)), zeta)
    return -found.rates / found.steps[None, :] - own


def rows(maps: list[LinearMap]) -> list[dict[str, Any]]:
    """The table: disagreement of measurement and theory, by integrator."""
    table = []
    for found in maps:
        wrong, far, again = disagreements(found)
        apart = deviations(found)
        limited = bool(np.isfinite(apart).any())
        table.append(
            {
                "integrator": found.name,
                "cells": int((~np.isnan(found.rates)).sum()),
                "grow": int((found.rates > 0.0).sum()),
                "hold again": again,
                "disagree": wrong,
                "beyond 2 %": far,
                "limit off at most [%]": 100.0 * float(np.nanmax(apart)) if limited else None,
                "at ζ": float(found.zetas[int(np.nanargmax(apart))]) if limited else None,
            }
        )
    return table


def boundary_rows(maps: list[LinearMap]) -> list[dict[str, Any]]:
    """Both boundaries, by integrator and zeta."""
    return [
        {"integrator": m.name, "zeta": float(z), "h omega measured": float(a), "h omega theory": float(b)}
        for m in maps
        for z, a, b in zip(m.zetas, m.measured, m.theory, strict=True)
        if not math.isnan(a)
    ]
