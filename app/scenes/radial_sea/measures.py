"""Numbers of the radial sea: each of the first three bodies beside Archimedes, and what oil leaves of the waves."""

import math
from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.measures import slug
from app.scenes.radial_sea.bodies import KINDS
from app.scenes.radial_sea.report import NAMES

if TYPE_CHECKING:
    from app.scenes.radial_sea.scene import RadialSeaScene


def measures(scene: "RadialSeaScene") -> dict[str, Measure]:
    """Of bodies and waves as they are; nan for a body that is not there, inf for the draft of what sinks."""
    gauge = scene.readings()
    found: dict[str, Measure] = {}
    for kind in KINDS[:3]:
        reading = next((r for r in gauge.readings if r.kind == kind), None)
        numbers = (math.nan,) * 5
        if reading is not None:
            t = reading.theory
            numbers = reading.mean_draft, t.draft, reading.draft, reading.period, t.period
        body = NAMES[kind]
        for (name, unit, meaning), value in zip(
            (
                ("mean_draft", "m", "mean draft over 8 s"),
                ("draft_at_rest", "m", "draft at rest by Archimedes"),
                ("draft", "m", "draft"),
                ("heave_period", "s", "heave period as measured"),
                ("heave_period_theory", "s", "heave period by theory"),
            ),
            numbers,
            strict=True,
        ):
            found[f"{slug(body)}_{name}"] = Measure(value, unit, f"{body}: {meaning}")
    return found | {
        "significant_height": Measure(gauge.height, "m", "Significant height of the waves"),
        "clean_height": Measure(gauge.height_clean, "m", "Significant height of the waves without the oil"),
        "mean_square_slope": Measure(gauge.slope, "1", "Mean square slope of the waves"),
        "clean_slope": Measure(gauge.slope_clean, "1", "Mean square slope of the waves without the oil"),
        "middle_period": Measure(gauge.peak_period, "s", "Period of the wave in the middle of the energy"),
    }
