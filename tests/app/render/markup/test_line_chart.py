"""Charts as SVG: the lines go through the numbers, and stop where there are none."""

import itertools
import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from app.render.markup.line_chart import (
    BOTTOM,
    CHARACTER_WIDTH,
    LEFT,
    PLOT_HEIGHT,
    RIGHT,
    TOP,
    WIDTH,
    ChartLine,
    Drawing,
    line_chart,
)

SVG = "{http://www.w3.org/2000/svg}"
BASE = PLOT_HEIGHT - BOTTOM


def chart(*columns: object, title: str = "x", name: str = "e", fill: str = "", **looks: object) -> Drawing | None:
    lines = [ChartLine(name, "#ff0000", fill=fill) for _ in columns[1:]]
    return line_chart(title, "t [s]", lines, [np.asarray(column, float) for column in columns], **looks)  # type: ignore


def paths(drawing: Drawing | None) -> list[str]:
    """The drawn lines."""
    assert drawing is not None
    return [p.attrib["d"] for p in ET.fromstring(drawing.svg).iter(f"{SVG}path") if p.get("stroke-linejoin")]


def points(path: str) -> list[tuple[float, ...]]:
    return [tuple(map(float, pair.split())) for pair in re.split("[MLZ]", path) if pair]


def test_a_line_goes_through_its_numbers() -> None:
    t, y = np.array([0.0, 5.0, 10.0]), np.array([-1.0, 3.0, 1.0])
    low, high = -1.0, 3.0
    for (px, py), a, b in zip(points(paths(chart(t, y))[0]), t, y, strict=True):
        assert px == pytest.approx(LEFT + a / 10.0 * (WIDTH - LEFT - RIGHT), abs=0.06)
        assert py == pytest.approx(TOP + (high - b) / (high - low) * (BASE - TOP), abs=0.06)


def test_a_gap_is_not_joined() -> None:
    (path,) = paths(chart(np.arange(5.0), [1.0, 2.0, math.nan, 3.0, 4.0]))
    assert path.count("M") == 2


def test_a_logarithmic_scale_goes_from_end_to_end_of_its_words() -> None:
    scale = ((1e-4, "0.1 mm"), (1e-2, "1 cm"), (1.0, "1 m"))
    drawing = chart([0.0, 1.0, 2.0, 3.0, 4.0], [1e-2, 1e-9, 1e3, math.nan, -1.0], scale=scale, end=8.0)
    # Down from the middle to the lower edge at 2/7 of the way, and no line along an edge.
    heights = [py for _, py in points(paths(drawing)[0])]
    assert heights == pytest.approx([(TOP + BASE) / 2, BASE], abs=0.06)
    assert points(paths(drawing)[0])[1][0] == pytest.approx(LEFT + 2 / 7 / 8 * (WIDTH - LEFT - RIGHT), abs=0.06)
    assert drawing is not None
    assert [round(BASE - y) for _, y in marks(drawing)] == [10]
    assert {"0.1 mm", "1 cm", "1 m"} <= {text.text for text in ET.fromstring(drawing.svg).iter(f"{SVG}text")}


def marks(drawing: Drawing | None) -> list[tuple[float, float]]:
    """The first corners of the marks of values beyond the chart."""
    assert drawing is not None
    found = [p.attrib["d"] for p in ET.fromstring(drawing.svg).iter(f"{SVG}path") if p.get("class") == "beyond"]
    return [(float(x), float(y)) for x, y in (re.match(r"M(\S+) (\S+?)h", path).groups() for path in found)]  # type: ignore


def test_a_line_that_leaves_the_chart_has_a_mark_where_it_does_and_comes_back() -> None:
    """An edge along which a line is drawn reads as a value."""
    t = np.arange(7.0)
    values = [0.0, 1.0, 3.0, 5.0, 1.0, -1.0, -1.0]
    drawing = chart(t, values, limits=(0.0, 2.0))
    (path,) = paths(drawing)
    high = 2.0
    assert path.count("M") == 2
    across = [LEFT + place / 6.0 * (WIDTH - LEFT - RIGHT) for place in (0, 1, (high + 1.0) / 2, 3 + (5 - high) / 4, 4)]
    assert [x for x, _ in points(path)][:5] == pytest.approx(across, abs=0.06)
    assert points(path)[-1][1] == pytest.approx(BASE, abs=0.06)
    tops = [TOP + 10.0, BASE - 10.0]
    assert [y for _, y in marks(drawing)] == pytest.approx(tops, abs=0.06)
    assert drawing is not None
    assert "beyond the chart" in drawing.svg
    inside = chart(t, values)
    assert marks(inside) == []
    assert inside is not None
    assert "beyond" not in inside.svg
    whole = chart(t, np.full(7, 9.0), limits=(0.0, 2.0))
    assert paths(whole) == [""]
    assert len(marks(whole)) == 1


def test_an_area_reaches_down_to_the_axis() -> None:
    drawing = chart([0.0, 1.0], [3.0, 4.0], fill="#00ff00")
    assert drawing is not None
    (area,) = [p.attrib["d"] for p in ET.fromstring(drawing.svg).iter(f"{SVG}path") if p.get("fill") == "#00ff00"]
    assert points(area)[0][1] == points(area)[-1][1] == BASE


def test_long_names_stay_apart_and_within_the_chart() -> None:
    names = [f"rope {i}: Runge-Kutta 4, 1/1200 s, 40 kN/m" for i in range(1, 7)]
    drawing = line_chart("E", "t [s]", [ChartLine(name, "red") for name in names], [np.arange(2.0)] * 7)
    assert drawing is not None
    key = [t for t in ET.fromstring(drawing.svg).iter(f"{SVG}text") if t.text in names]
    places = [(float(t.attrib["x"]), float(t.attrib["y"]), CHARACTER_WIDTH * len(t.text or "")) for t in key]
    assert len(key) == 6
    assert all(x + width <= WIDTH and y < drawing.height for x, y, width in places)
    for (x, y, width), (other_x, other_y, _) in itertools.pairwise(places):
        assert other_y > y or other_x > x + width


def test_titles_and_names_are_text() -> None:
    drawing = chart(np.arange(2.0), np.arange(2.0), title="<b>&", name="<i>")
    assert drawing is not None
    assert {"<b>&", "<i>"} <= {text.text for text in ET.fromstring(drawing.svg).iter(f"{SVG}text")}


def test_constants_and_nothing() -> None:
    assert chart(np.arange(3.0), np.full(3, np.nan)) is None
    for columns in ((np.arange(3.0), np.zeros(3)), (np.zeros(2), np.ones(2))):
        drawing = chart(*columns)
        assert drawing is not None
        assert "nan" not in drawing.svg
