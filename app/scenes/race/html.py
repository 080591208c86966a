"""The table of a race's results as HTML. Only the view imports it."""

from app.formats.formatting import metres, metres_above, number, percent, seconds
from app.render.markup.html import (
    ERROR_COLOUR,
    WRONG_COLOUR,
    Html,
    TableCell,
    bold,
    coloured,
    escape,
    fill,
    info,
    join,
    table_head,
    table_row,
)
from app.scenes.charts import PALETTE
from app.scenes.race.entrants import RaceReadings, Result
from app.scenes.race.names import rope_name

MIN_SHOWN_ENERGY = 1e-10  # [J]: less is round-off and is shown as 0
TABLE_INFO = (
    "Step: the time step relative to the largest stable one; above 100 % a rope diverges; not right: frequency and "
    "decay are off by more than 1 %. Forces: evaluations per "
    "second of the run; time: of one step on this computer."
)
HEAD = (("error", ""), ("energy error", "J"), ("step", "of limit"), ("forces", "a second"), ("time", "a step"))


def error_text(result: Result) -> Html:
    """The distance from the reference run, as far as the reference can tell it."""
    text = metres_above(result.error_floor, result.error)
    return bold(text) if result.error >= result.error_floor else escape(text)


def energy_text(result: Result) -> str:
    """The energy [J] that the method added, negative where it took some."""
    energy = -result.numerical_dissipation
    return "0" if abs(energy) < MIN_SHOWN_ENERGY else f"{'+' if energy > 0.0 else ''}{number(energy, 2)}"


def stability_text(result: Result) -> Html:
    """The step relative to the largest stable one."""
    gauge = result.gauge
    if gauge.critical_step <= 0.0:
        return coloured("none", ERROR_COLOUR)
    text = percent(gauge.share)
    if gauge.is_wrong:
        return fill("{}, {}", text, coloured("not right", WRONG_COLOUR))
    return escape(text) if gauge.share <= 1.0 else coloured(text, ERROR_COLOUR)


def result_rows(result: Result, stiffness_differs: bool) -> Html:
    """One rope: a row with its name, and one with its numbers or with the reason why it has stopped."""
    corrections = f", {result.corrections:.1f} corrections a step" if result.corrections else ""
    title = fill(
        '<div style="padding-top:5px"><span class="springtide-dot" style="background:{}"></span> <b>{}</b>{}</div>',
        PALETTE[result.number - 1],
        rope_name(result, stiffness_differs),
        corrections,
    )
    name = table_row([TableCell(title, columns=len(HEAD))])
    if result.failure:
        failure = fill('<span style="color:{}">{}</span>', ERROR_COLOUR, result.failure)
        return join((name, table_row([TableCell(failure, columns=len(HEAD))])))
    cells = (
        error_text(result),
        energy_text(result),
        stability_text(result),
        number(round(result.evals / result.step)),
        seconds(result.step_time, 2),
    )
    return join((name, table_row(cells)))


def reference_text(readings: RaceReadings) -> Html:
    """Remarks on the reference run."""
    if readings.no_reference:
        return fill("There is no reference run: {}.", readings.no_reference)
    if readings.reference_horizon is not None:
        return fill(
            "<b>Chaotic after t = {:.1f} s</b>: two references that started 0.1 nm apart now differ by 1 % of the "
            "length, so errors after this time are meaningless. Press R to restart.",
            readings.reference_horizon,
        )
    floor = max((result.error_floor for result in readings.results), default=0.0)
    return fill("Grey: reference (Dormand-Prince 5, tolerance 1e-10), reliable to {}.", metres(floor, 2))


def errors_line(readings: RaceReadings) -> Html:
    """The ropes that are nearest to the reference run and farthest from it."""
    known = sorted((r for r in readings.results if r.error >= r.error_floor), key=lambda result: result.error)
    if not known:
        return fill("Error: below the accuracy of the reference")
    least, most = (fill("{} (rope {})", bold(metres(r.error, 2)), r.number) for r in (known[0], known[-1]))
    return fill("Error: {} to {}", least, most) if len(known) > 1 else fill("Error: {}", most)


def results_table(readings: RaceReadings) -> Html:
    """The results of all ropes, and remarks on the reference run."""
    stiffness_differs = len({result.stiffness for result in readings.results}) > 1
    rows = join(result_rows(result, stiffness_differs) for result in readings.results)
    return fill(
        '<table class="springtide-table">{}<tbody>{}</tbody></table><div>{} {}</div>',
        table_head(HEAD), rows, info(TABLE_INFO, "1. Springs"), reference_text(readings),
    )  # fmt: skip
