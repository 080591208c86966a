"""HTML that the panels of rope, race and cloth share. Only views import it."""

import math

from app.formats.formatting import longest_step, number, percent
from app.render.colormap import css_scale
from app.render.markup.html import ERROR_COLOUR, GOOD_COLOUR, WARNING_COLOUR, Html, coloured, faint, fill, info
from app.scenes.springs.divergence import limit_text
from app.scenes.springs.recent_gauges import SPAN
from sim.springs.stability import Gauge

STEP_INFO = (
    "The worst of the last {:g} s: {}. hω is the time step h times the highest frequency ω of the springs. Above its "
    "limit, which depends on the damping ratio ζ = {}, the motion grows without end."
)
WARNING_SHARE = 0.8  # of the largest stable step, from which the step is shown in the colour of a warning


def stability_bar(gauge: Gauge, *, exact: bool = True) -> Html:
    """The step relative to the largest stable one, as a bar. exact: it is that of the state, not a bound of it."""
    share = gauge.share
    colour = GOOD_COLOUR if share < WARNING_SHARE else WARNING_COLOUR if share <= 1.0 else ERROR_COLOUR
    return fill(
        '<div><span class="springtide-step-share">{}</span> {}</div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 4px">'
        '<div style="height:8px;border-radius:4px;width:{:.0f}%;background:{}"></div></div>',
        share_text(gauge, colour, exact=exact),
        info(STEP_INFO.format(SPAN, limit_text(gauge), number(gauge.zeta, 2)), "1. Springs"),
        100.0 * min(share, 1.0),
        colour,
    )


def share_text(gauge: Gauge, colour: str, *, exact: bool) -> Html:
    """The step relative to the largest stable one, in words."""
    if gauge.critical_step == math.inf:
        return fill("Step: {}", coloured("any is stable", colour))
    if gauge.critical_step <= 0.0:
        return fill("Step: {}", coloured("none is stable with this method", colour))
    return fill(
        "Step: {} of the largest stable", coloured(f"{'' if exact else 'at most '}{percent(gauge.share)}", colour)
    )


def step_mark(critical_step: float) -> str:
    """The line below the control of the time step. critical_step: the largest stable step [s], 0 or infinity too."""
    if critical_step == math.inf:
        return "every step is stable"
    if critical_step <= 0.0:
        return "no step is stable with this method"
    return f"limit {longest_step(-1.0 / held(-1.0 / critical_step))}"


def held(limit: float) -> float:
    """A limit with two figures, rounded down, as further ones change all the time in a moving net."""
    if limit == 0.0 or math.isinf(limit):
        return limit
    unit = 10.0 ** (math.floor(math.log10(abs(limit))) - 1)
    return math.floor(limit / unit + 1e-9) * unit


def simple_drawing(quantity: str) -> Html:
    """The line that stands for the scale of a quantity in browsers that draw no colours of it."""
    return faint(f"Simple drawing: no colours of the {quantity}.")


def colour_scale(low: str, name: object, high: str, *, clipped: bool) -> Html:
    """The colour scale with the values of its two ends, and the name of the quantity.

    clipped: something has a larger value than the end of the scale.
    """
    return fill(
        '<div class="springtide-scale" style="--light-scale:{};--dark-scale:{}"></div>'
        '<div style="display:flex;justify-content:space-between">'
        "<span>{}</span><span>{}</span><span>{}</span></div>",
        Html(css_scale(dark=False)),
        Html(css_scale(dark=True)),
        low,
        name,
        f"{high} and more" if clipped else high,
    )
