"""The panel's texts of the radial sea: drafts, the lab's claims beside physics, radial beside square surface."""

import functools
import math
from collections.abc import Callable, Sequence

import numpy as np

from app.formats.formatting import fixed, metres, number, percent, seconds
from app.messages import Snapshot
from app.render.markup.html import Html, bold, faint, fill, info, join, table
from app.scenes.measured_sea import files_folder, measured_text
from app.scenes.quantities import read, written
from app.scenes.radial_sea.bodies import BodyReading
from app.scenes.radial_sea.frame import RadialReadings
from app.scenes.radial_sea.oil.budget import budget_html, budget_marks
from app.scenes.radial_sea.oil.well_blowout import CROSSING_WAVE, OilBudget
from app.scenes.radial_sea.parameters import conditions_of, spectrum_of
from app.scenes.radial_sea.quantities import OF_BODY, OF_OIL_BUDGET, QUANTITIES
from sim.ocean.fluids.emulsions import MIXTURE_LAWS
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.oil_film import appearance
from sim.ocean.radial.gerstner import peak_wavenumber
from sim.ocean.weathering.components import WARM
from sim.parameters import parameters_of

SHORT_WAVE = 1.0  # [m] length of the wave in statements about viscosity
HEIGHT = (
    "Significant height: the mean of the highest third of the waves, from trough to crest. Mean slope: the root of the "
    "mean squared slope."
)
LEAST_LEFT = 1e-3  # fraction of a wave, below which no number is shown
SURFACES = (("sum", "radial sum"), ("fft", "square FFT"))


def draft_text(value: float) -> str:
    """A draft [m], or that the body sinks."""
    return "sinks" if math.isinf(value) else fixed(value, 3)


def readout_of(snapshot: Snapshot) -> Html:
    """Under the status line: the draft of each body, then the waves and the oil of the jet."""
    readings: RadialReadings = snapshot.readings
    params = snapshot.frame.params
    parts = [drafts_html(readings, params.waves), waves_text(readings)]
    if params.spectrum_file and params.waves:
        parts.append(measured_text(params))
    if readings.oil_budget.ejected > 0.0:
        parts.append(oil_budget_text(readings.oil_budget))
    return join(parts)


def hundredths(value: float) -> str:
    """A number with two decimals."""
    return fixed(value, 2)


def bold_draft(value: float) -> Html:
    """The draft that a table is about."""
    return bold(draft_text(value))


def body_table(title: str, bodies: Sequence[BodyReading], *columns: tuple[str, str, Callable[[float], object]]) -> Html:
    """Quantities of bodies. columns: name of the quantity, heading, and writer of the number."""
    heads = ((title, ""), *((heading, OF_BODY[name].unit) for name, heading, _ in columns))
    return table(
        heads, [(one.title, *(write(read(OF_BODY, name, one)) for name, _, write in columns)) for one in bodies]
    )


def drafts_html(readings: RadialReadings, waves: bool) -> Html:
    """The draft of each body; waves: whether there are any."""
    if not readings.bodies:
        return Html("<div>No bodies.</div>")
    drafts = body_table(
        "draft", readings.bodies, ("draft", "now", draft_text), ("mean_draft", "mean of 60 s", bold_draft)
    )
    disturbed = " Waves disturb it: switch them off to compare it with theory." if waves else ""
    return join((
        drafts,
        faint(f"Draft: how deep a body reaches into the water.{disturbed}"),
    ))  # fmt: skip


def theory_html(readings: RadialReadings) -> Html:
    """The draft of each body at rest by Archimedes' principle."""
    added = "added_draft", "oil adds", lambda value: fixed(value, 3, sign=True) if math.isfinite(value) else "sinks"
    return join((
        body_table("draft", readings.bodies, ("draft_at_rest", "at rest", bold_draft), added),
        faint("A body at rest displaces its own weight of these fluids."),
    ))  # fmt: skip


def forces_html(readings: RadialReadings) -> Html:
    """Weight, buoyancy, mooring and heave period of each body."""
    approximated = [body.title for body in readings.bodies if not body.has_own_coefficients]
    note = faint(
        f"{', '.join(approximated)}: added mass, damping and wave forces are those of the box with its volume and "
        "waterplane. The command springtide hydrodynamics HULL computes its own."
    )
    outside = [
        faint(
            f"{body.title}: {body.prediction.outside} is outside the table of coefficients: added mass, damping and "
            "wave forces are taken from its edge."
        )
        for body in readings.bodies
        if body.prediction.outside
    ]
    return join((
        *weight_tables(readings),
        body_table(
            "heave period", readings.bodies, ("heave_period", "measured", hundredths),
            ("heave_period_theory", "theory", hundredths),
        ),
        body_table(
            "mooring lines", readings.bodies, ("offset", "offset", hundredths),
            ("line_tension", "largest tension", number),
        ),
        *([note] if approximated else []),
        *outside,
    ))  # fmt: skip


def weight_tables(readings: RadialReadings) -> tuple[Html, ...]:
    """Weights and the buoyancy that carries them, with all that Archimedes' sum is made of, and mean upward forces."""
    gravity = readings.column.gravity
    weights = [
        (body.title, fixed(body.density, 0), number(body.volume, 4), number(body.mass, 4),
         number(body.mass * gravity, 4)) for body in readings.bodies
    ]  # fmt: skip
    layered = readings.column.kind == "layer" or any(body.wet_volume[1] > 0.0 for body in readings.bodies)
    forces = [
        (body.title, *(number(v, 4) for v in (body.wet_volume if layered else body.wet_volume[:1])),
         number(body.buoyancy, 4)) for body in readings.bodies
    ]  # fmt: skip
    means = [
        (body.title, number(body.mass * gravity, 4), *(number(force, 4) for force in body.mean_lift))
        for body in readings.bodies
    ]  # fmt: skip
    wet = (("wet in oil", "m³"), ("in water", "m³")) if layered else (("wet volume", "m³"),)
    return (
        table((("weight", ""), ("density", "kg/m³"), ("volume", "m³"), ("mass", "kg"), ("weight", "N")),
              weights),
        table((("buoyancy now", ""), *wet, ("buoyancy", "N")), forces),
        table((("mean upward force, 60 s", ""), ("weight", "N"), ("buoyancy", "N"), ("waves", "N"), ("drag", "N"),
               ("own motion", "N")), means),
        faint("On average buoyancy carries the weight. Waves, drag and reactions to the motion (added mass, "
              "radiated waves, lines, a pull) push up and down, and nearly cancel over a minute."),
    )  # fmt: skip


def waves_text(readings: RadialReadings) -> Html:
    """Height and slope of the waves, with the height without oil where oil has lowered it."""
    if readings.clean_height == 0.0:
        return Html("<div>No waves.</div>")
    height, clean = number(readings.height), number(readings.clean_height)
    lowered = f" ({clean} m without oil)" if clean != height else ""
    slope = number(math.sqrt(readings.slope), 2)
    return fill(
        "<div>Significant height {} {} m{}, mean slope {}.</div>", info(HEIGHT, "2. Waves"), height, lowered, slope
    )


def oil_budget_text(budget: OilBudget) -> Html:
    """Place of the jet's oil, and the damping of a wave by its slick."""
    left = percent(budget.wave_left, 3) if budget.wave_left >= LEAST_LEFT else f"less than {percent(LEAST_LEFT)}"
    calmed = (
        "" if math.isnan(budget.wave_left) else f" A wave of {CROSSING_WAVE:g} m keeps {left} of its height across it."
    )
    return fill(
        "<div>Oil released: {}; {} in the air, {} on the sea. Slick: radius {}, thickness {}.{}</div>",
        *(written(OF_OIL_BUDGET, name, budget) for name in OF_OIL_BUDGET), metres(budget.thickness, 2), calmed,
    )  # fmt: skip


def notes_of(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> HTML of the folders below the controls."""
    return {
        "Archimedes' principle": theory_html(snapshot.readings),
        "Forces": forces_html(snapshot.readings),
        "Fluids": fluids_html(snapshot),
        "Spill budget": budget_html(snapshot.frame.params, snapshot.readings.weathering),
        "Radial or square": surfaces_html(snapshot),
        **files_folder(snapshot.frame.params),
    }


def mixture_html(column: FluidColumn, law: str) -> Html:
    """Viscosity of the mixture, its law, the dispersed and the continuous fluid, and the law's validity."""
    water = number(column.water.viscosity * 1e3)
    kinds = (
        "Oil and water do not dissolve in each other: they form an emulsion, oil in water or, in most spills at sea, "
        "water in oil (mousse). Arrhenius' law is that of a true solution, the lab's 'entirely mixed'."
    )
    return fill(
        "{} mPa·s ({}); that of water is {} mPa·s, of the oil {} mPa·s. {}{}",
        number(column.surface.viscosity * 1e3),
        law,
        water,
        number(column.oil.viscosity * 1e3),
        f"{drops_text(column)} " if MIXTURE_LAWS[column.law].is_emulsion else "",
        kinds,
    )


def drops_text(column: FluidColumn) -> str:
    """Continuous fluid and drop fraction of an emulsion, and the law's validity."""
    kind = "water in oil" if drops_of(column) == "water" else "oil in water"
    ratio = column.surface.viscosity / column.continuous_fluid.viscosity
    times = f"{number(ratio)} times as viscous as the {kind.split()[-1]} alone"
    text = f"It is {kind}: {percent(column.drops)} drops, {times}."
    limit = MIXTURE_LAWS[column.law].max_drops
    if column.drops <= limit:
        return text
    much = "far too low" if column.law == "taylor" else "outside what was measured"
    return f"{text} This law holds up to {limit:.0%} of drops; here it is {much}."


def drops_of(column: FluidColumn) -> str:
    """The fluid that an emulsion's drops are of."""
    return "water" if column.continuous_fluid is column.oil else "oil"


def fluids_html(snapshot: Snapshot) -> Html:
    """The fluids in use."""
    column: FluidColumn = snapshot.readings.column
    p = snapshot.frame.params
    warmth = p.temperature if p.spill == "layer" else WARM
    head = (("", ""), ("density ρ", "kg/m³"), ("viscosity μ", "mPa·s"), ("ν = μ/ρ", "m²/s"), ("index n", ""))
    fluids = [column.water, column.oil, *([column.surface] if column.kind == "mixed" else [])]
    rows = [
        (f"{f.name}, {warmth if f is column.oil else WARM:g} °C", fixed(f.density, 1), number(f.viscosity * 1e3),
         number(f.kinematic_viscosity), fixed(f.refractive_index, 3)) for f in fluids
    ]  # fmt: skip
    law = parameters_of(snapshot.frame.params)["mixture_law"].title_of(column.law)
    return join((
        table(head, rows),
        mixture_html(column, law) if column.kind == "mixed" else "",
        faint("ν: kinematic viscosity; n: refractive index. Oils: NOAA's records."),
    ))  # fmt: skip


def surfaces_html(snapshot: Snapshot) -> Html:
    """The lab's question 1.2-6, answered by measurement on request."""
    readings: RadialReadings = snapshot.readings
    if not readings.surfaces:
        return Html()
    surfaces = [(title, readings.surfaces[name]) for name, title in SURFACES if name in readings.surfaces]
    head = (("", ""), *((title, "") for title, _ in surfaces))
    rows = (
        ("cost [ms]", *(fixed(s.cost * 1e3, 2) for _, s in surfaces)),
        ("waves", *(number(s.waves) for _, s in surfaces)),
        ("shortest wave", *(metres(s.shortest, 2) for _, s in surfaces)),
        ("extent", *(metres(s.extent, 3) for _, s in surfaces)),
        ("significant height [m]", *(fixed(s.height, 2) for _, s in surfaces)),
        ("error of the height", *(percent(s.error) for _, s in surfaces)),
        ("mean square slope", *(number(s.slope) for _, s in surfaces)),
    )
    return join((
        table(head, rows),
        "Both on the same vertices, timed just now. The error is that of the expected height, against the whole "
        "spectrum on the same fluids. The radial grid reaches the horizon and never repeats. It is "
        "dense near the viewer; each of its waves costs a pass over the vertices. The FFT computes every wave of its "
        "tile at once, repeats beyond the extent, and is as fine far away as nearby.",
    ))  # fmt: skip


def marks_of(snapshot: Snapshot) -> dict[str, str]:
    """Parameter -> the line under its control."""
    readings: RadialReadings = snapshot.readings
    column = readings.column
    oil = column.oil
    marks = {
        "wind_speed": f"waves of {written(QUANTITIES, 'clean_height', snapshot)}, "
        f"middle period {written(QUANTITIES, 'middle_period', snapshot, 2)}"
        if readings.clean_height > 0.0
        else "no waves",
        "oil": f"{number(oil.density, 4)} kg/m³, {number(oil.viscosity * 1e3)} mPa·s, "
        f"refractive index {oil.refractive_index:.3f}",
        "rings": f"{written(QUANTITIES, 'grid_points', snapshot)} points, "
        f"spacing {written(QUANTITIES, 'inner_spacing', snapshot, 2)} in the middle, "
        f"{written(QUANTITIES, 'rim_spacing', snapshot, 2)} at the rim",
    }
    if readings.bodies:
        prediction = readings.bodies[0].prediction
        rest = "sinks" if math.isinf(prediction.draft) else f"draft at rest {fixed(prediction.draft, 3)} m"
        marks["density"] = f"{readings.bodies[0].title}, {fixed(prediction.height, 2)} m high: {rest}"
    if column.kind == "layer":
        marks["thickness"] = f"seen from above: {appearance(column.thickness)}"
    if column.kind == "mixed":
        density, viscosity = column.surface.density, column.surface.viscosity
        law = MIXTURE_LAWS[column.law]
        marks["mixture_law"] = f"{number(viscosity * 1e3)} mPa·s, {fixed(density, 0)} kg/m³"
        if law.is_emulsion:
            beyond = "" if column.drops <= law.max_drops else f"; the law holds up to {law.max_drops:.0%}"
            marks["continuous"] = f"{percent(column.drops)} drops of {drops_of(column)}{beyond}"
    if column.kind != "water":
        p = snapshot.frame.params
        k = peak_wavenumber(spectrum_of(p), conditions_of(p))
        remaining = math.exp(-sum(decay_rate(fluids, float(k)) * time for fluids, time in readings.past.items()))
        marks["exposure"] = f"after {seconds(readings.age)} the peak wave keeps {percent(remaining, 3)} of its height"
    return marks | budget_marks(snapshot.frame.params, readings.weathering)


@functools.lru_cache(maxsize=64)
def decay_rate(column: FluidColumn, k: float) -> float:
    """Decay rate [1/s] of the waves of wavenumber k [1/m]; cached, as each frame needs it."""
    return float(column.roots(np.array([k]))[1][0])
