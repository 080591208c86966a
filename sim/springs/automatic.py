"""`auto`: which of the embedded methods runs, from the net's own frequencies and damping.

For a tolerance, `rkn8` runs, but on soft nets that are damped more strongly than the tolerance allows it `dop853` does:
there damping makes rkn8's steps short. Both end their steps on the frames; `dopri5` fills frames in between, and runs
where frames are so close that this takes fewer force evaluations. For a given step, the method runs that holds at it
with the fewest evaluations. The numbers are measured on ropes and cloths (docs/measured.md).
"""

import math
from typing import NamedTuple

import numpy as np

from sim.springs.integrators import Integrator, discover
from sim.springs.net import Net
from sim.springs.stability import gershgorin

AUTO = "auto"  # in place of a method's name
SOFT = 100.0  # radians of the fastest vibration while gravity moves the net by its size: a softer net excites it
WEAK = 1e3  # rtol over zeta^2 above which damping does not shorten rkn8's steps, over 1e-6
QUINTIC = 0.5  # h omega of dopri5 at rtol 1e-6 where accuracy sets the step; it goes with the fifth root
# Slower vibrations are damped less, in proportion to their frequency: limits are looked up for these parts of it.
PARTS = (1.0, 0.85, 0.7, 0.5, 0.3)


class Choice(NamedTuple):
    """The method that runs, and why."""

    integrator: Integrator
    reason: str


def choose_for_tolerance(net: Net, rtol: float, interval: float) -> Choice:
    """The embedded method for a tolerance and for frames `interval` [s] apart."""
    records = discover()
    omega, zeta = bounds(net)
    quintic = min(records["dopri5"].limit(zeta), QUINTIC * (1e6 * rtol) ** 0.2)
    if interval * omega < quintic * records["rkn8"].evals / records["dopri5"].evals:
        return Choice(records["dopri5"], f"frames are {interval:.2g} s apart, within its steps")
    size, pull = float(np.ptp(net.x0, axis=(1, 2)).max()), math.hypot(*net.gravity)
    is_soft = omega**2 * size < SOFT**2 * pull
    if is_soft and rtol < 1e-6 * WEAK * zeta**2:
        return Choice(records["dop853"], f"the net is soft, with a damping ratio of {zeta:.2g}")
    return Choice(records["rkn8"], "the net is stiff" if not is_soft else f"its damping ratio is {zeta:.2g}")


def choose_for_step(net: Net, h: float) -> Choice:
    """The embedded method with the fewest evaluations that holds at steps of h [s], or the one that is nearest to."""
    omega, rate = gershgorin(net)
    embedded = sorted((r for r in discover().values() if r.adaptive), key=lambda r: r.evals)
    # A motion that only damping holds, as a rope's links across themselves, is the most damped.
    modes = [*((part * omega, part**2 * rate) for part in PARTS), (0.0, rate)]
    limits = [min(record.stable_step(*mode) for mode in modes) for record in embedded]
    for record, limit in zip(embedded, limits, strict=True):
        if h <= limit:
            return Choice(record, "it is stable at this step with the fewest force evaluations")
    return Choice(embedded[limits.index(max(limits))], "it comes closest to being stable at this step")


def bounds(net: Net) -> tuple[float, float]:
    """Upper bound of the frequencies [rad/s], and the damping ratio of the fastest vibration."""
    omega, rate = gershgorin(net)
    return omega, 0.5 * rate / omega if omega > 0.0 else 0.0
