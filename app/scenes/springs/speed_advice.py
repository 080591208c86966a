"""Advice on faster steps of a spring network."""

from app.formats.formatting import longest_step
from app.scenes.springs.methods import method_name
from sim.springs import INTEGRATORS
from sim.springs.integrators import Integrator
from sim.springs.stability import Gauge

CAUTION = 0.9  # of the limit of a method, up to which a step is proposed


def faster_steps(integrator: Integrator, gauge: Gauge, points: str, *, touches_itself: bool = False) -> str:
    """Proposals in words. gauge: of the present step; points: name of the elements that a coarser net has fewer of."""
    proposals = [f"fewer {points}"]
    if touches_itself:
        proposals.append("no self-collision")
    if integrator.implicit:
        proposals.append("a larger step")
    elif gauge.share < 0.5 * CAUTION:
        proposals.append(f"a larger step, up to {longest_step(CAUTION * gauge.critical_step)}")
    leapfrog = INTEGRATORS["leapfrog"]
    longest = leapfrog.stable_step(gauge.highest, 0.0)  # at any damping
    costs_more = integrator.evals > leapfrog.evals or integrator.implicit
    if costs_more and gauge.step < CAUTION * longest:
        proposals.append(f"leapfrog instead of {method_name(integrator.name)}")
    return either(proposals)


def either(proposals: list[str]) -> str:
    """One or more things in a sentence: a, b or c."""
    *others, last = proposals
    return f"{', '.join(others)} or {last}" if others else last
