"""The table of a race's results as HTML. Only the view imports it."""

import math

from app.render.html import ERROR_COLOUR, Html, bold, escape, fill, join, metres, seconds
from app.scenes.charts import PALETTE
from app.scenes.race.entrants import RaceReadings, Result
from app.scenes.race.names import rope_name

MIN_SHOWN_ENERGY = 1e-10  # [J]: less is round-off and is shown as 0


def error_text(result: Result) -> Html:
    """The distance from the reference run, as far as the reference can tell it."""
    if math.isnan(result.error_floor):
        return escape("no reference to compare with")
    if result.error < result.error_floor:
        return fill("off by less than {}", metres(result.error_floor))
    return fill("off by {}", bold(metres(result.error)))


def outcome(result: Result) -> Html:
    """Why the rope failed, or its error and what its method took."""
    if result.failure:
        return fill('<span style="color:{}">{}</span>', ERROR_COLOUR, result.failure)
    energy = result.numerical_dissipation if abs(result.numerical_dissipation) > MIN_SHOWN_ENERGY else 0.0
    verb = "took" if energy >= 0 else "added"
    return fill("{} · method {} {:.2g} J", error_text(result), verb, abs(energy))


def cost(result: Result) -> Html:
    """How near its limit the step is, and what it costs."""
    stable = result.gauge.h_omega <= result.gauge.limit
    return fill(
        '<span style="color:{}">h ω {:.3g} of {}</span> · {:.0f} forces/s · {} a step{}',
        "inherit" if stable else ERROR_COLOUR,
        result.gauge.h_omega,
        "any" if math.isinf(result.gauge.limit) else f"{result.gauge.limit:.3g}",
        result.evals / result.step,
        seconds(result.step_time),
        f" · {result.corrections:.1f} Newton corrections a step" if result.corrections else "",
    )


def result_block(result: Result, stiffness_differs: bool) -> Html:
    """One rope: its name, and below it how accurate it is and what it costs."""
    return fill(
        '<div><span style="color:{};font-size:15px;line-height:11px">●</span> <b>{}</b></div>'
        '<div style="padding-left:17px;font-size:11px;margin-bottom:5px"><div>{}</div>{}</div>',
        PALETTE[result.number - 1],
        rope_name(result, stiffness_differs),
        outcome(result),
        cost(result),
    )


def reference_text(readings: RaceReadings) -> Html:
    """What is to be said of the reference run."""
    if readings.no_reference:
        return fill("There is no reference run: {}.", readings.no_reference)
    if readings.reference_horizon is not None:
        return fill(
            "<b>Chaos made the reference run meaningless at t = {:.1f} s</b>: a second run, which started 0.1 nm away, "
            "was then a hundredth of the rope's length away from it. Errors after that time mean nothing. Reset starts "
            "again.",
            readings.reference_horizon,
        )
    floor = max((result.error_floor for result in readings.results), default=0.0)
    return fill(
        "Grey: the reference run, dopri5 at a tolerance of 1e-10. A second run, which started 0.1 nm away, shows "
        "that it can tell errors above {}.",
        metres(floor),
    )


def results_table(readings: RaceReadings) -> Html:
    """The results of all ropes, and what is to be said of the reference run."""
    stiffness_differs = len({result.stiffness for result in readings.results}) > 1
    blocks = join(result_block(result, stiffness_differs) for result in readings.results)
    return fill('{}<div style="font-size:11px;opacity:.75">{}</div>', blocks, reference_text(readings))
