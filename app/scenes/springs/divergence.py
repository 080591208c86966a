"""Divergence of a spring network: its last frames, the cause, and stable settings."""

import collections
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import longest_step, number, percent, time_step
from app.messages import LastFrame, vector_of
from app.scenes.contract import Advice
from app.scenes.springs.methods import method_name
from app.scenes.springs.speed_advice import limit_text_landed
from sim.springs import INTEGRATORS
from sim.springs.integrators import Integrator
from sim.springs.stability import Gauge

MOMENTS = 60  # kept: a second at 60 frames a second
MARGIN = 0.9  # of the largest stable step: the fastest motion of a run grows with its pulls
FIRST_RATE = 60  # [1/s] steps a second; others are this times a power of two
SHORTEST_STEP = 1e-5  # [s] least value of the parameter
SYMBOLS = "; h: the step, ω: the highest frequency of the springs"
MAX_OVERSHOOT = 3.0  # of the bounds, up to which moments beyond them are kept too


class LastMoments:
    """The last frames of a run."""

    def __init__(self) -> None:
        # (time [s], frame, points (n, 3) [m])
        self.frames: collections.deque[tuple[float, object, NDArray[np.float32]]] = collections.deque(maxlen=MOMENTS)

    def add(self, t: float, frame: object, points: NDArray[np.float32]) -> None:
        """Keep the frame of time t [s], unless it is kept already. points: (..., 3) [m] of the moving parts."""
        if not self.frames or self.frames[-1][0] < t:
            self.frames.append((t, frame, points.reshape(-1, 3)))

    def clear(self) -> None:
        """Clear the moments for a new run."""
        self.frames.clear()

    def __iter__(self) -> Iterator[LastFrame]:
        """The moments, with the box about their points, which only a divergence needs."""
        return (LastFrame(t, frame, vector_of(x.min(axis=0)), vector_of(x.max(axis=0))) for t, frame, x in self.frames)


def stability_number(value: float) -> str:
    """h omega or its limit, with two decimals if these are enough."""
    return f"{value:.2f}" if 0.1 <= value < 100.0 else number(value, 2)


def limit_text(gauge: Gauge) -> str:
    """The frequency nearest to its limit beside that limit, in symbols."""
    if gauge.omega == 0.0:
        return "damping alone limits it"
    return f"hω {stability_number(gauge.h_omega)} of {stability_number(gauge.limit)}"


def divergence_text(t: float, integrator: Integrator, step: float, gauge: Gauge, alternative: str) -> str:
    """The sentences for the panel. t [s]; step [s]; alternative: another stable setting, or ""."""
    method = method_name(integrator.name)
    start = f"The run became unstable at t = {t:.2f} s: its time step was"
    limit = limit_text(gauge) + (SYMBOLS if gauge.omega else "")
    if gauge.share > 1.0:
        holds = f"a time step up to {longest_step(gauge.critical_step)}" if gauge.critical_step > 0 else ""
        proposals = " or ".join(words for words in (holds, alternative) if words)
        over = f"{percent(gauge.share)} of the largest stable one" if gauge.critical_step > 0 else "too long"
        return f"{start} {over} for {method} ({limit}). Use {proposals or 'another method'}."
    if gauge.is_too_long_landed:
        return f"{start} within the limit of {method} ({limit}), but too long {limit_text_landed(gauge)}."
    return (
        f"{start} within the limit of {method} ({limit}), so an impact or a pull was too sudden for it. "
        f"Try a time step of {longest_step(step / 4)}."
    )


def short_divergence_text(t: float, gauge: Gauge) -> str:
    """Time [s] and cause of a divergence, for a table."""
    is_too_long = gauge.share > 1.0 or gauge.is_too_long_landed
    cause = "its step is too long" if is_too_long else "an impact was too sudden for its step"
    return f"diverged at {t:.2f} s: {cause} ({limit_text(gauge)})"


def leapfrog_alternative(integrator: Integrator, gauge: Gauge) -> str:
    """Words on the step at which leapfrog is stable; "" if that is no news."""
    longest = INTEGRATORS["leapfrog"].stable_step(gauge.highest, 0.0)
    if integrator.name == "leapfrog" or not 0.0 < longest < math.inf:
        return ""
    return f"leapfrog with one up to {longest_step(longest)}"


def holding_step(step: float, gauge: Gauge) -> Advice | None:
    """A time step, 1/n with a round n, at which a diverged run would have been stable, or None."""
    limit = min(gauge.critical_step, gauge.landed_step)
    largest = MARGIN * limit if step > limit else step / 4
    if not SHORTEST_STEP <= largest < math.inf:
        return None
    rate = FIRST_RATE
    while 1 / rate > largest:
        rate *= 2
    return Advice("time_step", 1 / rate, time_step(1 / rate)) if 1 / rate >= SHORTEST_STEP else None
