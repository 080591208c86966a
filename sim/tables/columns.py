"""Columns of a table: a name, a unit, a convention of direction, and values that may be missing.

    frequency [Hz]; density (m^2/Hz); direction (deg, to)

A quantity that a column may hold is a `Meaning`. A unit or a value that cannot be is refused in one line, and a column
without a meaning is left out, with a line that names it.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.tables.headers import Header, read_header
from sim.tables.numbers import is_value, values_of
from sim.tables.rows import Row, line_error, split_rows
from sim.tables.units import UnitMeasure, measure_of
from sim.validation import argument_error
from sim.water import EARTH_GRAVITY, SEA_DENSITY

TURN = 2.0 * math.pi
WEIGHT = SEA_DENSITY * EARTH_GRAVITY  # [N/m3] of sea water: waves of 1 m2 have this energy in J/m2
MAX_SHOWN = 60  # characters of a header in a message
MAX_HEADER = 200  # characters of a header that are read
MAX_LISTED = 12  # columns that are left out, in a line


class Kind(NamedTuple):
    """A kind of quantity."""

    unit: str  # of its values once they are read
    units: str  # that a header may have, for messages
    low: float
    high: float  # between which its values lie
    dimensions: dict[str, float]  # of its units, angles apart
    angles: tuple[float, ...] = (0.0,)  # powers of an angle that its units may have
    nines: float = 0.0  # up to which, as written, a number of digits of 9 is a value and never a missing one
    doubt: float = 0.0  # up to which values without a unit may be radians


PER_TIME = {"[time]": -1.0}
FREQUENCY = Kind("Hz", "Hz, mHz, 1/s, rad/s", 1e-4, 100.0, PER_TIME, (0.0, 1.0))
OMEGA = Kind("Hz", "rad/s, 1/s", 1e-4, 100.0, PER_TIME, (0.0, 1.0))  # of a column with the name of an angular frequency
DENSITY = Kind(
    "m2/Hz", "m2/Hz, m2 s, m2 s/rad, cm2/Hz, J/m2/Hz", 0.0, 1e6, {"[length]": 2.0, "[time]": 1.0}, (0.0, -1.0)
)
ENERGY = {"[mass]": 1.0, "[time]": -1.0}  # dimensions of J/m2/Hz
# Where waves go to, from +x towards +y.
DIRECTION = Kind("rad", "deg, rad", -2.0 * TURN, 2.0 * TURN, {}, (1.0,), nines=360.0, doubt=TURN + 1e-6)
SPREAD = Kind("rad", "deg, rad", 0.0, math.radians(120.0), {}, (1.0,), doubt=1.5)
SHARE = Kind("1", "1, %", 0.0, 100.0, {}, nines=100.0)
TIME = Kind("s", "s, ms, min, h", -math.inf, math.inf, {"[time]": 1.0}, nines=math.inf)
LENGTH = Kind("m", "m, cm, mm, ft", -1e3, 1e3, {"[length]": 1.0})
STRAIN = Kind("1", "1, %", -1.0, 10.0, {}, nines=math.inf)
FORCE = Kind("N", "N, kN, MN, lbf", -1e12, 1e12, {"[mass]": 1.0, "[length]": 1.0, "[time]": -2.0}, nines=math.inf)


class Meaning(NamedTuple):
    """A quantity that a column of a table may hold."""

    key: str
    kind: Kind
    names: tuple[str, ...]  # of headers, in small letters without signs
    default: str  # its unit where the header has none


class Column(NamedTuple):
    """A column that was read."""

    header: str
    values: np.ndarray  # (n,) in the unit of its kind; nan if missing
    is_angular: bool | None  # a frequency in rad/s, or a density per rad/s; None for a density that does not say


class ColumnTable(NamedTuple):
    """Columns by the keys of their meanings."""

    columns: dict[str, Column]
    lines: list[int]  # number of the line of each row
    notes: tuple[str, ...]  # a line on each thing that was left out or assumed


def read_table(text: str, path: Path, meanings: Sequence[Meaning], nameless: tuple[str, ...]) -> ColumnTable:
    """The columns of a table with names, or without them those of the keys `nameless`.

    Raises ValueError that names the line and the column.
    """
    return read_columns(*split_rows(text, path), path, meanings, nameless)


def read_columns(
    rows: list[Row], comments: list[Row], path: Path, meanings: Sequence[Meaning], nameless: tuple[str, ...]
) -> ColumnTable:
    """The columns of rows, with their names in the first one, or in a comment before it."""
    by_name = {name: meaning for meaning in meanings for name in meaning.names}
    if not rows:
        raise argument_error("path", str(path), "a table with rows of numbers")
    if all(is_value(word) for word in rows[0].words):
        default = {meaning.key: meaning for meaning in reversed(meanings)}
        keys = [default[key] for key in nameless]
        head = names_in_comments(comments, keys, len(rows[0].words), by_name, path)
        if head is None and len(rows[0].words) != len(nameless):
            named = " and ".join(nameless)
            raise line_error(path, rows[0].number, f"{len(nameless)} columns, {named}, or names of columns")
        if head is None:
            head = Row(rows[0].number, [meaning.names[0] for meaning in keys])
    else:
        head, rows = rows[0], rows[1:]
        if rows and is_units(rows[0].words, len(head.words)):
            head = Row(head.number, [f"{name} ({unit.strip('[]()')})" if unit.strip("[]()-") else name
                                     for name, unit in zip(head.words, rows[0].words, strict=True)])  # fmt: skip
            rows = rows[1:]
    count = len(head.words)
    for row in rows:
        if len(row.words) != count:
            raise line_error(path, row.number, f"{count} columns, not {len(row.words)}")
    found: dict[str, Column] = {}
    left: list[str] = []
    notes: list[str] = []
    for i, text in enumerate(head.words):
        header = header_of(text[:MAX_HEADER], by_name, path, head.number)
        meaning = by_name.get(header.name)
        if meaning is None:
            left.append(shown(text) or f"number {i + 1}, without a name")
            continue
        if meaning.key in found:
            both = f"'{shown(found[meaning.key].header)}' and '{shown(text)}'"
            raise argument_error("path", f"{path}, line {head.number}, columns {both}", f"one column of {meaning.key}")
        found[meaning.key] = read_column(header, text, meaning, [row.words[i] for row in rows], rows, path, notes)
    if left:
        more = f" and {len(left) - MAX_LISTED} more" if len(left) > MAX_LISTED else ""
        notes.append(f"columns left out: {', '.join(left[:MAX_LISTED])}{more}")
    return ColumnTable(found, [row.number for row in rows], tuple(notes))


def header_of(text: str, names: dict[str, Meaning], path: Path, number: int) -> Header:
    """`read_header` of a column. Raises ValueError that names the file."""
    try:
        return read_header(text, names)
    except ValueError as error:
        raise ValueError(f"path: {path}, line {number}: {error}") from None


def names_in_comments(
    comments: list[Row], keys: Sequence[Meaning], count: int, names: dict[str, Meaning], path: Path
) -> Row | None:
    """The comment that names the columns, if one does; keys: the meanings of columns without names.

    Raises ValueError for comments that have a unit of these other than the default, but no names.
    """
    for row in reversed(comments):
        if len(row.words) == count and all(
            header_of(word, names, path, row.number).name in names for word in row.words
        ):
            return row
    for row in comments:
        for word in " ".join(row.words).split():
            measure = measure_of(word.strip("[]():,;."))
            if measure is not None and any(factor_of(meaning.kind, measure)[0] not in (None, 1.0) for meaning in keys):
                raise line_error(path, row.number, f"names of the columns with their units, not {word} in a comment")
    return None


def is_units(words: list[str], count: int) -> bool:
    """True for a row of units below a row of names; some may be empty."""
    units = [unit for unit in (word.strip("[]()") for word in words) if unit not in ("", "-")]
    read = [read_header(f"x ({unit})", ()).unit for unit in units]
    return (
        len(words) == count
        and bool(units)
        and not any(map(is_value, units))
        and all(unit == "" or measure_of(unit) is not None for unit in read)
    )


def read_column(
    header: Header, text: str, meaning: Meaning, words: list[str], rows: list[Row], path: Path, notes: list[str]
) -> Column:
    """A column of words. Raises ValueError that names the line and the header."""
    kind = meaning.kind
    measure = measure_of(header.unit or meaning.default)
    factor, is_angular = (None, None) if measure is None else factor_of(kind, measure)
    if factor is None:
        raise argument_error("path", f"{path}, column '{shown(text)}'", f"a unit such as {kind.units}")
    if measure is not None and measure.dimensions == ENERGY:
        notes.append(f"'{shown(text)}' is divided by rho g of sea water, {WEIGHT:.0f} N/m3")
    values, wrong = values_of(words, min(kind.nines, kind.high / factor))
    if wrong is not None:
        raise line_error(path, rows[wrong].number, f"numbers in the column '{shown(text)}'")
    if not header.unit and in_doubt(values, kind.doubt):
        raise argument_error("path", f"{path}, column '{shown(text)}'", f"its unit in the header, such as {kind.units}")
    values = values * (factor * (2.0 if header.is_two_sided and kind is DENSITY else 1.0))
    bad = ~(np.isnan(values) | ((values >= kind.low) & (values <= kind.high)))
    if bad.any():
        i = int(bad.argmax())
        raise line_error(
            path, rows[i].number,
            f"{plainly(kind.low, factor)} to {plainly(kind.high, factor)} in the column '{shown(text)}'; "
            f"{words[i]} is no {meaning.key} in {header.unit or meaning.default}",
        )  # fmt: skip
    if kind is DIRECTION:
        values = header.convention.towards(values)
    return Column(text, values, is_angular)


def in_doubt(values: np.ndarray, largest: float) -> bool:
    """True for values without a unit that are small, and not whole numbers: degrees of one direction, or radians."""
    there = values[np.isfinite(values)]
    return bool(len(there)) and bool((np.abs(there) <= largest).all()) and bool((there != np.rint(there)).any())


def factor_of(kind: Kind, measure: UnitMeasure) -> tuple[float | None, bool | None]:
    """The factor of values of a measure, None for a measure of another kind; and `Column.is_angular`."""
    factor = measure.factor
    dimensions = measure.dimensions
    if kind is DENSITY and dimensions == ENERGY:
        factor, dimensions = factor / WEIGHT, kind.dimensions
    if dimensions != kind.dimensions or measure.angle not in kind.angles:
        return None, None
    if kind is OMEGA and measure.is_cyclic:
        return None, None
    if kind is OMEGA or (kind is FREQUENCY and measure.angle == 1.0):
        return factor / TURN, True
    if kind is DENSITY and measure.angle == -1.0:
        return (None, None) if measure.is_cyclic else (factor * TURN, True)
    return factor, False if measure.is_cyclic or kind is FREQUENCY else None


def plainly(value: float, factor: float) -> str:
    """A limit in the unit of the column."""
    return f"{value / factor:.6g}"


def shown(text: str) -> str:
    """A header as a message shows it."""
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}..."
