"""Files of spectra as people have them: each is read as its owner meant it, or refused in one line."""

import datetime
import itertools
import math
import random
import re
from pathlib import Path

import numpy as np
import pytest

from sim.ocean import measured_spectrum, read_record, read_spectrum, recorded_waves
from sim.ocean.spectrum_files.buoys import moment_at, moments_of, records_of, without_99
from sim.ocean.spectrum_files.sea_summary import bearing_of
from sim.tables.rows import split_rows
from sim.tables.text import MAX_BYTES
from tests.refusals import assert_refused

FIELD = Path(__file__).parent / "field"
F = np.arange(0.04, 0.405, 0.01)  # [Hz]
S = 4.0 * np.exp(-(((F - 0.1) / 0.02) ** 2)) + 0.1 * np.exp(-(((F - 0.25) / 0.06) ** 2))  # [m2/Hz]
HEIGHT = 4.0 * math.sqrt((0.5 * (S[1:] + S[:-1]) * np.diff(F)).sum())
TURN = 2.0 * math.pi


def seen(spectrum) -> tuple[float, float, float | None]:
    """Hs [m], Tp [s] and the bearing that waves come from [degrees] of a spectrum."""
    moments = spectrum.moments()
    return moments.significant_height, moments.peak_period, bearing_of(spectrum)


# name -> Hs [m], Tp [s], bearing that waves come from [degrees], and words of the notes
READ = {
    "46999w2021.txt": (1.537, 10.0, 268.0, ""),
    "46999h2021.txt": (1.51, 10.0, 270.0, "shape of JONSWAP"),
    "spectrum_rads.csv": (1.506, 10.0, None, ""),
    "spectrum_cm2.csv": (1.506, 10.0, None, ""),
    "spectrum_joule.csv": (1.506, 10.0, None, "rho g of sea water"),
    "spectrum_direction_rad.csv": (1.506, 10.0, 270.0, ""),
    "spectrum_half_circle.csv": (1.537, 10.0, 270.0, ""),
    "spectrum_999.csv": (1.506, 10.0, None, "1 row without a value left out, at 0.03 Hz"),
    "swan_sector.sp2": (1.537, 10.0, 180.0, ""),
    "swan_first_place_dry.sp2": (1.537, 10.0, 180.0, "place 2 of 2, at 10, 0"),
    "swan_1d.sp1": (1.537, 10.0, 270.0, ""),
}


@pytest.mark.parametrize("name", READ)
def test_a_file_of_the_field_is_read_as_it_was_meant(name):
    height, period, bearing, words = READ[name]
    spectrum = read_spectrum(FIELD / name)
    found = seen(spectrum)
    assert found[0] == pytest.approx(height, abs=2e-3)
    assert found[1] == pytest.approx(period, rel=5e-3)
    assert found[2] == (None if bearing is None else pytest.approx(bearing, abs=0.6))
    assert words in " | ".join(spectrum.notes)
    assert spectrum.notes[0].startswith(f"Hs {height:.3g} m, Tp 10 s")


def test_a_file_of_swan_of_one_dimension_has_the_spread_of_its_column():
    spectrum = read_spectrum(FIELD / "swan_1d.sp1")
    theta, k = np.linspace(0.0, TURN, 720, endpoint=False), (TURN * 0.1) ** 2 / 9.81
    D = spectrum.density(k * np.cos(theta), k * np.sin(theta), spectrum.conditions())
    first = (D * np.exp(1j * theta)).sum() / D.sum()
    assert math.degrees(math.sqrt(2.0 - 2.0 * abs(first))) == pytest.approx(25.0, rel=1e-3)
    assert np.angle(first) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("letter", "kind"), [*zip("dijk", ("alpha1", "alpha2", "r1", "r2"), strict=True)])
def test_a_file_of_directions_of_a_buoy_names_that_of_the_densities(letter, kind, tmp_path):
    path = FIELD / f"46999{letter}2021.txt"
    assert_refused("path", lambda: read_spectrum(path), f"(46999w2021.txt); this is of {kind}")
    renamed = tmp_path / "buoy.txt"
    renamed.write_bytes(path.read_bytes())
    assert_refused("path", lambda: read_spectrum(renamed), "whole numbers")


def test_files_of_directions_with_exchanged_names_are_refused(tmp_path):
    for letter, other in ("ww", "dj", "jd", "ik", "ki"):
        (tmp_path / f"46999{letter}2021.txt").write_bytes((FIELD / f"46999{other}2021.txt").read_bytes())
    assert_refused("path", lambda: read_spectrum(tmp_path / "46999w2021.txt"), "a file of r1, up to 100, not 280")


def test_a_file_of_winds_names_that_of_the_densities(tmp_path):
    path = tmp_path / "46999c2021.txt"
    path.write_text("#YY  MM DD hh mm WDIR WSPD GDR GST GTIME\n2021 03 05 04 40 310 7.1 320 8.9 0435\n", "utf-8")
    assert_refused("path", lambda: read_spectrum(path), "46999w2021.txt")


# --- 60 tables: unit, convention, separator, missing value ---

AXES = {  # header -> factor from Hz
    "frequency (Hz)": 1.0, "omega [rad/s]": TURN, "freq_mHz": 1e3, "f [1/s]": 1.0, "w": TURN, "frequency (rad/s)": TURN,
}  # fmt: skip
DENSITIES = {  # header -> factor from m2/Hz; None: per unit of the axis, as a density without a unit is
    "density (m2/Hz)": 1.0, "S [m^2 s/rad]": 1.0 / TURN, "PSD (cm²/Hz)": 1e4, "energy (J/m2/Hz)": 1025.0 * 9.81,
    "S(f) [m**2 s]": None, "E": None,
}  # fmt: skip
DIRECTIONS = {  # header -> the value of waves that come from the north-west
    "direction (deg)": 315.0, "dir (rad, to)": math.radians(135.0), "mwd [degrees true]": 315.0,
    "wave direction to (deg)": 135.0, "theta (deg, cartesian)": -45.0,
    "dir (rad, from, counterclockwise from east)": 0.75 * math.pi,
}  # fmt: skip
SEPARATORS = {";": ";", "decimal commas": ";", ",": ",", "tab": "\t", "spaces": "  "}
MISSING = {"none": "", "999.00": "999.00", "99": "99.00", "empty": "", "MM": "MM", "nan": "NaN", "-9999": "-9999"}
CHOICES = (AXES, DENSITIES, DIRECTIONS, SEPARATORS, MISSING)
DRAW = random.Random(1)
CASES = list(zip(*(DRAW.sample([*one] * 12, 60) for one in CHOICES), strict=True))


def test_the_60_tables_have_each_choice_and_most_pairs():
    for i, choice in enumerate(CHOICES):
        assert {case[i] for case in CASES} == set(choice)
    for i, j in itertools.combinations(range(5), 2):
        pairs = {(case[i], case[j]) for case in CASES}
        assert len(pairs) >= 0.6 * min(len(CHOICES[i]) * len(CHOICES[j]), 40), (i, j, len(pairs))


def made_table(axis: str, density: str, direction: str, separator: str, missing: str) -> str:
    """The text of a table; its first row has no density, if one is missing."""
    spread = "spread (rad)" if "rad" in direction else "spread"
    scale = DENSITIES[density] or 1.0 / AXES[axis] * (1e3 if "mHz" in axis else 1.0)
    rows = [[f"{f * AXES[axis]:.9g}", f"{s * scale:.9g}", f"{DIRECTIONS[direction]:.9g}",
             f"{math.radians(20.0):.6f}" if "rad" in spread else "20"] for f, s in zip(F, S, strict=True)]  # fmt: skip
    if missing != "none":
        word = MISSING[missing] or ("-" if separator == "spaces" else "")
        rows.insert(0, [f"{0.03 * AXES[axis]:.9g}", word, word, word])
        rows.append([f"{0.42 * AXES[axis]:.9g}", word, word, word])
    mark = SEPARATORS[separator]
    quote = '"{}"'.format if mark == "," else str
    head = [axis, density, direction, spread]
    if mark == "  ":
        head = [re.sub(r" (?=\w)(?![^(\[]*[)\]])", "_", word) for word in head]
        rows = [[word.replace(" ", "") for word in row] for row in rows]
    lines = [mark.join(map(quote, head)), *(mark.join(row) for row in rows)]
    text = "\n".join(lines) + "\n"
    return text if separator != "decimal commas" else lines[0] + "\n" + "\n".join(lines[1:]).replace(".", ",")


@pytest.mark.parametrize("case", CASES, ids=lambda case: " | ".join(case))
def test_a_table_with_units_and_conventions_is_the_sea_that_was_meant(case, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(made_table(*case), encoding="utf-8")
    height, period, bearing = seen(read_spectrum(path))
    assert height == pytest.approx(HEIGHT, rel=1e-3)
    assert period == pytest.approx(10.0, rel=1e-3)
    assert bearing == pytest.approx(315.0, abs=0.06)


# --- 40 hostile tables: one line each ---

ROWS = "".join(f"{f:.3f},{s:.6f}\n" for f, s in zip(F, S, strict=True))
NAMED = "f,S\n" + ROWS


def rows_with(word: str, column: int) -> str:
    """A table with a word in place of a number of its sixth row."""
    lines = NAMED.splitlines()
    words = lines[6].split(",")
    words[column] = word
    return "\n".join([*lines[:6], ",".join(words), *lines[7:]])


HOSTILE: dict[str, tuple[str | bytes, str]] = {
    "a word in numbers": (rows_with("high", 1), "line 7"),
    "a number with a word": (rows_with("0.5m", 1), "numbers in the column 'S'"),
    "infinite": (rows_with("inf", 1), "line 7"),
    "huge": (rows_with("1e400", 1), "line 7"),
    "underscores": (rows_with("1_000", 1), "line 7"),
    "negative": (rows_with("-1.5", 1), "-1.5 is no density"),
    "a frequency of 0": (rows_with("0", 0), "0 is no frequency"),
    "a frequency of a year": (rows_with("2020", 0), "2020 is no frequency"),
    "a frequency twice": (rows_with("0.040", 0), "rising"),
    "one column more": (rows_with("0.1,0.2", 1), "2 columns, not 3"),
    "two headers": ("f,S\nname,value\n" + ROWS, "line 2"),
    "two headers later": (NAMED + NAMED, "line 39"),
    "two densities": ("f,S,energy\n0.1,1,2\n0.2,1,2\n0.3,1,2\n", "columns 'S' and 'energy'"),
    "two frequencies": ("f,omega,S\n0.1,0.6,1\n0.2,1.2,1\n0.3,1.8,1\n", "columns 'f' and 'omega'"),
    "no density": ("f,Hs\n0.1,1\n0.2,1\n0.3,1\n", "the columns frequency"),
    "no frequency": ("T,S\n10,1\n5,1\n3,1\n", "the columns frequency"),
    "a unit unknown": ("f (Hz),S (m2/furlong day)\n" + ROWS, "a unit such as m2/Hz"),
    "a unit of nothing": ("f (foo),S\n" + ROWS, "a unit such as Hz"),
    "a unit of another kind": ("f (m),S\n" + ROWS, "a unit such as Hz"),
    "a height as density": ("f (Hz),S (m)\n" + ROWS, "a unit such as m2/Hz"),
    "a density over angles": ("f (Hz),S (m2/Hz/deg)\n" + ROWS, "a unit such as m2/Hz"),
    "omega in Hz": ("omega (Hz),S\n" + ROWS, "a unit such as rad/s"),
    "a power of powers": ("f (Hz),S (m^9^9^9^9^9)\n" + ROWS, "a unit such as m2/Hz"),
    "a long unit": ("f (Hz),S (" + "m*" * 5000 + "m)\n" + ROWS, ""),
    "a long line": (b"f,S" + b" " * 10 + b"(" * 10_000_000 + b"\n0.1,1\n0.2,1\n0.3,1\n", "at most 100000 characters"),
    "a million words": (b"0.1 " * 1_000_000, ""),
    "units in a comment": ("# rad/s and m2 s/rad\n" + ROWS, "names of the columns"),
    "north of the magnet": ("f,S,dir (deg magnetic),spread\n0.1,1,2,30\n0.2,1,2,30\n0.3,1,2,30\n", "magnetic north"),
    "directions in doubt": ("f,S,dir,spread\n0.1,1,4.7,30\n0.2,1,4.7,30\n0.3,1,4.7,30\n", "such as deg, rad"),
    "spreads in doubt": ("f,S,dir,spread\n0.1,1,270,0.3\n0.2,1,270,0.3\n0.3,1,270,0.3\n", "such as deg, rad"),
    "rows of radians": ("f,0,1.5,3.1,4.7\n0.1,1,1,1,1\n0.2,1,1,1,1\n", "the unit of the directions"),
    "a hole among directions": ("f,0,90,180,270\n0.1,1,MM,1,1\n0.2,1,1,1,1\n0.3,1,1,1,1\n", "line 2"),
    "only missing values": ("f,S\n" + "".join(f"{f:.3f},MM\n" for f in F), "at least three"),
    "10,000 columns": (",".join(["f", *map(str, range(10_000))]) + "\n" + ROWS, "at most 1000 columns"),
    "10,000 numbers": (",".join(["0.1"] * 10_000) + "\n" + ROWS, "at most 1000 columns"),
    "binary": (bytes(range(256)) * 40, "a table (CSV)"),
    "an archive": (b"PK\x03\x04" + bytes(2000), "a table (CSV)"),
    "broken gzip": (b"\x1f\x8b\x08" + bytes(100), "damaged"),
    "utf-32": (NAMED.encode("utf-32"), ""),
    "ebcdic": (NAMED.encode("cp500"), ""),
    "empty": ("", "a table (CSV)"),
    "a page of a web site": ("<html>\n<body>404, Not Found</body>\n</html>\n", ""),
}


def test_there_are_40_hostile_tables():
    assert len(HOSTILE) >= 40


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_table_is_refused_in_one_line(name, tmp_path):
    content, words = HOSTILE[name]
    path = tmp_path / "table.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match=r"^path: .* is not allowed; allowed: \S") as error:
        read_spectrum(path)
    said = str(error.value)
    assert words in said, said
    assert "\n" not in said
    assert len(said) < 600
    assert "table.csv" in said


def test_a_file_of_a_gigabyte_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "table.csv"
    with path.open("wb") as file:
        file.truncate(10 * MAX_BYTES)
    assert_refused("path", lambda: read_spectrum(path), "at most 100 MB")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_table_is_read_in_the_encodings_of_spreadsheets(encoding, tmp_path):
    path = tmp_path / "table.csv"
    path.write_bytes(made_table("frequency (Hz)", "PSD (cm²/Hz)", "direction (deg)", ";", "MM").encode(encoding))
    assert seen(read_spectrum(path))[0] == pytest.approx(HEIGHT, rel=1e-3)


def test_names_and_units_may_stand_in_a_comment_or_in_a_row_of_their_own(tmp_path):
    path = tmp_path / "table.txt"
    rows = "".join(f"{TURN * f:.9g} {s / TURN:.9g}\n" for f, s in zip(F, S, strict=True))
    for head in ("# omega (rad/s)  S (m2 s/rad)\n", "f S\nrad/s m2*s\n", "% of a flume\nomega S\n- -\n"):
        path.write_text(head + rows, encoding="utf-8")
        assert seen(read_spectrum(path))[:2] == pytest.approx((HEIGHT, 10.0), rel=1e-3)


def test_a_column_without_a_meaning_is_left_out_and_named(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("f,S,quality,dir\n" + "".join(f"{f},{s},good,270\n" for f, s in zip(F, S, strict=True)), "utf-8")
    notes = read_spectrum(path).notes
    assert "columns left out: quality" in notes
    assert "directions left out: they need a column of direction, and one of spread or r1" in notes


def test_a_density_of_two_sides_is_twice_as_large_on_one(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("f,S (m2/Hz two-sided)\n" + "".join(f"{f},{s / 2}\n" for f, s in zip(F, S, strict=True)), "utf-8")
    assert seen(read_spectrum(path))[0] == pytest.approx(HEIGHT, rel=1e-3)


@pytest.mark.parametrize(
    ("corner", "angle", "factor"),
    [
        ("f", lambda d: d, math.pi / 180.0),
        ("f (Hz) / dir (rad)", np.radians, 1.0),
        ("omega [rad/s], to", lambda d: (d + 180.0) % 360.0, math.pi / 180.0 / TURN),
        ("frequency (Hz), cartesian (deg), S (cm2/Hz/deg)", lambda d: (270.0 - d) % 360.0, 1e4 * math.pi / 180.0),
    ],
)
def test_a_table_of_directions_has_units_in_its_first_word(corner, angle, factor, tmp_path):
    bearings = np.arange(0.0, 360.0, 10.0)
    D = np.cos(np.radians(bearings - 300.0) / 2.0) ** 20
    D /= D.sum() * math.radians(10.0)
    scale = TURN if "omega" in corner else 1.0
    rows = "".join(
        ";".join(f"{x:.9g}" for x in (f * scale, *(s * D * factor))) + "\n" for f, s in zip(F, S, strict=True)
    )
    path = tmp_path / "table.csv"
    path.write_text(f"{corner};" + ";".join(f"{x:.9g}" for x in angle(bearings)) + "\n" + rows, encoding="utf-8")
    assert seen(read_spectrum(path)) == pytest.approx((HEIGHT, 10.0, 300.0), rel=1e-3)


# --- sectors of directions ---


@pytest.mark.parametrize(("low", "high", "step"), [(-60.0, 60.0, 10.0), (-90.0, 90.0, 5.0), (300.0, 420.0, 20.0)])
def test_a_sector_of_directions_has_no_waves_in_the_rest_of_the_circle(low, high, step):
    theta = np.radians(np.arange(low, high + 0.1, step))
    D = np.cos(0.5 * theta) ** 4
    D /= D.sum() * math.radians(step)
    spectrum = measured_spectrum(F, S[:, None] * D, theta)
    assert seen(spectrum)[0] == pytest.approx(HEIGHT, rel=1e-3)
    k = (TURN * 0.1) ** 2 / 9.81
    bounds = np.radians([low - 0.5 * step, high + 0.5 * step])
    c = spectrum.conditions()
    for at, outside in zip(bounds, (-0.01, 0.01), strict=True):
        assert spectrum.density(k * np.cos(at + outside), k * np.sin(at + outside), c) == 0.0
        assert spectrum.density(k * np.cos(at - outside), k * np.sin(at - outside), c) > 0.0


@pytest.mark.parametrize("unit", ["m2/(rad/s)", "m2/rad/s", "m^2/(rad/s)", "m\u00b2 s/rad", "m2*s"])
@pytest.mark.parametrize("brackets", ["()", "[]"])
def test_a_unit_with_a_quotient_in_brackets_is_read(unit, brackets, tmp_path):
    path = tmp_path / "table.csv"
    rows = "".join(f"{TURN * f:.9g},{s / TURN:.9g}\n" for f, s in zip(F, S, strict=True))
    path.write_text(f"omega (rad/s),S {brackets[0]}{unit}{brackets[1]}\n{rows}", encoding="utf-8")
    assert seen(read_spectrum(path))[:2] == pytest.approx((HEIGHT, 10.0), rel=1e-3)


def test_a_table_with_exchanged_rows_and_columns_is_named(tmp_path):
    path = tmp_path / "table.csv"
    rows = "".join(f"{d:g}," + ",".join(f"{s / 360.0:.6g}" for s in S) + "\n" for d in range(0, 360, 30))
    path.write_text("," + ",".join(f"{f:.3f}" for f in F) + "\n" + rows, encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "here they seem exchanged")


def test_the_decimal_sign_of_a_table_is_that_of_all_its_numbers(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("f;S\n0,1;1,000\n0,2;2,000\n0,3;1.000,5\n", encoding="utf-8")
    spectrum = read_spectrum(path)
    assert TURN * spectrum.frequency_density(TURN * np.array([0.1, 0.2, 0.3])) == pytest.approx([1.0, 2.0, 1000.5])
    path.write_text("f;S\n1;1,000\n2;2,000\n3;1,500\n", encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "1,000 may be 1.000 or 1000")
    path.write_text("f;S\n0,1;1,5\n0,2;2.5\n0,3;1,5\n", encoding="utf-8")
    assert_refused("path", lambda: read_spectrum(path), "one decimal sign: 2.5 here, and 0,1 in line 2")


def test_a_circle_that_is_closed_in_the_file_is_read_once(tmp_path):
    path = tmp_path / "table.csv"
    degrees = np.arange(0.0, 361.0, 30.0)
    D = 1.0 + np.cos(np.radians(degrees - 90.0))
    D /= D[:-1].sum() * 30.0
    rows = "".join(",".join(f"{x:.9g}" for x in (f, *(s * D))) + "\n" for f, s in zip(F, S, strict=True))
    path.write_text("f," + ",".join(f"{x:g}" for x in degrees) + "\n" + rows, encoding="utf-8")
    assert seen(read_spectrum(path)) == pytest.approx((HEIGHT, 10.0, 90.0), rel=1e-3)


# --- places and times of SWAN ---


def swan(blocks: list[list[str]], times: bool = True) -> str:
    """A file of SWAN with two places, and the blocks of each time."""
    head = ["SWAN   1", "$ made here", *(["TIME", "     1"] if times else []), "LONLAT", "     2", " 4.0 52.0",
            " 4.5 52.5", "RFREQ", f"  {len(F)}", *(f" {f:.4f}" for f in F), "NDIR", "   8",
            *(f" {45 * i}" for i in range(8)), "QUANT", "  1", "VaDens  variance densities", "m2/Hz/degr  unit",
            " -0.9900E+02  exception value"]  # fmt: skip
    lines = [line for i, one in enumerate(blocks) for line in ([f"2021030{i + 1}.000000"] if times else []) + one]
    return "\n".join([*head, *lines]) + "\n"


def block(factor: float) -> list[str]:
    """The lines of one place with waves from the west, of Hs sqrt(factor) times that of the table."""
    D = np.array([0, 0, 0, 0, 0, 1, 2, 1]) / 4.0 / 45.0
    return ["FACTOR", f"  {factor * 1e-7:.8E}", *(" ".join(f"{x:.0f}" for x in s * D * 1e7) for s in S)]


def test_places_and_times_of_swan_are_chosen_and_places_without_data_passed_over(tmp_path):
    path = tmp_path / "a.sp2"
    path.write_text(swan([["NODATA", *block(1.0)], [*block(4.0), "ZERO"], ["NODATA", "NODATA"]]), "utf-8")
    last = read_spectrum(path)
    assert seen(last) == pytest.approx((2.0 * HEIGHT, 10.0, 270.0), rel=2e-3)
    assert last.name == "a.sp2, 2021-03-02 00:00"
    assert "place 1 of 2, at 4, 52" in last.notes
    first = read_spectrum(path, "2021-03-01 00:30", 2)
    assert seen(first) == pytest.approx((HEIGHT, 10.0, 270.0), rel=2e-3)
    assert "place 2 of 2, at 4.5, 52.5" in first.notes
    for place in (None, 1):  # one place at all times, or a series would jump
        assert_refused(
            "place", lambda one=place: read_spectrum(path, "2021-03-01", one), "with data at 2021-03-01 00:00: 2"
        )
    assert_refused("place", lambda: read_spectrum(path, "2021-03-03"), "with data at 2021-03-03 00:00: none")
    assert_refused("place", lambda: read_spectrum(path, place=3), "1 to 2")
    assert_refused("place", lambda: read_spectrum(FIELD / "spectrum_cm2.csv", place=1), "several")
    path.write_text(swan([[*block(1.0), *block(9.0)]], times=False), "utf-8")
    assert seen(read_spectrum(path, place=2))[0] == pytest.approx(3.0 * HEIGHT, rel=2e-3)
    path.write_text(swan([[*block(1.0), *block(9.0)[:-1]]], times=False), "utf-8")
    assert_refused("path", lambda: read_spectrum(path), "it ends early")


def test_a_marker_of_0_is_a_density_of_0_and_missing_bins_are_named_with_their_energy(tmp_path):
    path = tmp_path / "a.sp2"
    text = swan([[*block(1.0), "NODATA"]])
    path.write_text(text.replace(" -0.9900E+02", "  0.0000E+00"), "utf-8")  # four of eight bins of each row are 0
    assert seen(read_spectrum(path)) == pytest.approx((HEIGHT, 10.0, 270.0), rel=2e-3)
    assert not [note for note in read_spectrum(path).notes if "missing" in note]
    lines = text.splitlines()
    row = next(i for i, line in enumerate(lines) if line == "FACTOR") + 2
    words = lines[row + 6].split()  # the row of the peak
    lines[row + 6] = " ".join([*words[:5], "-99", *words[6:]])
    path.write_text("\n".join(lines), "utf-8")
    spectrum = read_spectrum(path)
    assert HEIGHT * 0.9 < seen(spectrum)[0] < HEIGHT
    assert re.search(r"1 of 296 densities are missing and taken as 0; .* about \d(\.\d)? % of", spectrum.notes[2])


def test_a_time_that_is_asked_for_is_chosen_before_records_without_data_are_left_out(tmp_path):
    source = (FIELD / "46999w2021.txt").read_text("utf-8").splitlines()
    words = source[1].split()
    empty = " ".join([*words[:3], f"{(int(words[3]) + 1) % 24:02d}", *words[4:5], *["999.00"] * len(words[5:])])
    path = tmp_path / "buoy.txt"
    path.write_text("\n".join([source[0], source[1], empty]) + "\n", "utf-8")
    assert seen(read_spectrum(path))[1] == pytest.approx(10.0, rel=1e-2)
    hour = empty.split()
    assert_refused(
        "time", lambda: read_spectrum(path, f"{'-'.join(hour[:3])} {hour[3]}:{hour[4]}"), "has none, that at"
    )


@pytest.mark.parametrize("beside", ["alpha1", "density"])
def test_digits_of_9_of_a_buoy_are_missing_by_its_own_rule_only(beside, tmp_path):
    head = "#YY  MM DD hh mm " + " ".join(f"{f:.4f}" for f in (0.08, 0.09, 0.10, 0.11, 0.12, 0.13))
    rows = {"w": "60 80 99.00 90 70 99.00" if beside == "density" else "1 2 3 3 2 1", "d": "40 45 99 210 999 220",
            "i": "40 45 99 210 215 220", "j": "0.9 0.9 0.9 0.9 0.9 0.9", "k": "0.8 0.8 0.8 0.8 0.8 0.8"}  # fmt: skip
    for letter, row in rows.items():
        (tmp_path / f"46999{letter}2021.txt").write_text(f"{head}\n2021 03 05 04 40 {row}\n", "utf-8")
    if beside == "density":
        density = records_of((tmp_path / "46999w2021.txt").read_text("utf-8"), tmp_path)
        assert without_99(density.values)[0] == pytest.approx([60, 80, 99, 90, 70, 99])
        assert np.isnan(without_99(np.array([[1.0, 2.0, 99.0, 3.0]]))).tolist() == [[False, False, True, False]]
    else:
        f = np.array([0.08, 0.09, 0.10, 0.11, 0.12, 0.13])
        records = moments_of(tmp_path / "46999d2021.txt", "alpha1")
        found = moment_at(records, datetime.datetime(2021, 3, 5, 4, 40), f)
        assert found is not None
        assert found.tolist() == [40, 45, 99, 210, 210, 220]


def test_a_sea_that_is_unlikely_has_a_warning(tmp_path):
    path = tmp_path / "table.csv"
    for f, s, words in ((F, S, ""), (F, 400.0 * S, "Hs 31"), (6.0 * F, S / 100.0, "Tp 1.67 s"), (F / 4.0, S, "Tp 40 s"),
                        (2.0 * F, 40.0 * S, "steepness")):  # fmt: skip
        path.write_text("f,S\n" + "".join(f"{a:.6g},{b:.9g}\n" for a, b in zip(f, s, strict=True)), "utf-8")
        said = [note for note in read_spectrum(path).notes if note.startswith("Warning: ")]
        assert (words in said[0]) if words else not said


# --- records of heights ---

T = np.arange(0.0, 60.0, 0.25)
ETA = 0.8 * np.sin(TURN * T / 8.0 + 0.3) + 0.2 * np.sin(TURN * T / 5.0)


@pytest.mark.parametrize(
    ("head", "times", "heights"),
    [("time (s),eta (m)", 1.0, 1.0), ("t [ms];height [cm]", 1e3, 100.0), ("Time (min)\tElevation (mm)", 1 / 60, 1e3),
     ("time,surface elevation (ft),flag", 1.0, 1 / 0.3048), ("", 1.0, 1.0)],
)  # fmt: skip
@pytest.mark.parametrize("missing", ["", "999.00", "NaN"])
def test_a_record_is_read_with_its_units_and_without_missing_ends(head, times, heights, missing, tmp_path):
    mark = next((one for one in ";\t," if one in head), ",")
    rows = [[f"{t * times:.9g}", f"{h * heights:.9g}"] for t, h in zip(T, ETA, strict=True)]
    rows[-1][1] = missing or rows[-1][1]
    lines = [mark.join([*row, *(["1"] if "flag" in head else [])]) for row in rows]
    path = tmp_path / "record.csv"
    path.write_text("\n".join([*([head] if head else []), *lines]) + "\n", encoding="utf-8")
    record = read_record(path, missing=999.0 if missing == "999.00" else None)
    count = len(T) - bool(missing)
    assert record.t == pytest.approx(T[:count], abs=1e-6)
    assert record.height == pytest.approx(ETA[:count], abs=1e-7)
    assert record.notes[0].startswith(f"Hs {4.0 * ETA.std():.2g}")
    assert f"in {count} samples" in record.notes[0]
    assert ("columns left out: flag" in record.notes) == ("flag" in head)
    assert recorded_waves(record.t, record.height).significant_height == pytest.approx(4.0 * ETA.std(), rel=0.01)


def test_a_record_with_a_gap_or_times_that_fall_is_refused(tmp_path):
    path = tmp_path / "record.csv"
    rows = [f"{t:g},{h:.6f}" for t, h in zip(T, ETA, strict=True)]
    for row, words in (("2.5,", "line 12"), ("2.25,0.1", "line 12"), ("2.5,high", "line 12"), ("2.5,1e9", "line 12")):
        path.write_text("\n".join(["t,eta", *rows[:10], row, *rows[11:]]), "utf-8")
        assert_refused("path", lambda: read_record(path), "")
        with pytest.raises(ValueError, match=words):
            read_record(path)
    path.write_text("t,f\n0,1\n1,2\n", "utf-8")
    assert_refused("path", lambda: read_record(path), "t [s] and height [m]")
    heights = np.where(T == 3.0, np.nan, ETA)
    assert_refused("height", lambda: recorded_waves(T, heights), "finite")
    with pytest.raises(ValueError, match=r"nan at t = 3 s, 1 such"):
        recorded_waves(T, heights)


def test_a_mark_at_the_end_of_each_line_is_no_column_and_one_of_some_lines_is_an_empty_word():
    def words(text: str) -> list[list[str]]:
        return [row.words for row in split_rows(text, Path("table.csv"))[0]]

    assert words("f;S\n1;2\n") == words("f;S;\n1;2;\n") == [["f", "S"], ["1", "2"]]
    assert words("f;;S\n1;;2\n") == [["f", "", "S"], ["1", "", "2"]]
    assert words("f;S;\n1;2\n") == [["f", "S", ""], ["1", "2"]]
    assert words("f;;\n1;;\n") == [["f", ""], ["1", ""]]
