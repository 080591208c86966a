"""Energy of the undamped rope over a million steps, in a swing of 5 degrees. No method should change it."""

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.study.pool import spread
from sim.springs import INTEGRATORS, Net, rope
from sim.springs.analysis.growth import energy_course
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.state import State, energy
from sim.springs.statics import hanging_chain

STEP = 1 / 300  # [s]: h omega = 0.19 of the stiffest mode, inside the limit of every method but explicit Euler
STEPS, QUICK_STEPS = 1_000_000, 20_000
SAMPLES = 500
ANGLE = math.radians(5.0)  # small: in a large swing, energy moves slowly into the stiff modes
PARTS = 5  # into which the time series is divided; the first and the last are compared


class Drift(NamedTuple):
    """The energy error of one integrator."""

    name: str
    symplectic: bool
    t: NDArray[np.float64]  # (samples + 1,) [s]
    error: NDArray[np.float64]  # (samples + 1,) over the energy of the swing; NaN: diverged


def swing() -> Net:
    """The lab's rope without damping: straight, stretched by its weight, at an angle to the vertical."""
    net = rope(10, damping=0.0, drag=0.0, gravity=10.0)
    depth = -hanging_chain(net).x[:, 2]
    return dataclasses.replace(
        net, x0=np.stack([-depth * math.sin(ANGLE), 0.0 * depth, -depth * math.cos(ANGLE)])[:, None, :]
    )


def course(name: str, steps: int) -> NDArray[np.float64]:
    """Times and energy errors of one integrator, (2, samples + 1)."""
    net = swing()
    t, total = energy_course(INTEGRATORS[name], net, STEP, steps, SAMPLES)
    held = float(total[0]) - energy(net, resting(net)).total
    return np.array([t, (total - total[0]) / held])


def resting(net: Net) -> State:
    """The rope at rest."""
    state = State.at_rest(net)
    state.x[:] = find_rest_positions(net)
    return state


def measure(quick: bool = False, workers: int = 0) -> list[Drift]:
    """All integrators. workers: processes, 0 for one on each core."""
    courses = spread(course, [(name, QUICK_STEPS if quick else STEPS) for name in INTEGRATORS], "energy", workers)
    return [
        Drift(name, record.symplectic, *part) for (name, record), part in zip(INTEGRATORS.items(), courses, strict=True)
    ]


def rows(drifts: list[Drift]) -> list[dict[str, Any]]:
    """The table: drift by least squares, largest error, and whether the error stays bounded."""
    table = []
    for d in drifts:
        good = np.isfinite(d.error)
        t, error = d.t[good], d.error[good]
        slope = float(np.polyfit(t, error, 1)[0]) if len(t) == len(d.t) else None
        table.append(
            {
                "integrator": d.name,
                "symplectic": "yes" if d.symplectic else "no",
                "steps": round(float(t[-1]) / STEP),
                "drift per 1e6 steps": None if slope is None else slope * 1e6 * STEP,
                "error at most": float(np.abs(error).max()),
                "course": "diverged" if slope is None else course_of(error),
            }
        )
    return table


def course_of(error: NDArray[np.float64]) -> str:
    """The trend in a word: "drifts" if the mean of the last fifth is outside twice the range of the first fifth."""
    part = len(error) // PARTS
    first, last = error[:part], float(error[-part:].mean())
    if last < -0.5:
        return "comes to rest"
    return "bounded" if abs(last - 0.5 * (first.max() + first.min())) <= np.ptp(first) else "drifts"


def course_rows(drifts: list[Drift]) -> list[dict[str, Any]]:
    """All samples, one column for each integrator."""
    return [{"t [s]": float(t), **{d.name: float(d.error[i]) for d in drifts}} for i, t in enumerate(drifts[0].t)]
