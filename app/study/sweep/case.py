"""One case of a sweep, from its parameters to its numbers; runs in a worker, which may be another machine."""

import math
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import app
import sim
from app.scenes import scene_named
from app.scenes.quantities import Measure, measured
from app.scenes.setups import make_setup
from app.scenes.stepping import steps_to
from app.scenes.timer import effort_clock
from sim.jit import sources_hash
from sim.validation import DivergenceError

CHECK_INTERVAL = 1 / 30  # [s] of simulated time between two checks for divergence
FINISHED, DIVERGED, FAILED = "finished", "diverged", "failed"
ENDS = (FINISHED, DIVERGED, FAILED)


class Outcome(NamedTuple):
    """The result of a case; `_asdict()` of it can be written as JSON."""

    end: str  # one of ENDS
    message: str  # reason why it did not finish, or ""
    diverged_at: float  # [s] the last time with a finite, bounded state; NaN where it did not diverge
    run_time: float  # [s] of processor time
    measures: dict[str, list[float]]  # one value for each time; NaN for times that were not reached
    labels: dict[str, tuple[str, str]]  # unit and meaning of each measure


def program() -> str:
    """The identity of this program: its version, and a hash of its sources."""
    try:
        number = version("springtide")
    except PackageNotFoundError:
        number = "from its sources"
    return f"springtide {number}, sources " + "-".join(
        sources_hash(Path(package.__path__[0]))[:8] for package in (app, sim)
    )


def failed(message: str) -> Outcome:
    """The outcome of a case that gave no numbers."""
    return Outcome(FAILED, message, math.nan, math.nan, {}, {})


def run_case(scene: str, values: dict[str, Any], times: tuple[float, ...]) -> Outcome:
    """Run one case and measure it at each of `times` [s]. An exception becomes a failed outcome."""
    kind = scene_named(scene)
    measures: dict[str, list[float]] = {}
    labels: dict[str, tuple[str, str]] = {}
    end, message, diverged_at = FINISHED, "", math.nan
    row: tuple[float, ...] = ()
    running: Any = None
    start = effort_clock()
    try:
        with np.errstate(all="ignore"):
            running = kind.make(make_setup(kind, "", values).params)
            if note := running.note:
                # Numbers of another integrator than the requested one are no result.
                return failed(note)
            for index, until in enumerate(times):
                row = advance_to(running, until) or row
                add_measures(measured(kind, running, row), index, times, measures, labels)
    except DivergenceError as reason:
        end, message, diverged_at = DIVERGED, str(reason), float(running.time)
    except Exception as error:
        end, message = FAILED, f"{type(error).__name__}: {error}"
    return Outcome(end, message, diverged_at, effort_clock() - start, measures, labels)


def add_measures(
    measures: dict[str, Measure],
    index: int,
    times: tuple[float, ...],
    values: dict[str, list[float]],
    labels: dict[str, tuple[str, str]],
) -> None:
    """Write the measures at times[index] into `values` and `labels`, as `Outcome` has them."""
    for name, measure in measures.items():
        values.setdefault(name, [math.nan] * len(times))[index] = float(measure.value)
        labels[name] = measure.unit, measure.meaning


def advance_to(running: Any, until: float) -> tuple[float, ...]:
    """Take steps up to time `until` [s]; returns the newest plot row, () for none. Raises DivergenceError."""
    row: tuple[float, ...] = ()
    due = steps_to(running, until)
    while due > 0:
        count = min(due, max(1, round(CHECK_INTERVAL / running.step)))
        advance(running, count)
        due -= count
        rows = running.take_plot_rows()
        row = rows[-1] if rows else row
    return row


def advance(running: Any, count: int) -> None:
    """Take `count` steps. If the run diverges on the way, take those before that, and raise DivergenceError.

    A scene that diverges keeps its last good state, so halving the steps finds the last good step.
    """
    while count > 0:
        try:
            running.advance(count)
            return
        except DivergenceError:
            if count == 1:
                raise
            first = count // 2
            advance(running, first)
            count -= first
