"""Frames and readings of the mooring for its view and the panel, immutable."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import Pull, Vector
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.start_check import Fault
from sim.springs.stability import Gauge


class MooringFrame(NamedTuple):
    """Drawn state of a mooring."""

    params: MooringParams
    time: float  # [s]
    body: NDArray[np.float32]  # (3,) [m] the body's centre
    rotation: NDArray[np.float32]  # (4,) its quaternion
    points: NDArray[np.float32]  # (lines, n, 3) [m]
    tension: NDArray[np.float32]  # (lines, n - 1) [N]
    full_scale: float  # [N] tension at the end of the colour scale
    surface: NDArray[np.float32]  # (m, m) [m] heights of the water
    side: float  # [m] of the square that it covers, about the origin
    path: NDArray[np.float32]  # (k, 2) [m] where the body has been
    rest: Vector  # [m] where the body's centre rests
    offset: float  # [m] largest horizontal distance from there
    anchors: NDArray[np.float32]  # (a, 3) [m]
    fairleads: NDArray[np.float32]  # (f, 3) [m], and other points that move
    uplift: NDArray[np.bool_]  # (a,) whether an anchor is pulled upwards
    grab: Pull | None  # the pull of the body


class EndStatistics(NamedTuple):
    """Statistics of the tension at one end of a line since they began; NaN before the first sample."""

    least: float  # [N]
    mean: float  # [N]
    largest: float  # [N]
    deviation: float  # [N] standard deviation
    expected: float = math.nan  # [N] largest one expected in three hours, see `Peaks`; NaN: too few peaks


class LineReading(NamedTuple):
    """One line."""

    fairlead: float  # [N] tension
    anchor: float  # [N]
    at_fairlead: EndStatistics
    at_anchor: EndStatistics
    uplift: float  # [N] upward force on the anchor
    most_uplift: float  # [N] since the statistics began
    lying: float  # [m] of unstretched length on the bed
    slack_since: float  # [s] of simulated time; NaN: the whole line is taut
    slack_fraction: float  # of the time of the statistics


class MooringReadings(NamedTuple):
    """Numbers for the panel."""

    lines: tuple[LineReading, ...]
    offset: float  # [m] horizontal distance of the body from its rest position
    most_offset: float  # [m] since the statistics began
    most_at: tuple[int, float]  # line, from 0, and time [s] of the largest tension
    stability: Gauge
    fault: Fault | None  # of the state that the mooring starts with
    since: float  # [s] when the statistics began
    duration: float  # [s] of the statistics: without drags and what they leave behind
    counts: bool  # False while the time is left out
    dragged: float  # [N] largest tension at a fairlead in the time that was left out; NaN without such a time
