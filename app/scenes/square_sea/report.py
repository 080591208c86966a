"""The texts of the panel: the statistics of the sea beside theory, and statements of the course lab beside physics."""

import math
from typing import TYPE_CHECKING

from app.messages import Snapshot
from app.render.html import WARNING_COLOUR, Html, bold, coloured, faint, fill, join, lines, table
from app.scenes.square_sea.parameters import Params, gravity
from app.scenes.square_sea.statistics import Report
from sim.formatting import count, fixed, metres, number, percent, seconds
from sim.ocean.planets import RADIUS_RULES, gravity_of
from sim.ocean.statistics import beaufort, resolved_in_time

if TYPE_CHECKING:
    from app.scenes.square_sea.scene import RainReadings

MAX_SHARE_OF_ENDLESS_SEA = 1.2  # in wave height: a tile with more than this still has waves of earlier weather
BAND_WIDTH = 2.0  # standard deviations to each side: 95 of 100 seas lie within
WATER_VISCOSITY, HEAVY_OIL_VISCOSITY = 1e-6, 1e-3  # [m2/s] kinematic, to compare with
HEADING = "Lab says, physics says"


def readout(snapshot: Snapshot) -> Html:
    """Statistics, foam, rain and wave gauge."""
    frame, r = snapshot.frame, snapshot.readings
    texts: list[object] = []
    if r.report is not None:
        texts.append(statistics_table(r.report))
    if frame.params.foam:
        texts.append(
            f"Foam covers {percent(r.foam_cover)} of the sea; by Monahan's law {percent(r.expected_foam_cover)}."
        )
    if r.rain is not None:
        texts.append(rain_text(r.rain))
    if frame.gauge is not None:
        x, y, z = frame.gauge
        texts.append(f"Wave gauge at ({x:.1f}, {y:.1f}) m: {fixed(z, 2, sign=True)} m.")
    return lines(texts)


def rain_text(rain: "RainReadings") -> str:
    """How much of the rain is shown."""
    rings = "The grid is too coarse for rings."
    if rain.drops_per_ring:
        rings = f"Each ring stands for {count(rain.drops_per_ring)} drops."
    falling = count(rain.drawn * rain.weight)
    return f"Rain {number(rain.rate)} mm/h. Shown: {rain.drawn} of {falling} falling drops. {rings}"


def statistics_table(r: Report) -> Html:
    """The statistics: as drawn, as expected of this tile, and of an endless sea."""
    m, e, endless = r.measured, r.theory.statistics, r.theory.whole
    band = BAND_WIDTH * r.theory.scatter * e.significant_height
    inside = abs(m.significant_height - e.significant_height) <= band + 1e-9
    height = number(m.significant_height)
    direction = bold(fixed(math.degrees(m.direction), 0))
    if e.peak_period > 0.0 and not resolved_in_time(e.peak_period, r.interval):
        direction = coloured("not resolved in time", WARNING_COLOUR)
    measured = table(
        (("", ""), ("as drawn", ""), ("theory", "95 % band")),
        (
            (
                Html("height H<sub>s</sub> [m]"),
                bold(height) if inside else coloured(height, WARNING_COLOUR),
                f"{number(e.significant_height)} ± {number(band, 2)}",
            ),
            (Html("period T<sub>p</sub> [s]"), bold(number(m.peak_period)), number(e.peak_period)),
            ("mean square slope", bold(number(m.mean_square_slope)), number(e.mean_square_slope)),
            ("direction [°]", direction, fixed(math.degrees(e.direction), 0)),
        ),
    )
    if not endless > 0.0:
        return measured
    share = e.significant_height / endless
    if share < MAX_SHARE_OF_ENDLESS_SEA:
        text = fill("The tile captures {} of the open-sea H<sub>s</sub> ({} m).", percent(share, 3), number(endless))
    else:
        text = fill(
            "Waves of the earlier weather are still here; this wind alone makes H<sub>s</sub> = {} m.", number(endless)
        )
    return join((measured, faint(text)))


def marks(snapshot: Snapshot) -> dict[str, str]:
    """Parameter -> the line under its control."""
    p: Params = snapshot.frame.params
    limit = snapshot.readings.foam_limit
    cell = p.length / int(p.size)
    return {
        "wind_speed": wind_line(p),
        "planet": f"g = {number(gravity(p))} m/s²",
        "radius_rule": radius_line(p),
        "low_pass": low_pass_line(p),
        "viscosity": viscosity_line(p, snapshot.readings.age),
        "loop_period": f"repeats every {seconds(p.loop_period, 2)}" if p.loop_period else "never repeats",
        "size": f"grid spacing {metres(cell)}, shortest wave {metres(2 * cell)}",
        "mesh": f"grid spacing {metres(p.length / len(snapshot.frame.vertices))}",
        "foam_by_wind": f"foam where the Jacobian is below {fixed(limit, 2)}" if math.isfinite(limit) else "no foam",
    }


def notes(snapshot: Snapshot) -> dict[str, str]:
    """Heading -> text of the folders below the controls."""
    return {HEADING: lab_statements(snapshot.frame.params, snapshot.readings.report)}


def wind_line(params: Params) -> str:
    """The wind on Beaufort's scale."""
    force, name = beaufort(params.wind_speed)
    return f"Beaufort {force}, {name}"


def radius_line(params: Params) -> str:
    """Gravity of a planet of this mass by each rule for its radius."""
    each = ", ".join(
        f"{number(gravity_of(params.planet_mass, rule))} ({rule.replace('_', ' ')})" for rule in RADIUS_RULES
    )
    return f"g in m/s² by each rule: {each}"


def low_pass_line(params: Params) -> str:
    """How long a fluid at rest takes to lose the waves that the low pass l leaves out: T = l^2/(4 nu)."""
    if params.low_pass == 0.0:
        return "no wave is left out"
    water, oil = (params.low_pass**2 / (4.0 * nu) for nu in (WATER_VISCOSITY, HEAVY_OIL_VISCOSITY))
    return f"like {seconds(water, 2)} of decay in water, or {seconds(oil, 2)} in heavy oil (10⁻³ m²/s)"


def viscosity_line(params: Params, age: float) -> str:
    """What viscosity has done after `age` [s], and how fast it damps a wave of 1 m."""
    if params.viscosity == 0.0:
        return "no decay"
    length = 2.0 * math.sqrt(params.viscosity * age)
    decay = 1.0 / (2.0 * params.viscosity * (2.0 * math.pi / 1.0) ** 2)
    return (
        f"after {seconds(age, 2)} the lab's l = 2√(νT) is {metres(length, 2)}; a wave of 1 m falls to 37 % in "
        f"{seconds(decay, 2)}"
    )


def lab_statements(params: Params, r: Report | None) -> Html:
    """Statements of the course lab beside the physics, with the numbers of this sea."""
    g, U = gravity(params), params.wind_speed
    storm = fill(
        "Both are true. A fully developed sea has H<sub>s</sub> = 0.209 U²/g, and its crests run at c = U/0.877: "
        "for U = {} m/s these are {} m and {} m/s.",
        number(U), number(0.20925 * U * U / g), number(U / 0.877),
    )  # fmt: skip
    if r is not None and not math.isnan(r.theory.wave[0]):
        length, speed = r.theory.wave
        storm = join((storm, f" The dominant waves here are {number(length)} m long and run at {number(speed)} m/s."))
    planet = fill(
        "That depends on its radius too: here g = {} m/s². In the same wind, heights and lengths are proportional to "
        "1/g, and speeds stay the same: H<sub>s</sub> g/U² is 0.209 on every planet.",
        number(g),
    )
    time = f": {low_pass_line(params)}" if params.low_pass else ""
    damping = (
        "It is a length l that cuts off short waves once, by exp(−k²l²). A fluid of viscosity ν does the same in a "
        f"time T = l²/4ν{time}. Viscosity itself damps each wave at the rate 2νk²: it removes the short waves first, "
        "lowers the sea last, and hardly changes any speed."
    )
    height = ""
    if r is not None:
        height = fill("H<sub>s</sub> stays {} m. ", number(r.measured.significant_height))
    after_storm = fill(
        "The lab's dispersion rounds frequencies down so that the sea repeats after 200 s, and a factor slows it down. "
        "Neither lowers a wave. {}A calm sea needs less wind: load the preset Storm over.",
        height,
    )
    pairs: list[tuple[str, object]] = [
        ("In a storm waves are higher and move faster.", storm),
        ("On a planet of 100 times the mass waves are different.", planet),
        ("The damping parameter is viscosity.", damping),
        ("When the storm is over, change the dispersion.", after_storm),
        (
            "Which grid is more realistic, which scales better?",
            "The cost of this square grid grows as N² log N. It carries every wave of its tile exactly, and repeats. "
            "The radial grid has most of its points near the camera and never repeats; its cost is the number of "
            "points times the number of waves.",
        ),
    ]
    return join(
        fill(
            '<div style="margin-bottom:8px"><div class="springtide-faint"><b>Lab:</b> {}</div>'
            "<div><b>Physics:</b> {}</div></div>",
            statement, physics,
        )
        for statement, physics in pairs
    )  # fmt: skip
