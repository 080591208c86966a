"""The panel's texts of the radial sea: drafts, the lab's claims beside physics, radial beside square surface."""

import math

import numpy as np

from app.messages import Snapshot
from app.render.html import Html, bold, faint, fill, fixed, join, number, table
from app.scenes.radial_sea.frame import RadialReadings
from app.scenes.radial_sea.materials import LAB_SPECULAR
from app.scenes.radial_sea.parameters import conditions_of
from app.scenes.radial_sea.well_blowout import OilBudget
from sim.ocean.dispersion import viscous_root
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.fluids import diffuse_reflectance, normal_reflectance
from sim.ocean.gerstner import peak_wavenumber
from sim.ocean.spectra import SPECTRA

SAMPLE_WAVE = 10.0  # [m] length of the wave in statements about the speed of waves
SHORT_WAVE = 1.0  # [m] length of the wave in statements about viscosity
SURFACES = (("sum", "radial sum"), ("fft", "square FFT"))


def heading(name: str, unit: str = "") -> Html:
    """The head of a column: the name over the unit."""
    return fill("{}<br>{}", name, unit)


def draft_text(value: float) -> str:
    """A draft [m], or that the body sinks."""
    return "sinks" if math.isinf(value) else f"{value:.3f}"


def readout_of(snapshot: Snapshot) -> str:
    """Under the status line: a row for each body, then the waves and the oil of the jet."""
    readings: RadialReadings = snapshot.readings
    if not readings.bodies:
        return "No bodies."
    head = (
        "", heading("draft", "m"), heading("mean", "m"), heading("at rest", "m"), heading("oil adds", "m"),
        heading("heave", "s"), heading("theory", "s"),
    )  # fmt: skip
    rows = []
    for body in readings.bodies:
        p = body.prediction
        added = "sinks" if math.isinf(p.draft) else f"{p.draft - p.draft_in_water:+.3f}"
        rows.append((
            body.title, f"{body.draft:.3f}", f"{body.mean_draft:.3f}", bold(draft_text(p.draft)), added,
            fixed(body.period, 2), fixed(p.period, 2),
        ))  # fmt: skip
    parts = [
        table(head, rows),
        faint(
            "mean: over 8 s; at rest: by Archimedes' principle in these fluids; oil adds: to the draft in clean water; "
            "heave: measured period; theory: predicted period."
        ),
        archimedes(readings.column),
        fill(
            "<div>Waves: Hs {:.2f} m, without oil {:.2f} m; root mean square slope {:.3f}.</div>",
            readings.height, readings.clean_height, math.sqrt(readings.slope),
        ),
    ]  # fmt: skip
    if readings.oil_budget.ejected > 0.0:
        parts.append(oil_budget_text(readings.oil_budget))
    return join(parts)


def oil_budget_text(budget: OilBudget) -> Html:
    """Where the oil of the jet is."""
    return fill(
        "<div>Oil from the jet: {:.1f} m³, of which {:.1f} m³ in the air and {:.1f} m³ on the sea ({} parcels), in a "
        "slick with a radius of {:.1f} m and a thickness of {:.0f} mm.</div>",
        budget.ejected, budget.in_flight, budget.fed, budget.hits, budget.radius, 1e3 * budget.thickness,
    )  # fmt: skip


def archimedes(column: FluidColumn) -> Html:
    """How the fluids change the draft, in symbols and in numbers."""
    oil, water = column.oil.density, column.water.density
    if column.kind == "layer":
        return fill(
            "<div>A body that reaches through the oil floats deeper by d (1 − ρ₁/ρ₂) = {:g} × (1 − {:g}/{:g}) = "
            "<b>{:.4f} m</b>.</div>",
            column.thickness, oil, water, column.thickness * (1.0 - oil / water),
        )  # fmt: skip
    if column.kind == "mixed":
        mixed = column.surface.density
        return fill(
            "<div>The mixture has ρ = {:.1f} kg/m³, water {:g} kg/m³: a body with straight sides floats {:.4f} times "
            "as deep.</div>",
            mixed, water, water / mixed,
        )  # fmt: skip
    return fill(
        "<div>Archimedes' principle: ρ V = {:g} V<sub>wet</sub>. The displaced water weighs as much as the body.</div>",
        water,
    )


def notes_of(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> HTML of the folders below the controls."""
    return {
        "Lab says, physics says": claims_html(snapshot),
        "Fluids": fluids_html(snapshot),
        "Radial or square": surfaces_html(snapshot),
    }


def claims_html(snapshot: Snapshot) -> Html:
    """The statements of the lab's section 1.1, each with what physics says and the present numbers."""
    readings: RadialReadings = snapshot.readings
    p, column = snapshot.frame.params, readings.column
    surface, water = column.surface, column.water
    k = np.array([2.0 * math.pi / SAMPLE_WAVE])
    speed, clean_speed = float(column.roots(k)[0][0] / k[0]), float(FluidColumn(water=water).omega(k)[0] / k[0])
    height_loss = 1.0 - (readings.height / readings.clean_height if readings.clean_height > 0 else 1.0)
    slope_loss = 1.0 - (readings.slope / readings.clean_slope if readings.clean_slope > 0 else 1.0)
    short = 2.0 * math.pi / SHORT_WAVE
    decay = float(column.roots(np.array([short]))[1][0])
    slowing = 1.0 - float(viscous_root(short, surface.kinematic_viscosity)[0] / math.sqrt(9.81 * short))
    normal_oil, normal_water = normal_reflectance(surface.refractive_index), normal_reflectance(water.refractive_index)
    sky_oil, sky_water = diffuse_reflectance(surface.refractive_index), diffuse_reflectance(water.refractive_index)
    prediction = readings.bodies[0].prediction if readings.bodies else None
    here = ""
    if prediction is not None and not math.isinf(prediction.draft):
        here = f" The {readings.bodies[0].title.lower()} here: {prediction.draft - prediction.draft_in_water:+.4f} m."
    shown = f"as the lab asks, reflections times {LAB_SPECULAR:g}" if p.optics == "lab" else "as physics says"
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
                "Yes: by d (1 − ρ₁/ρ₂) if they reach through the oil; if not, by their draft in oil less their draft "
                "in water.{}",
                here,
            ),
        ),
        (
            "5. The viscosity of the mixture.",
            fill(
                "{:.3g} mPa s ({}); that of water is {:.3g} mPa s. Oil and water do not dissolve in each other: "
                "Taylor's law is that of the emulsion which forms, Arrhenius' law that of a true solution, the lab's "
                "'entirely mixed'.",
                surface.viscosity * 1e3, p.mixture_law if column.kind == "mixed" else surface.name,
                water.viscosity * 1e3,
            ),
        ),
        (
            "6a. Viscosity changes the speed of waves.",
            fill(
                "Hardly: a wave of {:g} m runs at {:.3f} m/s here and at {:.3f} m/s on clean water, since ω² = g k "
                "does not depend on the density. Viscosity slows a wave of {:g} m by {:.2%}.",
                SAMPLE_WAVE, speed, clean_speed, SHORT_WAVE, slowing,
            ),
        ),
        (
            "6b. Viscosity lowers the waves.",
            fill(
                "The short ones: after {:.0f} s Hs is {:.1%} lower and the mean square slope {:.0%} lower. A wave of "
                "{:g} m decays as e<sup>−t/{:,.0f} s</sup>.",
                readings.age, height_loss, slope_loss, SHORT_WAVE, 1.0 / decay,
            ),
        ),
        (
            "7. Oil reflects less.",
            fill(
                "It reflects more, at every angle: {:.2%} straight down (water {:.2%}), {:.2%} of the light of a "
                "whole sky (water {:.2%}), with n = {:.3f}. It looks darker because no light comes up from below, and "
                "smoother because it damps the ripples. Drawn {}.",
                normal_oil, normal_water, sky_oil, sky_water, surface.refractive_index, shown,
            ),
        ),
    )  # fmt: skip
    return join(fill('<div style="margin-bottom:6px"><b>{}</b><br>{}</div>', *claim) for claim in claims)


def fluids_html(snapshot: Snapshot) -> Html:
    """The fluids in use."""
    column: FluidColumn = snapshot.readings.column
    head = ("", heading("ρ", "kg/m³"), heading("μ", "mPa s"), heading("ν", "m²/s"), heading("n"))
    fluids = [column.water, column.oil, *([column.surface] if column.kind == "mixed" else [])]
    rows = [
        (f.name, f"{f.density:.1f}", f"{f.viscosity * 1e3:.3g}", f"{f.kinematic_viscosity:.2e}",
         f"{f.refractive_index:.3f}") for f in fluids
    ]  # fmt: skip
    return join((
        table(head, rows),
        "ρ: density, μ: dynamic viscosity, ν: kinematic viscosity, n: refractive index, at 15 °C, from NOAA's records "
        "of oils.",
    ))  # fmt: skip


def surfaces_html(snapshot: Snapshot) -> Html:
    """The lab's question 1.2-6, answered by measurement where that is asked for."""
    readings: RadialReadings = snapshot.readings
    if not readings.surfaces:
        return fill("Turn on <b>compare</b> in the folder Surface to time both surfaces on the same vertices.")
    head = (
        "", heading("cost", "ms"), heading("waves"), heading("shortest", "m"), heading("extent", "m"),
        heading("Hs", "m"), heading("error", "of Hs"), heading("slope²", "mean"),
    )  # fmt: skip
    rows = []
    for name, title in SURFACES:
        s = readings.surfaces.get(name)
        if s is not None:
            rows.append((
                title, f"{s.cost * 1e3:.2f}", s.waves, f"{s.shortest:.2g}", number(s.extent), f"{s.height:.2f}",
                f"{s.error:+.1%}", f"{s.slope:.4f}",
            ))  # fmt: skip
    return join((
        table(head, rows),
        "Both on the same vertices, timed just now. The radial grid reaches the horizon and never repeats; it is "
        "dense near the viewer; each of its waves costs a pass over the vertices. The transform computes every wave "
        "of its tile at once, repeats after the extent, and is as fine far away as near by.",
    ))  # fmt: skip


def marks_of(snapshot: Snapshot) -> dict[str, str]:
    """Parameter -> the line under its control."""
    readings: RadialReadings = snapshot.readings
    column, grid = readings.column, snapshot.frame.grid
    oil = column.oil
    marks = {
        "wind_speed": f"Hs {readings.clean_height:.2f} m, period in the middle of the energy "
        f"{readings.middle_period:.1f} s",
        "oil": f"{oil.density:g} kg/m³, {oil.viscosity * 1e3:g} mPa s, n = {oil.refractive_index:.3f}",
        "rings": f"{len(grid)} points, {grid.spacing[0]:.2g} m apart in the middle, {grid.spacing[-2]:.0f} m outside",
    }
    if readings.bodies:
        prediction = readings.bodies[0].prediction
        rest = "sinks" if math.isinf(prediction.draft) else f"draft at rest {prediction.draft:.3f} m"
        marks["density"] = f"{readings.bodies[0].title}, {prediction.height:.2f} m high: {rest}"
    if column.kind == "mixed":
        marks["mixture_law"] = f"{column.surface.viscosity * 1e3:.3g} mPa s, {column.surface.density:.0f} kg/m³"
    if column.kind != "water":
        p = snapshot.frame.params
        k = np.array([peak_wavenumber(SPECTRA[p.spectrum], conditions_of(p))])
        remaining = math.exp(-float(column.roots(k)[1][0]) * readings.age)
        marks["exposure"] = f"{readings.age:.0f} s so far: the peak wave keeps {remaining:.2%} of its height"
    return marks
