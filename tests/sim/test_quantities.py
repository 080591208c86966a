"""Numbers as people write them."""

import math
import random
import re
from pathlib import Path

import pytest

from app.commands.options import quantity
from sim.quantities import plain, read_number, write_number
from sim.tables import number_of, split_rows, values_of


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("1e4", "", 1e4), ("3.7e+03", "N/m", 3700.0), ("1/60", "s", 1 / 60), ("1 / 60 s", "s", 1 / 60),
        ("0,02", "s", 0.02), (".5", "", 0.5), ("20k", "N/m", 20e3), ("20 kN/m", "N/m", 20e3), ("5 ms", "s", 0.005),
        ("5 min", "s", 300.0), ("0.5 h", "s", 1800.0), ("5m", "m", 5.0), ("5mm", "m", 0.005),
        ("9.81 m/s²", "m/s^2", 9.81), ("9.81 m/s^2", "m/s²", 9.81), ("3 700", "N/m", 3700.0),
        ("\u22123", "", -3.0), ("0.1", "", 0.1), ("0.3u", "m", 3e-7), ("11.25 cm", "m", 0.1125), ("3 mm²", "m²", 3e-6),
    ],
)  # fmt: skip
def test_a_number_is_read_in_the_ways_that_people_write_it(text: str, unit: str, value: float) -> None:
    assert read_number(text, unit) == value


WRITTEN = [  # text, unit of the quantity, value
    ("0.1125 m", "m", 0.1125), ("112.5 mm", "m", 0.1125), ("0.1125 metres", "m", 0.1125), ("0,1125", "m", 0.1125),
    ("4,004,001", "", 4004001.0), ("4 004 001", "", 4004001.0), ("4.004.001", "", 4004001.0), ("1'000", "", 1000.0),
    ("1.234,5", "", 1234.5), ("1,234.5", "", 1234.5), ("1.125*10^-1", "", 0.1125), ("1.125 x 10^-1", "", 0.1125),
    ("1,125e-1", "", 0.1125), ("1.125\u00b710\u207b\u00b9", "", 0.1125), ("10^4", "", 1e4), ("1.5D+03", "", 1500.0),
    ("\u22120.1125", "", -0.1125), ("\u20130,5", "", -0.5), ("90/800", "", 0.1125), ("9.81 m/s2", "m/s\u00b2", 9.81),
    ("10 Ns/m", "N s/m", 10.0), ("10 N*s/m", "N s/m", 10.0), ("10 N-s/m", "N s/m", 10.0), ("36 km/h", "m/s", 10.0),
    ("5 d", "s", 432000.0), ("3 t", "kg", 3000.0), ("180 deg", "rad", math.pi), ("5 mPas", "Pa s", 0.005),
    ("2 m2/(rad/s)", "m2 s/rad", 2.0), ("5 %", "1", 0.05), ("50 cm/s", "m/s", 0.5), ("1,000.5 kg", "kg", 1000.5),
]  # fmt: skip


@pytest.mark.parametrize(("text", "unit", "value"), WRITTEN)
def test_a_number_has_any_form_and_unit_of_its_quantity(text: str, unit: str, value: float) -> None:
    assert read_number(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(("text", "unit", "value"), [one for one in WRITTEN if one[0] != "90/800"])
def test_a_table_and_an_option_take_a_number_as_the_panel_does(
    text: str, unit: str, value: float, tmp_path: Path
) -> None:
    assert quantity(unit)(text) == pytest.approx(value, rel=1e-15)
    if not any(letter.isalpha() or letter in "%" for letter in re.sub(r"[eD][-+]?\d| x ", "", text)):
        assert number_of(text) == pytest.approx(value, rel=1e-15)
    rows, _ = split_rows(f"a;b\n{text};1\n", tmp_path)
    assert values_of([rows[1].words[0]], unit=unit)[0] == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit"),
    [("5 c", "m/s"), ("5 kg", "m"), ("5 m/s", "m"), ("1,2,3", ""), ("1.234.5", ""), ("12,34,567", ""),
     ("2 x 3", ""), ("10^9999", "")],
)  # fmt: skip
def test_another_quantity_and_groups_of_other_lengths_are_refused(text: str, unit: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        read_number(text, unit)


@pytest.mark.parametrize(
    "text",
    [
        "", "abc", "nan", "inf", "1/0", "1e999", "1e99999999999", "--3", "1/2/3", "5 kg", "5 c", "0x10", "1_000",
        "9" * 65,
    ],
)  # fmt: skip
def test_what_is_no_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        read_number(text, "N/m")


@pytest.mark.parametrize(("unit", "clear"), [("s", "ms or min"), ("N/m", "e-3"), ("", "e-3")])
def test_m_alone_is_refused_where_it_is_no_metre(unit: str, clear: str) -> None:
    with pytest.raises(ValueError, match=f"two things: write {clear}$"):
        read_number("5m", unit)


@pytest.mark.parametrize("text", ["1,000", "-12,345", "30,000 N"])
def test_a_comma_that_may_mean_two_things_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="two things"):
        read_number(text)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1 / 60, "1/60"), (0.02, "0.02"), (800.0, "800"), (10, "10"), (5, "5"), (5.0, "5.0"), (1e-5, "1e-5"),
        (1e9, "1e9"), (9.81, "9.81"), (0.0, "0.0"),
    ],
)  # fmt: skip
def test_a_number_is_written_as_one_would(value: float, text: str) -> None:
    assert write_number(value) == text


def test_what_is_written_is_read_as_the_same_number() -> None:
    source = random.Random(1)
    for _ in range(20_000):
        value = source.choice(
            [
                source.uniform(-1, 1) * 10 ** source.uniform(-300, 300),
                round(source.uniform(-1e3, 1e3), source.randrange(6)),
                1 / source.randrange(1, 5000),
                float(source.randrange(-(10**9), 10**9)),
            ]
        )
        assert read_number(write_number(value)) == value


def test_numbers_of_ranges_are_as_one_types_them() -> None:
    assert [plain(v) for v in (1e9, 1e-5, 0.5, 1000.0, -3.0, 2e10)] == ["1e9", "1e-5", "0.5", "1000", "-3", "2e10"]
    for value in (1e9, 1e-5, 0.25, -3.0):
        assert float(plain(value)) == value
