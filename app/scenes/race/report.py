"""The race in words: what each rope is called, and the table of results as HTML."""

import html
import math
from typing import Protocol

from app.scenes.charts import PALETTE
from app.scenes.race.entrants import RaceReadings, Result

MIN_SHOWN_ENERGY = 1e-10  # [J]: less is round-off and is shown as 0


class Named(Protocol):
    """What `rope_name` needs of an entrant."""

    number: int
    step: float

    @property
    def name(self) -> str:
        """Name of the method."""
        ...

    @property
    def stiffness(self) -> float:
        """[N/m]."""
        ...


def step_text(step: float) -> str:
    """A step [s] in a few characters: 1/240 s where it is nearly one over a whole number, else in ms."""
    whole = round(1.0 / step)
    if whole >= 10 and abs(whole * step - 1.0) < 1e-4 and whole <= 10_000:
        return f"1/{whole} s"
    return f"{1e3 * step:.3g} ms"


def name_of(number: int, integrator: str, step: float, stiffness: float, stiffness_differs: bool) -> str:
    """A rope by number, method and step [s], and by its stiffness [N/m] where the ropes differ in it."""
    words = f"{number} {integrator}, {step_text(step)}"
    return f"{words}, k {stiffness:g}" if stiffness_differs else words


def rope_name(entrant: Named, stiffness_differs: bool) -> str:
    """The name of an entrant."""
    return name_of(entrant.number, entrant.name, entrant.step, entrant.stiffness, stiffness_differs)


def label_of(entrant: Named, failure: str, stiffness_differs: bool) -> str:
    """The label at its root. A failure comes first, as a label may reach out of view."""
    words = rope_name(entrant, stiffness_differs)
    return f"{entrant.number} {failure.partition(':')[0]}: {words.partition(' ')[2]}" if failure else words


def metres(value: float) -> str:
    """A length [m] in the unit that suits it."""
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)):
        if value >= 0.9995 * size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.1e} m"


def seconds(value: float) -> str:
    """A time [s] in µs or ms."""
    return f"{1e6 * value:.3g} µs" if value < 1e-3 else f"{1e3 * value:.3g} ms"


def error_text(result: Result) -> str:
    """The distance from the reference run, as far as the reference can tell it."""
    if math.isnan(result.error_floor):
        return "no reference to compare with"
    if result.error < result.error_floor:
        return f"off by less than {metres(result.error_floor)}"
    return f"off by <b>{metres(result.error)}</b>"


def result_row(result: Result, stiffness_differs: bool) -> str:
    """One rope: its name, and below it how accurate it is and what it costs."""
    dot = f'<span style="color:{PALETTE[result.number - 1]};font-size:15px;line-height:11px">●</span>'
    limit = "any" if math.isinf(result.gauge.limit) else f"{result.gauge.limit:.3g}"
    colour = "inherit" if result.gauge.h_omega <= result.gauge.limit else "#c92a2a"
    name = name_of(result.number, result.integrator, result.step, result.stiffness, stiffness_differs)
    head = f"<div>{dot} <b>{html.escape(name)}</b></div>"
    gauge = f'<span style="color:{colour}">h ω {result.gauge.h_omega:.3g} of {limit}</span>'
    newton = f" · {result.corrections:.1f} Newton corrections a step" if result.corrections else ""
    if result.failure:
        outcome = f'<span style="color:#c92a2a">{html.escape(result.failure)}</span>'
    else:
        energy = result.numerical_dissipation if abs(result.numerical_dissipation) > MIN_SHOWN_ENERGY else 0.0
        outcome = f"{error_text(result)} · method {'took' if energy >= 0 else 'added'} {abs(energy):.2g} J"
    cost = f"{gauge} · {result.evals / result.step:.0f} forces/s · {seconds(result.step_time)} a step{newton}"
    return f'{head}<div style="padding-left:17px;font-size:11px;margin-bottom:5px"><div>{outcome}</div>{cost}</div>'


def results_table(readings: RaceReadings) -> str:
    """The results and what is to be said of the reference run, as HTML."""
    stiffness_differs = len({result.stiffness for result in readings.results}) > 1
    rows = "".join(result_row(result, stiffness_differs) for result in readings.results)
    if readings.no_reference:
        text = f"There is no reference run: {html.escape(readings.no_reference)}."
    elif readings.reference_horizon is not None:
        text = (
            f"<b>Chaos made the reference run meaningless at t = {readings.reference_horizon:.1f} s</b>: a second run, "
            "which started 0.1 nm away, was then a hundredth of the rope's length away from it. Errors after that time "
            "mean nothing. Reset starts again."
        )
    else:
        floor = max((result.error_floor for result in readings.results), default=0.0)
        text = (
            "Grey: the reference run, dopri5 at a tolerance of 1e-10. A second run, which started 0.1 nm away, shows "
            f"that it can tell errors above {metres(floor)}."
        )
    return f'{rows}<div style="font-size:11px;opacity:.75">{text}</div>'
