"""Energy over a million steps of the undamped rope: what no method should gain or lose."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.stability.pool import spread
from sim.springs import INTEGRATORS, rope
from sim.springs.growth import energy_course

STEP = 1 / 300  # [s]: h omega = 0.19 of the stiffest mode, where every method but explicit Euler is at home
STEPS, QUICK_STEPS = 1_000_000, 20_000
SAMPLES = 500
BOUNDED = 1.5  # times its largest error in the first half that a bounded energy may have in the second


class Drift(NamedTuple):
    """One integrator."""

    name: str
    symplectic: bool
    t: NDArray[np.float64]  # (samples + 1,) [s]
    error: NDArray[np.float64]  # (samples + 1,) of the energy, in parts of what the rope can fall; NaN: diverged


def course(name: str, steps: int) -> NDArray[np.float64]:
    """Times and energy errors of one integrator, (2, samples + 1)."""
    net = rope(10, damping=0.0, drag=0.0)
    t, total = energy_course(INTEGRATORS[name], net, STEP, steps, SAMPLES)
    # From level to hanging: sum of m g times each point's place along the rope.
    fall = net.mass * abs(net.gravity[2]) * float(np.abs(net.x0 - net.x0[:, :, :1]).sum())
    return np.array([t, (total - total[0]) / fall])


def measure(quick: bool = False, workers: int = 0) -> list[Drift]:
    """Every integrator there is."""
    found = spread(course, [(name, QUICK_STEPS if quick else STEPS) for name in INTEGRATORS], "energy", workers)
    return [
        Drift(name, record.symplectic, *part) for (name, record), part in zip(INTEGRATORS.items(), found, strict=True)
    ]


def rows(drifts: list[Drift]) -> list[dict[str, Any]]:
    """The table: slope of the error by least squares, its largest size, and whether it stays within bounds."""
    table = []
    for d in drifts:
        good = np.isfinite(d.error)
        t, error = d.t[good], d.error[good]
        whole = bool(good.all())
        half = len(error) // 2
        first, second = np.abs(error[:half]).max(initial=0.0), np.abs(error[half:]).max(initial=0.0)
        table.append(
            {
                "integrator": d.name,
                "symplectic": "yes" if d.symplectic else "no",
                "steps": round(float(t[-1]) / STEP),
                "slope [1/s]": float(np.polyfit(t, error, 1)[0]) if whole else None,
                "error at most": float(np.abs(error).max()),
                "bounded": "yes" if whole and second <= BOUNDED * first else "no" if whole else "diverged",
            }
        )
    return table


def course_rows(drifts: list[Drift]) -> list[dict[str, Any]]:
    """Every sample, a column an integrator."""
    return [{"t [s]": float(t), **{d.name: float(d.error[i]) for d in drifts}} for i, t in enumerate(drifts[0].t)]
