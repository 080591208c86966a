"""The static restoring curve: the force of all lines over the offset along the waves, and the force now."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.messages import ChartLine
from app.scenes.charts import PALETTE, Chart
from app.scenes.mooring.rows import LineRows
from sim.interruption import raise_if_stopped
from sim.mooring import System, at_rest
from sim.validation import ConvergenceError

SHARES = np.sin(0.5 * math.pi * np.linspace(-1.0, 1.0, 17))  # of the way, closer where the curve is steep
REACH = 0.9  # of the way to where the first line is straight, which the curve goes to either side
LEAST_REACH = 0.03  # of the extent, of lines that are straight at rest

STATIC_LINE, NOW_LINE = ChartLine("static", PALETTE[0], 2.0), ChartLine("now", PALETTE[1], dots=True)


class CurveInputs(NamedTuple):
    """Everything that a restoring curve depends on."""

    system: System  # in still water; its coupled points move along the waves
    wave: tuple[float, float]  # unit vector along the waves
    slack: float  # [m] of the way to where the first line is straight
    extent: float  # [m] of the mooring
    far: float  # [m] offset to which the curve goes at least

    def curve(self, rows: LineRows) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Offsets [m] along the waves, and the force [N] of all lines against each; NaN without a state of rest.

        rows: those of the system's lines.
        """
        offset = max(REACH * self.slack, LEAST_REACH * self.extent, self.far) * SHARES
        force = np.full(len(offset), math.nan)
        coupled = {point.id: point.position for point in self.system.points if point.kind == "coupled"}
        for i, away in enumerate(np.outer(offset, (*self.wave, 0.0))):
            raise_if_stopped()
            try:
                rest = at_rest(self.system, {one: np.add(place, away) for one, place in coupled.items()})
            except ConvergenceError:
                continue
            tension = np.concatenate([rest.tension[line.id] for line in self.system.lines])[rows.links]
            force[i] = -float(rows.level_force(rows.points(rest.nodes), tension) @ self.wave)
        return offset, force


class RestoringCurve:
    """The last curve of the arrangement."""

    def __init__(self) -> None:
        self.made_of: CurveInputs | None = None
        self.curve: tuple[NDArray[np.float64], NDArray[np.float64]] = (np.zeros(0), np.zeros(0))  # [m], [N]

    def chart(
        self, inputs: Callable[[float], CurveInputs], rows: LineRows, farthest: float, now: float, pull: float
    ) -> Chart:
        """The chart; the curve is found again where anything that it depends on is another.

        inputs: for a curve that goes to an offset [m] at least. rows: of all lines. farthest: offset [m] so far. now,
        pull: offset along the waves [m], and the force of the lines against it [N].
        """
        # The range is the next power of two above the offsets so far, so that it is rarely recomputed.
        key = inputs(2.0 ** math.ceil(math.log2(max(farthest, 1e-3))))
        # Systems are kept by those who make them; equal ones may hold arrays, which `==` cannot compare.
        if self.made_of is None or key.system is not self.made_of.system or key[1:] != self.made_of[1:]:
            self.curve = key.curve(rows)
            self.made_of = key
        offset, force = self.curve
        x = np.append(offset, now)
        static = np.append(force, np.interp(now, offset, force, math.nan, math.nan))
        mark = np.append(np.full(len(offset), math.nan), pull)
        order = np.argsort(x, kind="stable")
        columns = x[order], 1e-3 * static[order], 1e-3 * mark[order]
        return Chart("Offset along the waves [m]", (STATIC_LINE, NOW_LINE), columns)
