"""HTML that the panels of rope, race and cloth share. Only views import it."""

import math

from app.formats.formatting import longest_step, number, percent
from app.render.colormap import css_scale
from app.render.markup.html import (
    ERROR_COLOUR,
    GOOD_COLOUR,
    WARNING_COLOUR,
    WRONG_COLOUR,
    Html,
    coloured,
    escape,
    faint,
    fill,
    info,
    join,
)
from app.scenes.springs.divergence import limit_text
from app.scenes.springs.recent_gauges import SPAN
from app.scenes.springs.speed_advice import accurate_steps, error_text, limit_text_landed, rounded_down
from sim.springs.stability import TOLERANCE, Gauge

STEP_INFO = (
    "The worst of the last {:g} s: {}. hω is the time step h times the highest frequency ω of the springs. Above its "
    "limit, which depends on the damping ratio ζ = {}, the motion grows without end. A stable step is right if "
    "frequency and decay of the motion that gravity causes are off by at most {}."
)
WARNING_SHARE = 0.8  # of the largest stable step, from which the step is shown in the colour of a warning
MUCH_SHORTER = 0.75  # of the largest stable step, below which the step in contact is shown too
UNLIMITED = 2.0  # steps that are right, in the length of the bar of a method that is stable at every step


def stability_bar(gauge: Gauge, *, exact: bool = True) -> Html:
    """The step relative to the largest stable one, and whether it is right, as a bar with a text.

    Of a stable step the bar is hatched beyond the step up to which the method is right. exact: the largest stable step
    is that of the state, not a bound of it.
    """
    colour = verdict_colour(gauge)
    full = gauge.critical_step if gauge.critical_step < math.inf else UNLIMITED * gauge.accurate_step
    used = gauge.step / full if full > 0.0 else math.inf
    right = gauge.accurate_step / full if 0.0 < full < math.inf and gauge.share <= 1.0 else 1.0
    wrong = fill('<div class="wrong" style="left:{:.0f}%"></div>', 100.0 * right) if right < 1.0 else Html("")
    return fill(
        '<div><span class="springtide-step-share">{}</span>{} {}</div>'
        '<div class="springtide-step-bar"><div class="used" style="width:{:.0f}%;background:{}"></div>{}</div>{}',
        share_text(gauge, colour, exact=exact),
        accuracy_text(gauge, colour),
        info(STEP_INFO.format(SPAN, limit_text(gauge), number(gauge.zeta, 2), percent(TOLERANCE)), "1. Springs"),
        100.0 * min(used, 1.0) if used == used else 0.0,
        colour,
        wrong,
        join(fill("<div>{}</div>", words) for words in verdicts(gauge)),
    )


def verdicts(gauge: Gauge) -> list[Html]:
    """Sentences on a stable step that is not right, or too long where the net touches something."""
    words = [escape(accurate_steps(gauge, briefly=True))] if gauge.is_wrong else []
    if gauge.is_too_long_landed:
        words.append(coloured(f"Too long {limit_text_landed(gauge)}.", WARNING_COLOUR))
    return words


def verdict_colour(gauge: Gauge) -> str:
    """The colour of a step: unstable, stable but not right, near its limit, or right."""
    if gauge.share > 1.0:
        return ERROR_COLOUR
    if gauge.is_wrong:
        return WRONG_COLOUR
    return WARNING_COLOUR if gauge.share >= WARNING_SHARE or gauge.is_too_long_landed else GOOD_COLOUR


def share_text(gauge: Gauge, colour: str, *, exact: bool) -> Html:
    """The step relative to the largest stable one, in words."""
    if gauge.critical_step == math.inf:
        return fill("Step: {}", coloured("any is stable", colour))
    if gauge.critical_step <= 0.0:
        return fill("Step: {}", coloured("none is stable with this method", colour))
    return fill(
        "Step: {} of the largest stable", coloured(f"{'' if exact else 'at most '}{percent(gauge.share)}", colour)
    )


def accuracy_text(gauge: Gauge, colour: str) -> Html:
    """Verdict on the accuracy of a stable step, in words; empty if it is unstable or not assessed."""
    if gauge.share > 1.0 or math.isnan(gauge.error):
        return Html("")
    if gauge.is_wrong:
        return fill(", {}", coloured(error_text(gauge.error), colour))
    return fill(", right to {}", percent(TOLERANCE))


def step_mark(critical_step: float, accurate_step: float = math.nan, landed_step: float = math.inf) -> str:
    """The line below the control of the time step.

    critical_step: the largest stable step [s], 0 or infinity too. accurate_step: the one up to which the method is
    right [s]; NaN: not assessed. landed_step: estimate of the largest stable one in contact with floor or sphere [s].
    """
    landed = ""
    if landed_step < MUCH_SHORTER * critical_step:
        landed = f"; in contact about {longest_step(rounded_down(landed_step))}"
    return right_mark(critical_step, accurate_step) + landed


def right_mark(critical_step: float, accurate_step: float) -> str:
    """The part of `step_mark` on the steps that are stable now, and right."""
    if critical_step <= 0.0:
        return "no step is stable with this method"
    limit = (
        "every step is stable" if critical_step == math.inf else f"limit {longest_step(rounded_down(critical_step))}"
    )
    if math.isnan(accurate_step) or (accurate_step == critical_step == math.inf):
        return limit
    if accurate_step >= critical_step:
        return f"{limit}, right below it"
    right = f"up to {longest_step(rounded_down(accurate_step))}" if accurate_step > 0.0 else "at no step"
    return f"{limit}, right {right}"


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
