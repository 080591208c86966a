"""Runs that are sampled at equal times: their arguments, the loop over their frames, and the warning of divergence."""

import math
import warnings
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.validation import argument_error, check_positive, is_whole_number

MAX_FRAMES = 10_000_000  # capacity of memory, for a small system
ROUND_OFF = 1e-9  # relative, of an interval over a step, that adds no step
SAME = 1e-14  # the same, of an interval that steps fill

Progress = Callable[[int, int], None] | None  # called with (frames done, frames)


class Sampled(Protocol):
    """A motion that goes from frame to frame."""

    def advance(self, frame: int) -> None:
        """Continue to a frame from the one before."""
        ...

    @property
    def is_bounded(self) -> bool:
        """False once anything is not finite or is out of any sane bound."""
        ...

    def sample(self, frame: int) -> None:
        """Keep the state as that of a frame."""
        ...


def frame_times(
    duration: float, frames: int, step: float | None = None, progress: Progress = None
) -> NDArray[np.float64]:
    """The times (frames,) [s] from 0 to `duration` [s]. Raises ValueError for arguments that no run can have."""
    check_positive("duration", duration, "s")
    if not is_whole_number(frames) or not 2 <= frames <= MAX_FRAMES:
        raise argument_error("frames", frames, f"a whole number from 2 to {MAX_FRAMES}")
    if step is not None:
        check_positive("step", step, "s")
    if progress is not None and not callable(progress):
        raise argument_error("progress", progress, "a function of frames done and frames, or None")
    return np.linspace(0.0, duration, int(frames))


def check_steps(duration: float, step: float, most: float, is_given: bool) -> None:
    """Raises ValueError for more than `most` steps [s], of the step if the caller gave it, else of the duration."""
    if step > 0.0 and duration / step <= most:
        return
    if is_given:
        raise argument_error("step", step, f"at least duration / {most:g} = {duration / most:g} s")
    raise argument_error("duration", duration, f"up to {most:g} steps of {step:g} s")


def steps_for(interval: float, step: float) -> int:
    """Steps that fill `interval` [s] with none longer than `step` [s], forgiving round-off in their ratio."""
    return max(1, math.ceil(interval / step * (1.0 - ROUND_OFF)))


def equal_steps(interval: float, step: float) -> tuple[int, float]:
    """Number and length [s] of the equal steps that fill `interval` [s], none longer than `step` [s].

    The length is exactly `step` where that fills the interval to round-off, whatever times the interval lies between.
    """
    count = steps_for(interval, step)
    return count, step if math.isclose(count * step, interval, rel_tol=SAME) else interval / count


def run_frames(motion: Sampled, frames: int, progress: Progress) -> int:
    """Take a motion from frame to frame; the number of frames that it has, fewer than `frames` if it diverged."""
    for frame in range(frames):
        if frame:
            motion.advance(frame)
            if not motion.is_bounded:
                return frame
        motion.sample(frame)
        if progress:
            progress(frame + 1, frames)
    return frames


def warn_of_divergence(method: str, step: float | None, diverged_at: float | None) -> None:
    """Warn the caller of the caller if a run diverged at a time [s]. step: [s], None if the method chose its own."""
    if diverged_at is None:
        return
    took = "its own steps" if step is None else f"steps of {step:g} s"
    warnings.warn(
        f"the run with {method} in {took} diverged at t = {diverged_at:g} s: later frames are NaN; "
        "critical_step(system, integrator) is the longest step that is stable at the start",
        RuntimeWarning,
        stacklevel=3,
    )
