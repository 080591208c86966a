"""What the panel of the radial scene says: the numbers are those of the physics, in every preset."""

import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.formats.formatting import fixed
from app.scenes.quantities import read
from app.scenes.radial_sea import SCENE
from app.scenes.radial_sea.drawn_surface import DrawnSurface
from app.scenes.radial_sea.oil.budget import budget_html, origin_text
from app.scenes.radial_sea.oil.charts import budget_chart
from app.scenes.radial_sea.oil.well_blowout import OilBudget
from app.scenes.radial_sea.parameters import PRESETS, RadialSeaParams, column_of, hidden, spill_of
from app.scenes.radial_sea.quantities import QUANTITIES
from app.scenes.radial_sea.report import marks_of, mixture_html, notes_of, oil_budget_text, readout_of, surfaces_html
from app.scenes.radial_sea.scene import RadialSeaScene
from app.server.loop.sim_loop import SimLoop
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.fluids import fluids
from sim.ocean.weathering import oil_records, weather
from sim.parameters import check_record, parameters_of
from tests import naive_spill
from tests.naive_ocean import layer_roots

Loop: Any = SimLoop  # of a scene whose types the tests know


@pytest.mark.parametrize("name", list(PRESETS))
def test_each_preset_is_reported_without_a_number_that_is_none(name: str) -> None:
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, PRESETS[name])))
    loop.tick(0.1)
    snapshot = loop.latest
    texts = [readout_of(snapshot), *marks_of(snapshot).values()]
    assert all(texts)
    assert not any("nan" in text or "inf " in text for text in (*texts, *notes_of(snapshot).values()))
    assert set(marks_of(snapshot)) <= set(parameters_of(RadialSeaParams()))


def test_the_share_that_oil_leaves_is_that_of_clean_water() -> None:
    scene = RadialSeaScene(check_record(RadialSeaParams, PRESETS["Light crude spill 0.2 m"]))
    for _ in range(20):
        scene.advance(10)
    now = scene.readings()
    height, slope = (read(QUANTITIES, f"{one}_left", SimpleNamespace(readings=now)) for one in ("height", "slope"))
    assert height == pytest.approx(now.height / now.clean_height)
    assert slope == pytest.approx(now.slope / now.clean_slope)
    assert slope < height < 1.0


def test_the_height_of_the_whole_spectrum_follows_wind_and_decay() -> None:
    drawing, sums = DrawnSurface(), []
    for wind, oil in ((8.0, 0.0), (12.0, 0.0), (12.0, 60.0), (8.0, 0.0)):
        scene = RadialSeaScene(check_record(RadialSeaParams, {"wind_speed": wind, "spill": "layer", "exposure": oil}))
        sums.append(drawing.spectrum_height(scene.wave_choice, scene.sum))
        assert sums[-1] == drawing.spectrum_height(scene.wave_choice, scene.sum)
    assert sums[0] == sums[3]
    assert sums[2] < sums[1]
    assert sums[1] > 1.5 * sums[0]


def test_the_source_of_boiling_points_is_told() -> None:
    texts = [origin_text(record) for record in oil_records().values()]
    for record, text in zip(oil_records().values(), texts, strict=True):
        assert ("are from its record" in text) is bool(record.distillation)
        assert ("has no distillation" in text) is not bool(record.distillation)
    assert any(record.distillation for record in oil_records().values())


def test_sinking_bodies_are_said_to_sink() -> None:
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"spill": "mixed", "fraction": 0.6, "density": 1010.0})))
    loop.tick(0.1)
    assert "sinks" in notes_of(loop.latest)["Archimedes' principle"]


def test_no_bodies_and_no_waves_are_reported_too() -> None:
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"bodies": 0, "waves": False, "spill": "layer"})))
    loop.tick(0.1)
    assert readout_of(loop.latest) == "<div>No bodies.</div><div>No waves.</div>"
    assert marks_of(loop.latest)["wind_speed"] == "no waves"
    assert [heading for heading, text in notes_of(loop.latest).items() if not text] == ["Radial or square"]


@pytest.mark.parametrize(("density", "is_said"), [(50.0, True), (450.0, False)])
def test_a_body_outside_its_table_of_coefficients_is_said_to_be(density: float, is_said: bool) -> None:
    """The box of 50 kg/m3 floats at 0.058 of half its width, where the table begins at 0.06."""
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"density": density, "bodies": 3, "waves": False})))
    loop.tick(0.1)
    words = "Box: draft over half the width 0.0569 (table: 0.06 to 4.2) is outside"
    assert (words in notes_of(loop.latest)["Forces"]) == is_said


def live(**values) -> dict[str, Any]:
    """The live values of a scene."""
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, values)))
    loop.tick(0.1)
    return {name: quantity.value(loop.latest) for name, quantity in SCENE.quantities.items()}


@pytest.mark.parametrize("spill", ["none", "layer", "mixed"])
@pytest.mark.parametrize("oil", ["diesel 2002", "Maya", "Bunker C Zalinski"])
def test_reflection_is_that_of_the_oil_and_more_than_the_water_s(spill: str, oil: str) -> None:
    found = live(spill=spill, oil=oil, fraction=0.4)
    third = fluids()[oil].density / 3000.0  # the one-third rule
    index = math.sqrt((1.0 + 2.0 * third) / (1.0 - third))
    assert found["oil_reflectance"] == pytest.approx(((index - 1.0) / (index + 1.0)) ** 2, rel=1e-6)
    assert found["water_reflectance"] == pytest.approx((0.34 / 2.34) ** 2, rel=1e-6)
    assert found["oil_reflectance"] > found["water_reflectance"]
    assert found["oil_sky_reflectance"] > found["water_sky_reflectance"]


def test_what_oil_does_to_the_waves_is_there_where_there_is_oil() -> None:
    clean = live()
    assert clean["added_draft"] == 0.0
    assert clean["height_left"] == clean["slope_left"] == 1.0
    # 2 nu k^2 of sea water at 15 C: 1/(2 x 1.19e-6 x 39.5) s
    assert clean["short_wave_lifetime"] == pytest.approx(3.0 * 3600.0, rel=0.03)
    layer = live(spill="layer", oil="IFO 180", thickness=0.01)
    assert layer["long_wave_speed"] == pytest.approx(layer["clean_wave_speed"], rel=0.01)
    assert layer["short_wave_lifetime"] < clean["short_wave_lifetime"]


@pytest.mark.parametrize("law", ["pal_rhodes", "mooney", "taylor", "arrhenius", "kendall_monroe"])
@pytest.mark.parametrize("continuous", ["plentiful", "oil", "water"])
@pytest.mark.parametrize("fraction", [0.1, 0.45, 0.8])
def test_what_is_said_of_a_mixture_is_the_law_s(law: str, continuous: str, fraction: float) -> None:
    oil, water, phi = 13.0, 1.22, fraction  # [mPa s] of Arabian Light and of sea water
    in_oil = continuous == "oil" or (continuous == "plentiful" and fraction > 0.5)
    (drop, around), drops = ((water, oil), 1.0 - phi) if in_oil else ((oil, water), phi)
    x = drops / 0.84
    expected = {
        "pal_rhodes": around * (1.187 / (1.187 - x)) ** 2.49,
        "mooney": around * math.exp(2.5 * drops / (1.0 - 0.65 * drops)),
        "taylor": around * (1.0 + 2.5 * drops * (drop + 0.4 * around) / (drop + around)),
        "arrhenius": oil**phi * water ** (1.0 - phi),
        "kendall_monroe": (phi * oil ** (1 / 3) + (1.0 - phi) * water ** (1 / 3)) ** 3,
    }[law]
    column = FluidColumn(oil=fluids()["Arabian Light"], fraction=fraction, law=law, continuous=continuous)
    said = mixture_html(column, law).replace("\u202f", "")
    assert float(said.split(" mPa")[0]) == pytest.approx(expected, rel=6e-3)
    emulsion = law in ("pal_rhodes", "mooney", "taylor")
    assert ("water in oil: " in said) == (emulsion and in_oil)
    assert ("oil in water: " in said) == (emulsion and not in_oil)
    assert ("This law holds up to" in said) == (
        drops > {"pal_rhodes": 0.84, "mooney": 0.8, "taylor": 0.1}.get(law, 1.0)
    )
    if emulsion:
        assert float(re.findall(r"([\d.]+) times as viscous", said)[0]) == pytest.approx(expected / around, rel=6e-3)


def budget_rows(html: str) -> dict[str, list[float]]:
    """The rows of the first table: label -> numbers."""
    rows = [re.findall(r"<td>([^<]*)</td>", row) for row in re.findall(r"<tr>.*?</tr>", html.split("</table>")[0])]
    return {row[0]: [float(cell) for cell in row[1:]] for row in rows if row}


@pytest.mark.parametrize("oil", naive_spill.OILS)
def test_the_spill_budget_on_screen_is_that_of_plain_steps_of_pygnome_s_laws(oil: str) -> None:
    params = check_record(RadialSeaParams, {"spill": "layer", "oil": oil, "spill_hours": 12.0, "wind_speed": 9.0})
    spill = spill_of(params)
    assert spill is not None
    html = budget_html(params, weather(spill)).replace("\u202f", "")
    rows = budget_rows(html)
    for label, hours in (("1", 1.0), ("6", 6.0), ("24", 24.0), ("now, 12", 12.0)):
        expected = naive_spill.spill(oil, 100.0, 9.0, hours)
        lost, drops = 100.0 * expected["evaporated"], 100.0 * expected["dispersed"]
        wanted = [lost, drops, 100.0 - lost - drops, 100.0 * expected["water_content"]]
        assert rows[label] == pytest.approx(wanted, rel=0.02, abs=0.06), (oil, hours)
    expected = naive_spill.spill(oil, 100.0, 9.0, 12.0)
    assert float(re.findall(r" on ([\d.]+) km²", html)[0]) == pytest.approx(expected["area"] * 1e-6, rel=0.02)
    assert float(re.findall(r"drifted ([\d.]+) km", html)[0]) == pytest.approx(0.03 * 9.0 * 12.0 * 3.6, rel=6e-3)
    density, fresh, viscosity = (
        float(re.findall(pattern, html)[0])
        for pattern in (r"([\d.]+) kg/m³ \(fresh", r"kg/m³ \(fresh ([\d.]+)\)", r"([\d.]+) mPa·s \(fresh")
    )
    # Other laws, after a day: Fingas from what boils off at 180 C, Stiver and Mackay from the exposure.
    distilled, crude = {
        "Alaska North Slope 2002": (22.6, True),
        "Arabian Light": (15.9, True),
        "diesel 2002": (26.8, False),
    }[oil]
    by_fingas = 0.165 * distilled * math.log(1440.0) if crude else 0.0254 * distilled * math.sqrt(1440.0)
    api = 141.5 / (fluids()[oil].density / 999.016) - 131.5
    T0, G = (532.98 - 3.1295 * api, 985.62 - 13.597 * api) if crude else (654.45 - 4.6588 * api, 388.19 - 3.8725 * api)
    spent = weather(spill).exposure(24.0)
    by_mackay = 28815.0 / (10.3 * G) * math.log(1.0 + 10.3 * G / 288.15 * spent * math.exp(6.3 - 10.3 * T0 / 288.15))
    said = [float(p) for p in re.findall(r"([\d.]+)\s%", html.split("by other laws")[1])[:2]]
    assert said == pytest.approx([by_fingas, by_mackay], rel=0.03)
    assert fresh == fluids()[oil].density
    assert viscosity == pytest.approx(1e3 * expected["viscosity"] * density, rel=0.03)


def test_what_floats_is_the_weathered_oil() -> None:
    aged = {"spill": "layer", "oil": "Arabian Light", "spill_hours": 24.0, "spread": True, "wind_speed": 7.0}
    column = column_of(check_record(RadialSeaParams, aged))
    expected = naive_spill.spill("Arabian Light", 100.0, 7.0, 24.0)
    assert column.oil.kinematic_viscosity == pytest.approx(expected["viscosity"], rel=0.02)
    # 89 % of it is water of 1025 kg/m3; the oil itself has grown heavier by what it lost.
    assert 1024.0 > column.oil.density > 0.891 * 1025.0 + 0.109 * 864.0
    remaining = 100.0 * (1.0 - expected["evaporated"] - expected["dispersed"])
    volume = remaining * 864.0 / ((column.oil.density - 0.8913 * 1025.0) / 0.1087) / 0.1087
    assert column.thickness == pytest.approx(volume / expected["area"], rel=0.03)
    fresh = column_of(check_record(RadialSeaParams, {**aged, "spill_hours": 0.0, "spread": False}))
    assert (fresh.oil, fresh.thickness) == (fluids()["Arabian Light"], 0.2)
    cold = column_of(check_record(RadialSeaParams, {**aged, "spill_hours": 0.0, "temperature": 0.0}))
    assert (cold.oil.density, cold.oil.viscosity) == (pytest.approx(877.6), pytest.approx(0.033))


def test_a_spill_that_is_gone_leaves_clean_water() -> None:
    gone = {"spill": "layer", "oil": "diesel 2002", "spill_hours": 48.0, "spread": True, "wind_speed": 15.0}
    assert column_of(check_record(RadialSeaParams, gone)).kind == "water"


def test_without_a_spill_to_follow_the_budget_says_why() -> None:
    for values, said in (
        ({}, ""),
        ({"spill": "mixed"}, ""),
        ({"spill": "layer", "oil": "IFO 180", "spill_hours": 24.0}, "has no data on evaporation"),
    ):
        params = check_record(RadialSeaParams, values)
        assert spill_of(params) is None
        assert said in budget_html(params, None)
        assert bool(budget_html(params, None)) == bool(said)
        assert {"spill_hours", "spill_volume", "spread", "plot_budget"} <= hidden(params)
    assert (
        column_of(check_record(RadialSeaParams, {"spill": "layer", "oil": "IFO 180", "spill_hours": 24.0})).oil
        == fluids()["IFO 180"]
    )


def test_the_chart_of_the_budget_is_stacked_to_the_whole() -> None:
    spill = spill_of(check_record(RadialSeaParams, PRESETS["A day after a spill"]))
    assert spill is not None
    chart = budget_chart(spill, 24.0)
    hours, whole, below, oil, water, now = chart.columns
    for h in (6.0, 72.0):
        state, at = weather(spill).at(h), int(np.flatnonzero(hours == h)[0])
        assert whole[at] - below[at] == pytest.approx(100 * state.evaporated)
        assert below[at] - oil[at] == pytest.approx(100 * state.dispersed)
        assert (oil[at], water[at]) == pytest.approx((100 * state.remaining, 100 * state.water_content))
    assert (whole == 100.0).all()
    assert np.diff(hours).min() > 0.0
    assert (hours[0], hours[-1], chart.end) == (0.0, 120.0, 120.0)
    assert hours[np.isfinite(now)].tolist() == pytest.approx([23.7, 24.3])
    assert np.isfinite(budget_chart(spill, 0.0).columns[-1]).sum() == 2
    assert np.isfinite(budget_chart(spill, 120.0).columns[-1]).sum() == 2
    assert budget_chart(spill, 24.0) is chart


@pytest.mark.parametrize(
    ("oil", "thickness", "wind", "exposure"),
    [("Arabian Light", 0.05, 4.0, 3000.0), ("IFO 180", 0.01, 7.0, 600.0), ("Maya", 0.4, 14.0, 3600.0)],
)
def test_lines_on_the_waves_are_jonswap_s_and_those_of_the_exact_root(
    oil: str, thickness: float, wind: float, exposure: float
) -> None:
    values = {"spill": "layer", "oil": oil, "thickness": thickness, "wind_speed": wind, "exposure": exposure}
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {**values, "bodies": 0, "ageing": False})))
    loop.tick(0.1)
    said = {name: text.replace("\u202f", "").replace("\xa0", " ") for name, text in marks_of(loop.latest).items()}
    # JONSWAP from 100 km, at most full growth (22 x 1.026/0.87716)^3, where the peak factor is 1.
    g, grown = 9.81, 1.704e4
    chi = min(g * 1e5 / wind**2, grown)
    wp, gamma = 22.0 * chi ** (-1 / 3) * g / wind, 3.3 ** min(math.log(grown / chi) / -math.log(0.86), 1.0)
    w = np.geomspace(0.4 * wp, 30.0 * wp, 20001)
    r = np.exp(-((w - wp) ** 2) / (2.0 * np.where(w <= wp, 0.07, 0.09) ** 2 * wp**2))
    S = 0.076 * chi**-0.22 * g**2 * w**-5.0 * np.exp(-1.25 * (wp / w) ** 4) * gamma**r
    part = 0.5 * (S[1:] + S[:-1]) * np.diff(w)
    height, period = re.findall(r"waves of ([\d.]+) m, middle period ([\d.]+) s", said["wind_speed"])[0]
    assert float(height) == pytest.approx(4.0 * math.sqrt(part.sum()), rel=0.01)
    middle = w[np.searchsorted(np.cumsum(part), 0.5 * part.sum())]
    assert float(period) == pytest.approx(2.0 * math.pi / middle, rel=0.03)
    fluid, water = fluids()[oil], fluids()["sea water"]
    k = np.array([wp**2 / g])
    root: Any = layer_roots(
        k, np.array([thickness]), (fluid.density, water.density), (fluid.viscosity, water.viscosity), g,
        (fluid.surface_tension or 0.0, fluid.interface_tension or 0.0), steps=30,
    )  # fmt: skip
    left = 100.0 * math.exp(float(root.real[0]) * exposure)
    assert float(re.findall(r"keeps ([\d.]+)", said["exposure"])[0]) == pytest.approx(left, rel=0.01)


def test_what_a_slick_leaves_of_a_wave_is_said_in_words_where_it_is_nothing() -> None:
    budget = OilBudget(ejected=9.0, in_flight=1.0, fed=8.0, hits=3, radius=10.0, thickness=0.02, wave_left=0.4321)
    assert "A wave of 1 m keeps 43.2 % of its height" in oil_budget_text(budget).replace("\xa0", " ")
    assert "keeps less than 0.1 % of" in oil_budget_text(budget._replace(wave_left=8e-18)).replace("\xa0", " ")
    assert "A wave of" not in oil_budget_text(budget._replace(wave_left=math.nan))


@pytest.mark.parametrize(("values", "calms"), [({}, True), ({"surface": "fft"}, False), ({"spill": "mixed"}, False)])
def test_a_slick_is_said_to_calm_the_sea_where_it_does(values: dict[str, str], calms: bool) -> None:
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"jet": True, "jet_flow": 20.0, "bodies": 0, **values})))
    for _ in range(60):
        loop.tick(0.1)
    assert loop.latest.readings.oil_budget.fed > 0.0
    assert ("A wave of" in readout_of(loop.latest)) == calms


def test_the_cost_of_a_surface_is_shown_in_milliseconds() -> None:
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"compare": True, "bodies": 0, "wave_count": 16})))
    loop.tick(0.1)
    costs = [surface.cost for surface in loop.latest.readings.surfaces.values()]
    assert len(costs) == 2
    text = surfaces_html(loop.latest)
    assert all(f">{fixed(1e3 * cost, 2)}<" in text for cost in costs)
    radial = loop.latest.readings.surfaces["sum"]
    grid = loop.latest.frame.grid
    assert radial.shortest == 2.0 * min(grid.spacing)
    assert radial.extent == 2.0 * grid.radii[-1]


@pytest.mark.parametrize(("fraction", "beyond"), [(0.05, False), (0.3, True)])
def test_the_line_under_a_mixture_says_where_its_law_ends(fraction: float, beyond: bool) -> None:
    values = {"spill": "mixed", "mixture_law": "taylor", "fraction": fraction, "bodies": 0, "oil": "Arabian Light"}
    loop = Loop(RadialSeaScene(check_record(RadialSeaParams, {"wave_count": 16, **values})))
    loop.tick(0.1)
    said = marks_of(loop.latest)
    ending = "; the law holds up to 10%" if beyond else ""
    assert said["continuous"].replace("\u202f", "") == f"{100.0 * fraction:.0f}\u00a0% drops of oil{ending}"
    column = loop.latest.readings.column
    assert float(said["mixture_law"].split("\u202f")[0].split(" ")[0]) == pytest.approx(
        1e3 * column.surface.viscosity, rel=6e-3
    )
