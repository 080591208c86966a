"""How numbers are written in the panel."""

import math

import pytest

from app.formats.formatting import (
    count,
    counted,
    fixed,
    longest_step,
    metres,
    number,
    percent,
    seconds,
    short_step,
    time_step,
)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (0.123456, "0.123"), (12.0, "12"), (99.96, "100"), (0.4, "0.4"), (-0.5, "−0.5"),
     (3728.4, "3\u202f730"), (54321.0, "54\u202f321"), (-12345.6, "−12\u202f300"), (1234567.0, "1.23 × 10⁶"),
     (999_999.6, "1 × 10⁶"), (5.36e-5, "5.36 × 10⁻⁵"), (9.996e-4, "0.001"), (1e-3, "0.001"),
     (math.nan, "–"), (math.inf, "∞"), (-math.inf, "−∞")],
)  # fmt: skip
def test_a_number_has_as_many_digits_as_one_reads(value: float, text: str) -> None:
    assert number(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0 m"), (1.5, "1.5 m"), (0.9996, "1 m"), (2.5e-5, "25 µm"), (3e-9, "3 nm"),
                        (1.5e-12, "1.5 × 10⁻¹² m"), (-0.002, "−2 mm"), (math.nan, "–")],
)  # fmt: skip
def test_a_length_is_in_the_unit_it_is_read_in(value: float, text: str) -> None:
    assert metres(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.0, "0 s"), (80.0, "80 s"), (120.0, "2 min"), (5200.0, "86.7 min"),
                        (5600.0, "1.56 h"), (7200.0, "2 h"), (3e5, "3.47 days"),
                        (6.312e7, "2 years"), (1 / 60, "16.7 ms"), (0.0026, "2.6 ms"), (4e-6, "4 µs"),
                        (4e-8, "0.04 µs"), (math.inf, "∞")],
)  # fmt: skip
def test_a_time_is_in_the_unit_it_is_read_in(value: float, text: str) -> None:
    assert seconds(value) == text


@pytest.mark.parametrize(
    ("step", "text"), [(1 / 60, "1/60 s"), (0.0166667, "1/60 s"), (1 / 2400, "1/2400 s"), (2.6e-3, "2.6 ms"),
                       (0.05, "1/20 s"), (2.5e-5, "25 µs"), (0.3, "300 ms")],
)  # fmt: skip
def test_a_time_step_is_a_fraction_where_it_is_one(step: float, text: str) -> None:
    assert short_step(step) == text


@pytest.mark.parametrize(
    ("step", "text"), [(1 / 120, "1/120 s (8.3 ms)"), (0.0015, "1.5 ms"), (1 / 960, "1/960 s (1 ms)"), (0.25, "250 ms")]
)
def test_a_time_step_is_written_in_both_notations(step: float, text: str) -> None:
    assert time_step(step) == text


@pytest.mark.parametrize(
    ("step", "text"),
    [
        (1 / 120, "1/120 s (8.3 ms)"),
        (0.0095, "1/106 s (9.4 ms)"),
        (0.0015, "1/667 s (1.5 ms)"),
        (0.25, "250 ms"),
        (2e-5, "20 µs"),
    ],
)
def test_a_bound_of_steps_is_one_that_holds(step: float, text: str) -> None:
    assert longest_step(step) == text


def test_a_fixed_number_of_decimals() -> None:
    assert (fixed(1.0, 2), fixed(math.nan, 2), fixed(math.inf, 0)) == ("1.00", "–", "–")
    assert (fixed(-0.5, 1), fixed(0.5, 1, sign=True), fixed(12345.6, 1)) == ("−0.5", "+0.5", "12\u202f345.6")
    assert (fixed(-0.4, 0), fixed(-0.04, 1, sign=True), number(-0.0)) == ("0", "+0.0", "0")


def test_large_counts_are_in_words() -> None:
    assert [count(n) for n in (600, 2670.4, 2.5e6, 3.04e7, 7.2e9)] == [
        "600", "2\u202f670", "2.5 million", "30 million", "7.2 billion"
    ]  # fmt: skip


def test_shares_are_in_percent() -> None:
    assert (percent(0.94914, 3), percent(0.0), percent(math.nan)) == ("94.9\u00a0%", "0\u00a0%", "–")


def test_a_noun_has_the_number_of_its_count() -> None:
    assert [counted(n, "line") for n in (0, 1, 2, 12345)] == ["0 lines", "1 line", "2 lines", "12\u202f345 lines"]
