"""Axes of charts: ticks are round, and stand where their numbers lie."""

import math
import xml.etree.ElementTree as ET

import pytest

from app.render.markup.axis import (
    MIN_FILLED,
    SHORT_TICK,
    TICK,
    decades,
    draw_axes,
    fitted,
    power_text,
    rounded,
    scale_of,
)


@pytest.mark.parametrize(
    ("low", "high"),
    [(0.0, 1.0), (-137.2, 118.4), (0.4371, 0.4379), (-1e-13, 3e-13), (2e7, 9e7), (5.0, 5.0), (0.0, 0.0)],
)
def test_a_scale_holds_its_data_between_round_ticks_with_words_of_their_own(low: float, high: float) -> None:
    scale = scale_of(low, high)
    slack = 1e-6 * scale.step
    assert scale.low <= low + slack
    assert scale.high >= high - slack
    assert 2 <= len(scale.ticks) <= 7
    assert len(set(scale.words)) == len(scale.words)
    mantissa = scale.step / 10.0 ** math.floor(math.log10(scale.step) + 1e-9)
    assert min(abs(mantissa - round_one) for round_one in (1, 2, 2.5, 5, 10)) < 1e-6


def test_a_scale_is_kept_while_the_data_fill_it() -> None:
    scale = scale_of(-1.0, 1.0)
    assert scale.fits(-0.9, 1.0)
    assert not scale.fits(-1.1, 1.0)
    assert not scale.fits(0.0, 0.9 * MIN_FILLED * 2.0)


def test_a_negative_tick_has_a_minus_sign_and_zero_has_none() -> None:
    assert scale_of(-1.0, 1.0).words == ("\N{MINUS SIGN}1.0", "\N{MINUS SIGN}0.5", "0.0", "0.5", "1.0")


@pytest.mark.parametrize(
    ("low", "high", "words"),
    [
        (0.0, 10.0, ["0", "2", "4", "6", "8", "10"]),
        (5e5, 5e5 + 1.0, ["500000.0", "500000.2", "500000.4", "500000.6", "500000.8", "500001.0"]),
        (-0.13, 0.11, ["\N{MINUS SIGN}0.10", "\N{MINUS SIGN}0.05", "0.00", "0.05", "0.10"]),
    ],
)
def test_an_axis_from_data_to_data_has_the_round_numbers_between(low: float, high: float, words: list[str]) -> None:
    axis = fitted("t [s]", low, high, 100.0, 50.0, intervals=5)
    assert [word for _, word in axis.ticks] == words
    assert (axis.at(low), axis.at(high)) == pytest.approx((100.0, 150.0))


@pytest.mark.parametrize(
    ("low", "high"), [(0.0, 1.0), (-3.7, 12.0), (1e-9, 2e-9), (1e8, 1.1e8), (2.0, 2.0), (0.3, 0.9)]
)
def test_data_lie_within_a_round_axis(low: float, high: float) -> None:
    axis = rounded("y", low, high, 0.0, 1.0)
    assert axis.within(low) == low
    assert axis.within(high) == high
    assert 2 <= len(axis.ticks) <= 7


def test_a_logarithmic_axis_has_ticks_at_the_powers_of_ten_and_short_ones_between() -> None:
    axis = decades("h [s]", 5.3e-4, 0.1, 10.0, 200.0)
    assert [10.0**value for value, word in axis.ticks if word] == pytest.approx([1e-3, 1e-2, 1e-1])
    assert [10.0**value for value, word in axis.ticks if not word][:5] == pytest.approx([6e-4, 7e-4, 8e-4, 9e-4, 2e-3])
    assert axis.at(math.log10(5.3e-4)) == pytest.approx(10.0)
    assert axis.share(math.log10(math.sqrt(5.3e-5))) == pytest.approx(0.5)
    assert [power_text(e) for e in (-5, -2, 0, 2, 4)] == ["10⁻⁵", "0.01", "1", "100", "10⁴"]


@pytest.mark.parametrize("grid", [True, False])
def test_ticks_are_drawn_with_their_words_and_axes_with_their_names(grid: bool) -> None:
    x, y = decades("h [s]", 1e-3, 1e-1, 40.0, 200.0), rounded("<y>", 0.0, 4.0, 120.0, -100.0)
    drawn = ET.fromstring(f"<svg>{draw_axes(x, y, grid=grid)}</svg>")
    texts = {text.text: (float(text.attrib["x"]), float(text.attrib["y"])) for text in drawn.iter("text")}
    assert {"h [s]", "<y>"} < texts.keys()
    assert texts["0.01"] == (140.0, 138.0)
    assert texts["2"] == (34.0, 74.0)
    paths = [path.attrib["d"] for path in drawn.iter("path")]
    assert f"M140.0 120.0v{TICK}" in paths
    assert sum(path.endswith(f"v{SHORT_TICK}") for path in paths) == 16
    assert ("M40.0 70.0h200.0" in paths) is grid
    assert (f"M40.0 70.0h-{TICK}" in paths) is not grid
