"""Measures of the mooring for sweeps: its tensions, slack, uplift and offset."""

import math
from typing import TYPE_CHECKING

from app.scenes.contract import Measure
from app.scenes.mooring.frame import MooringReadings

if TYPE_CHECKING:
    from app.scenes.mooring.line_scene import LineScene


def tension_measures(found: MooringReadings, breaking_load: float) -> dict[str, Measure]:
    """Statistics of the tensions at the fairleads. breaking_load: [kN], 0 if it is not known."""
    ends = [line.at_fairlead for line in found.lines]
    largest = max(end.largest for end in ends)
    use = 1e-3 * largest / breaking_load if breaking_load > 0.0 else math.nan
    return {
        "least_tension": Measure(min(end.least for end in ends), "N", "Least tension at a fairlead"),
        "mean_tension": Measure(max(end.mean for end in ends), "N", "Largest mean tension at a fairlead"),
        "largest_tension": Measure(largest, "N", "Largest tension at a fairlead"),
        "tension_deviation": Measure(
            max(end.deviation for end in ends), "N", "Largest standard deviation of the tension at a fairlead"
        ),
        "breaking_load_use": Measure(use, "1", "Largest tension at a fairlead over the breaking load"),
    }


def measures(scene: "LineScene") -> dict[str, Measure]:
    """The measures since the statistics began, which leave out drags."""
    found = scene.readings()
    lines = found.lines
    return {
        **tension_measures(found, scene.params.breaking_load),
        "largest_at_anchor": Measure(
            max(line.at_anchor.largest for line in lines), "N", "Largest tension at an anchor"
        ),
        "largest_uplift": Measure(max(line.most_uplift for line in lines), "N", "Largest upward force on an anchor"),
        "slack_share": Measure(
            max(line.slack_share for line in lines), "1", "Largest share of time that a line is slack"
        ),
        "lying_length": Measure(sum(line.lying for line in lines), "m", "Length of all lines on the bed"),
        "largest_offset": Measure(found.most_offset, "m", "Largest level distance of the body from its place of rest"),
        "heave": Measure(float(scene.body_place()[2] - scene.middle[2]), "m", "Height of the body over its rest"),
        "rest_stretch": Measure(float(scene.rest_stretch.max()), "1", "Largest stretch of a line at rest"),
        "critical_step": Measure(found.stability.critical_step, "s", "Largest stable time step"),
    }
