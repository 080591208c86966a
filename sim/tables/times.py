"""Columns of time: stamps, clocks, columns of year to millisecond, and numbers since an epoch, as seconds.

| written | example |
|---|---|
| seconds and other units | time (s), t [ms], Time (min) |
| stamps, with or without a zone | 2020-01-02T23:50:00.5Z, 2020-01-02 23:50:00+01:00, 02-Jan-2020 |
| a column of dates and one of clocks | 2020/01/02; 23:50:00.5 |
| clocks | 23:50:00.5, 11:50:00.5 PM, 50:00.5 |
| columns of year to microsecond | year, month, day, hour, min, sec, ms |
| an epoch in s, ms, us or ns | 1578009000.5 |
| days since 1899, 1970 or year 0 | time (d); without the unit it is asked for |

Seconds begin at the first row, except for numbers below those of an epoch, which stay as they are. Written digits are
rounded: times that are equally spaced within their last digit become so.
"""

import datetime
import math
import re
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.tables.headers import letters_of
from sim.tables.rows import Row, line_error

DAY = 86400.0  # [s]
NAMES = (
    "t", "time", "times", "seconds", "elapsedtime", "timestamp", "timestamps", "datetime", "date", "dateandtime",
    "datetimeutc", "timeutc", "utc", "utctime", "gmt", "localtime", "sampletime", "recordtime", "epoch", "epochtime",
    "unixtime", "unixepoch", "posixtime", "clock", "clocktime", "timeofday", "datenum", "serialtime", "serialdate",
    "exceltime", "matlabtime", "elapsed", "elapsedseconds",
)  # fmt: skip
DATES = ("date", "day", "dateutc", "datum")
CLOCKS = ("time", "clock", "clocktime", "timeofday", "timeutc", "hhmmss", "utc", "zeit", "localtime")
PARTS = {  # of a time, from the largest -> names of columns, and seconds of those of fixed length
    "year": (("year", "years", "yyyy", "yr", "yy"), 0.0),
    "month": (("month", "months", "mon", "mo"), 0.0),
    "day": (("day", "days", "dd", "dy"), DAY),
    "hour": (("hour", "hours", "hr", "hh", "hrs"), 3600.0),
    "minute": (("minute", "minutes", "min", "mins", "mn"), 60.0),
    "second": (("second", "seconds", "sec", "secs", "ss"), 1.0),
    "millisecond": (("millisecond", "milliseconds", "milisec", "millisec", "msec", "ms", "milisecond"), 1e-3),
    "microsecond": (("microsecond", "microseconds", "microsec", "usec", "us"), 1e-6),
}
SERIAL = ("datenum", "serialtime", "serialdate", "exceltime", "matlabtime")  # names of columns of days
EPOCHS = ((1e8, 1e10, 1.0, "s"), (1e11, 1e13, 1e-3, "ms"), (1e14, 1e16, 1e-6, "us"), (1e17, 1e19, 1e-9, "ns"))
DAYS_STEP = 1e-3  # [s] a shorter step without a unit is likely to be one in days
SAME_STEP = 1e-6  # of a step, that times may miss it by and are equally spaced all the same
MAX_ROUNDING = 3.0  # steps in the last digit of a time, up to which it still tells the step
MAX_EXACT = 2000  # rows whose digits are counted
GAP = 1.5  # of a step, beyond which samples are missing

MONTHS = {name: i for i, name in enumerate(re.findall("...", "janfebmaraprmayjunjulaugsepoctnovdec"), 1)}
DATE = r"(?:(?P<y>\d{4})[-/.]?(?P<m>\d\d)[-/.]?(?P<d>\d\d)|(?P<a>\d\d?)[-/.](?P<b>\d\d?|[A-Za-z]{3})[-/.](?P<c>\d{4}))"
CLOCK = (
    r"(?P<hour>\d\d?):(?P<minute>\d\d)(?::(?P<second>\d\d(?:[.,]\d+)?))?"
    r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?\s*(?P<zone>Z|UTC|GMT|[+-]\d\d(?::?\d\d)?)?"
)
SHORT = re.compile(r"(?P<minute>\d+):(?P<second>\d\d[.,]\d+)")  # 50:00.5, as Excel shows a clock
IS_DATE, IS_CLOCK = re.compile(DATE), re.compile(CLOCK, re.IGNORECASE)
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
STAMP = re.compile(rf"{DATE}(?:(?:T|\s+){CLOCK})?", re.IGNORECASE)


class Clock(NamedTuple):
    """A column of time."""

    seconds: np.ndarray  # (n,) [s] nan if missing
    resolution: float  # [s] of the last digit that is written
    form: str  # for a note, "" for plain numbers
    begin: str  # of the first row, "" if it has no date or clock


def is_time(word: str) -> bool:
    """True for a stamp, a date or a clock."""
    return any(form.fullmatch(word.strip()) for form in (STAMP, IS_CLOCK, SHORT))


def seconds_of_clock(match: re.Match[str]) -> float:
    """Seconds since midnight, of the zone UTC where a zone is written. Raises ValueError."""
    hour, minute = int(match["hour"]), int(match["minute"])
    second = float((match["second"] or "0").replace(",", "."))
    if match["half"]:
        if not 1 <= hour <= 12:
            raise ValueError
        hour = hour % 12 + (12 if match["half"] in "Pp" else 0)
    if hour > 24 or minute > 59 or second >= 61.0:
        raise ValueError
    zone, shift = match["zone"] or "", 0.0
    if zone[:1] in ("+", "-"):
        digits = zone[1:].replace(":", "")
        shift = (60.0 * int(digits[:2]) + int(digits[2:] or 0)) * (60.0 if zone[0] == "+" else -60.0)
    return 3600.0 * hour + 60.0 * minute + second - shift


def day_of(match: re.Match[str], is_month_first: bool) -> int:
    """The day of a date, counted from the year 1. Raises ValueError."""
    if match["y"]:
        return datetime.date(int(match["y"]), int(match["m"]), int(match["d"])).toordinal()
    first, second = match["a"], match["b"]
    if second.isalpha():
        return datetime.date(int(match["c"]), MONTHS.get(second.lower(), 0), int(first)).toordinal()
    day, month = (second, first) if is_month_first else (first, second)
    return datetime.date(int(match["c"]), int(month), int(day)).toordinal()


def decimals(text: str | None) -> float:
    """Size of the last digit of a number of seconds."""
    digits = re.split("[.,]", text or "0")
    return 10.0 ** -len(digits[1]) if len(digits) > 1 else 1.0


def stamps(words: Sequence[str], missing: frozenset[str]) -> tuple[Clock | None, int]:
    """A column of stamps or clocks; None and the first word that is none otherwise."""
    parts: list[tuple[re.Match[str] | None, float]] = []
    resolution, has_dates = 1.0, False
    for i, word in enumerate(words):
        plain = word.strip()
        if plain.lower() in missing:
            parts.append((None, math.nan))
            continue
        match = STAMP.fullmatch(plain) or IS_CLOCK.fullmatch(plain)
        short = None if match else SHORT.fullmatch(plain)
        try:
            if short:
                parts.append((None, 60.0 * int(short["minute"]) + float(short["second"].replace(",", "."))))
                resolution = min(resolution, decimals(short["second"]))
                continue
            if match is None:
                return None, i
            is_dated = "y" in match.re.groupindex
            has_dates |= is_dated
            parts.append((match if is_dated else None, seconds_of_clock(match) if match["hour"] else 0.0))
        except ValueError:
            return None, i
        if match["hour"]:
            resolution = min(resolution, decimals(match["second"]) if match["second"] else 60.0)
    seconds = np.array([clock for _, clock in parts])
    begin = words[0].strip()
    if not has_dates:
        fall = np.diff(seconds, prepend=seconds[:1])
        period = 3600.0 if SHORT.fullmatch(begin) else DAY
        return Clock(seconds - seconds[0] + period * np.cumsum(fall < -0.5 * period), resolution, "clocks", begin), -1
    trials, wrong = [], 0
    for is_month_first in (False, True):
        days: dict[str, int] = {}
        ordinals = np.full(len(parts), math.nan)
        for i, (match, _) in enumerate(parts):
            if match is None:
                continue
            key = match[0][: match.end("c") if match["c"] else match.end("d")]
            try:
                if key not in days:
                    days[key] = day_of(match, is_month_first)
            except ValueError:
                wrong = max(wrong, i)
                break
            ordinals[i] = days[key]
        else:
            trials.append((ordinals - ordinals[np.isfinite(ordinals)][0]) * DAY + seconds)
    if not trials:
        return None, wrong
    best = min(trials, key=lambda t: (not (np.diff(t) >= 0.0).all(), float(np.ptp(t[np.isfinite(t)]))))
    return Clock(best - best[np.isfinite(best)][0], resolution, "stamps", begin), -1


def of_numbers(words: Sequence[str], values: np.ndarray, factor: float | None, name: str) -> Clock:
    """A column of numbers (n,). factor: [s] of its unit, None if the header names none."""
    there = np.flatnonzero(np.isfinite(values))
    first = float(values[there[0]]) if len(there) else 0.0
    form = ""
    if factor is None:
        factor = 1.0
        for low, high, scale, unit in EPOCHS:
            if low <= abs(first) < high:
                factor, form = scale, f"an epoch in {unit}"
        if not form and name in SERIAL:
            factor, form = DAY, "days"
    exact = [Decimal(word) if NUMBER.fullmatch(word) else None for word in words[:MAX_EXACT]]
    digits = [-int(one.as_tuple().exponent) for one in exact if one is not None]
    resolution = factor * 10.0 ** -max(digits, default=0)
    is_far = form.startswith("an epoch") or (factor == DAY and abs(first) > 1e3)
    if is_far and len(there) and NUMBER.fullmatch(words[int(there[0])]):
        start = Decimal(words[int(there[0])])
        values = np.array(
            [float(Decimal(word) - start) if NUMBER.fullmatch(word) else math.nan for word in words], float
        )
        form = form or "days"
    return Clock(values * factor, resolution, form, "")


class TimeColumns(NamedTuple):
    """Columns of a table that make one time."""

    places: tuple[int, ...]
    words: list[str]  # (n,) stamps or clocks, of each row


def joined(names: Sequence[str], rows: Sequence[Row]) -> TimeColumns | None:
    """Columns of a date and a clock, or of year to microsecond, as one; None without them."""
    letters = [letters_of(name) for name in names]
    first = rows[0].words if rows else []
    for i, name in enumerate(letters):
        if name in DATES and i < len(first) and IS_DATE.fullmatch(first[i].strip()):
            for j, other in enumerate(letters):
                if other in CLOCKS and j != i and IS_CLOCK.fullmatch(first[j].strip()):
                    return TimeColumns((i, j), [f"{row.words[i].strip()} {row.words[j].strip()}" for row in rows])
    places = {part: next((i for i, name in enumerate(letters) if name in known), None)
              for part, (known, _) in PARTS.items()}  # fmt: skip
    indices = {part: i for part, i in places.items() if i is not None}
    if not {"hour", "minute"} <= indices.keys() and not {"minute", "second"} <= indices.keys():
        return None
    try:
        return TimeColumns(tuple(indices.values()), [stamp_of({part: row.words[i] for part, i in indices.items()})
                                                     for row in rows])  # fmt: skip
    except ValueError:
        return None


def stamp_of(parts: dict[str, str]) -> str:
    """The stamp of columns of year to microsecond. Raises ValueError for words that are no whole numbers."""
    second = Decimal(parts.get("second", "0") or "0")
    for part, scale in (("millisecond", Decimal("0.001")), ("microsecond", Decimal("0.000001"))):
        if part in parts:
            second += scale * Decimal(parts[part])
    clock = f"{int(float(parts.get('hour', 0))):02d}:{int(float(parts['minute'])):02d}:{second:09.6f}"
    if not {"year", "month", "day"} <= parts.keys():
        return clock
    year = int(float(parts["year"]))
    year += 0 if year >= 100 else 1900 if year >= 70 else 2000
    return f"{year:04d}-{int(float(parts['month'])):02d}-{int(float(parts['day'])):02d} {clock}"


def evened(clock: Clock) -> tuple[np.ndarray, str]:
    """The times (n,) [s], equally spaced if the written digits allow it; and a note, or ""."""
    t = clock.seconds
    if len(t) < 3 or not np.isfinite(t).all():
        return t, ""
    i = np.arange(len(t), dtype=float)
    step, start = np.polyfit(i - i.mean(), t, 1)
    start -= step * i.mean()
    miss = float(np.abs(t - start - step * i).max())
    if not step > 0.0 or miss <= SAME_STEP * step:
        return t, ""
    if miss > 1.01 * clock.resolution or clock.resolution > MAX_ROUNDING * step:
        return t, ""
    even = step * i + (t[0] if clock.form == "" else 0.0)
    return even, f"times are equally spaced within their last digit, {clock.resolution:.3g} s: a step of {step:.9g} s"


def gaps_of(t: np.ndarray) -> list[tuple[int, float]]:
    """Index of the sample before each gap in rising times (n,) [s], and its length [s]."""
    steps = np.diff(t)
    step = float(np.median(steps)) if len(steps) else 0.0
    return [(int(i), float(steps[i])) for i in np.flatnonzero(steps > GAP * step)]


def check_step(t: np.ndarray, is_given: bool, header: str, path: Path, number: int) -> None:
    """Raises ValueError for times (n,) without a unit whose step is so short in seconds that it is likely in days."""
    steps = np.diff(t[np.isfinite(t)])
    step = float(np.median(steps)) if len(steps) else 1.0
    if not is_given and 0.0 < step < DAYS_STEP:
        raise line_error(
            path, number,
            f"a unit of the time in its header: '{header} (d)' for days, which makes the step {step * DAY:.4g} s, "
            f"or '{header} (s)' for a step of {step:.3g} s",
        )  # fmt: skip
