"""Measures of the radial sea for sweeps: bodies beside predictions, and the waves that oil leaves."""

import math
from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.measures import slug
from app.scenes.radial_sea.bodies import BODY_KINDS
from app.scenes.radial_sea.parameters import weathered_oil

if TYPE_CHECKING:
    from app.scenes.radial_sea.scene import RadialSeaScene


def measures(scene: "RadialSeaScene") -> dict[str, Measure]:
    """Numbers of bodies and waves as they are: NaN for a kind that is not there, inf for the draft of one that sinks.

    Of each kind it is the first body.
    """
    readings = scene.readings()
    found: dict[str, Measure] = {}
    for kind in BODY_KINDS:
        body = next((r for r in readings.bodies if r.kind == kind.name), None)
        prediction = body.prediction if body is not None else None
        for name, unit, meaning, value in (
            ("mean_draft", "m", "mean draft over the last minute", body and body.mean_draft),
            ("draft_at_rest", "m", "draft at rest by Archimedes", prediction and prediction.draft),
            ("draft", "m", "draft", body and body.draft),
            ("density", "kg/m³", "density", body and body.density),
            ("mass", "kg", "mass", body and body.mass),
            ("volume", "m³", "volume", body and body.volume),
            ("buoyancy", "N", "weight of the displaced fluids", body and body.buoyancy),
            ("mean_buoyancy", "N", "mean buoyancy over the last minute", body and body.mean_lift[0]),
            ("wet_volume_above", "m³", "wet volume in the upper fluid", body and body.wet_volume[0]),
            ("wet_volume_below", "m³", "wet volume in the lower fluid", body and body.wet_volume[1]),
            ("offset", "m", "level distance from where its lines hold it", body and body.offset),
            ("line_tension", "N", "largest tension of its mooring lines", body and body.tension),
            ("heave_period", "s", "heave period as measured", body and body.period),
            ("heave_period_theory", "s", "heave period by theory", prediction and prediction.period),
        ):
            number = math.nan if value is None else value
            found[f"{slug(kind.title)}_{name}"] = Measure(number, unit, f"{kind.title}: {meaning}")
    spill = weathered_oil(scene.params)
    for name, unit, meaning, value in (
        ("evaporated", "1", "Share of the spill that has evaporated", spill and spill.evaporated),
        ("dispersed", "1", "Share of the spill in drops in the water", spill and spill.dispersed),
        ("water_content", "1", "Share of water in the emulsion", spill and spill.water_content),
        ("slick_area", "m²", "Area of the spill", spill and spill.area),
        ("oil_viscosity", "Pa·s", "Viscosity of the oil that floats", scene.column.oil.viscosity),
        ("oil_density", "kg/m³", "Density of the oil that floats", scene.column.oil.density),
    ):
        found[name] = Measure(math.nan if value is None else value, unit, meaning)
    return found | {
        "significant_height": Measure(readings.height, "m", "Significant height of the waves"),
        "clean_height": Measure(readings.clean_height, "m", "Significant height of the waves without the oil"),
        "mean_square_slope": Measure(readings.slope, "1", "Mean square slope of the waves"),
        "clean_slope": Measure(readings.clean_slope, "1", "Mean square slope of the waves without the oil"),
        "middle_period": Measure(readings.middle_period, "s", "Period above which half of the energy is"),
    }
