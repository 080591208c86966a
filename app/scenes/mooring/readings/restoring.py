"""The static restoring curve: the force of all lines over the offset along the waves, and the force now."""

import math
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from app.messages import ChartLine, Vector
from app.scenes.charts import PALETTE, Chart
from app.scenes.mooring.arrangement import Places
from sim.interruption import raise_if_stopped
from sim.mooring import Line, Point, System, at_rest

SPANS = 32  # places at which a line's statics are solved
POINTS = 41  # of the drawn curve
REACH = 0.9  # of the way to where the first line is straight, which the curve goes to either side
LEAST_REACH = 0.03  # of the distance of the anchors, of lines that are straight at rest

STATIC_LINE, NOW_LINE = ChartLine("static", PALETTE[0], 2.0), ChartLine("now", PALETTE[1], dots=True)


class CurveInputs(Protocol):
    """Everything that a restoring curve depends on; equal where the curve is the same."""

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Offsets [m] along the waves, and the force [N] against each."""
        ...


class StaticInputs(NamedTuple):
    """Everything that the curve depends on."""

    places: Places
    lines: tuple[Line, ...]
    rest_place: Vector  # [m] of the body's centre
    wave: tuple[float, float]  # unit vector along the waves
    length: float  # [m] of each line
    reach: float  # [m] distance of the anchors
    far: float  # [m] offset to which the curve goes at least
    depth: float  # [m]
    gravity: float  # [m/s2]
    density: float  # [kg/m3]

    def curve(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Offsets [m] along the waves, and the force [N] against each."""
        return static_curve(self)


class RestoringCurve:
    """The last curve of the arrangement."""

    def __init__(self) -> None:
        self.made_of: object = None
        self.curve: tuple[NDArray[np.float64], NDArray[np.float64]] = (np.zeros(0), np.zeros(0))  # [m], [N]

    def chart(self, inputs: Callable[[float], CurveInputs], farthest: float, now: float, pull: float) -> Chart:
        """The chart; the curve is found again where anything that it depends on is another.

        inputs: for a curve that goes to an offset [m] at least. farthest: offset [m] so far. now, pull: offset along
        the waves [m], and the force of the lines against it [N].
        """
        # The range is the next power of two above the offsets so far, so that it is rarely recomputed.
        key = inputs(2.0 ** math.ceil(math.log2(max(farthest, 1e-3))))
        if key != self.made_of:
            self.curve = key.curve()
            self.made_of = key
        offset, force = self.curve
        x = np.append(offset, now)
        static = np.append(force, np.interp(now, offset, force, math.nan, math.nan))
        mark = np.append(np.full(len(offset), math.nan), pull)
        order = np.argsort(x, kind="stable")
        columns = x[order], 1e-3 * static[order], 1e-3 * mark[order]
        return Chart("Offset along the waves [m]", (STATIC_LINE, NOW_LINE), columns)


def static_curve(inputs: StaticInputs) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Offsets [m] along the waves, and the force [N] against each: of each line by its span.

    Lines that are alike share their statics.
    """
    wave, rest_place = np.array(inputs.wave), np.array(inputs.rest_place)
    fairleads, anchors = rest_place + np.array(inputs.places.fairleads), np.array(inputs.places.anchors)
    ways = fairleads - anchors
    straight = np.sqrt(np.maximum(inputs.length**2 - ways[:, 2] ** 2, 0.0))
    slack = float((straight - np.hypot(ways[:, 0], ways[:, 1])).min())
    offset = max(REACH * slack, LEAST_REACH * inputs.reach, inputs.far) * np.linspace(-1.0, 1.0, POINTS)
    away = -ways[:, None, :2] - offset[:, None] * wave  # (lines, points, 2) from the fairlead to the anchor
    span = np.linalg.norm(away, axis=2)
    along = (away @ wave) / np.maximum(span, 1e-9)
    alike: dict[tuple[object, ...], list[int]] = {}
    for i in range(len(ways)):
        parts = tuple(line for line in inputs.lines if line.id // 10 == i + 1)
        kind = *((line.type, line.length, line.segments) for line in parts), round(float(ways[i, 2]), 9)
        alike.setdefault(kind, []).append(i)
    force = np.zeros(POINTS)
    for group in alike.values():
        parts = tuple(line for line in inputs.lines if line.id // 10 == group[0] + 1)
        at = np.linspace(span[group].min(), span[group].max() + 1e-6, SPANS)
        level = np.array([level_tension(inputs, parts, one, float(ways[group[0], 2])) for one in at])
        force -= (np.interp(span[group], at, level) * along[group]).sum(axis=0)
    return offset, force


def level_tension(inputs: StaticInputs, lines: tuple[Line, ...], span: float, rise: float) -> float:
    """Horizontal part [N] of a line's tension at the fairlead, `rise` [m] over its anchor and `span` [m] away."""
    raise_if_stopped()
    first, last = lines[0].start, lines[-1].end
    points = [
        Point(first, "fixed", (0.0, 0.0, -inputs.depth)),
        Point(last, "coupled", (span, 0.0, rise - inputs.depth)),
    ]
    points += [Point(line.end, "free", (0.5 * span, 0.0, 0.5 * rise - inputs.depth)) for line in lines[:-1]]
    rest = at_rest(System(lines, tuple(points), inputs.depth, (), inputs.gravity, inputs.density))
    end = rest.x[lines[-1].id]
    way = end[-1] - end[-2]
    return float(rest.tension[lines[-1].id][-1] * way[0] / np.linalg.norm(way))
