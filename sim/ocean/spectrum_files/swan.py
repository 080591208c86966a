"""Spectral files of SWAN: one or two dimensions, several places and times (SWAN User Manual, Appendix D).

Places without data, such as dry ones, are skipped.
"""

import datetime
import functools
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.ocean.records.measured import spread_by_mean
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.contents import DIRECTIONS, SpectrumSeries, filled, made, unrepeated
from sim.tables import line_error, number_of
from sim.tables.columns import WEIGHT
from sim.tables.headers import convention_of
from sim.validation import argument_error

PLACES, FREQUENCIES = ("LOCATIONS", "LONLAT"), ("AFREQ", "RFREQ")
CONVENTIONS = {"NDIR": convention_of(["north", "from"]), "CDIR": convention_of(["axis", "to"])}
NO_DATA = ("NODATA", "ZERO")
MAX_LISTED = 10  # places in a message
MAX_COUNT = 1_000_000  # of places, frequencies or directions
UNITS = {"m2/hz": 1.0, "j/m2/hz": 1.0 / WEIGHT, "m2/hz/degr": 180.0 / math.pi, "j/m2/hz/degr": 180.0 / math.pi / WEIGHT}


class Lines:
    """The lines of a file that are no comments, one after the other."""

    def __init__(self, text: str, path: Path) -> None:
        """All lines are ahead."""
        self.path = path
        self.rows = [(i, words) for i, line in enumerate(text.splitlines(), 1)
                     if (words := line.split()) and not line.lstrip().startswith("$")]  # fmt: skip
        self.at = 0

    @property
    def key(self) -> str:
        """The first word of the line that comes next, in capitals; "" at the end."""
        return self.rows[self.at][1][0].upper() if self.at < len(self.rows) else ""

    def next(self) -> list[str]:
        """The words of the next line. Raises ValueError at the end of the file."""
        if self.at >= len(self.rows):
            raise argument_error("path", str(self.path), "a whole file of SWAN; it ends early")
        self.at += 1
        return self.rows[self.at - 1][1]

    def error(self, allowed: str) -> ValueError:
        """The error of the line that was read last."""
        return line_error(self.path, self.rows[max(self.at - 1, 0)][0], allowed)

    def numbers(self, count: int) -> list[float]:
        """The first numbers of the next line. Raises ValueError that names it."""
        numbers = [number_of(word) for word in self.next()[:count]]
        if len(numbers) < count or any(one is None or math.isinf(one) for one in numbers):
            raise self.error(f"{count} numbers")
        return [one for one in numbers if one is not None]

    def count(self) -> int:
        """The whole number of the next line."""
        number = self.numbers(1)[0]
        if number != int(number) or not 1 <= number <= MAX_COUNT:
            raise self.error(f"a whole number from 1 to {MAX_COUNT}")
        return int(number)


class SwanHead(NamedTuple):
    """The part of a file before its spectra."""

    has_times: bool
    places: list[list[float]]  # x, y [m], or longitude and latitude [degrees]
    frequency: np.ndarray  # (n,) [Hz]
    directions: np.ndarray | None  # (m,) [rad] where waves go to, of a file of two dimensions
    quantities: list[tuple[str, str, float]]  # name, unit and the value for missing data


def from_swan(text: str, path: Path, place: int | None) -> Spectrum[Any] | SpectrumSeries:
    """The spectra at a place, counted from 1, or at the first one with data at any time; the only one without times.

    Raises ValueError that names the line.
    """
    lines = Lines(text, path)
    head = read_head(lines)
    if place is not None and not 1 <= place <= len(head.places):
        raise argument_error("place", place, f"1 to {len(head.places)}, the places of {path.name}")
    starts: list[int] = []  # of the spectra of each time
    times: list[datetime.datetime] = []
    blocks: list[list[bool]] = []  # of each time: which places have data
    while lines.key:
        if head.has_times:
            times.append(time_of(lines))
        starts.append(lines.at)
        blocks.append([skip_block(lines, head) for _ in head.places])
    has_data = np.array(blocks, bool).reshape(-1, len(head.places))
    if not has_data.any():
        raise argument_error("path", str(path), "a file of SWAN with data at one of its places")
    number = int(has_data.any(axis=0).argmax()) + 1 if place is None else place
    there = has_data[:, number - 1]
    if not there.any():
        raise argument_error("place", number, f"a place of {path.name} with data")
    at = functools.partial(spectrum_at, lines, head, number, starts, times)
    if not head.has_times:
        return at(0)
    return SpectrumSeries(path, times, at, there, functools.partial(without_data, has_data, number, times))


def without_data(has_data: np.ndarray, number: int, times: Sequence[datetime.datetime], i: int) -> ValueError:
    """The error of place `number` without data at one of the times; has_data (times, places)."""
    others = ", ".join(str(one + 1) for one in np.flatnonzero(has_data[i])[:MAX_LISTED]) or "none"
    return argument_error("place", number, f"a place with data at {times[i]:%Y-%m-%d %H:%M}: {others}")


def spectrum_at(
    lines: Lines, head: SwanHead, number: int, starts: Sequence[int], times: Sequence[datetime.datetime], i: int
) -> Spectrum[Any]:
    """The spectrum at place `number`; i: of the time, whose spectra start at `starts` in the lines."""
    lines.at = starts[i]
    for _ in range(number - 1):
        skip_block(lines, head)
    block, notes = read_block(lines, head)
    return spectrum_of(block, head, number, lines.path, times[i] if head.has_times else None, notes)


def read_head(lines: Lines) -> SwanHead:
    """Everything before the first spectrum."""
    lines.next()
    has_times = lines.key == "TIME"
    if has_times:
        lines.next()
        lines.next()
    if lines.key not in PLACES:
        lines.next()
        raise lines.error("LOCATIONS or LONLAT")
    lines.next()
    places = [lines.numbers(2) for _ in range(lines.count())]
    if lines.key not in FREQUENCIES:
        lines.next()
        raise lines.error("AFREQ or RFREQ")
    lines.next()
    frequency = np.array([lines.numbers(1)[0] for _ in range(lines.count())])
    directions = None
    if lines.key in CONVENTIONS:
        convention = CONVENTIONS[lines.next()[0].upper()]
        directions = convention.towards(np.radians([lines.numbers(1)[0] for _ in range(lines.count())]))
    if lines.key != "QUANT":
        lines.next()
        raise lines.error("QUANT")
    lines.next()
    quantities = []
    for _ in range(lines.count()):
        quantities.append((lines.next()[0].upper(), lines.next()[0].lower(), lines.numbers(1)[0]))
    if quantities[0][0] not in ("VADENS", "ENDENS") or quantities[0][1] not in UNITS:
        raise lines.error("the density VaDens or EnDens first, in m2/Hz or J/m2/Hz, with /degr where directions are")
    return SwanHead(has_times, places, frequency, directions, quantities)


def time_of(lines: Lines) -> datetime.datetime:
    """The time in the next line, as 20210305.044000."""
    word = lines.next()[0]
    try:
        if not re.fullmatch(r"\d{8}\.\d{6}", word):
            raise ValueError
        return datetime.datetime.strptime(word, "%Y%m%d.%H%M%S")
    except ValueError:
        raise lines.error("a time such as 20210305.044000") from None


def skip_block(lines: Lines, head: SwanHead) -> bool:
    """Skip the spectrum of one place; True if it has data."""
    if lines.next()[0].upper() in NO_DATA:
        return False
    lines.at += len(head.frequency) + (head.directions is not None)
    if lines.at > len(lines.rows):
        lines.next()  # raises
    return True


def read_block(lines: Lines, head: SwanHead) -> tuple[np.ndarray, list[str]]:
    """The values of a place with data (n, m), nan for rows without values; and a line on those that are missing.

    A marker of missing values that is 0 is a density of 0.
    """
    first = lines.next()[0].upper()
    if head.directions is None:
        if first != "LOCATION":
            raise lines.error("LOCATION and its number, or NODATA")
        rows = np.array([lines.numbers(len(head.quantities)) for _ in head.frequency])
        is_empty = np.isclose(rows[:, 0], head.quantities[0][2]) | (rows[:, 0] == 0.0)
        for i, (_, _, none) in enumerate(head.quantities):
            marked = np.isclose(rows[:, i], none)
            # 0 degrees is a direction, too
            rows[(marked & is_empty if none == 0.0 else marked) & ((none != 0.0) | (i > 0)), i] = math.nan
        return rows, []
    if first != "FACTOR":
        raise lines.error("FACTOR, ZERO or NODATA")
    factor = lines.numbers(1)[0]
    rows = np.array([lines.numbers(len(head.directions)) for _ in head.frequency])
    none = head.quantities[0][2]
    lost = np.isclose(rows, none) & (none != 0.0)
    some = lost & ~lost.all(axis=1, keepdims=True)
    rows[lost.all(axis=1)] = math.nan
    rows[some] = 0.0
    return factor * rows, [missing_line(rows, some, head)] if some.any() else []


def missing_line(rows: np.ndarray, lost: np.ndarray, head: SwanHead) -> str:
    """A line on densities (n, m) that are missing and taken as 0, with the energy of those beside them."""
    around = np.arange(rows.shape[1], dtype=float)
    total, held = 0.0, 0.0
    for row, gone, width in zip(rows, lost, np.abs(np.gradient(head.frequency)), strict=True):
        there = np.flatnonzero(~gone)
        if np.isnan(row).all():
            continue
        beside = np.interp(around[gone], around[there], row[there], period=len(row)) if gone.any() else np.zeros(0)
        total, held = total + width * float(row.sum()), held + width * float(beside.sum())
    part = 100.0 * held / (total + held) if total + held > 0.0 else 0.0
    return (
        f"{int(lost.sum())} of {lost.size} densities are missing and taken as 0; "
        f"like those beside them they would hold about {part:.2g} % of the energy"
    )


def spectrum_of(
    block: np.ndarray,
    head: SwanHead,
    number: int,
    path: Path,
    time: datetime.datetime | None,
    said: Sequence[str],
) -> Spectrum[Any]:
    """The spectrum of the values of a place. said: lines on values that are missing."""
    scale = UNITS[head.quantities[0][1]]
    x, y = head.places[number - 1]
    notes = [f"place {number} of {len(head.places)}, at {x:g}, {y:g}"] if len(head.places) > 1 else []
    notes += said
    there = np.isfinite(block).all(axis=1) if head.directions is not None else np.isfinite(block[:, 0])
    if not there.all():
        notes.append(f"left out, as they have no value: {int((~there).sum())} of {there.size} frequencies")
    f, block = head.frequency[there], block[there]
    if head.directions is not None:
        theta, S = unrepeated(head.directions, block * scale)
        return made(path, time, f, S, theta, notes=notes)
    names = [name for name, _, _ in head.quantities]
    S = block[:, 0] * scale
    if not ({"NDIR", "CDIR"} & set(names) and "DSPRDEGR" in names):
        return made(path, time, f, S, notes=notes)
    direction = next(name for name in names if name in CONVENTIONS)
    mean = CONVENTIONS[direction].towards(np.radians(filled(f, f, block[:, names.index(direction)])))
    spread = np.radians(filled(f, f, block[:, names.index("DSPRDEGR")]))
    if not (np.isfinite(mean).all() and np.isfinite(spread).all()):
        return made(path, time, f, S, notes=[*notes, "no directions at this place"])
    # Kuik, van Vledder, Holthuijsen 1988, J. Phys. Oceanogr. 18:1020
    first = np.clip(1.0 - 0.5 * spread**2, 0.0, 1.0)
    return made(path, time, f, S[:, None] * spread_by_mean(DIRECTIONS, mean, first), DIRECTIONS, notes=notes)
