"""Measured spectra from files: tables (CSV), text files of NDBC's buoys, and the formats that `wavespectra` reads.

    sea = Sea(256, 1500.0, read_spectrum("44013w2020.txt", "2020-01-02 05:00"))

Files have directions that waves come from, clockwise from north, and densities in m2/Hz, or m2/Hz/degree. They become
those that waves go to, from +x, which is east, towards +y, north.
"""

import datetime
import gzip
import importlib
import math
import os
import re
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.ocean.measured import measured_spectrum, spread_by_mean, spread_by_moments
from sim.ocean.spectra.record import SECOND_EXPONENT, SECOND_PEAK, Spectrum, peaked
from sim.validation import argument_error, check_kind, unreadable

MAX_BYTES = 100_000_000  # of a text file, unpacked
DIRECTIONS = np.radians(np.arange(0.0, 360.0, 2.5))  # of spreadings that are made of moments
MISSING = 999.0  # and above: what a buoy's file does not have
NEAREST = datetime.timedelta(hours=1.5)  # between the time that is asked for and a record of a file
REALTIME = {".swdir": "alpha1", ".swdir2": "alpha2", ".swr1": "r1", ".swr2": "r2"}  # endings of files beside .data_spec
HISTORY = {"d": "alpha1", "i": "alpha2", "j": "r1", "k": "r2"}  # letter in 44013w2020.txt, which is w for the density
HISTORY_NAME = re.compile(r"^(.{5})w(\w+\.txt(?:\.gz)?)$")
COMPASS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
WIND_SEA_EXPONENT = 10.0  # s of cos2s of wind waves (Goda 2010, Sec. 2.3)
SUMMARY_FREQUENCIES = np.geomspace(0.01, 5.0, 800)  # [Hz]
COLUMNS = {  # of a table with one row a frequency, by the letters and digits of its header
    "frequency": ("frequency", "freq", "f", "frequencyhz", "freqhz", "fhz"),
    "omega": ("omega", "w", "omegarads", "wrads"),
    "density": (
        "density",
        "s",
        "energy",
        "spectraldensity",
        "psd",
        "e",
        "variancedensity",
        "ef",
        "sm2hz",
        "densitym2hz",
    ),
    "alpha1": ("direction", "dir", "alpha1", "meandirection", "mwd", "theta", "a1", "mdir"),
    "r1": ("r1",),
    "spread": ("spread", "spreading", "spr", "directionalspread", "sigma"),
}
FORMS = "a table (CSV), an NDBC text file, or a file of WAVEWATCH III or SWAN (with `wavespectra`)"


class Records(NamedTuple):
    """Rows of a buoy's file, the newest last."""

    time: list[datetime.datetime]  # (n,)
    frequency: np.ndarray  # (m,) [Hz]
    values: np.ndarray  # (n, m), nan if missing


def read_spectrum(path: str | Path, time: str | None = None) -> Spectrum[Any]:
    """The spectrum in a file, or its record nearest to a time, "2020-01-02 05:00", by default its last one.

    With directions it has those of the file, else waves spread about the wind's direction. Raises ValueError for a file
    that holds none, in one line; ModuleNotFoundError without `wavespectra` or xarray, where the format needs them.
    """
    check_kind("path", path, str | os.PathLike, "the name of a file")
    path = Path(path)
    when = None if time is None else read_time(time)
    if path.suffix.lower() in (".nc", ".nc4", ".cdf"):
        return from_wavespectra(path, when)
    text = read_text(path)
    head = next((line for line in text.splitlines() if line.strip()), "")
    words = head.lstrip("# ").split()
    if head.lstrip("'\" ").upper().startswith(("SWAN", "WAVEWATCH")):
        return from_wavespectra(path, when)
    if words[:4] and words[0].strip("#") in ("YY", "YYYY") and words[1:3] == ["MM", "DD"]:
        return from_summary(text, path, when) if "SwH" in words else from_buoy(text, path, when)
    if when is not None:
        raise argument_error("time", time, "a time for a file with records of several times; this is a table of one")
    return from_table(text, path)


def read_time(text: str) -> datetime.datetime:
    """A time of day. Raises ValueError for what is none."""
    try:
        found = datetime.datetime.fromisoformat(str(text).strip())
    except ValueError:
        raise argument_error("time", text, "a time such as 2020-01-02 05:00") from None
    return found.replace(tzinfo=None) if found.tzinfo is None else found.astimezone(datetime.UTC).replace(tzinfo=None)


def read_text(path: Path) -> str:
    """The text of a file, also of one that gzip has packed. Raises ValueError where it cannot be read."""
    try:
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
        with gzip.open(path) if packed else path.open("rb") as file:
            found = file.read(MAX_BYTES + 1)
    except (EOFError, gzip.BadGzipFile, zlib.error):
        raise argument_error("path", str(path), f"{FORMS}; what gzip has packed is damaged here") from None
    except OSError as error:
        raise unreadable("path", path, error) from None
    if len(found) > MAX_BYTES or b"\0" in found:
        raise argument_error("path", str(path), FORMS)
    return found.decode("utf-8-sig", errors="replace")


def titled(path: Path, time: datetime.datetime | None) -> str:
    """The name of a spectrum: file and time."""
    return path.name if time is None else f"{path.name}, {time:%Y-%m-%d %H:%M}"


def towards(degrees: np.ndarray) -> np.ndarray:
    """Where waves go to [rad] from +x towards +y, that come from these degrees, clockwise from north."""
    return np.radians(270.0 - np.asarray(degrees))


def made(path: Path, time: datetime.datetime | None, *given: Any) -> Spectrum[Any]:
    """`measured_spectrum` of these arrays. Raises ValueError that names the file."""
    try:
        return measured_spectrum(*given, name=titled(path, time))
    except ValueError as error:
        raise ValueError(f"path: {path}: {error}") from None


def nearest(times: list[datetime.datetime], when: datetime.datetime | None, path: Path) -> int:
    """Index of the record nearest to a time, or of the last one. Raises ValueError where none is near."""
    if when is None:
        return max(range(len(times)), key=times.__getitem__)
    i = min(range(len(times)), key=lambda j: abs(times[j] - when))
    if abs(times[i] - when) > NEAREST:
        allowed = f"{min(times):%Y-%m-%d %H:%M} to {max(times):%Y-%m-%d %H:%M}, near a record of {path.name}"
        raise argument_error("time", f"{when:%Y-%m-%d %H:%M}", allowed)
    return i


# --- buoys ---


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
    density = Records([t for t, there in zip(density.time, whole, strict=True) if there], density.frequency,
                      density.values[whole])  # fmt: skip
    i = nearest(density.time, when, path)
    time, there = density.time[i], np.isfinite(density.values[i])
    f, S = density.frequency[there], density.values[i][there]
    order = np.argsort(f)
    f, S = f[order], S[order]
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
    """What a buoy's file holds, alpha1, alpha2, r1, r2 or density, by the words of its first line."""
    head = text.partition("\n")[0].lower()
    found = re.search(r"\b(alpha[12]|r[12])_1\b", head)
    return found.group(1) if found else "density"


def files_beside(path: Path) -> dict[str, Path]:
    """The files of directions that belong to one of densities, by what they hold."""
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


def line_error(path: Path, number: int, allowed: str) -> ValueError:
    """The error of a line."""
    return argument_error("path", f"{path}, line {number}", allowed)


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


# --- tables ---


def from_table(text: str, path: Path) -> Spectrum[Any]:
    """The spectrum of a table with one row a frequency.

    Columns by name, or frequency and density without names; or a first row of directions, and densities over both.
    """
    rows = table_rows(text)
    if len(rows) < 3:
        raise argument_error("path", str(path), FORMS)
    number, head = rows[0]
    numeric = [is_number(word) for word in head]
    if len(head) > 4 and all(numeric[1:]) and (not numeric[0] or len(head) > len(COLUMNS)):
        return from_matrix(rows, path)
    if all(numeric):
        if len(head) != 2:
            raise line_error(path, number, "two columns, frequency [Hz] and density [m2/Hz], or names of columns")
        names, body = ["frequency", "density"], rows
    else:
        names, body = [column_of(word) for word in head], rows[1:]
    if not {"density"} < set(names) or not {"frequency", "omega"} & set(names):
        raise line_error(
            path, number, "the columns frequency [Hz] and density [m2/Hz]; and direction and spread, or r1"
        )
    values = np.array([numbers_of(words, path, line, len(names), names) for line, words in body])
    columns = {name: values[:, i] for i, name in enumerate(names) if name}
    f = columns["frequency"] if "frequency" in columns else columns["omega"] / (2.0 * math.pi)
    S = columns["density"] * (1.0 if "frequency" in columns else 2.0 * math.pi)
    order = np.argsort(f)
    columns = {name: column[order] for name, column in columns.items()}
    f, S = f[order], S[order]
    if "alpha1" not in columns or not {"r1", "spread"} & columns.keys():
        return made(path, None, f, S)
    # the spread of a buoy is sqrt(2 - 2 r1), Kuik, van Vledder, Holthuijsen 1988, J. Phys. Oceanogr. 18:1020
    r1 = columns["r1"] if "r1" in columns else 1.0 - 0.5 * np.radians(columns["spread"]) ** 2
    return made(
        path, None, f, S[:, None] * spread_by_mean(DIRECTIONS, towards(columns["alpha1"]), shares(r1)), DIRECTIONS
    )


def from_matrix(rows: list[tuple[int, list[str]]], path: Path) -> Spectrum[Any]:
    """The spectrum of rows of densities [m2/Hz/degree] behind a frequency, under a row of directions [degrees]."""
    number, head = rows[0]
    degrees = numbers_of(head[1:], path, number, len(head) - 1)
    values = np.array([numbers_of(words, path, line, len(head)) for line, words in rows[1:]])
    values = values[np.argsort(values[:, 0])]
    return made(path, None, values[:, 0], values[:, 1:] * (180.0 / math.pi), towards(degrees))


def table_rows(text: str) -> list[tuple[int, list[str]]]:
    """(number, words) of the lines of a table, without comments. Semicolons and tabs allow decimal commas."""
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith(("#", "%", "//")):
            continue
        mark = next((mark for mark in (";", "\t", ",") if mark in line), None)
        words = [word.strip().strip('"') for word in line.split(mark)]
        rows.append((number, words if mark == "," else [w.replace(",", ".") if is_number(w.replace(",", ".")) else w
                                                        for w in words]))  # fmt: skip
    return rows


def is_number(word: str) -> bool:
    """True for the text of a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def column_of(word: str) -> str:
    """The name of a column by its header, "" for another one."""
    letters = re.sub(r"[^a-z0-9]", "", re.sub(r"[\[(].*?[\])]", "", word.lower()))
    return next((name for name, known in COLUMNS.items() if letters in known), "")


def numbers_of(words: list[str], path: Path, number: int, count: int, names: list[str] | None = None) -> np.ndarray:
    """The numbers (count,) of a row of a table; nan for the words of columns without a name, where these are known.

    Raises ValueError that names the line.
    """
    if len(words) != count:
        raise line_error(path, number, f"{count} columns; here are {len(words)}")
    if not all(is_number(word) for i, word in enumerate(words) if names is None or names[i]):
        raise line_error(path, number, "numbers")
    return np.array([float(word) if is_number(word) else math.nan for word in words])


# --- other programs ---


def from_wavespectra(path: Path, when: datetime.datetime | None) -> Spectrum[Any]:
    """The spectrum of a file of WAVEWATCH III or SWAN: its first place, and the time asked for, or the last one."""
    if not path.is_file():
        raise unreadable("path", path, FileNotFoundError())
    wavespectra: Any = importlib.import_module("wavespectra")  # optional, and slow to import
    try:
        data = opened(wavespectra, path)
        data = data.isel({axis: 0 for axis in data.dims if axis not in ("time", "freq", "dir")})
        time, i = None, 0
        if "time" in data.dims:
            times = [datetime.datetime.fromisoformat(str(one)[:19]) for one in data["time"].values]
            i = nearest(times, when, path)
            data, time = data.isel(time=i), times[i]
        f = np.asarray(data["freq"].values, float)
        if "dir" not in data.dims or data.sizes["dir"] < 2:
            return made(path, time, f, np.asarray(data.squeeze().values, float))
        density = np.asarray(data.transpose("freq", "dir").values, float) * (180.0 / math.pi)
        degrees = np.asarray(data["dir"].values, float)
        _, once = np.unique(np.mod(degrees, 360.0), return_index=True)
        return made(path, time, f, density[:, once], towards(degrees[once]))
    except ValueError as error:
        if str(error).startswith(("path: ", "time: ")):
            raise
        raise refused(path, error) from error
    except Exception as error:  # its readers raise errors of many types
        raise refused(path, error) from error


def refused(path: Path, error: Exception) -> ValueError:
    """The error of a file that `wavespectra` cannot read."""
    reason = " ".join(str(error).partition("\n")[0].split()) or type(error).__name__
    return argument_error("path", str(path), f"{FORMS} ({reason[:120]})")


def opened(wavespectra: Any, path: Path) -> Any:
    """The densities [m2/Hz/degree] of a file, along freq, dir [degrees that waves come from] and maybe time."""
    readers: list[Callable[..., Any]] = []
    if path.suffix.lower() in (".nc", ".nc4", ".cdf"):
        import xarray

        with xarray.open_dataset(path) as file:
            names = {*map(str, file.variables), *map(str, file.dims)}
        ours = {"freq", "efth"} <= names
        readers = [
            wavespectra.read_netcdf if ours else wavespectra.read_ww3 if "efth" in names else wavespectra.read_ncswan
        ]
    else:
        head = read_text(path)[:40].lstrip("'\" ").upper()
        readers = [wavespectra.read_swan if head.startswith("SWAN") else wavespectra.read_ww3_station]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return readers[0](str(path))["efth"].load()
