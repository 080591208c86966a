"""Measures of the mooring for sweeps: its largest tensions, slack, uplift and offset."""

from typing import TYPE_CHECKING

from app.scenes.contract import Measure

if TYPE_CHECKING:
    from app.scenes.mooring.line_scene import LineScene


def measures(scene: "LineScene") -> dict[str, Measure]:
    """The measures since the start."""
    found = scene.readings()
    lines = found.lines
    return {
        "largest_tension": Measure(max(line.most_at_fairlead for line in lines), "N", "Largest tension at a fairlead"),
        "largest_at_anchor": Measure(max(line.most_at_anchor for line in lines), "N", "Largest tension at an anchor"),
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
