"""The HTML of panel and reports."""

import math

import pytest

from app.render.html import Html, bold, escape, fill, fixed, join, lines, metres, note, number, seconds, table

EVIL = "<img src=x onerror='alert(1)'> & more"
SAFE = "&lt;img src=x onerror=&#x27;alert(1)&#x27;&gt; &amp; more"


def test_text_is_escaped_and_html_is_not() -> None:
    assert escape(EVIL) == SAFE
    assert escape(Html("<b>x</b>")) == "<b>x</b>"
    assert fill("<p>{} {name}</p>", EVIL, name=bold(EVIL)) == f"<p>{SAFE} <b>{SAFE}</b></p>"
    assert "<img" not in note(EVIL)
    assert SAFE in note(EVIL)
    for text in (bold(EVIL), join((EVIL, "x")), lines((EVIL,)), table((EVIL,), ((EVIL, "1"),))):
        assert isinstance(text, Html)
        assert "<img" not in text
        assert SAFE in text


def test_what_is_escaped_once_is_not_escaped_again() -> None:
    assert note(lines((bold("a < b"),))).count("&lt;") == 1
    assert "&amp;" not in note(table(("<",), (("<",),)))


def test_what_goes_to_viser_is_a_plain_string() -> None:
    assert type(note(bold("x"))) is str
    assert type(str(bold("x"))) is str


def test_fields_of_a_template_take_formats() -> None:
    assert fill("{:.2f} {x.real:g}", 1.0 / 3.0, x=2.5) == "0.33 2.5"
    assert fill("{{}} {}", 1) == "{} 1"


def test_a_table_has_a_cell_for_each_entry() -> None:
    found = table(("", "a", "b"), (("x", 1, 2), ("y", 3, 4)))
    assert (found.count("<tr>"), found.count("<th "), found.count("<td ")) == (3, 3, 6)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.123456, "0.123"), (12.0, "12"), (1234567.0, "1.23e+06"), (54321.0, "54,321"), (1234.5, "1,234"),
     (-0.5, "-0.5"), (math.nan, "–"), (math.inf, "∞"), (-math.inf, "-∞")],
)  # fmt: skip
def test_a_number_has_as_many_digits_as_one_reads(value: float, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0 m"), (1.5, "1.5 m"), (0.9996, "1 m"), (2.5e-5, "25 µm"), (3e-9, "3 nm"),
                        (1e-12, "1.0e-12 m"), (-0.002, "-2 mm"), (math.nan, "–")],
)  # fmt: skip
def test_a_length_is_in_the_unit_it_is_read_in(value: float, text: str) -> None:
    assert metres(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0 s"), (80.0, "80 s"), (120.0, "2 min"), (7200.0, "2 h"), (3e5, "3.47 days"),
                        (6.312e7, "2 years"), (0.0025, "2.5 ms"), (4e-6, "4 µs"), (4e-8, "0.04 µs"), (math.inf, "∞")],
)  # fmt: skip
def test_a_time_is_in_the_unit_it_is_read_in(value: float, text: str) -> None:
    assert seconds(value) == text


def test_a_fixed_number_of_decimals() -> None:
    assert (fixed(1.0, 2), fixed(math.nan, 2), fixed(math.inf, 0)) == ("1.00", "–", "–")
