"""The texts of the panel: the statistics of the sea beside theory, and statements of the course lab beside physics."""

import math

from app.formats.formatting import count, fixed, metres, number, percent, seconds
from app.messages import Snapshot
from app.render.markup.html import WARNING_COLOUR, Html, bold, coloured, faint, fill, info, join, lines, table
from app.scenes.measured_sea import measured_text
from app.scenes.quantities import read, written
from app.scenes.sea_parameters import chosen_spectrum
from app.scenes.square_sea.frame import SeaFrame, SeaReadings
from app.scenes.square_sea.parameters import DRAUPNER, SquareSeaParams, gravity, is_draupner, marches, solved_points
from app.scenes.square_sea.quantities import OF_RAIN, OF_REPORT, QUANTITIES, here, spectrum_conditions
from app.scenes.square_sea.rainfall import RainReadings
from app.scenes.square_sea.statistics import Report
from app.scenes.square_sea.tile_mesh import Highest
from sim.ocean.dispersion import viscous_root
from sim.ocean.planets import RADIUS_RULES, gravity_of
from sim.ocean.spectra.jonswap import FetchConditions, fetch_of_full_growth
from sim.ocean.spectra.regular import RegularConditions
from sim.ocean.statistics.statistics import BREAKING_HEIGHT, beaufort, resolved_in_time
from sim.water import EARTH_GRAVITY

MIN_SLOPE_LEFT = 0.98  # fraction of the mean square slope below which the sea counts as damped
MAX_FRACTION_OF_ENDLESS_SEA = 1.2  # in wave height: a tile with more than this still has waves of earlier weather
HEIGHT = (
    "Significant height: the mean of the highest third of the waves, from trough to crest. "
    "The band holds 19 of 20 seas."
)
CREST = "The highest crest of the tile now. Theory: the most probable highest crest of as many waves."
MOMENTS = (
    "Skewness is above 0 if crests are higher than troughs are deep. Kurtosis is above 3 if high waves are frequent."
)
SLOPE = "Mean square slope: the mean of the squared slope of the water, on which its glitter depends."
BAND_WIDTH = 2.0  # standard deviations to each side: 95 of 100 seas lie within
WATER_VISCOSITY, HEAVY_OIL_VISCOSITY = 1e-6, 2e-2  # [m2/s] kinematic, to compare with


def readout(snapshot: Snapshot) -> Html:
    """Statistics, foam, rain and wave gauge."""
    frame, r = snapshot.frame, snapshot.readings
    is_measured = bool(frame.params.spectrum_file)
    texts: list[object] = [measured_text(frame.params)] if is_measured else []
    if r.report is not None:
        texts.append(statistics_table(r.report, chosen_spectrum(frame.params).title if is_measured else "an open sea"))
        if r.report.heights is not None:
            texts.append(heights_table(r.report, frame))
        if frame.highest is not None and is_draupner(frame.params):
            texts.append(draupner_table(r.report, frame.highest))
    if frame.params.foam:
        texts.append(foam_text(r, gravity(frame.params)))
    breaking = breaking_text(frame.params)
    if breaking:
        texts.append(coloured(breaking, WARNING_COLOUR))
    if r.rain is not None:
        texts.append(rain_text(r.rain))
    if frame.gauge is not None:
        x, y, z = frame.gauge
        texts.append(f"Wave gauge at ({x:.1f}, {y:.1f}) m: {fixed(z, 2, sign=True)} m.")
    return lines(texts)


def heights_table(r: Report, frame: SeaFrame) -> Html:
    """Crest, skewness and kurtosis of a sea that is solved step by step, beside theory; its highest wave, its loss."""
    heights = r.heights
    hs, hs_expected = (read(OF_REPORT, name, r) for name in ("significant_height", "expected_height"))
    assert heights is not None
    if not hs > 0.0 or not hs_expected > 0.0:
        return Html("")
    p, t = frame.params, heights.theory
    scale = p.amplitude / hs_expected
    measured = table(
        (("", ""), ("as drawn", ""), ("linear", "theory"), ("second order", "Forristall")),
        (
            (
                fill("crest over significant height {}", info(CREST, "2. Waves")),
                bold(fixed(p.amplitude * heights.crest / hs, 2)),
                fixed(scale * t.linear, 2),
                fixed(scale * t.second_order, 2),
            ),
            (
                fill("skewness {}", info(MOMENTS, "2. Waves")),
                bold(fixed(heights.skewness, 2)),
                "0",
                fixed(t.skewness, 2),
            ),
            ("kurtosis", bold(fixed(heights.kurtosis, 2)), "3", fixed(t.kurtosis, 2)),
        ),
    )
    return join((measured, faint(f"Breaking has dissipated {percent(heights.lost)} of the energy.")))


def draupner_table(r: Report, highest: Highest) -> Html:
    """The highest crest since the start beside the record of the Draupner platform."""
    hs, ratio = read(OF_REPORT, "significant_height", r), DRAUPNER.crest / DRAUPNER.height
    comparison = table(
        (("", ""), ("as drawn", ""), ("measured", "1995")),
        (
            ("significant height [m]", bold(fixed(hs, 1)), fixed(DRAUPNER.height, 1)),
            ("highest crest [m]", bold(fixed(highest.place[2], 1)), fixed(DRAUPNER.crest, 1)),
            ("crest over significant height", bold(fixed(highest.ratio, 2)), fixed(ratio, 2)),
        ),
    )
    return join((comparison, faint("The wave of 1995 took {:g} to {:g} s.".format(*DRAUPNER.period))))


def highest_text(h: Highest) -> str:
    """The highest crest since the start."""
    return f"Highest crest: {number(h.place[2])} m, {fixed(h.ratio, 2)} × significant height"


def foam_text(r: "SeaReadings", g: float) -> str:
    """Foam cover of the sea, and the law that it is compared with."""
    covered = f"Foam covers {percent(r.foam_cover)} of the sea"
    if not r.is_choppy:
        return "No foam: without choppiness the surface is not compressed anywhere."
    if r.slope_left < MIN_SLOPE_LEFT:
        left = percent(r.slope_left)
        return f"{covered}; expected {percent(r.expected_foam_cover)}: Monahan's law times the {left} of slope left."
    if abs(g / EARTH_GRAVITY - 1.0) > 0.02:
        return f"{covered}; Monahan's law, measured on the Earth, gives {percent(r.expected_foam_cover)}."
    return f"{covered}; by Monahan's law {percent(r.expected_foam_cover)}."


def breaking_text(params: SquareSeaParams) -> str:
    """A warning where the waves are too high for the depth; "" if they are not."""
    if params.deep:
        return ""
    height = here(params).height
    if height <= BREAKING_HEIGHT * params.depth:
        return ""
    other = "" if chosen_spectrum(params).name == "tma" else " Of the wind seas only TMA is limited by depth."
    return (
        f"A wave height of {number(height)} m is {number(height / params.depth, 2)} times the depth. "
        f"Above {BREAKING_HEIGHT:g} such waves break, which these do not.{other}"
    )


def depth_line(params: SquareSeaParams) -> str:
    """Height over depth."""
    return breaking_text(params) or "waves are lower than 0.6 of the depth"


def fetch_line(c: FetchConditions) -> str:
    """Conditions of a fully grown sea."""
    full = fetch_of_full_growth(c)
    if c.fetch >= full:
        return f"fully grown, as from {metres(full)} on: a longer fetch adds nothing, and the peak factor is 1"
    return f"fully grown at {metres(full)}"


def rain_text(rain: "RainReadings") -> str:
    """Sentence on the fraction of the rain that is shown."""
    rings = "The grid is too coarse for rings."
    if rain.drops_per_ring:
        rings = f"Each ring stands for {count(rain.drops_per_ring)} drops."
    visible_count, falling = (count(read(OF_RAIN, name, rain)) for name in ("drops_shown", "drops_falling"))
    return f"Rain {number(rain.rate)} mm/h. Shown: {visible_count} of {falling} falling drops. {rings}"


def whole_degrees(direction: float) -> str:
    """A direction [rad] in whole degrees above -180 and up to 180, so that west has one sign."""
    text = fixed(math.degrees(direction), 0)
    return "180" if text == "−180" else text


def statistics_table(r: Report, source: str = "an open sea") -> Html:
    """The statistics: as drawn, as expected of this tile, and of an endless sea, which `source` names."""
    now = {name: read(OF_REPORT, name, r) for name in OF_REPORT}
    expected, endless = now["expected_height"], now["endless_height"]
    band = BAND_WIDTH * now["height_scatter"] * expected
    inside = abs(now["significant_height"] - expected) <= band + 1e-9
    height = number(now["significant_height"])
    direction = bold(whole_degrees(r.measured.direction))
    if now["expected_period"] > 0.0 and not resolved_in_time(now["expected_period"], r.interval):
        direction = coloured("not resolved in time", WARNING_COLOUR)
    measured = table(
        (("", ""), ("as drawn", ""), ("theory", "95 % band")),
        (
            (
                fill("significant height [m] {}", info(HEIGHT, "2. Waves")),
                bold(height) if inside else coloured(height, WARNING_COLOUR),
                f"{number(expected)} ± {number(band, 2)}",
            ),
            ("peak period [s]", bold(number(now["peak_period"])), number(now["expected_period"])),
            (
                fill("mean square slope {}", info(SLOPE, "2. Waves")),
                bold(number(now["mean_square_slope"])),
                number(now["expected_slope"]),
            ),
            ("direction [°]", direction, whole_degrees(r.theory.statistics.direction)),
        ),
    )
    if not endless > 0.0:
        return measured
    fraction = expected / endless
    if fraction < MAX_FRACTION_OF_ENDLESS_SEA:
        text = fill("These waves have {} of the height of {} ({} m).", percent(fraction, 3), source, number(endless))
    else:
        text = fill("Waves of the earlier weather are still here; this wind alone makes {} m.", number(endless))
    return join((measured, faint(text)))


def loop_line(p: SquareSeaParams) -> str:
    """After which time the sea repeats: the scale on frequencies comes after the rounding."""
    if p.loop_period == 0.0 or p.dispersion_scale == 0.0:
        return "never repeats"
    return f"repeats every {seconds(p.loop_period / p.dispersion_scale, 2)}"


def marks(snapshot: Snapshot) -> dict[str, str]:
    """Parameter -> the line under its control."""
    p: SquareSeaParams = snapshot.frame.params
    limit = snapshot.readings.foam_limit
    points = solved_points(p)
    cell = p.length / points
    c = spectrum_conditions(p, p.wind_speed, gravity(p))
    mark_lines = {
        "order": order_line(p, snapshot.frame),
        "wind_speed": wind_line(p),
        "planet": f"gravity {written(QUANTITIES, 'gravity_here', snapshot)}",
        "radius_rule": radius_line(p),
        "low_pass": low_pass_line(p),
        "viscosity": viscosity_line(p, snapshot.readings.viscous_area),
        "loop_period": loop_line(p),
        "size": f"grid spacing {metres(cell)}, shortest wave {metres(2 * cell)}"
        + (f"; at this order {points} × {points} at most" if points < int(p.size) else ""),
        "mesh": f"grid spacing {metres(p.length / len(snapshot.frame.vertices))}",
        "foam_by_wind": f"foam where the surface is compressed below {percent(limit)} of its area"
        if math.isfinite(limit)
        else "no foam",
    }
    if not p.deep:
        mark_lines["depth"] = depth_line(p)
    if isinstance(c, FetchConditions) and not chosen_spectrum(p).is_level(c):
        mark_lines["fetch"] = fetch_line(c)
    if isinstance(c, RegularConditions) and snapshot.readings.report is not None:
        length, period = (written(QUANTITIES, name, snapshot) for name in ("wave_length", "expected_period"))
        mark_lines["wave_period"] = f"the nearest wave that fits the tile: {length}, {period}"
    return mark_lines


def order_line(params: SquareSeaParams, frame: SeaFrame) -> str:
    """Line under the order: the highest crest, or the solver."""
    if frame.highest is not None:
        return f"{highest_text(frame.highest)}, at t = {frame.highest.time:.1f} s"
    return "solved step by step; new weather restarts it" if marches(params) else "a sum of linear waves"


def wind_line(params: SquareSeaParams) -> str:
    """The wind on Beaufort's scale."""
    force, name = beaufort(params.wind_speed)
    spectrum = chosen_spectrum(params)
    if spectrum.wind_height == 10.0:
        return f"Beaufort {force}, {name}"
    there = number(spectrum.wind_speed(params.wind_speed))
    return f"Beaufort {force}, {name}; {there} m/s at {spectrum.wind_height:g} m height"


def radius_line(params: SquareSeaParams) -> str:
    """Gravity of a planet of this mass by each rule for its radius."""
    each = ", ".join(
        f"{number(gravity_of(params.planet_mass, rule))} ({rule.replace('_', ' ')})" for rule in RADIUS_RULES
    )
    return f"gravity in m/s² by each rule: {each}"


def low_pass_line(params: SquareSeaParams) -> str:
    """Time that fluids at rest take to lower a wave of wavenumber 1/l as the low pass l does: by e^(-1/2)."""
    if params.low_pass == 0.0:
        return "no wave is left out"
    k, g = 1.0 / params.low_pass, gravity(params)
    water, oil = (0.5 / float(viscous_root(k, nu, g)[1]) for nu in (WATER_VISCOSITY, HEAVY_OIL_VISCOSITY))
    return f"like {seconds(water, 2)} of decay in water, or {seconds(oil, 2)} in heavy oil (2×10⁻² m²/s)"


def viscosity_line(params: SquareSeaParams, area: float) -> str:
    """Rate at which viscosity damps a wave of 1 m, and the lab's length l for the decay so far; area [m2]: of nu T."""
    length = 2.0 * math.sqrt(area)
    so_far = ""
    if length > 0.0 and is_weak(1.0 / length, params.viscosity, gravity(params)):
        so_far = f"; the decay so far is that of the lab's length l = {metres(length, 2)}"
    if params.viscosity == 0.0:
        return f"no decay{so_far}; a reset restores the waves" if so_far else "no decay"
    omega, decay = viscous_root(2.0 * math.pi, params.viscosity, gravity(params))
    how = "a wave of 1 m" if omega > 0.0 else "1 m is too short to swing: such a hump"
    return f"{how} falls to 37 % in {seconds(1.0 / float(decay), 2)}{so_far}"


def is_weak(k: float, viscosity: float, g: float) -> bool:
    """True if a wave of wavenumber k [rad/m] decays at 2 nu k^2 within 5 %."""
    _, decay = viscous_root(k, viscosity, g)
    return abs(float(decay) - 2.0 * viscosity * k**2) <= 0.05 * 2.0 * viscosity * k**2
