"""Maps over h omega and zeta of the linear oscillator: measured growth and error, and the limit of stability beside
theory."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.study.pool import spread
from sim.springs import INTEGRATORS
from sim.springs.analysis.accuracy import mode_errors
from sim.springs.analysis.growth import growth, measured_limit, step_changes
from sim.springs.stability import TOLERANCE

MAX_H_OMEGA = 4.0
MAX_ZETA = 2.0
LIMIT_TOLERANCE = 0.02  # relative: cells nearer than this to the limit may grow or not
ZERO_LIMIT = 0.02  # h omega: a limit below this counts as 0


class LinearMap(NamedTuple):
    """The map of one integrator."""

    name: str
    zetas: NDArray[np.float64]  # (rows,)
    steps: NDArray[np.float64]  # (cols,) h omega
    rates: NDArray[np.float64]  # (rows, cols) logarithm of the amplitude per step; NaN where damping is refused
    measured: NDArray[np.float64]  # (rows,) h omega at which growth begins; inf: there is no growth
    theory: NDArray[np.float64]  # (rows,)
    errors: NDArray[np.float64]  # (rows, cols) relative error of oscillation and damping, from one step of the kernel


def row(
    name: str, zeta: float, steps: NDArray[np.float64], max_steps: int
) -> tuple[NDArray[np.float64], float, NDArray[np.float64]]:
    """Growth rates (cols,) at each step, the h omega at which growth begins, and errors (cols,)."""
    record = INTEGRATORS[name]
    if record.undamped_only and zeta > 0.0:
        return np.full(len(steps), math.nan), math.nan, np.full(len(steps), math.nan)
    rates = np.array([growth(record, zeta, float(z), max_steps) for z in steps])
    changes = np.array([step_changes(record, zeta, float(z)) for z in steps]).T
    errors = mode_errors(lambda *_: changes, np.ones_like(steps), np.full_like(steps, 2.0 * zeta), steps)
    return rates, measured_limit(record, zeta, steps, rates, 8 * max_steps), errors


def measure(quick: bool = False, workers: int = 0) -> list[LinearMap]:
    """All integrators. workers: processes, 0 for one on each core."""
    rows, cols, max_steps = (9, 24, 1 << 16) if quick else (41, 100, 1 << 18)
    zetas, steps = np.linspace(0.0, MAX_ZETA, rows), MAX_H_OMEGA * (np.arange(cols) + 0.5) / cols
    tasks = [(name, float(zeta), steps, max_steps) for name in INTEGRATORS for zeta in zetas]
    map_rows = spread(row, tasks, "h ω and ζ", workers)
    maps = []
    for i, (name, record) in enumerate(INTEGRATORS.items()):
        own = map_rows[i * rows : (i + 1) * rows]
        theory = np.array([record.limit(float(zeta)) for zeta in zetas])
        maps.append(
            LinearMap(
                name,
                zetas,
                steps,
                np.array([one[0] for one in own]),
                np.array([one[1] for one in own]),
                theory,
                np.array([one[2] for one in own]),
            )
        )
    return maps


def deviations(linear_map: LinearMap) -> NDArray[np.float64]:
    """Relative distance (rows,) of the measured limit from theory; NaN where neither has one."""
    measured, theory = linear_map.measured, linear_map.theory
    seen = theory <= linear_map.steps[-1]
    apart = np.full(len(theory), math.nan)
    for i in np.flatnonzero(np.isfinite(linear_map.rates[:, 0])):
        if seen[i] or math.isfinite(measured[i]):
            near_0 = max(measured[i], theory[i]) < ZERO_LIMIT
            apart[i] = 0.0 if near_0 else abs(measured[i] - theory[i]) / max(min(measured[i], theory[i]), 1e-9)
    return apart


def disagreements(linear_map: LinearMap) -> tuple[int, int, int]:
    """Three numbers of cells: (disagree, not within 2 % of the limit, stable again).

    A cell disagrees if it grows below the limit of theory, or is stable above it. Not counted are cells that are stable
    again above cells that grow: theory gives the lowest limit only.
    """
    z, limit = linear_map.steps[None, :], linear_map.theory[:, None]
    grows = linear_map.rates > 0.0
    again = ~grows & np.logical_or.accumulate(grows, axis=1)
    wrong = (grows != (z > limit)) & ~again & ~np.isnan(linear_map.rates)
    return int(wrong.sum()), int((wrong & (np.abs(z - limit) > LIMIT_TOLERANCE * limit)).sum()), int(again.sum())


def extra_damping(linear_map: LinearMap) -> NDArray[np.float64]:
    """Damping ratio (rows, cols) that the method adds to that of the oscillator, for the slower of its two modes."""
    zeta = linear_map.zetas[:, None]
    own = np.where(zeta > 1.0, zeta - np.sqrt(np.maximum(zeta**2 - 1.0, 0.0)), zeta)
    return -linear_map.rates / linear_map.steps[None, :] - own


def right_up_to(linear_map: LinearMap) -> float:
    """The largest h omega of the map up to which an undamped oscillator is right to 1 %, measured; 0: none."""
    wrong = (linear_map.errors[0] > TOLERANCE) | (linear_map.rates[0] > 0.0)
    first = int(wrong.argmax()) if wrong.any() else len(wrong)
    return float(linear_map.steps[first - 1]) if first else 0.0


def rows(maps: list[LinearMap]) -> list[dict[str, Any]]:
    """The table: disagreement of measurement and theory, for each integrator."""
    table = []
    for linear_map in maps:
        wrong, far, again = disagreements(linear_map)
        apart = deviations(linear_map)
        limited = bool(np.isfinite(apart).any())
        table.append(
            {
                "integrator": linear_map.name,
                "cells": int((~np.isnan(linear_map.rates)).sum()),
                "grow": int((linear_map.rates > 0.0).sum()),
                "stable again": again,
                "disagree": wrong,
                "beyond 2 %": far,
                "limit off at most [%]": 100.0 * float(np.nanmax(apart)) if limited else None,
                "right up to h ω, ζ = 0": right_up_to(linear_map),
                "at ζ": float(linear_map.zetas[int(np.nanargmax(apart))]) if limited else None,
            }
        )
    return table


def boundary_rows(maps: list[LinearMap]) -> list[dict[str, Any]]:
    """The measured limit and that of theory, for each integrator and zeta."""
    return [
        {"integrator": m.name, "zeta": float(z), "h omega measured": float(a), "h omega theory": float(b)}
        for m in maps
        for z, a, b in zip(m.zetas, m.measured, m.theory, strict=True)
        if not math.isnan(a)
    ]
