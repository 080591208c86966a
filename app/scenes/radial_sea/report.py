"""The panel's texts of the radial sea: drafts, the lab's claims beside physics, radial beside square surface."""

import math

import numpy as np

from app.messages import Snapshot
from app.render.html import Html, bold, faint, fill, join, table
from app.scenes.radial_sea.frame import RadialReadings
from app.scenes.radial_sea.materials import LAB_SPECULAR
from app.scenes.radial_sea.parameters import conditions_of, spectrum_of
from app.scenes.radial_sea.well_blowout import OilBudget
from sim.formatting import fixed, metres, number, percent, seconds
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.fluids import diffuse_reflectance, normal_reflectance
from sim.ocean.gerstner import peak_wavenumber
from sim.parameters import parameters_of

SAMPLE_WAVE = 10.0  # [m] length of the wave in statements about the speed of waves
SHORT_WAVE = 1.0  # [m] length of the wave in statements about viscosity
MAX_DILUTE = 0.1  # share of drops up to which Taylor's law, of first order, holds
SURFACES = (("sum", "radial sum"), ("fft", "square FFT"))


def draft_text(value: float) -> str:
    """A draft [m], or that the body sinks."""
    return "sinks" if math.isinf(value) else fixed(value, 3)


def readout_of(snapshot: Snapshot) -> Html:
    """Under the status line: the draft of each body, then the waves and the oil of the jet."""
    readings: RadialReadings = snapshot.readings
    if not readings.bodies:
        return Html("No bodies.")
    drafts = []
    for body in readings.bodies:
        p = body.prediction
        added = "sinks" if math.isinf(p.draft) else fixed(p.draft - p.draft_in_water, 3, sign=True)
        drafts.append((
            body.title, fixed(body.draft, 3), fixed(body.mean_draft, 3), bold(draft_text(p.draft)), added,
        ))  # fmt: skip
    parts = [
        table((("draft", ""), ("now", "m"), ("mean, 60 s", "m"), ("at rest", "m"), ("oil adds", "m")), drafts),
        faint(
            "At rest: by Archimedes' principle in these fluids. Waves disturb it: switch them off to compare exactly."
            if snapshot.frame.params.waves
            else "At rest: by Archimedes' principle in these fluids."
        ),
        archimedes(readings.column),
        waves_text(readings),
    ]
    if readings.oil_budget.ejected > 0.0:
        parts.append(oil_budget_text(readings.oil_budget))
    return join(parts)


def forces_html(readings: RadialReadings) -> Html:
    """Weight, buoyancy and heave period of each body."""
    periods = [(body.title, fixed(body.period, 2), fixed(body.prediction.period, 2)) for body in readings.bodies]
    return join((
        *weight_tables(readings),
        table((("heave period", ""), ("measured", "s"), ("theory", "s")), periods),
    ))  # fmt: skip


def weight_tables(readings: RadialReadings) -> tuple[Html, Html]:
    """Weights and the buoyancy that carries them, with all that Archimedes' sum is made of."""
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
    wet = (("wet in oil", "m³"), ("in water", "m³")) if layered else (("wet volume", "m³"),)
    return (
        table((("weight", ""), ("density", "kg/m³"), ("volume V", "m³"), ("mass ρV", "kg"), ("weight gρV", "N")),
              weights),
        table((("buoyancy now", ""), *wet, ("buoyancy", "N")), forces),
    )  # fmt: skip


def waves_text(readings: RadialReadings) -> Html:
    """Height and slope of the waves, with the height without oil where oil has lowered it."""
    height, clean = number(readings.height), number(readings.clean_height)
    lowered = f" ({clean} m without oil)" if clean != height else ""
    slope = number(math.sqrt(readings.slope), 2)
    return fill("<div>Waves: H<sub>s</sub> = {} m{}, rms slope {}.</div>", height, lowered, slope)


def oil_budget_text(budget: OilBudget) -> Html:
    """Where the oil of the jet is."""
    return fill(
        "<div>Oil released: {} m³; {} m³ in the air, {} m³ on the sea. Slick: radius {} m, thickness {}.</div>",
        number(budget.ejected), number(budget.in_flight), number(budget.fed), number(budget.radius),
        metres(budget.thickness, 2),
    )  # fmt: skip


def archimedes(column: FluidColumn) -> Html:
    """How the fluids change the draft, in symbols and in numbers."""
    oil, water = column.oil.density, column.water.density
    if column.kind == "layer":
        return fill(
            "<div>A body with straight sides that reaches through the oil floats deeper by "
            "d (1 − ρ₁/ρ₂) = {:g} m × (1 − {:g}/{:g}) = "
            "<b>{:.4f} m</b>.</div>",
            column.thickness, oil, water, column.thickness * (1.0 - oil / water),
        )  # fmt: skip
    if column.kind == "mixed":
        mixed = column.surface.density
        return fill(
            "<div>Density of the mixture {:.1f} kg/m³, of water {:g} kg/m³: a body with straight sides floats {:.4f} "
            "times as deep.</div>",
            mixed, water, water / mixed,
        )  # fmt: skip
    return fill(
        "<div>Archimedes' principle: ρV = {:g} kg/m³ × V<sub>wet</sub>. The displaced water weighs as much as the "
        "body.</div>",
        water,
    )


def notes_of(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> HTML of the folders below the controls."""
    return {
        "Weight, buoyancy, heave": forces_html(snapshot.readings),
        "Lab says, physics says": claims_html(snapshot),
        "Fluids": fluids_html(snapshot),
        "Radial or square": surfaces_html(snapshot),
    }


def claims_html(snapshot: Snapshot) -> Html:
    """The statements of the lab's section 1.1, each with what physics says and the present numbers."""
    readings: RadialReadings = snapshot.readings
    p, column = snapshot.frame.params, readings.column
    water = column.water
    k = np.array([2.0 * math.pi / SAMPLE_WAVE])
    speed, clean_speed = float(column.roots(k)[0][0] / k[0]), float(FluidColumn(water=water).omega(k)[0] / k[0])
    height_loss = 1.0 - (readings.height / readings.clean_height if readings.clean_height > 0 else 1.0)
    slope_loss = 1.0 - (readings.slope / readings.clean_slope if readings.clean_slope > 0 else 1.0)
    short = 2.0 * math.pi / SHORT_WAVE
    decay = float(column.roots(np.array([short]))[1][0])
    # Against the same fluids without viscosity, so that tension and layer do not count.
    slowing = 1.0 - float(column.roots(np.array([short]))[0][0] / column.omega(np.array([short]))[0])
    oil = column.oil
    normal_oil, normal_water = normal_reflectance(oil.refractive_index), normal_reflectance(water.refractive_index)
    sky_oil, sky_water = diffuse_reflectance(oil.refractive_index), diffuse_reflectance(water.refractive_index)
    prediction = readings.bodies[0].prediction if readings.bodies else None
    here = ""
    if prediction is not None and column.kind != "water" and not math.isinf(prediction.draft):
        added = fixed(prediction.draft - prediction.draft_in_water, 4, sign=True)
        here = f" The {readings.bodies[0].title.lower()} here: {added} m."
    shown = f"as in the lab, reflections times {LAB_SPECULAR:g}" if p.optics == "lab" else "physical"
    claims: tuple[tuple[str, Html], ...] = (
        (
            "1. Which fluid is on top?",
            fill(
                "The lighter one: {:g} kg/m³ is less than {:g} kg/m³. Oil below water would rise, because that lowers "
                "the centre of mass.",
                column.oil.density, water.density,
            ),
        ),
        (
            "2, 4. The bodies float deeper in oil.",
            fill(
                "Yes: by d (1 − ρ₁/ρ₂) if they have straight sides and reach through the oil; if not, by their "
                "draft in oil less their draft in water.{}",
                here,
            ),
        ),
        (
            "5. The viscosity of the mixture.",
            mixture_html(column, parameters_of(p)["mixture_law"].title_of(p.mixture_law)),
        ),
        (
            "6a. Viscosity changes the speed of waves.",
            fill(
                "Hardly: a wave of {:g} m runs at {:.3f} m/s here and at {:.3f} m/s on clean water, because ω² = gk "
                "does not contain the density. Viscosity slows a wave of {:g} m by {}.",
                SAMPLE_WAVE, speed, clean_speed, SHORT_WAVE, percent(slowing),
            ),
        ),
        (
            "6b. Viscosity lowers the waves.",
            join((
                "The short ones. ",
                "" if column.kind == "water" else fill(
                    "After {} H<sub>s</sub> is {} lower and the mean square slope {} lower. ",
                    seconds(readings.age, 2), percent(height_loss), percent(slope_loss),
                ),
                fill("A wave of {:g} m falls to 37 % in {} here.", SHORT_WAVE, seconds(1.0 / decay)),
            )),
        ),
        (
            "7. Oil reflects less.",
            fill(
                "It reflects more, at every angle: {} straight down (water {}), {} of the light of a whole sky "
                "(water {}), with n = {:.3f}. It looks darker because no light is scattered back from below, and "
                "smoother because it damps the ripples. Rendering: {}.",
                percent(normal_oil), percent(normal_water), percent(sky_oil), percent(sky_water),
                oil.refractive_index, shown,
            ),
        ),
    )  # fmt: skip
    return join(fill('<div style="margin-bottom:6px"><b>{}</b><br>{}</div>', *claim) for claim in claims)


def mixture_html(column: FluidColumn, law: str) -> Html:
    """The viscosity of the mixture, by which law, and whether that law holds for so much oil."""
    water = number(column.water.viscosity * 1e3)
    kinds = (
        "Oil and water do not dissolve in each other: they form an emulsion, for which Taylor's law holds as long as "
        f"drops are less than {MAX_DILUTE:.0%} of it. Arrhenius' law is that of a true solution, the lab's 'entirely "
        "mixed'."
    )
    if column.kind != "mixed":
        return fill("Nothing is mixed here; water has {} mPa·s. {}", water, kinds)
    drops = min(column.fraction, 1.0 - column.fraction)
    beyond = ""
    if column.law == "taylor" and drops > MAX_DILUTE:
        beyond = f" With {drops:.0%} of drops it is far too low."
    return fill(
        "{} mPa·s ({}); that of water is {} mPa·s. {}{}",
        number(column.surface.viscosity * 1e3),
        law,
        water,
        kinds,
        beyond,
    )


def fluids_html(snapshot: Snapshot) -> Html:
    """The fluids in use."""
    column: FluidColumn = snapshot.readings.column
    head = (("at 15 °C", ""), ("ρ", "kg/m³"), ("μ", "mPa·s"), ("ν", "m²/s"), ("n", ""))
    fluids = [column.water, column.oil, *([column.surface] if column.kind == "mixed" else [])]
    rows = [
        (f.name, fixed(f.density, 1), number(f.viscosity * 1e3), number(f.kinematic_viscosity),
         fixed(f.refractive_index, 3)) for f in fluids
    ]  # fmt: skip
    return join((
        table(head, rows),
        faint("ρ density, μ dynamic and ν kinematic viscosity, n refractive index. Oils: NOAA's records."),
    ))  # fmt: skip


def surfaces_html(snapshot: Snapshot) -> Html:
    """The lab's question 1.2-6, answered by measurement where that is asked for."""
    readings: RadialReadings = snapshot.readings
    if not readings.surfaces:
        return fill("Switch on <b>Compare surfaces</b> in the folder Grid to time both surfaces on the same vertices.")
    found = [(title, readings.surfaces[name]) for name, title in SURFACES if name in readings.surfaces]
    head = (("", ""), *((title, "") for title, _ in found))
    rows = (
        ("cost [ms]", *(fixed(s.cost * 1e3, 2) for _, s in found)),
        ("waves", *(number(s.waves) for _, s in found)),
        ("shortest wave", *(metres(s.shortest, 2) for _, s in found)),
        ("extent", *(metres(s.extent, 3) for _, s in found)),
        (Html("height H<sub>s</sub> [m]"), *(fixed(s.height, 2) for _, s in found)),
        (Html("error of H<sub>s</sub>"), *(percent(s.error) for _, s in found)),
        ("mean square slope", *(number(s.slope) for _, s in found)),
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
    column, grid = readings.column, snapshot.frame.grid
    oil = column.oil
    marks = {
        "wind_speed": f"Hs = {number(readings.clean_height)} m, mean period {number(readings.middle_period, 2)} s",
        "oil": f"{number(oil.density, 4)} kg/m³, {number(oil.viscosity * 1e3)} mPa·s, n = {oil.refractive_index:.3f}",
        "rings": f"{number(len(grid))} points, spacing {metres(grid.spacing[0], 2)} in the middle, "
        f"{metres(grid.spacing[-2], 2)} at the rim",
    }
    if readings.bodies:
        prediction = readings.bodies[0].prediction
        rest = "sinks" if math.isinf(prediction.draft) else f"draft at rest {fixed(prediction.draft, 3)} m"
        marks["density"] = f"{readings.bodies[0].title}, {fixed(prediction.height, 2)} m high: {rest}"
    if column.kind == "mixed":
        density, viscosity = column.surface.density, column.surface.viscosity
        marks["mixture_law"] = f"{number(viscosity * 1e3)} mPa·s, {fixed(density, 0)} kg/m³"
    if column.kind != "water":
        p = snapshot.frame.params
        k = np.array([peak_wavenumber(spectrum_of(p), conditions_of(p))])
        remaining = math.exp(-float(column.roots(k)[1][0]) * readings.age)
        marks["exposure"] = f"after {seconds(readings.age)} the peak wave keeps {percent(remaining, 3)} of its height"
    return marks
