"""Advice on the step of a spring network: faster ones, and those that are right."""

import math

from app.formats.formatting import counted, longest_step, number, percent, time_step
from app.scenes.springs.methods import method_name
from app.scenes.springs.net_motion import SolverReport
from sim.springs import INTEGRATORS
from sim.springs.integrators import Integrator
from sim.springs.stability import Gauge

CAUTION = 0.9  # of the limit of a method, up to which a step is proposed


def faster_steps(integrator: Integrator, gauge: Gauge, points: str, *, touches_itself: bool = False) -> str:
    """Proposals in words. gauge: of the present step; points: name of the elements that a coarser net has fewer of."""
    proposals, stable = [f"fewer {points}"], CAUTION * min(gauge.critical_step, gauge.landed_step)
    if touches_itself:
        proposals.append("no contact with itself")
    if integrator.implicit:
        proposals.append("a larger step")
    elif gauge.step < 0.5 * stable:
        proposals.append(f"a larger step, up to {longest_step(stable)}")
    leapfrog = INTEGRATORS["leapfrog"]
    longest = leapfrog.stable_step(gauge.highest, 0.0)  # at any damping
    costs_more = integrator.evals > leapfrog.evals or integrator.implicit
    if costs_more and gauge.step < CAUTION * longest:
        proposals.append(f"leapfrog instead of {method_name(integrator.name)}")
    return either(proposals)


def solver_words(report: SolverReport, parts: str) -> list[str]:
    """Sentences on the failures of a method. parts: name of the parts that touch."""
    words, steps = [], counted(report.steps, "step")
    if report.unsettled and report.implicit:
        words.append(f"the solver had not settled in {number(report.unsettled)} of {steps}: use a smaller time step")
    elif report.unsettled:
        words.append(f"the solver had not settled in {counted(report.unsettled, 'kick')}")
    if report.slowed:
        words.append(f"{parts} that touch were slowed down in {number(report.slowed)} of {steps}, to keep them apart")
    return words


def either(proposals: list[str]) -> str:
    """One or more things in a sentence: a, b or c."""
    *others, last = proposals
    return f"{', '.join(others)} or {last}" if others else last


def accurate_steps(gauge: Gauge, *, briefly: bool = False) -> str:
    """A sentence for a step that is stable but not right: the method that is, and the step up to which its own is.

    briefly: only the first of these.
    """
    other = f"{method_name(gauge.accurate_method)} at this step" if gauge.accurate_method else ""
    with_own = (
        f"this method up to {longest_step(rounded_down(gauge.accurate_step))}" if gauge.accurate_step > 0.0 else ""
    )
    right = [words for words in (other, with_own) if words][: 1 if briefly else 2]
    return f"Right: {either(right)}." if right else "No method is right at this step."


def error_text(error: float) -> str:
    """The relative error of oscillation and damping, in words."""
    return f"{percent(error)} off" if error < 1.0 else "more than 100\u00a0% off"


def limit_text_landed(gauge: Gauge) -> str:
    """The estimate of the largest stable step in contact, in words."""
    return f"in contact with floor or sphere, where about {longest_step(rounded_down(gauge.landed_step))} is stable"


def step_warnings(integrator: Integrator, gauge: Gauge) -> list[str]:
    """Sentences for a run without a page, if the step is stable but not right, or not stable in contact."""
    start, words = f"The time step of {time_step(gauge.step)} is stable with {method_name(integrator.name)}", []
    if gauge.is_wrong:
        error = error_text(gauge.error)
        words.append(f"{start} but not right: oscillation and damping are {error}. {accurate_steps(gauge)}")
    if gauge.is_too_long_landed:
        words.append(f"{start} now, but too long {limit_text_landed(gauge)}.")
    return words


def rounded_down(step: float) -> float:
    """A step [s] with two figures, as further ones change all the time in a moving net."""
    return -1.0 / held(-1.0 / step)


def held(limit: float) -> float:
    """A limit with two figures, rounded down, as further ones change all the time in a moving net."""
    if limit == 0.0 or math.isinf(limit):
        return limit
    unit = 10.0 ** (math.floor(math.log10(abs(limit))) - 1)
    return math.floor(limit / unit + 1e-9) * unit
