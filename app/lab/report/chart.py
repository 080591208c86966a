"""A chart for the report: the reference as a line, the student's function as points."""

import numpy as np

from app.lab.check.program_check import Points
from app.messages import ChartLine
from app.render.markup.html import Html, fill
from app.render.markup.line_chart import line_chart

LINES = (ChartLine("Reference", "#1c6aa8"), ChartLine("Your function", "#c2410c", dots=True))


def chart(points: Points) -> Html:
    """The chart of a function; empty if no value is finite."""
    ys = [np.asarray(y, np.float64) for y in (points.reference, points.student) if y is not None]
    # A wrong function can be far off: the range is that of the reference, three times as wide at most.
    known = [y[np.isfinite(y)] for y in ys]
    limits = None
    if known[0].size:
        low, high = known[0].min(), known[0].max()
        reach = (high - low) or abs(high) or 1.0
        near = [y[(low - reach <= y) & (y <= high + reach)] for y in known]
        limits = float(min(y.min() for y in near if y.size)), float(max(y.max() for y in near if y.size))
    lines, columns = LINES[: len(ys)], [np.asarray(points.x, np.float64), *ys]
    drawing = line_chart(points.y_label, points.x_label, lines, columns, limits=limits)
    return Html() if drawing is None else fill("<figure>{}</figure>", drawing.svg)
