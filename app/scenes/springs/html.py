"""HTML that the panels of rope, race and cloth share. Only views import it."""

import math

from app.render.colormap import css_scale
from sim.springs.stability import Gauge


def stability_bar(gauge: Gauge, *, exact: bool = True) -> str:
    """h omega as a bar up to its limit. exact: h omega is that of the state, not an upper bound of it."""
    part = gauge.h_omega / gauge.limit if gauge.limit > 0 else math.inf
    width, colour = min(part, 1.0) * 100, "#2b8a3e" if part < 0.8 else "#e67700" if part <= 1.0 else "#c92a2a"
    verdict = "stable" if part <= 1.0 else "unstable" if exact else "may be unstable"
    limit = f"limit {gauge.limit:.3g} at ζ = {gauge.zeta:.2g}" if gauge.limit < math.inf else "no limit"
    sign = "=" if exact else "≤"
    return (
        f'<div style="display:flex;justify-content:space-between"><b>h ω {sign} {gauge.h_omega:.3g}</b>'
        f'<span>{limit}</span><b style="color:{colour}">{verdict}</b></div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 8px">'
        f'<div style="height:8px;border-radius:4px;width:{width:.0f}%;background:{colour}"></div></div>'
    )


def step_mark(critical_step: float) -> str:
    """The line below the control of the time step. critical_step: the largest stable step [s], 0 or infinity too."""
    if critical_step == math.inf:
        return "every step is stable"
    return f"stable up to {critical_step:.3g} s" if critical_step > 0 else "no step is stable with this method"


def colour_scale(low: str, name: str, high: str) -> str:
    """The colour scale with what its two ends mean, and the name of the quantity."""
    return (
        f'<div style="height:8px;border-radius:4px;background:{css_scale()}"></div>'
        '<div style="display:flex;justify-content:space-between">'
        f"<span>{low}</span><span>{name}</span><span>{high}</span></div>"
    )
