"""Text files of NDBC's buoys: densities, the four moments of their directions, and summaries.

https://www.ndbc.noaa.gov/faq/measdes.shtml describes them: alpha1 and alpha2 are directions that waves come from.
"""

import datetime
import math
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.ocean.records.measured import spread_by_mean, spread_by_moments
from sim.ocean.spectra.record import SECOND_EXPONENT, SECOND_PEAK, Spectrum, peaked
from sim.ocean.spectrum_files.contents import DIRECTIONS, line_error, made, nearest, read_text, towards
from sim.validation import argument_error

MISSING = 999.0  # and above: what a buoy's file does not have
REALTIME = {".swdir": "alpha1", ".swdir2": "alpha2", ".swr1": "r1", ".swr2": "r2"}  # endings of files beside .data_spec
HISTORY = {"d": "alpha1", "i": "alpha2", "j": "r1", "k": "r2"}  # letter in 44013w2020.txt, which is w for the density
HISTORY_NAME = re.compile(r"^(.{5})w(\w+\.txt(?:\.gz)?)$")
COMPASS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
WIND_SEA_EXPONENT = 10.0  # s of cos2s of wind waves (Goda 2010, Sec. 2.3)
SUMMARY_FREQUENCIES = np.geomspace(0.01, 5.0, 800)  # [Hz]


class Records(NamedTuple):
    """Rows of a buoy's file."""

    time: list[datetime.datetime]  # (n,)
    frequency: np.ndarray  # (m,) [Hz]
    values: np.ndarray  # (n, m), nan if missing


def from_buoy(text: str, path: Path, when: datetime.datetime | None) -> Spectrum[Any]:
    """The spectrum of an NDBC file of densities, with the directions of the files beside it."""
    kind = kind_of(text)
    if kind != "density":
        raise argument_error(
            "path", str(path), f"the file of densities (.data_spec, or w in its name); this is of {kind}"
        )
    density = records_of(text, path)
    whole = np.isfinite(density.values).sum(axis=1) >= 3
    if not whole.any():
        raise argument_error("path", str(path), "a file with a record of at least three densities")
    rows = np.flatnonzero(whole)
    i = rows[nearest([density.time[row] for row in rows], when, path)]
    time, there = density.time[i], np.isfinite(density.values[i])
    order = np.argsort(density.frequency[there])
    f, S = density.frequency[there][order], density.values[i][there][order]
    moments = {kind: moment_at(other, time, f) for kind, other in files_beside(path).items()}
    known = {kind: values for kind, values in moments.items() if values is not None}
    if not {"alpha1", "r1"} <= known.keys():
        if known:
            warnings.warn(f"{path.name}: directions need the files of alpha1 and of r1 at the same time", stacklevel=3)
        return made(path, time, f, S)
    mean, first = towards(known["alpha1"]), shares(known["r1"])
    if {"alpha2", "r2"} <= known.keys():
        D = spread_by_moments(DIRECTIONS, mean, first, towards(known["alpha2"]), shares(known["r2"]))
    else:
        D = spread_by_mean(DIRECTIONS, mean, first)
    return made(path, time, f, S[:, None] * D, DIRECTIONS)


def kind_of(text: str) -> str:
    """The quantity in a buoy's file by its first line: alpha1, alpha2, r1, r2 or density."""
    head = text.partition("\n")[0].lower()
    found = re.search(r"\b(alpha[12]|r[12])_1\b", head)
    return found.group(1) if found else "density"


def files_beside(path: Path) -> dict[str, Path]:
    """The files of directions that belong to one of densities, by their quantity."""
    found = {kind: path.with_suffix(ending) for ending, kind in REALTIME.items()}
    history = HISTORY_NAME.match(path.name)
    if history is not None:
        found = {kind: path.with_name(history[1] + letter + history[2]) for letter, kind in HISTORY.items()}
    return {kind: other for kind, other in found.items() if other.is_file() and other != path}


def moment_at(path: Path, time: datetime.datetime, frequency: np.ndarray) -> np.ndarray | None:
    """Values (n,) of a file of directions at this time and these frequencies [Hz]; None without them.

    Where one is missing, it is that of the nearest frequency that has one.
    """
    records = records_of(read_text(path), path)
    if time not in records.time:
        return None
    values = records.values[records.time.index(time)]
    there = np.isfinite(values)
    if not there.any():
        return None
    near = np.abs(frequency[:, None] - records.frequency[there]).argmin(axis=1)
    return values[there][near]


def shares(r: np.ndarray) -> np.ndarray:
    """r1 or r2 from 0 to 1; files of past years have percents."""
    return np.clip(r / 100.0 if (r > 1.0).any() else r, 0.0, 1.0)


def records_of(text: str, path: Path) -> Records:
    """The rows of a buoy's file: `value (frequency)` in turn, or values under a line of frequencies.

    Raises ValueError that names the line.
    """
    lines = [(i, line.split()) for i, line in enumerate(text.splitlines(), start=1) if line.strip()]
    head = " ".join(lines[0][1]).lstrip("# ").split()
    clock = 5 if head[4:5] == ["mm"] else 4
    is_paired = any("(" in word for _, words in lines[:3] for word in words)
    frequency = None if is_paired else floats(head[clock:], path, 1)
    times, rows = [], []
    for number, words in lines[1:]:
        if words[0].startswith("#"):
            continue
        times.append(clock_time(words[:clock], path, number))
        values = words[clock:]
        if is_paired:
            values, places = paired(values, path, number)
            frequency = places if frequency is None else frequency
            if len(places) != len(frequency) or not np.array_equal(places, frequency):
                raise line_error(path, number, "the frequencies of the first row")
        found = floats(values, path, number)
        if frequency is None or len(found) != len(frequency):
            raise line_error(
                path, number, f"{0 if frequency is None else len(frequency)} values; here are {len(found)}"
            )
        rows.append(found)
    if not rows or frequency is None:
        raise argument_error("path", str(path), "a file with at least one record")
    values = np.array(rows)
    values[(values >= MISSING) | (values < 0.0)] = math.nan
    return Records(times, frequency, values)


def paired(words: list[str], path: Path, number: int) -> tuple[list[str], np.ndarray]:
    """Values and frequencies [Hz] of "0.1 (0.033) 0.2 (0.038)", maybe behind one number, the separation frequency."""
    words = words[len(words) % 2 :] if words and len(words) > 1 and not words[1].startswith("(") else words
    places = words[1::2]
    if len(words) % 2 or not all(word.startswith("(") and word.endswith(")") for word in places):
        raise line_error(path, number, "values with their frequencies, as 0.1 (0.033)")
    return words[::2], floats([word[1:-1] for word in places], path, number)


def clock_time(words: list[str], path: Path, number: int) -> datetime.datetime:
    """The time of a row. Raises ValueError that names the line."""
    try:
        year, month, day, hour, minute = (int(word) for word in [*words, "0"][:5])
        year += 0 if year >= 100 else 1900 if year >= 70 else 2000
        return datetime.datetime(year, month, day, hour, minute)
    except ValueError:
        raise line_error(path, number, "year, month, day, hour and minute") from None


def floats(words: list[str], path: Path, number: int) -> np.ndarray:
    """Numbers of a line; MM, as NDBC writes a missing one, is nan. Raises ValueError that names the line."""
    try:
        found = np.array([math.nan if word == "MM" else float(word) for word in words])
    except ValueError:
        raise line_error(path, number, "numbers") from None
    if np.isinf(found).any():
        raise line_error(path, number, "finite numbers")
    return found


def from_summary(text: str, path: Path, when: datetime.datetime | None) -> Spectrum[Any]:
    """Swell and wind sea of an NDBC summary (.spec), which has heights, periods and directions, and no spectrum.

    Both get the shape of JONSWAP with gamma 3.3 and the spreading cos2s.
    """
    lines = [(i, line.split()) for i, line in enumerate(text.splitlines(), start=1) if line.strip()]
    head = [word.strip("#") for word in lines[0][1]]
    times, rows = [], []
    for number, words in lines[1:]:
        if words[0].startswith("#"):
            continue
        if len(words) != len(head):
            raise line_error(path, number, f"{len(head)} columns; here are {len(words)}")
        row = dict(zip(head, words, strict=True))
        try:
            systems = [(row[h], row[p], row[d], s) for h, p, d, s in
                       (("SwH", "SwP", "SwD", SECOND_EXPONENT), ("WWH", "WWP", "WWD", WIND_SEA_EXPONENT))]  # fmt: skip
        except KeyError as missing:
            raise line_error(path, 1, f"the columns SwH SwP SwD WWH WWP WWD; {missing} is not here") from None
        whole = [one for one in systems if "MM" not in one[:2] and one[2] in COMPASS]
        if whole:
            times.append(clock_time(words[:5], path, number))
            rows.append((number, whole))
    if not rows:
        raise argument_error("path", str(path), "a summary with a record of swell or wind sea")
    i = nearest(times, when, path)
    number, systems = rows[i]
    f = SUMMARY_FREQUENCIES
    total = np.zeros((len(f), len(DIRECTIONS)))
    for height, period, bearing, s in systems:
        H, T = floats([height, period], path, number)
        if H > 0.0 and not 1.0 <= T <= 60.0:
            raise line_error(path, number, "periods of 1 to 60 s")
        mean = np.array([float(towards(np.array(22.5 * COMPASS.index(bearing))))])
        if H > 0.0:
            S = 2.0 * math.pi * peaked(2.0 * math.pi * f, H, 2.0 * math.pi / T, SECOND_PEAK)
            total += S[:, None] * spread_by_mean(DIRECTIONS, mean, np.array([s / (s + 1.0)]))
    return made(path, times[i], f, total, DIRECTIONS)
