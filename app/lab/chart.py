"""A chart for the report: the reference as a line, the student's function as points."""

import numpy as np

from app.lab.program_check import Points
from app.messages import ChartLine
from app.render.html import Html, fill
from app.render.line_chart import line_chart

LINES = (ChartLine("Reference", "#1c6aa8"), ChartLine("Your function", "#c2410c", dots=True))


def chart(points: Points) -> Html:
    """The chart of a function; empty if no value is finite."""
    ys = [np.asarray(y, np.float64) for y in (points.reference, points.student) if y is not None]
    known = ys[0][np.isfinite(ys[0])]
    if known.size and len(ys) > 1:
        # A wrong function can be far off: the range is that of the reference, three times as wide at most.
        low, high = known.min(), known.max()
        reach = (high - low) or abs(high) or 1.0
        ys[1] = np.where((low - reach <= ys[1]) & (ys[1] <= high + reach), ys[1], np.nan)
    drawing = line_chart(points.y_label, points.x_label, LINES[: len(ys)], [np.asarray(points.x, np.float64), *ys])
    return Html() if drawing is None else fill("<figure>{}</figure>", drawing.svg)
