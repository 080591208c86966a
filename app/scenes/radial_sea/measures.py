"""What a sweep records of the radial sea: bodies beside predictions, and what oil leaves of the waves."""

import math
from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.measures import slug
from app.scenes.radial_sea.bodies import BODY_KINDS

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
            ("density", "kg/m3", "density", body and body.density),
            ("mass", "kg", "mass", body and body.mass),
            ("volume", "m3", "volume", body and body.volume),
            ("buoyancy", "N", "upward force of the fluids' pressure", body and body.buoyancy),
            ("wet_volume_above", "m3", "wet volume in the upper fluid", body and body.wet_volume[0]),
            ("wet_volume_below", "m3", "wet volume in the lower fluid", body and body.wet_volume[1]),
            ("heave_period", "s", "heave period as measured", body and body.period),
            ("heave_period_theory", "s", "heave period by theory", prediction and prediction.period),
        ):
            number = math.nan if value is None else value
            found[f"{slug(kind.title)}_{name}"] = Measure(number, unit, f"{kind.title}: {meaning}")
    return found | {
        "significant_height": Measure(readings.height, "m", "Significant height of the waves"),
        "clean_height": Measure(readings.clean_height, "m", "Significant height of the waves without the oil"),
        "mean_square_slope": Measure(readings.slope, "1", "Mean square slope of the waves"),
        "clean_slope": Measure(readings.clean_slope, "1", "Mean square slope of the waves without the oil"),
        "middle_period": Measure(readings.middle_period, "s", "Period of the wave in the middle of the energy"),
    }
