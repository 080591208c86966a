"""A chart of lines as SVG, for files: it needs no script and no font of its own."""

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from app.messages import ChartLine
from app.render.markup.axis import Axis, draw_axes, fitted, rounded
from app.render.markup.html import Html, fill, join

WIDTH, PLOT_HEIGHT = 560, 208  # [px] of the chart, and of it without its key
LEFT, RIGHT, TOP, BOTTOM = 70, 14, 30, 24  # [px] margins of the axes, without the key
KEY_HEIGHT = 20  # [px] of a row of the key
KEY_LINE, KEY_SPACE = 24, 16  # [px] for the piece of line before a name, and between two names
CHARACTER_WIDTH = 6.6  # [px] of a name in the key
FIRST_LABEL_WIDTH = 40  # [px] for the label of the first column, at the end of the key's rows
INTERVALS = 6  # approximate number of them on the first axis
BEYOND = "beyond the chart"  # name of the marks of values that are
COLOUR = "#1b2a3a"  # of the axes and all words
MARK_COLOUR = "#4d5560"  # in the key
BEYOND_SIZE = 5  # [px] of such a mark, from its middle


class Drawing(NamedTuple):
    """An SVG element."""

    svg: Html
    height: int  # [px]


def line_chart(
    title: str,
    first: str,
    lines: Sequence[ChartLine],
    columns: Sequence[NDArray[np.floating]],
    end: float | None = None,
    scale: Sequence[tuple[float, str]] = (),
    limits: tuple[float, float] | None = None,
) -> Drawing | None:
    """Lines over the first of `columns`, (n,) each, ascending; they stop where a number is not finite.

    Where one leaves the chart it has a mark at the edge, which the key explains.

    first: label of the first column. end: of its axis, which then starts at 0; None to fit it to the data.
    scale: (value, word) from end to end of a logarithmic scale. limits: values to which a linear scale is fitted; None
    for all. Returns None if no number is finite.
    """
    places, values = np.asarray(columns[0], float), np.array(columns[1:], float).reshape(len(lines), -1)
    if scale:
        values = np.log10(values, out=np.full_like(values, math.nan), where=values > 0.0)
    finite = values[[not line.cross for line in lines]]
    finite = finite[np.isfinite(finite)]
    if finite.size == 0:
        return None
    start, last = float(places[0]), float(places[-1])
    if end is not None:
        start, last = 0.0, max(last, end)
    x = fitted(first, start, last if last > start else start + 1.0, LEFT, WIDTH - LEFT - RIGHT, INTERVALS)
    low, high = limits or (float(finite.min()), float(finite.max()))
    y = rounded(title, low, high, PLOT_HEIGHT - BOTTOM, TOP + BOTTOM - PLOT_HEIGHT)
    if scale:
        marks = tuple((math.log10(value), word) for value, word in scale)
        y = y._replace(low=marks[0][0], high=marks[-1][0], ticks=marks)
    drawn = join(draw_line(line, places, column, x, y) for line, column in zip(lines, values, strict=True))
    leaves = any(
        not (line.cross or line.fill) and bool(((column < y.low) | (column > y.high))[np.isfinite(column)].any())
        for line, column in zip(lines, values, strict=True)
    )
    key, rows = draw_key(lines, [BEYOND] if leaves else [])
    height = PLOT_HEIGHT + KEY_HEIGHT * rows
    svg = fill(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img"'
        ' font-family="sans-serif" font-size="12" color="{colour}" fill="{colour}">'
        '<rect width="{w}" height="{h}" fill="#ffffff"/>{axes}{drawn}{key}</svg>',
        w=WIDTH, h=height, colour=COLOUR, axes=draw_axes(x, y), drawn=drawn, key=key,
    )  # fmt: skip
    return Drawing(svg, height)


def draw_line(line: ChartLine, places: NDArray[np.float64], values: NDArray[np.float64], x: Axis, y: Axis) -> Html:
    """One line, and the area below it if it has one; or dots, or crosses at the top edge."""
    if line.cross:
        at = (x.at(place) for place in places[np.isfinite(values)].tolist())
        mark = '<path d="M{0:.1f} {1}l10 10m0 -10l-10 10" stroke="{2}" stroke-width="2"/>'
        return join(fill(mark, place - 5.0, TOP - 5, line.colour) for place in at)
    if line.dots:
        known = np.isfinite(values)
        beyond = known & ((values < y.low) | (values > y.high))
        at = (
            (x.at(place), y.at(value))
            for place, value in zip(places[known & ~beyond], values[known & ~beyond], strict=True)
        )
        dots = join(fill('<circle cx="{:.1f}" cy="{:.1f}" r="3"/>', *place) for place in at)
        marks = join(
            draw_beyond(x.at(place), value, y, line.colour)
            for place, value in zip(places[beyond], values[beyond], strict=True)
        )
        return join((fill('<g fill="{}">{}</g>', line.colour, dots), marks))
    if line.fill:
        runs, left = whole_runs(places, values), []
    else:
        runs, left = runs_within(places, values, y)
    path, area = "", ""
    for run in runs:
        along = "L".join(f"{x.at(place):.1f} {y.at(y.within(value)):.1f}" for place, value in run)
        path += f"M{along}"
        area += f"M{x.at(run[0][0]):.1f} {y.start}L{along}L{x.at(run[-1][0]):.1f} {y.start}Z"
    below = fill('<path d="{}" fill="{}"/>', area, line.fill) if line.fill else Html()
    stroke = fill(
        '<path d="{}" fill="none" stroke="{}" stroke-width="{:g}" stroke-dasharray="{}" stroke-linejoin="round"/>',
        path, line.colour, line.width, dashes(line),
    )  # fmt: skip
    marks = join(draw_beyond(x.at(place), value, y, line.colour) for place, value in left)
    return join((below, stroke, marks))


Runs: TypeAlias = list[list[tuple[float, float]]]  # points that a line joins, without gaps


def whole_runs(places: NDArray[np.float64], values: NDArray[np.float64]) -> Runs:
    """The points of a line between its gaps."""
    runs: Runs = [[]]
    for place, value in zip(places.tolist(), values.tolist(), strict=True):
        if math.isfinite(value):
            runs[-1].append((place, value))
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if run]


def runs_within(
    places: NDArray[np.float64], values: NDArray[np.float64], y: Axis
) -> tuple[Runs, list[tuple[float, float]]]:
    """The parts of a line that lie in the chart, and a point beyond it for each part that does not."""
    runs: Runs = []
    left: list[tuple[float, float]] = []
    for whole in whole_runs(places, values):
        run: list[tuple[float, float]] = []
        last: tuple[float, float] | None = None
        for place, value in whole:
            inside = y.within(value) == value
            was_inside = last is not None and y.within(last[1]) == last[1]
            if last is not None and inside != was_inside:
                edge = y.within(last[1] if inside else value)
                crossing = last[0] + (place - last[0]) * (edge - last[1]) / (value - last[1]), edge
                run.append(crossing)
                if not inside:
                    runs.append(run)
                    left.append((crossing[0], value))
                    run = []
            elif last is None and not inside:
                left.append((place, value))
            if inside:
                run.append((place, value))
            last = place, value
        runs += [run] if run else []
    return runs, left


def draw_beyond(place: float, value: float, y: Axis, colour: str) -> Html:
    """A triangle at the edge beyond which a value lies. place: [px]."""
    up = -1 if value > y.high else 1
    edge, size = y.at(y.within(value)), BEYOND_SIZE
    return fill(
        '<path class="beyond" d="M{:.1f} {:.1f}h{}l{} {}z" fill="{}"/>',
        place - size, edge - up * 2 * size, 2 * size, -size, up * 2 * size, colour,
    )  # fmt: skip


def dashes(line: ChartLine) -> str:
    """The dashes of a line as SVG has them."""
    return " ".join(f"{length:g}" for length in line.dash) or "none"


def draw_key(lines: Sequence[ChartLine], marks: Sequence[str] = ()) -> tuple[Html, int]:
    """The names of the lines and marks below the chart, and the number of rows that they take."""
    names: list[Html] = []
    place, row = float(LEFT), 1
    for line in (*lines, *(ChartLine(mark, MARK_COLOUR) for mark in marks)):
        width = KEY_LINE + CHARACTER_WIDTH * len(line.label)
        if place > LEFT and place + width > WIDTH - RIGHT - FIRST_LABEL_WIDTH:
            place, row = float(LEFT), row + 1
        base = PLOT_HEIGHT + KEY_HEIGHT * row - 6
        drawn = f"M{place + 4:.0f} {base - 9}l10 10m0 -10l-10 10" if line.cross else f"M{place:.0f} {base - 4}h18"
        if line.label in marks:
            drawn = f"M{place + 4:.0f} {base}h10l-5 -9z"
        names.append(
            fill(
                '<path d="{}" stroke="{}" stroke-width="{}" stroke-dasharray="{}"/><text x="{:.0f}" y="{}">{}</text>',
                drawn, line.fill or line.colour, 2 if line.cross else 3, dashes(line), place + KEY_LINE, base,
                line.label,
            )
        )  # fmt: skip
        place += width + KEY_SPACE
    return join(names), row
