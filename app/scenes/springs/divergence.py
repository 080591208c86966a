"""Why a net of springs left its bounds, and what would hold, in words."""

from sim.springs.integrators import Integrator
from sim.springs.stability import Gauge


def divergence_text(thing: str, t: float, integrator: Integrator, step: float, gauge: Gauge, alternative: str) -> str:
    """The sentences for the panel. thing: "rope" or "cloth"; t [s]; step [s]; alternative: what else would hold."""
    start = f"The {thing} left its bounds at t = {t:.2f} s: h ω = {gauge.h_omega:.3g}"
    if gauge.h_omega > gauge.limit:
        step_that_holds = f"A step below {gauge.critical_step:.3g} s" if gauge.critical_step > 0 else "No step"
        return (
            f"{start} is over {integrator.name}'s limit {gauge.limit:.3g} at damping ratio {gauge.zeta:.3g}. "
            f"{step_that_holds} would hold; {alternative}."
        )
    return (
        f"{start} is within the limit {gauge.limit:.3g} of {integrator.name}, so an impact or a pull was too sudden "
        f"for the step. Try h = {step / 4:.3g} s."
    )
