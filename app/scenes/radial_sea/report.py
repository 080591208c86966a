"""The radial sea in words and numbers: drafts, the lab's claims beside physics, radial beside square."""

import html
import math

import numpy as np

from app.messages import Snapshot
from app.scenes.radial_sea.materials import LAB_SPECULAR
from app.scenes.radial_sea.parameters import conditions_of
from sim.ocean.dispersion import viscous_root
from sim.ocean.fluid_column import FluidColumn
from sim.ocean.fluids import diffuse_reflectance, normal_reflectance
from sim.ocean.gerstner import peak_wavenumber
from sim.ocean.spectra import SPECTRA

NAMES = {"buoy_red": "Red buoy", "buoy_yellow": "Yellow buoy", "crate": "Box", "ball": "Ball", "hull": "Yours"}
SAMPLE_WAVE = 10.0  # [m] the wave that stands for all where one must
TABLE = "border-collapse:collapse;font-size:10.5px"
CELL = 'style="padding:1px 3px 1px 0;text-align:right"'
HEAD = 'style="padding:1px 3px 1px 0;text-align:right;font-weight:400;opacity:.7"'


def metres(value: float) -> str:
    return "sinks" if math.isinf(value) else f"{value:.3f}"


def seconds(value: float) -> str:
    return "-" if not math.isfinite(value) else f"{value:.2f}"


def row(cells: list[str], style: str = CELL, tag: str = "td") -> str:
    first = cells[0]
    return (
        f'<tr><{tag} style="padding:1px 6px 1px 0;text-align:left;white-space:nowrap">{first}</{tag}>'
        + "".join(f"<{tag} {style}>{cell}</{tag}>" for cell in cells[1:])
        + "</tr>"
    )


def readout_of(snapshot: Snapshot) -> str:
    """Draft now, its mean, Archimedes' draft, what oil adds to it, and heave periods, a row a body."""
    g = snapshot.readings
    if not g.readings:
        return "No bodies."
    rows = [row(["", "draft", "mean", "at rest", "oil adds", "heave", "theory"], HEAD, "th")]
    for r in g.readings:
        t = r.theory
        extra = "sinks" if math.isinf(t.draft) else f"{t.draft - t.in_water:+.3f}"
        rows.append(
            row([
                NAMES[r.kind], f"{r.draft:.3f}", f"{r.mean_draft:.3f}", f"<b>{metres(t.draft)}</b>", extra,
                seconds(r.period), seconds(t.period),
            ])
        )  # fmt: skip
    lines = [
        f'<table style="{TABLE};font-variant-numeric:tabular-nums">{"".join(rows)}</table>',
        '<div style="opacity:.7;font-size:11px">m and s; at rest: Archimedes in these fluids; mean over 8 s</div>',
        archimedes(g.column),
        f"<div>Waves: Hs {g.height:.2f} m, {g.height_clean:.2f} m without; slope {math.sqrt(g.slope):.3f} rms</div>",
    ]
    if g.tally.ejected > 0.0:
        t = g.tally
        lines.append(
            f"<div>Gushed {t.ejected:.1f} m³: {t.in_flight:.1f} in the air, {t.fed:.1f} on the sea ({t.hits} hits), a "
            f"slick of {t.radius:.1f} m radius and {1e3 * t.thickness:.0f} mm</div>"
        )
    return "".join(lines)


def archimedes(column: FluidColumn) -> str:
    """The extra sinkage that the fluids give, in symbols and in numbers."""
    oil, water = column.oil.density, column.water.density
    if column.kind == "layer":
        extra = column.thickness * (1.0 - oil / water)
        return (
            f"<div>d (1 − ρ₁/ρ₂) = {column.thickness:g} × (1 − {oil:g}/{water:g}) = <b>{extra:.4f} m</b> "
            "deeper, if the body reaches through the oil</div>"
        )
    if column.kind == "mixed":
        mixed = column.surface.density
        return (
            f"<div>draft × {water / mixed:.4f} where sides are straight: "
            f"ρ = {mixed:.1f} instead of {water:g} kg/m³</div>"
        )
    return f"<div>ρ V = {water:g} V<sub>wet</sub>: the weight of the water displaced (Archimedes)</div>"


def lab_says(snapshot: Snapshot) -> str:
    """The lab's questions of section 1.1, with what physics says and the numbers of just now."""
    g, p = snapshot.readings, snapshot.frame.params
    column: FluidColumn = g.column
    surface, water = column.surface, column.water
    k = np.array([2.0 * math.pi / SAMPLE_WAVE])
    speed, clean = float(column.roots(k)[0][0] / k[0]), float(FluidColumn(water=water).omega(k)[0] / k[0])
    lost = 1.0 - (g.height / g.height_clean if g.height_clean > 0 else 1.0)
    calmer = 1.0 - (g.slope / g.slope_clean if g.slope_clean > 0 else 1.0)
    short = np.array([2.0 * math.pi])
    decay = float(column.roots(short)[1][0])
    r_oil, r_water = normal_reflectance(surface.refractive_index), normal_reflectance(water.refractive_index)
    d_oil, d_water = diffuse_reflectance(surface.refractive_index), diffuse_reflectance(water.refractive_index)
    shift = 1.0 - float(viscous_root(2.0 * math.pi, surface.kinematic_viscosity)[0] / math.sqrt(9.81 * 2.0 * math.pi))
    buoy = g.readings[0].theory if g.readings else None
    sink = "" if buoy is None or math.isinf(buoy.draft) else f" Here: {buoy.draft - buoy.in_water:+.4f} m."
    shown = f"as the lab asks, reflections × {LAB_SPECULAR:g}" if p.optics == "lab" else "physics"
    claims = [
        (
            "1. Which fluid is on top?",
            f"The lighter: {column.oil.density:g} < {water.density:g} kg/m³. p = ρ g z; "
            "a swap would lift the centre of mass.",
        ),
        (
            "2, 4. The bodies sink deeper into oil.",
            f"By d (1 − ρ₁/ρ₂), if they reach through it; by their draft in oil less that in water if not.{sink}",
        ),
        (
            "5. The mixture's viscosity.",
            f"{surface.viscosity * 1e3:.3g} mPa s ({p.mixture_law if column.kind == 'mixed' else surface.name}); water "
            f"{water.viscosity * 1e3:.3g}. Oil and water do not dissolve: Taylor's emulsion is what happens, "
            "Arrhenius' law the reading of 'entirely mixed'.",
        ),
        (
            "6a. Viscosity changes the speed of waves.",
            f"Hardly: a {SAMPLE_WAVE:g} m wave runs at {speed:.3f} m/s here and {clean:.3f} m/s on clean water, for "
            f"ω² = g k knows no density; viscosity slows a 1 m wave by {shift:.2%}.",
        ),
        (
            "6b. Viscosity lowers the waves.",
            f"The short ones: Hs is {lost:.1%} lower after {g.age:.0f} s, the mean "
            f"square slope {calmer:.0%}. A 1 m wave dies as e<sup>−t/{1.0 / decay:,.0f} s</sup>.",
        ),
        (
            "7. Oil reflects less.",
            f"More, at every angle: straight down {r_oil:.2%} against {r_water:.2%}, under a whole sky {d_oil:.2%} "
            f"against {d_water:.2%} (n = {surface.refractive_index:.3f}). It looks dark for no light comes up from "
            f"below, and smooth. Shown: {shown}.",
        ),
    ]
    return "".join(f'<div style="margin-bottom:6px"><b>{question}</b><br>{answer}</div>' for question, answer in claims)


def fluids_html(snapshot: Snapshot) -> str:
    """The fluids in use."""
    column: FluidColumn = snapshot.readings.column
    rows = [row(["", "ρ kg/m³", "μ mPa s", "ν m²/s", "n"], HEAD, "th")]
    chosen = [column.water, column.oil, *([column.surface] if column.kind == "mixed" else [])]
    for f in chosen:
        name = "mixture" if f is not column.water and f is not column.oil else html.escape(f.name)
        rows.append(
            row([
                name, f"{f.density:.1f}", f"{f.viscosity * 1e3:.3g}", f"{f.kinematic_viscosity:.2e}",
                f"{f.refractive_index:.3f}",
            ])
        )  # fmt: skip
    return f'<table style="{TABLE}">{"".join(rows)}</table>15 °C; NOAA\'s oil records.'


def compared_html(snapshot: Snapshot) -> str:
    """The lab's question 1.2-6 by measurement."""
    g = snapshot.readings
    rows = [row(["", "ms", "waves", "shortest", "extent", "Hs", "off", "mss"], HEAD, "th")]
    for name, label in (("sum", "radial sum"), ("fft", "square FFT")):
        c = g.compared.get(name)
        if c is not None:
            rows.append(
                row([
                    label, f"{c.cost * 1e3:.2f}", f"{c.waves}", f"{c.smallest:.2g} m", f"{c.extent:,.0f} m",
                    f"{c.height:.2f} m", f"{c.error:+.1%}", f"{c.slope:.4f}",
                ])
            )  # fmt: skip
    verdict = (
        "Same vertices, timed just now. The rings reach the horizon and never repeat, dense where one looks, but each "
        "wave costs a pass; the transform gives every wave of its tile at once, repeats, and is as fine far off "
        "as near by. Off: of Hs, against the spectrum's."
    )
    return f'<table style="{TABLE}">{"".join(rows)}</table>{verdict}'


def notes_of(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> HTML of the folders below the controls."""
    return {
        "Lab says, physics says": lab_says(snapshot),
        "Fluids": fluids_html(snapshot),
        "Radial or square": compared_html(snapshot),
    }


def marks_of(snapshot: Snapshot) -> dict[str, str]:
    """What is written under a parameter."""
    g = snapshot.readings
    column: FluidColumn = g.column
    grid = snapshot.frame.grid
    oil = column.oil
    out = {
        "wind_speed": f"Hs {g.height_clean:.2f} m, middle period {g.peak_period:.1f} s",
        "oil": f"{oil.density:g} kg/m³, {oil.viscosity * 1e3:g} mPa s, n = {oil.refractive_index:.3f}",
        "rings": f"{len(grid)} points, {grid.spacing[0]:.2g} m apart at the middle, {grid.spacing[-2]:.0f} m at 5 km",
    }
    if g.readings:
        t = g.readings[0].theory
        out["density"] = f"buoys at rest {metres(t.draft)} m deep of {t.height:.2f} m"
    if column.kind == "mixed":
        out["mixture_law"] = f"{column.surface.viscosity * 1e3:.3g} mPa s, {column.surface.density:.0f} kg/m³"
    if column.kind != "water":
        k = np.array([peak_wavenumber_of(snapshot)])
        kept = math.exp(-float(column.roots(k)[1][0]) * g.age)
        out["exposure"] = f"{g.age:.0f} s by now: the peak wave keeps {kept:.2%}"
    return out


def peak_wavenumber_of(snapshot: Snapshot) -> float:
    """Wavenumber [rad/m] of the spectrum's peak."""
    p = snapshot.frame.params
    return peak_wavenumber(SPECTRA[p.spectrum], conditions_of(p))
