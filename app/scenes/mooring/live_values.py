"""Values of the mooring for the tasks of the lab: tensions, slack and the limit of the step."""

from app.messages import Snapshot
from app.scenes.contract import Measure
from app.scenes.mooring.arrangement import first_line, water_of
from app.scenes.mooring.frame import MooringReadings
from app.scenes.mooring.measures import tension_measures
from app.scenes.mooring.parameters import MooringParams
from app.scenes.springs.live_values import stability_values


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot."""
    readings: MooringReadings = snapshot.readings
    first = readings.lines[0]
    p: MooringParams = snapshot.params
    kind, length = first_line(p)
    water = water_of(p)
    weight = water.gravity * (kind.mass - water.density * kind.volume)
    height = float(snapshot.frame.points[0, -1, 2]) + water.depth
    return (
        stability_values(readings.stability)
        | tension_measures(readings, p.breaking_load)
        | {
            "fairlead_tension": Measure(first.fairlead, "N", "Tension of line 1 at the fairlead"),
            "anchor_tension": Measure(first.anchor, "N", "Tension of line 1 at the anchor"),
            "uplift": Measure(first.uplift, "N", "Upward force of line 1 on its anchor"),
            "line_1_lying_length": Measure(first.lying, "m", "Length of line 1 on the bed"),
            "hanging_length": Measure(length - first.lying, "m", "Length of line 1 that hangs"),
            "fairlead_height": Measure(height, "m", "Height of the fairlead of line 1 over the bed"),
            "line_weight": Measure(weight, "N/m", "Weight of a metre of line in water"),
            "line_1_slack_share": Measure(first.slack_share, "1", "Share of time that line 1 is slack"),
            "offset": Measure(readings.offset, "m", "Level distance of the body from its place of rest"),
        }
    )
