"""Charts as SVG: the lines go through the numbers, and stop where there are none."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from app.render.line_chart import BOTTOM, HEIGHT, LEFT, RIGHT, SPACE, TOP, WIDTH, line_chart, ticks

SVG = "{http://www.w3.org/2000/svg}"


def paths(chart: str) -> list[str]:
    """The drawn lines."""
    return [p.attrib["d"] for p in ET.fromstring(chart).iter(f"{SVG}path") if p.get("stroke-width") == "1.8"]


def test_a_line_goes_through_its_numbers() -> None:
    t, y = np.array([0.0, 5.0, 10.0]), np.array([-1.0, 3.0, 1.0])
    points = [
        tuple(map(float, pair.split())) for pair in re.split("[ML]", paths(line_chart("E [J]", t, {"e": y}))[0])[1:]
    ]
    low, high = -1.0 - SPACE * 4.0, 3.0 + SPACE * 4.0
    for (px, py), a, b in zip(points, t, y, strict=True):
        assert px == pytest.approx(LEFT + a / 10.0 * (WIDTH - LEFT - RIGHT), abs=0.06)
        assert py == pytest.approx(TOP + (high - b) / (high - low) * (HEIGHT - TOP - BOTTOM), abs=0.06)


def test_a_gap_is_not_joined() -> None:
    t = np.arange(5.0)
    (path,) = paths(line_chart("x", t, {"e": np.array([1.0, 2.0, np.nan, 3.0, 4.0])}))
    assert path.count("M") == 2


def test_titles_and_names_are_text() -> None:
    root = ET.fromstring(line_chart("<b>&", np.arange(2.0), {"<i>": np.arange(2.0)}))
    assert {"<b>&", "<i>"} <= {text.text for text in root.iter(f"{SVG}text")}


def test_constants_and_nothing() -> None:
    assert line_chart("x", np.arange(3.0), {"e": np.full(3, np.nan)}) == ""
    assert "nan" not in line_chart("x", np.arange(3.0), {"e": np.zeros(3)})
    assert "nan" not in line_chart("x", np.zeros(2), {"e": np.ones(2)})


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [(0.0, 10.0, [0, 2, 4, 6, 8, 10]), (-0.13, 0.11, [-0.1, -0.05, 0, 0.05, 0.1]), (3.0, 3.0, [3.0])],
)
def test_ticks_are_round(low: float, high: float, expected: list[float]) -> None:
    assert list(ticks(low, high)) == pytest.approx(expected)
