"""Values of the rope for the tasks of the lab: its stretch, its tension, the limits of its step and stiffness."""

import numpy as np

from app.messages import Snapshot
from app.scenes.contract import Measure
from app.scenes.rope.frame import RopeFrame, RopeReadings
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.live_values import stability_values
from app.scenes.springs.rope_parameters import ROPE_RADIUS, link_and_point


def live_values(snapshot: Snapshot) -> dict[str, Measure]:
    """The numbers of a snapshot."""
    p: RopeParams = snapshot.params
    frame: RopeFrame = snapshot.frame
    readings: RopeReadings = snapshot.readings
    values = link_and_point(p)
    stiffness, weight = values["stiffness"], values["mass"] * p.gravity
    points = frame.points.astype(float)
    stretch = float(np.linalg.norm(points[1] - points[0])) - p.length / (p.points - 1)
    lift = weight * (p.points - 1)
    unit = "N/m" if readings.parameter == "stiffness" else "N"
    found = stability_values(readings.stability) | {
        "largest_stiffness": Measure(readings.largest_stiffness, unit, "Largest stable stiffness"),
        "link_stiffness": Measure(stiffness, "N/m", "Stiffness of a link"),
        "carried_weight": Measure(lift, "N", "Weight that the top spring carries at rest"),
        "rest_stretch": Measure(lift / stiffness, "m", "Stretch of the top spring at rest"),
        "top_stretch": Measure(stretch, "m", "Stretch of the top spring"),
        "largest_tension": Measure(float(frame.tension.max()), "N", "Largest tension"),
        "tip_height": Measure(float(points[-1, 2]), "m", "Height of the tip"),
    }
    if frame.sphere is not None:
        *centre, radius = frame.sphere
        depth = radius + ROPE_RADIUS - float(np.linalg.norm(points - centre, axis=1).min())
        found["contact_depth"] = Measure(max(depth, 0.0), "m", "Depth of the deepest point in the sphere")
        found["contact_force"] = Measure(p.contact_stiffness * max(depth, 0.0), "N", "Force of its spring")
    return found
