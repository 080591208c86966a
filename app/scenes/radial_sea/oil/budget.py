"""Report of the spill over hours: a table, the present oil, and the evaporation by other laws."""

from app.formats.formatting import fixed, metres, number, percent
from app.render.markup.html import Html, faint, fill, join, table
from app.scenes.quantities import read
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.quantities import OF_SPILL
from sim.ocean.weathering import OilRecord, WeatheredOil, Weathering, can_weather, oil_at, oil_records
from sim.ocean.weathering.components import CELSIUS, api_gravity, boiled_off
from sim.ocean.weathering.laws import fingas, stiver_mackay

HOURS = (1.0, 6.0, 24.0, 72.0, 120.0)  # [h] of the table's rows
FINGAS_TEMPERATURE = 180.0 + CELSIUS  # [K] up to which Fingas's law asks what has boiled off
COMPARED_HOURS = 24.0  # [h] at which laws of evaporation are compared


def budget_html(params: RadialSeaParams, weathering: Weathering | None) -> Html:
    """The whole folder; a sentence on why where a layer's spill cannot be followed, and nothing without a layer."""
    if weathering is None:
        if params.spill != "layer":
            return Html()
        return fill("The record of {} has no data on evaporation, so the oil stays fresh here.", params.oil)
    rows = [row_of(weathering.at(hours), fixed(hours, 0)) for hours in HOURS]
    now = weathering.at(params.spill_hours)
    parts = [
        table(
            (("after", "h"), ("evaporated", "%"), ("in drops", "%"), ("on the sea", "%"), ("water in it", "%")),
            [*rows, row_of(now, f"now, {number(now.hours)}")],
        ),
        now_html(params, now),
        other_laws(params, weathering),
        faint(origin_text(oil_records()[params.oil])),
    ]
    return join(parts)


def row_of(state: WeatheredOil, label: str) -> tuple[str, ...]:
    """A row of the table."""
    evaporated, dispersed, water = fractions_of(state)
    fractions = evaporated, dispersed, state.remaining, water
    return (label, *(fixed(100.0 * fraction, 1) for fraction in fractions))


def square_kilometres(state: WeatheredOil) -> str:
    """Area of the slick in the unit in which it is easily read."""
    return f"{number(1e-6 * read(OF_SPILL, 'slick_area', state))} km²"


def fractions_of(state: WeatheredOil) -> tuple[float, float, float]:
    """Fractions of the spill that have evaporated and are in drops, and that of water in the emulsion."""
    return (
        read(OF_SPILL, "evaporated", state),
        read(OF_SPILL, "dispersed", state),
        read(OF_SPILL, "water_content", state),
    )


def now_html(params: RadialSeaParams, now: WeatheredOil) -> Html:
    """The slick at the time that is shown."""
    fresh = oil_at(params.oil, params.temperature)
    return fill(
        "<div>Now: {} on {}, {} kg/m³ (fresh {}), {} mPa·s (fresh {}). At 3 % of the wind it has drifted {} km.</div>",
        metres(now.thickness, 2),
        square_kilometres(now),
        fixed(now.density, 1),
        fixed(fresh.density, 1),
        number(now.viscosity * now.density * 1e3),
        number(fresh.viscosity * 1e3),
        number(now.drift * 1e-3),
    )


def other_laws(params: RadialSeaParams, weathering: Weathering) -> Html:
    """Evaporation in a day by the laws of Fingas and of Stiver and Mackay."""
    is_crude = oil_records()[params.oil].is_crude
    distilled = boiled_off(params.oil, FINGAS_TEMPERATURE)
    by_fingas = fingas(distilled, CELSIUS + params.temperature, 60.0 * COMPARED_HOURS, is_crude=is_crude)
    exposure, api = weathering.exposure(COMPARED_HOURS), api_gravity(params.oil)
    by_mackay = stiver_mackay(exposure, CELSIUS + params.temperature, api, is_crude=is_crude)
    return fill(
        "<div>Evaporated after {} h by other laws: {} (Fingas: no wind), {} (Stiver and Mackay: one boiling curve); "
        "here {}.</div>",
        fixed(COMPARED_HOURS, 0),
        percent(by_fingas),
        percent(by_mackay),
        percent(weathering.at(COMPARED_HOURS).evaporated),
    )


def origin_text(record: OilRecord) -> str:
    """Sources of the numbers of the oil and of the laws."""
    if not record.distillation:
        known = "Its record has no distillation: boiling points are estimated from its density (Jones 1997)."
    else:
        known = "Boiling points are from its record."
    emulsion = "It forms no emulsion."
    if record.emulsion_water > 0.0:
        onset = f"once {percent(record.emulsion_onset)} has evaporated" if record.emulsion_onset else "from the start"
        emulsion = f"It takes up water {onset}, at most {percent(record.emulsion_water)}."
    return f"Fractions of the mass spilled, by the laws of NOAA's PyGNOME. {known} {emulsion}"


def budget_marks(params: RadialSeaParams, weathering: Weathering | None) -> dict[str, str]:
    """Parameter -> the line under its control."""
    if params.spill != "layer":
        return {}
    fresh = oil_at(params.oil, params.temperature)
    marks = {"temperature": f"fresh {fixed(fresh.density, 1)} kg/m³, {number(fresh.viscosity * 1e3)} mPa·s"}
    if not can_weather(params.oil):
        marks["temperature"] += "; its record has no data on evaporation"
    if weathering is None:
        return marks
    now = weathering.at(params.spill_hours)
    evaporated, dispersed, water = map(percent, fractions_of(now))
    marks["spill_hours"] = (
        f"{evaporated} evaporated, {dispersed} in drops, {percent(now.remaining)} on the sea, with {water} water in it"
    )
    marks["spread"] = f"{metres(now.thickness, 2)} on {square_kilometres(now)}"
    return marks
