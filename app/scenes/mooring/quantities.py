"""Quantities of the mooring: tensions, slack, uplift and offset, line 1, and the limit of the step."""

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from app.scenes.mooring.arrangement import first_line, water_of
from app.scenes.quantities import Quantities, Quantity, for_sweeps, for_tasks
from app.scenes.springs.quantities import STABILITY

if TYPE_CHECKING:
    from app.scenes.mooring.frame import LineReading
    from app.scenes.mooring.parameters import MooringParams


def over_lines(
    reduce: Callable[[Iterable[float]], float], value: "Callable[[LineReading], float]"
) -> Callable[[Any], float]:
    """A number of every line, reduced to one."""
    return lambda now: reduce(value(line) for line in now.readings.lines)


def of_line_1(value: "Callable[[LineReading], float]") -> Callable[[Any], float]:
    """A number of line 1."""
    return lambda now: value(now.readings.lines[0])


largest_tension = over_lines(max, lambda line: line.at_fairlead.largest)


def load_use(tension: float, params: "MooringParams") -> float:
    """A tension [N] over the breaking load; NaN if that is not known."""
    load = 1e3 * params.breaking_load  # [N]
    return tension / load if load > 0.0 else math.nan


def dragged_tension(now: Any) -> float | None:
    """Largest tension [N] at a fairlead in the time that the statistics leave out; None without such a time."""
    tension = now.readings.dragged
    return None if math.isnan(tension) else tension


def hanging_length(now: Any) -> float:
    """Length [m] of line 1 that hangs."""
    return first_line(now.params)[1] - now.readings.lines[0].lying


def weight_in_water(p: "MooringParams") -> float:
    """Weight [N/m] of line 1 in water."""
    kind, water = first_line(p)[0], water_of(p)
    return water.gravity * (kind.mass - water.density * kind.volume)


QUANTITIES: Quantities = {
    "least_tension": Quantity("N", "Least tension at a fairlead", over_lines(min, lambda line: line.at_fairlead.least)),
    "mean_tension": Quantity(
        "N", "Largest mean tension at a fairlead", over_lines(max, lambda line: line.at_fairlead.mean)
    ),
    "largest_tension": Quantity("N", "Largest tension at a fairlead", largest_tension),
    "tension_deviation": Quantity(
        "N",
        "Largest standard deviation of the tension at a fairlead",
        over_lines(max, lambda line: line.at_fairlead.deviation),
    ),
    "expected_tension": Quantity(
        "N",
        "Largest tension at a fairlead expected in three hours",
        over_lines(max, lambda line: line.at_fairlead.expected),
    ),
    "breaking_load_use": Quantity(
        "1",
        "Largest tension at a fairlead over the breaking load",
        lambda now: load_use(largest_tension(now), now.params),
    ),
    "largest_at_anchor": Quantity(
        "N", "Largest tension at an anchor", over_lines(max, lambda line: line.at_anchor.largest)
    ),
    "largest_uplift": Quantity(
        "N", "Largest upward force on an anchor", over_lines(max, lambda line: line.most_uplift)
    ),
    "slack_fraction": Quantity(
        "1", "Largest fraction of time that a line is slack", over_lines(max, lambda line: line.slack_fraction)
    ),
    "lying_length": Quantity("m", "Length of all lines on the bed", over_lines(sum, lambda line: line.lying)),
    "largest_offset": Quantity(
        "m", "Largest horizontal distance of the body from its rest position", lambda now: now.readings.most_offset
    ),
    "heave": for_sweeps(
        "m",
        "Height of the body over its rest position",
        lambda now: float(now.scene.body_place()[2] - now.scene.middle[2]),
    ),
    "rest_stretch": for_sweeps(
        "1", "Largest stretch of a line at rest", lambda now: float(now.scene.start.stretch.max())
    ),
    **STABILITY,
    "fairlead_tension": for_tasks("N", "Tension of line 1 at the fairlead", of_line_1(lambda line: line.fairlead)),
    "anchor_tension": for_tasks("N", "Tension of line 1 at the anchor", of_line_1(lambda line: line.anchor)),
    "uplift": for_tasks("N", "Upward force of line 1 on its anchor", of_line_1(lambda line: line.uplift)),
    "line_1_lying_length": for_tasks("m", "Length of line 1 on the bed", of_line_1(lambda line: line.lying)),
    "hanging_length": for_tasks("m", "Length of line 1 that hangs", hanging_length),
    "fairlead_height": for_tasks(
        "m",
        "Height of the fairlead of line 1 over the bed",
        lambda now: float(now.frame.points[0, -1, 2]) + water_of(now.params).depth,
    ),
    "line_weight": for_tasks("N/m", "Weight of a metre of line in water", lambda now: weight_in_water(now.params)),
    "line_1_slack_fraction": for_tasks(
        "1", "Fraction of time that line 1 is slack", of_line_1(lambda line: line.slack_fraction)
    ),
    "offset": for_tasks("m", "Horizontal distance of the body from its rest position", lambda now: now.readings.offset),
    "largest_tension_line": for_tasks(
        "1", "Number of the line with the largest tension", lambda now: now.readings.most_at[0] + 1
    ),
    "largest_tension_time": for_tasks("s", "Time of the largest tension", lambda now: now.readings.most_at[1]),
    "statistics_start": for_tasks("s", "Time at which the statistics began", lambda now: now.readings.since),
    "statistics_duration": for_tasks(
        "s", "Duration of the statistics, without drags", lambda now: now.readings.duration
    ),
    "dragged_tension": for_tasks("N", "Largest tension at a fairlead while dragged", dragged_tension),
}
