"""HTML that the panels of rope, race and cloth share. Only views import it."""

import math

from app.formats.formatting import number, seconds
from app.render.colormap import css_scale
from app.render.html import ERROR_COLOUR, GOOD_COLOUR, WARNING_COLOUR, Html, coloured, fill
from app.scenes.springs.divergence import stability_number
from sim.springs.stability import Gauge

WARNING_SHARE = 0.8  # of the limit, from which h omega is shown in the colour of a warning


def stability_bar(gauge: Gauge, *, exact: bool = True) -> Html:
    """h omega as a bar up to its limit. exact: h omega is that of the state, not an upper bound of it."""
    share = gauge.h_omega / gauge.limit if gauge.limit > 0 else math.inf
    colour = GOOD_COLOUR if share < WARNING_SHARE else WARNING_COLOUR if share <= 1.0 else ERROR_COLOUR
    verdict = "stable" if share <= 1.0 else "unstable" if exact else "may be unstable"
    limit = "no limit"
    if gauge.limit < math.inf:
        limit = f"limit {stability_number(gauge.limit)} at ζ = {number(gauge.zeta, 2)}"
    return fill(
        '<div style="display:flex;justify-content:space-between"><b>hω {} {}</b><span>{}</span>{}</div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 8px">'
        '<div style="height:8px;border-radius:4px;width:{:.0f}%;background:{}"></div></div>',
        "=" if exact else "≤",
        stability_number(gauge.h_omega),
        limit,
        coloured(verdict, colour),
        100.0 * min(share, 1.0),
        colour,
    )


def step_mark(critical_step: float) -> str:
    """The line below the control of the time step. critical_step: the largest stable step [s], 0 or infinity too."""
    if critical_step == math.inf:
        return "every step is stable"
    return f"stable up to {seconds(critical_step)}" if critical_step > 0 else "no step is stable with this method"


def colour_scale(low: str, name: str, high: str) -> Html:
    """The colour scale with the values of its two ends, and the name of the quantity."""
    return fill(
        '<div class="springtide-scale" style="--light-scale:{};--dark-scale:{}"></div>'
        '<div style="display:flex;justify-content:space-between">'
        "<span>{}</span><span>{}</span><span>{}</span></div>",
        Html(css_scale(dark=False)),
        Html(css_scale(dark=True)),
        low,
        name,
        high,
    )
