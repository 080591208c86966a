"""Text files of single instruments: Datawell's buoys (.spt) and Nortek's AWAC (lines of NMEA)."""

import datetime
import functools
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.records.measured import spread_by_moments
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.contents import DIRECTIONS, MAGNETIC, SpectrumSeries, filled, made, towards
from sim.ocean.spectrum_files.tables import MEANINGS, from_columns
from sim.tables import Row, line_error, number_of, read_columns, split_rows
from sim.validation import argument_error

DATAWELL_HEAD, LARGEST = 12, 3  # lines before the rows of frequencies; that of the largest density
DATAWELL_COLUMNS = ["frequency", "density", "direction (deg)", "spread (deg)", "skewness", "kurtosis"]
DATAWELL_TIME = re.compile(r"\}(\d{4}-\d\d-\d\d)T(\d\d)h(\d\d)")  # in the name of a file
AWAC_DENSITY, AWAC_MOMENTS = "$PNORE", "$PNORF"
CM2 = 1e-4  # [m2]

Values = tuple[np.ndarray, np.ndarray]  # frequencies (n,) [Hz], and values (n,) at them


def is_datawell(text: str) -> bool:
    """True for twelve lines of one number, and rows of six behind them."""
    lines = text.splitlines()[: DATAWELL_HEAD + 1]
    return (
        len(lines) > DATAWELL_HEAD
        and all(number_of(line.strip()) is not None for line in lines[:DATAWELL_HEAD])
        and lines[DATAWELL_HEAD].count(",") == len(DATAWELL_COLUMNS) - 1
    )


def from_datawell(text: str, path: Path) -> Spectrum[Any]:
    """The spectrum of a .spt file: densities over the largest one, directions that waves come from, and spreads.

    Datawell, File formats (2013), section .spt. The time is in the name of the file.
    """
    lines = text.splitlines()
    largest = number_of(lines[LARGEST].strip())
    if largest is None or not largest > 0.0:
        raise line_error(path, LARGEST + 1, "the largest density, above 0 m2/Hz")
    rows, _ = split_rows("\n" * DATAWELL_HEAD + "\n".join(lines[DATAWELL_HEAD:]), path)
    table = read_columns([Row(DATAWELL_HEAD, DATAWELL_COLUMNS), *rows], [], path, MEANINGS, ("frequency", "density"))
    density = table.columns["density"]
    table.columns["density"] = density._replace(values=density.values * largest)
    match = DATAWELL_TIME.search(path.name)
    time = datetime.datetime.fromisoformat(f"{match[1]} {match[2]}:{match[3]}") if match else None
    return from_columns(table._replace(notes=(MAGNETIC,)), path, time)


def from_awac(text: str, path: Path) -> SpectrumSeries:
    """The spectra of lines $PNORE (densities [cm2/Hz]) and $PNORF (Fourier coefficients of directions from).

    Nortek, Integrator's Guide AWAC, NMEA format. A coefficient of -9 is missing.
    """
    densities: dict[datetime.datetime, Values] = {}
    moments: dict[datetime.datetime, dict[str, Values]] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.strip().partition("*")[0].split(",")
        if words[0] == AWAC_DENSITY:
            time, f, values = awac_line(words[1:], path, number)
            densities[time] = f, CM2 * values
        elif words[0] == AWAC_MOMENTS and len(words) > 1:
            time, f, values = awac_line(words[2:], path, number)
            moments.setdefault(time, {})[words[1]] = f, np.where(np.abs(values) <= 1.0, values, np.nan)
    if not densities:
        raise argument_error("path", str(path), f"lines {AWAC_DENSITY} with the densities of an AWAC")
    times = sorted(densities)
    at = functools.partial(spectrum_of, path, densities, moments, times)
    return SpectrumSeries(path, times, at, [True] * len(times))


def spectrum_of(
    path: Path,
    densities: Mapping[datetime.datetime, Values],
    moments: Mapping[datetime.datetime, Mapping[str, Values]],
    times: Sequence[datetime.datetime],
    i: int,
) -> Spectrum[Any]:
    """The spectrum of one of the times, with directions if it has all four coefficients."""
    f, S = densities[times[i]]
    parts = moments.get(times[i], {})
    if not {"A1", "B1", "A2", "B2"} <= parts.keys():
        return made(path, times[i], f, S, notes=[f"no directions: they need {AWAC_MOMENTS} of A1, B1, A2 and B2"])
    a1, b1, a2, b2 = (filled(f, *parts[name]) for name in ("A1", "B1", "A2", "B2"))
    if not np.isfinite([a1, b1, a2, b2]).all():
        return made(path, times[i], f, S, notes=["no directions: the Fourier coefficients are missing"])
    D = spread_by_moments(
        DIRECTIONS, towards(np.degrees(np.arctan2(b1, a1))), np.hypot(a1, b1),
        towards(0.5 * np.degrees(np.arctan2(b2, a2))), np.minimum(np.hypot(a2, b2), 1.0),
    )  # fmt: skip
    return made(path, times[i], f, S[:, None] * D, DIRECTIONS, notes=[MAGNETIC])


def awac_line(words: list[str], path: Path, number: int) -> tuple[datetime.datetime, np.ndarray, np.ndarray]:
    """Time, frequencies (n,) [Hz] and values (n,) of MMDDYY, hhmmss, kind, start, step, n, values."""
    row = [number_of(word.strip()) for word in words[3:]]
    try:
        time = datetime.datetime.strptime(words[0] + words[1].partition(".")[0], "%m%d%y%H%M%S")
        start, step, count, *values = row
        if None in row or count != len(values) or not step:  # pyright: ignore
            raise ValueError
    except (ValueError, IndexError):
        raise line_error(path, number, "date, time, kind, first frequency, step, number and as many values") from None
    numbers = np.array(values, float)
    return time, start + step * np.arange(len(numbers)), numbers  # pyright: ignore
