"""What the panel says of a sea: its statistics beside theory, and the lab's sentences beside the physics."""

import math
from typing import NamedTuple

import numpy as np

from app.scenes.square_sea.parameters import Params, gravity
from sim.ocean import Sea
from sim.ocean.planets import RADIUS_RULES, gravity_of
from sim.ocean.statistics import Statistics, beaufort, expected, height_scatter, measured

STILL_HIGHER = 1.2  # of the height of an endless sea: what no tile holds of this wind alone
BAND = 2.0  # standard deviations: 95 of 100 seas lie within
NEAR_PEAK = 0.08  # of the peak frequency: waves within are called dominant
WATER, HEAVY_OIL = 1e-6, 1e-3  # [m2/s] kinematic viscosities to compare with


class Theory(NamedTuple):
    """What the spectrum says."""

    statistics: Statistics  # as the tile resolves it
    scatter: float  # relative standard deviation of one sea's Hs
    whole: float  # Hs [m] on an endless sea, nan where no closed form is known
    wave: tuple[float, float]  # length [m] and speed [m/s] of the dominant wave


class Report(NamedTuple):
    """The sea as drawn, and as theory has it."""

    measured: Statistics
    theory: Theory


def scaled(s: Statistics, factor: float) -> Statistics:
    """The statistics of heights `factor` times as high."""
    return s._replace(
        significant_height=factor * s.significant_height, mean_square_slope=factor**2 * s.mean_square_slope
    )


def theory(sea: Sea, t: float, params: Params) -> Theory:
    """Theory of the sea at time t [s] as drawn."""
    found = expected(sea, t)
    c = sea.conditions
    closed = sea.spectrum.significant_height
    whole = closed(c) if closed is not None and c.wind_speed > 0.0 else math.nan
    wave = dominant(sea, t, found.peak_period)
    return Theory(scaled(found, params.amplitude), height_scatter(sea, t), params.amplitude * whole, wave)


def measure(sea: Sea, height: np.ndarray, earlier: np.ndarray | None, params: Params) -> Statistics:
    """Statistics of heights (n, n) [m]; earlier: those of the picture before."""
    found = measured(height, sea.length, sea.conditions, earlier)
    # A scale on the dispersion makes every period shorter by as much.
    period = found.peak_period / params.dispersion_scale if params.dispersion_scale > 0.0 else math.nan
    return scaled(found, params.amplitude)._replace(peak_period=period)


def dominant(sea: Sea, t: float, period: float) -> tuple[float, float]:
    """Length [m] and phase speed [m/s] of the waves about the peak period [s]; nan where there are none."""
    if not period > 0.0:
        return math.nan, math.nan
    peak = 2.0 * math.pi / period
    energy = sea.energy_at(t)
    away = np.where(energy > 0.0, np.abs(sea.frequencies / peak - 1.0), math.inf)
    # A tile of few waves may have none so near: then the nearest.
    energy = np.where(away <= max(NEAR_PEAK, float(away.min())), energy, 0.0)
    total = float(energy.sum())
    if not total > 0.0:
        return math.nan, math.nan
    k = float((energy * np.hypot(sea.k[:, None], sea.k[None, :])).sum()) / total
    return 2.0 * math.pi / k, peak / k


def table(r: Report) -> str:
    """The statistics as HTML: drawn, expected of this tile with its band, and of an endless sea."""

    def row(name: str, drawn: str, theory: str, good: bool = True) -> str:
        colour = "" if good else ";color:#e67700"
        return (
            f"<tr><td>{name}</td><td style='text-align:right;font-weight:600{colour}'>{drawn}</td>"
            f"<td style='text-align:right'>{theory}</td></tr>"
        )

    m, e, whole = r.measured, r.theory.statistics, r.theory.whole
    band = BAND * r.theory.scatter * e.significant_height
    inside = abs(m.significant_height - e.significant_height) <= band + 1e-9
    rows = [
        row("H<sub>s</sub> [m]", f"{m.significant_height:.3g}", f"{e.significant_height:.3g} ± {band:.2g}", inside),
        row("T<sub>p</sub> [s]", number(m.peak_period), number(e.peak_period)),
        row("mean square slope", f"{m.mean_square_slope:.3g}", f"{e.mean_square_slope:.3g}"),
        row("direction [°]", number(math.degrees(m.direction), ".0f"), number(math.degrees(e.direction), ".0f")),
    ]
    share = ""
    if whole > 0.0:
        held = e.significant_height / whole
        said = (
            f"The tile holds {held:.0%} of the {whole:.3g} m of an endless, undamped sea."
            if held < STILL_HIGHER
            else f"Waves of the old weather are still here; this wind alone would raise {whole:.3g} m."
        )
        share = f"<div style='opacity:.75'>{said}</div>"
    return (
        "<table style='width:100%;border-spacing:0;font-size:12px'><tr style='opacity:.75'><td></td>"
        "<td style='text-align:right'>drawn</td><td style='text-align:right'>theory, 95 %</td></tr>"
        + "".join(rows)
        + f"</table>{share}"
    )


def number(value: float, form: str = ".3g") -> str:
    return "–" if math.isnan(value) else format(value, form)


def span(seconds: float) -> str:
    """A time in words, two digits."""
    for unit, size in (("years", 3.156e7), ("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"


def wind_line(params: Params) -> str:
    force, name = beaufort(params.wind_speed)
    return f"Beaufort {force}, {name}"


def planet_line(params: Params) -> str:
    """The three readings of a planet's mass."""
    each = ", ".join(f"{rule.replace('_', ' ')} {gravity_of(params.planet_mass, rule):.3g}" for rule in RADIUS_RULES)
    return f"g = {gravity(params):.3g} m/s² ({each})"


def low_pass_line(params: Params) -> str:
    """l = 2 sqrt(nu T), read the other way."""
    if params.low_pass == 0.0:
        return "l = 2 √(ν T): none"
    water, oil = (params.low_pass**2 / (4.0 * nu) for nu in (WATER, HEAVY_OIL))
    return f"water left still for {span(water)}, heavy oil (1e-3 m²/s) for {span(oil)}"


def viscosity_line(params: Params, age: float) -> str:
    if params.viscosity == 0.0:
        return "no decay"
    length = 2.0 * math.sqrt(params.viscosity * age)
    half = 1.0 / (2.0 * params.viscosity * (2.0 * math.pi / 1.0) ** 2)
    return f"after {age:.0f} s: the lab's l = 2 √(ν T) = {length:.2g} m; a wave of 1 m fades in {span(half)}"


def lab_says(params: Params, r: Report | None) -> str:
    """The lab's sentences and the physics, with this sea's own numbers, as HTML."""
    g, U = gravity(params), params.wind_speed
    pairs = [
        (
            "In a storm waves are higher and move faster.",
            f"Both. A full-grown sea has H<sub>s</sub> = 0.209 U²/g and crests at c = U/0.877: for {U:.3g} m/s "
            f"{0.20925 * U * U / g:.3g} m and {U / 0.877:.3g} m/s."
            + (
                f" The dominant waves here are {r.theory.wave[0]:.3g} m long and run at {r.theory.wave[1]:.3g} m/s."
                if r and not math.isnan(r.theory.wave[0])
                else ""
            ),
        ),
        (
            "On a planet of 100 times the mass waves are different.",
            f"It takes the radius too: here g = {g:.3g} m/s². Heights and lengths go as 1/g at one wind, speeds stay: "
            f"H<sub>s</sub> g/U² is 0.209 on every planet.",
        ),
        (
            "The damping parameter is viscosity.",
            "It is a length l that cuts off short waves once, exp(−k²l²). A fluid of viscosity ν does the same in a "
            f"time T = l²/4ν{': ' + low_pass_line(params) if params.low_pass else ''}. "
            "Viscosity itself takes 2νk² a second from each wave: texture first, height last, speed hardly at all.",
        ),
        (
            "When the storm is over, change the dispersion.",
            "The lab's dispersion rounds frequencies down so that the sea repeats after 200 s; a scale slows it down. "
            "Neither lowers a wave: "
            + (f"H<sub>s</sub> stays {r.measured.significant_height:.3g} m. " if r else "")
            + "A calm is less wind: try the preset Storm over.",
        ),
        (
            "Which grid is more realistic, which scales better?",
            "This square one costs N² log N, carries every wave of its tile exactly, and repeats; the radial one "
            "spends its points near the eye and never repeats, at a cost of points times waves.",
        ),
    ]
    return "".join(
        f"<div style='margin-bottom:8px'><div style='opacity:.7'><b>Lab:</b> {lab}</div><div><b>Physics:</b> {physics}"
        "</div></div>"
        for lab, physics in pairs
    )
