"""Text files of NDBC's buoys: densities, the four moments of their directions, summaries, and heights and periods.

https://www.ndbc.noaa.gov/faq/measdes.shtml describes them: alpha1 and alpha2 are directions that waves come from.
"""

import datetime
import functools
import math
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.ocean.records.measured import spread_by_mean, spread_by_moments
from sim.ocean.spectra.record import SECOND_EXPONENT, SECOND_PEAK, Spectrum, peaked
from sim.ocean.spectrum_files.contents import DIRECTIONS, FORMS, SpectrumSeries, filled, made, towards
from sim.ocean.spectrum_files.sea_summary import COMPASS
from sim.tables import line_error, read_text, values_of
from sim.validation import argument_error

REALTIME = {".swdir": "alpha1", ".swdir2": "alpha2", ".swr1": "r1", ".swr2": "r2"}  # endings of files beside .data_spec
HISTORY = {"d": "alpha1", "i": "alpha2", "j": "r1", "k": "r2"}  # letter in 44013w2020.txt, which is w for the density
HISTORY_NAME = re.compile(r"^(.{5})([a-z])(\d{4}\w*\.txt(?:\.gz)?)$")  # station, letter, year
LARGEST = 30.0  # [m2/Hz] that whole numbers in a file of unknown letter may be densities
MISSING = (999.0, 9999.0)  # for what is missing, of any kind
MISSING_SEA = (99.0, *MISSING)  # of a height or a period; densities and shares of 99 may be values, too
NEAR = 2.0  # ratio of a density of 99 to those beside it, up to which it is a value like them
TURN, PERCENT = 360.0, 100.0  # largest values of alpha1, alpha2, and of r1, r2
WIND_SEA_EXPONENT = 10.0  # s of cos2s of wind waves (Goda 2010, Sec. 2.3)
# Files of heights and periods: columns of height [m], period [s] and direction, and s of the spreading.
SUMMARIES: dict[str, tuple[tuple[Any, ...], ...]] = {
    "an NDBC summary": (
        ("SwH", "SwP", "SwD", SECOND_EXPONENT), ("WWH", "WWP", "WWD", WIND_SEA_EXPONENT),
    ),
    "standard meteorological data of NDBC": (("WVHT", "DPD", "MWD", WIND_SEA_EXPONENT),),
}  # fmt: skip
SUMMARY_FREQUENCIES = np.geomspace(0.01, 5.0, 800)  # [Hz]


class Records(NamedTuple):
    """Rows of a buoy's file."""

    time: list[datetime.datetime]  # (n,)
    frequency: np.ndarray  # (m,) [Hz]
    values: np.ndarray  # (n, m), nan if missing
    row: dict[datetime.datetime, int]  # of each time the first


def from_buoy(text: str, path: Path) -> SpectrumSeries:
    """The spectra of an NDBC file of densities, with the directions of the files beside it."""
    density = records_of(text, path)
    density = density._replace(values=without_99(density.values))
    kind = kind_of(text, path, density)
    if kind != "density":
        raise argument_error("path", str(path), f"{file_of_densities(path)}; this is of {kind}")
    whole = np.isfinite(density.values).sum(axis=1) >= 3
    if not whole.any():
        raise argument_error("path", str(path), "a file with a record of at least three densities")
    moments = {kind: moments_of(other, kind) for kind, other in files_beside(path).items()}
    return SpectrumSeries(path, density.time, functools.partial(spectrum_of, path, density, moments), whole)


def spectrum_of(path: Path, density: Records, moments: Mapping[str, Records], i: int) -> Spectrum[Any]:
    """The spectrum of a row of densities; moments: the files of directions, by their quantity."""
    time, there = density.time[i], np.isfinite(density.values[i])
    order = np.argsort(density.frequency[there])
    f, S = density.frequency[there][order], density.values[i][there][order]
    by_kind = {kind: moment_at(records, time, f) for kind, records in moments.items()}
    known = {kind: values for kind, values in by_kind.items() if values is not None}
    if not {"alpha1", "r1"} <= known.keys():
        needed = "no directions: they need the files of alpha1 and of r1 at the same time"
        return made(path, time, f, S, notes=[needed] if known else [])
    mean, first = towards(known["alpha1"]), shares(known["r1"])
    if {"alpha2", "r2"} <= known.keys():
        D = spread_by_moments(DIRECTIONS, mean, first, towards(known["alpha2"]), shares(known["r2"]))
    else:
        D = spread_by_mean(DIRECTIONS, mean, first)
    return made(path, time, f, S[:, None] * D, DIRECTIONS)


def kind_of(text: str, path: Path, records: Records) -> str:
    """The quantity in a buoy's file: by its first line, by the letter in its name, or by its values."""
    head = text.partition("\n")[0].lower()
    match = re.search(r"\b(alpha[12]|r[12])_1\b", head)
    if match is not None:
        return match.group(1)
    history = HISTORY_NAME.match(path.name)
    if history is not None and history[2] in HISTORY:
        return HISTORY[history[2]]
    values = records.values[np.isfinite(records.values)]
    # degrees and percents are whole numbers, and no sea has only such densities
    if len(values) and (values == np.rint(values)).all() and LARGEST < values.max() <= TURN:
        return "directions, or of r1 or r2, as its values are whole numbers"
    return "density"


def file_of_densities(path: Path) -> str:
    """The file that is meant, for messages."""
    history = HISTORY_NAME.match(path.name)
    name = f"{history[1]}w{history[3]}" if history is not None else ".data_spec or .swden, or w in its name"
    return f"the file of densities ({name})"


def files_beside(path: Path) -> dict[str, Path]:
    """The files of directions that belong to one of densities, by their quantity."""
    candidates = {kind: path.with_suffix(ending) for ending, kind in REALTIME.items()}
    history = HISTORY_NAME.match(path.name)
    if history is not None:
        candidates = {kind: path.with_name(history[1] + letter + history[3]) for letter, kind in HISTORY.items()}
    return {kind: other for kind, other in candidates.items() if other.is_file() and other != path}


def moments_of(path: Path, kind: str) -> Records:
    """The rows of a file of directions, or of r1 or r2, which belongs to one of densities.

    Raises ValueError for values impossible for this kind, as in files with exchanged names.
    """
    records = records_of(read_text(path, FORMS), path)
    if kind.startswith("r") and not (records.values[records.values != 99.0] > 1.0).any():  # no percents
        records = records._replace(values=np.where(records.values == 99.0, math.nan, records.values))
    largest = TURN if kind.startswith("alpha") else PERCENT
    if (records.values > largest).any():
        raise argument_error(
            "path", str(path), f"a file of {kind}, up to {largest:g}, not {np.nanmax(records.values):g}"
        )
    return records


def moment_at(records: Records, time: datetime.datetime, frequency: np.ndarray) -> np.ndarray | None:
    """Values (n,) at this time and these frequencies [Hz]; None without a record of it.

    A missing value is that of the nearest frequency with one.
    """
    i = records.row.get(time)
    if i is None or not np.isfinite(records.values[i]).any():
        return None
    return filled(frequency, records.frequency, records.values[i])


def shares(r: np.ndarray) -> np.ndarray:
    """r1 or r2 from 0 to 1; files of past years have percents."""
    return np.clip(r / PERCENT if (r > 1.0).any() else r, 0.0, 1.0)


def records_of(text: str, path: Path) -> Records:
    """The rows of a buoy's file: `value (frequency)` in turn, or values under a line of frequencies.

    Raises ValueError that names the line.
    """
    head, clock, lines = parts_of(text)
    is_paired = any("(" in word for words in (head, *(words for _, words in lines[:1])) for word in words)
    frequency = None if is_paired else floats(head[clock:], path, 1)
    times, rows = [], []
    for number, words in lines:
        times.append(clock_time(words[:clock], path, number))
        values = words[clock:]
        if is_paired:
            values, places = paired(values, path, number)
            frequency = places if frequency is None else frequency
            if len(places) != len(frequency) or not np.array_equal(places, frequency):
                raise line_error(path, number, "the frequencies of the first row")
        numbers = floats(values, path, number)
        if frequency is None or len(numbers) != len(frequency):
            raise line_error(path, number, f"{0 if frequency is None else len(frequency)} values, not {len(numbers)}")
        rows.append(numbers)
    if not rows or frequency is None:
        raise argument_error("path", str(path), "a file with at least one record")
    values = np.array(rows)
    values[values < 0.0] = math.nan
    return Records(times, frequency, values, {time: i for i, time in reversed(list(enumerate(times)))})


def parts_of(text: str) -> tuple[list[str], int, list[tuple[int, list[str]]]]:
    """The words of a table's head, how many of them are the clock, and the numbers and words of the lines below.

    Lines that are empty or a comment are left out.
    """
    lines = [(i, line.split()) for i, line in enumerate(text.splitlines(), start=1) if line.strip()]
    head = " ".join(lines[0][1]).lstrip("# ").split() if lines else []
    return head, 5 if head[4:5] == ["mm"] else 4, [line for line in lines[1:] if not line[1][0].startswith("#")]


def paired(words: list[str], path: Path, number: int) -> tuple[list[str], np.ndarray]:
    """Values and frequencies [Hz] of "0.1 (0.033) 0.2 (0.038)", optionally after the separation frequency."""
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


def floats(words: list[str], path: Path, number: int, missing: Collection[float] = MISSING) -> np.ndarray:
    """Numbers of a line, nan where one is missing. Raises ValueError that names the line.

    missing: numbers that NDBC writes for a missing value of this kind.
    """
    numbers, wrong = values_of(words, missing)
    if wrong is not None:
        raise line_error(path, number, "numbers")
    return numbers


def without_99(values: np.ndarray) -> np.ndarray:
    """Densities (n, m), nan in place of a 99, NDBC's other sign of a missing one, that those beside it are not near."""
    densities = values.copy()
    for row, column in np.argwhere(values == 99.0):
        line = values[row]
        whole = np.flatnonzero(np.isfinite(line) & (line != 99.0))
        at = int(np.searchsorted(whole, column))
        beside = line[whole[max(at - 1, 0) : at + 1]]
        if not len(beside) or (beside * NEAR < 99.0).any() or (beside > NEAR * 99.0).any():
            densities[row, column] = math.nan
    return densities


def from_summary(text: str, path: Path) -> SpectrumSeries:
    """Heights, periods and directions of a file without a spectrum, in the shape of JONSWAP with gamma 3.3.

    Those are swell and wind sea of an NDBC summary (.spec), or WVHT, DPD and MWD of standard meteorological data. They
    spread as cos2s.
    """
    head, clock, lines = parts_of(text)
    kind = next((one for one in SUMMARIES if set(SUMMARIES[one][0][:2]) <= set(head)), None)
    if kind is None:
        raise argument_error("path", str(path), f"{file_of_densities(path)}; this has no waves: {' '.join(head)[:80]}")
    times, rows = [], []
    for number, words in lines:
        if len(words) != len(head):
            raise line_error(path, number, f"{len(head)} columns, not {len(words)}")
        row = dict(zip(head, words, strict=True))
        try:
            row_systems = [system_of([row[one] for one in columns], s, path, number) for *columns, s in SUMMARIES[kind]]
        except KeyError as missing:
            raise line_error(path, 1, f"the columns of {kind}; {missing} is not here") from None
        times.append(clock_time(words[:clock], path, number))
        rows.append([system for system in row_systems if system is not None])
    if not any(rows):
        raise argument_error("path", str(path), f"{kind} with a record of waves")
    return SpectrumSeries(
        path,
        times,
        functools.partial(spectrum_of_systems, path, kind, times, rows),
        [bool(systems) for systems in rows],
    )


def spectrum_of_systems(
    path: Path,
    kind: str,
    times: Sequence[datetime.datetime],
    rows: Sequence[Sequence[tuple[np.ndarray, np.ndarray | None, float]]],
    i: int,
) -> Spectrum[Any]:
    """The spectrum of a row of a summary, from the `system_of` of each of its systems."""
    f, notes = SUMMARY_FREQUENCIES, [f"{kind}, without a spectrum: heights and periods in the shape of JONSWAP"]
    going = [(S, mean, np.array([s / (s + 1.0)])) for S, mean, s in rows[i] if mean is not None]
    if len(going) < len(rows[i]):
        return made(path, times[i], f, sum(S for S, _, _ in rows[i]), notes=notes)
    total = sum(S[:, None] * spread_by_mean(DIRECTIONS, mean, first) for S, mean, first in going)
    return made(path, times[i], f, total, DIRECTIONS, notes=notes)


def system_of(
    words: list[str], exponent: float, path: Path, number: int
) -> tuple[np.ndarray, np.ndarray | None, float] | None:
    """S [m2/Hz] of SUMMARY_FREQUENCIES, where it goes to (1,) [rad] and s, of height, period and direction.

    The direction is of the compass or in degrees; None if it is missing. None for waves that are missing.
    """
    # each by itself: they are no neighbours
    H, T = (float(floats([word], path, number, MISSING_SEA)[0]) for word in words[:2])
    if not (math.isfinite(H) and math.isfinite(T)):
        return None
    if H > 0.0 and not 1.0 <= T <= 60.0:
        raise line_error(path, number, "periods of 1 to 60 s")
    bearing = 22.5 * COMPASS.index(words[2]) if words[2] in COMPASS else float(values_of(words[2:3], MISSING)[0][0])
    if not bearing <= TURN and not math.isnan(bearing):
        raise line_error(path, number, f"directions of 0 to {TURN:g} degrees")
    f = SUMMARY_FREQUENCIES
    S = np.zeros(len(f))
    if H > 0.0:
        S = 2.0 * math.pi * peaked(2.0 * math.pi * f, H, 2.0 * math.pi / T, SECOND_PEAK)
    return S, None if math.isnan(bearing) else np.array([float(towards(np.array(bearing)))]), exponent
