"""Records with times as people have them: 14 forms of time, separators, and decimal signs."""

import datetime
import itertools

import numpy as np
import pytest

from sim.ocean import read_record
from sim.ocean.records.wave_record import zero_crossings
from tests.refusals import assert_refused

BEGIN = datetime.datetime(2020, 1, 2, 23, 59, 40, 400_000)  # before midnight
STEP = 0.4
N = 1500
T = STEP * np.arange(N)
ETA = np.sin(2.0 * np.pi * T / 8.3 + 0.4) + 0.3 * np.sin(2.0 * np.pi * T / 4.7)
TZ = zero_crossings(T, ETA).mean_period
STAMPS = [BEGIN + datetime.timedelta(milliseconds=400 * i) for i in range(N)]
UNIX = datetime.datetime(1970, 1, 1)


def since(day: datetime.datetime, unit: float, digits: int) -> list[str]:
    """Times since a day in a unit [s], as spreadsheets and loggers write them."""
    return [f"{(one - day) / datetime.timedelta(seconds=unit):.{digits}f}" for one in STAMPS]


def midnight(one: datetime.datetime) -> datetime.datetime:
    """The beginning of a day."""
    return one.replace(hour=0, minute=0, second=0, microsecond=0)


def clock(one: datetime.datetime, form: str) -> str:
    """A time with one digit behind the second."""
    return one.strftime(form) + f".{one.microsecond // 100_000}"


# form -> names of the columns, and the words of each
FORMS = {
    "seconds": ("time (s)", [f"{t:.1f}" for t in T]),
    "milliseconds": ("t [ms]", [f"{1e3 * t:.0f}" for t in T]),
    "minutes": ("Time (min)", [f"{t / 60.0:.8f}" for t in T]),
    "ISO, UTC": ("time", [clock(one, "%Y-%m-%dT%H:%M:%S") + "Z" for one in STAMPS]),
    "ISO with a zone": ("timestamp", [clock(one, "%Y-%m-%d %H:%M:%S") + "+01:00" for one in STAMPS]),
    "day first": ("Date and time", [clock(one, "%d.%m.%Y %H:%M:%S") for one in STAMPS]),
    "month by name": ("datetime", [clock(one, "%d-%b-%Y %H:%M:%S") for one in STAMPS]),
    "clock": ("time", [clock(one, "%H:%M:%S") for one in STAMPS]),
    "clock of twelve hours": ("time", [clock(one, "%I:%M:%S") + one.strftime(" %p") for one in STAMPS]),
    "date and clock": ("date|time", [clock(one, "%Y/%m/%d|%H:%M:%S") for one in STAMPS]),
    "columns": ("year|month|day|hour|min|sec|milisec",
                [one.strftime("%Y|%m|%d|%H|%M|%S|") + str(one.microsecond // 1000) for one in STAMPS]),
    "epoch in s": ("epoch", since(UNIX, 1.0, 1)),
    "epoch in ms": ("unix time", since(UNIX, 1e-3, 0)),
    "epoch in us": ("time", since(UNIX, 1e-6, 0)),
    "days since 1899": ("time (d)", since(datetime.datetime(1899, 12, 30), 86400.0, 9)),
    "days since 1970": ("time (days since 1970-01-01)", since(UNIX, 86400.0, 9)),
    "days of MATLAB": ("datenum", [f"{one.toordinal() + 366 + (one - midnight(one)) / datetime.timedelta(days=1):.10f}"
                                      for one in STAMPS]),
}  # fmt: skip
SEPARATORS = {"semicolons": ";", "tabs": "\t", "commas": ","}


def text_of(form: str, separator: str, decimal: str) -> str:
    """The text of a record."""
    names, words = FORMS[form]
    rows = [[*names.split("|"), "eta (m)"], *([*one.split("|"), f"{h:.9f}"] for one, h in zip(words, ETA, strict=True))]
    if decimal == ",":
        rows = [rows[0], *([word.replace(".", ",") if form != "day first" or i else word for i, word in enumerate(row)]
                           for row in rows[1:])]  # fmt: skip
    mark = SEPARATORS[separator]
    if mark == ",":
        rows = [[f'"{word}"' for word in row] for row in rows]
    return "\n".join(mark.join(row) for row in rows) + "\n"


@pytest.mark.parametrize(("separator", "decimal"), list(itertools.product(SEPARATORS, (".", ","))))
@pytest.mark.parametrize("form", FORMS)
def test_a_record_has_its_periods_whatever_form_its_times_have(form, separator, decimal, tmp_path):
    path = tmp_path / "record.csv"
    path.write_text(text_of(form, separator, decimal), encoding="utf-8")
    record = read_record(path)
    assert record.t - record.t[0] == pytest.approx(T, abs=2e-5)
    assert record.height == pytest.approx(ETA, abs=1e-9)
    assert zero_crossings(record.t, record.height).mean_period == pytest.approx(TZ, rel=1e-6)
    assert not [note for note in record.notes if note.startswith("Warning")]


@pytest.mark.parametrize("form", ["ISO, UTC", "date and clock", "clock", "epoch in s"])
def test_times_between_spaces_and_without_names_are_read_too(form, tmp_path):
    path = tmp_path / "record.txt"
    rows = text_of(form, "tabs", ".").splitlines()
    path.write_text("\n".join(row.replace("\t", "  ") for row in rows[1:]), encoding="utf-8")
    if form == "date and clock":
        path.write_text("\n".join(["time eta", *(row.replace("\t", "  ") for row in rows[1:])]), encoding="utf-8")
    record = read_record(path)
    assert record.t - record.t[0] == pytest.approx(T, abs=1e-6)


def test_rounded_digits_are_no_unevenness_and_a_gap_is_named(tmp_path):
    path = tmp_path / "record.csv"
    rows = [f"{one:%H:%M:%S},{h:.6f}" for one, h in zip(STAMPS, ETA, strict=True)]  # two or three samples a second
    path.write_text("\n".join(["time,eta", *rows]), encoding="utf-8")
    record = read_record(path)
    assert np.diff(record.t) == pytest.approx(STEP, rel=1e-4)
    assert "within their last digit, 1 s" in " | ".join(record.notes)
    rows = [f"{t:.1f},{h:.6f}" for t, h in zip(T, ETA, strict=True)]
    path.write_text("\n".join(["time,eta", *rows[:500], *rows[520:]]), encoding="utf-8")
    assert "Warning: no samples for 8.4 s after t = 199.6 s, line 501" in read_record(path).notes


def test_days_without_their_unit_are_asked_back(tmp_path):
    path = tmp_path / "record.csv"
    days = FORMS["days since 1899"][1]
    path.write_text("\n".join(["time,eta", *(f"{t},{h:.6f}" for t, h in zip(days, ETA, strict=True))]), "utf-8")
    assert_refused("path", lambda: read_record(path), "'time (d)' for days, which makes the step 0.4 s, or 'time (s)'")


@pytest.mark.parametrize(
    ("word", "said"),
    [("2020-13-02T00:00:00", "a time such as"), ("2020-01-02T25:61:00", "a time such as"), ("noon", "a time such as")],
)
def test_a_stamp_that_is_no_time_is_refused_with_its_line(word, said, tmp_path):
    path = tmp_path / "record.csv"
    rows = [f"{time},{h:.6f}" for time, h in zip(FORMS["ISO, UTC"][1], ETA, strict=True)]
    path.write_text("\n".join(["time,eta", *rows[:7], f"{word},0.1", *rows[8:]]), encoding="utf-8")
    assert_refused("path", lambda: read_record(path), said)
    with pytest.raises(ValueError, match="line 9"):
        read_record(path)


# --- digits of 9 ---


def millimetres(tmp_path, rows: dict[int, str]):
    """A record in whole millimetres, with words in place of those of some rows."""
    words = [f"{1300.0 * eta:.0f}" for eta in ETA]
    for i, word in rows.items():
        words[i] = word
    path = tmp_path / "record.csv"
    path.write_text(
        "\n".join(["t (s),eta (mm)", *(f"{t:.1f},{word}" for t, word in zip(T, words, strict=True))]), "utf-8"
    )
    return path


def test_a_height_of_99_mm_is_a_height(tmp_path):
    path = millimetres(tmp_path, {200: "99", 700: "-99", 1200: "999"})
    assert read_record(path).height[[200, 700, 1200]] == pytest.approx([0.099, -0.099, 0.999])
    assert_refused("path", lambda: read_record(path, missing=[99, -99]), "1 are missing from t = 80 s")


def test_nines_far_beyond_all_others_are_missing_and_named_with_their_energy(tmp_path):
    path = millimetres(tmp_path, dict.fromkeys(range(1490, 1500), "99999"))
    record = read_record(path)
    assert len(record.t) == 1490
    said = " | ".join(record.notes)
    assert "counts as missing; missing=() takes it for a value, with" in said
    assert "% of the energy" in said
    assert len(read_record(path, missing=()).t) == 1500
