"""Columns of a table: a name, a unit, a convention of direction, and values that may be missing.

    frequency [Hz]; density (m^2/Hz); direction (deg, to)

A quantity that a column may hold is a `Meaning`. A unit or a value that cannot be is refused in one line, and a column
without a meaning is left out, with a line that names it.
"""

import itertools
import math
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.tables.headers import Convention, Header, read_header
from sim.tables.numbers import MISSING, beyond_others, is_value, number_of, of_nines, values_of
from sim.tables.rows import Row, line_error, split_rows
from sim.tables.times import check_step, evened, is_time, joined, of_numbers, stamps
from sim.units import UnitMeasure, measure_of
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
TIME = Kind("s", "s, ms, min, h, d", -math.inf, math.inf, {"[time]": 1.0}, nines=math.inf)
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
    nines: np.ndarray | None = None  # (n,) the numbers of digits of 9 that may mean missing ones; nan elsewhere
    begin: str = ""  # stamp or clock of the first row, of a time


class ColumnTable(NamedTuple):
    """Columns by the keys of their meanings."""

    columns: dict[str, Column]
    lines: list[int]  # number of the line of each row
    notes: tuple[str, ...]  # a line on each thing that was left out or assumed


def read_table(
    text: str,
    path: Path,
    meanings: Sequence[Meaning],
    nameless: tuple[str, ...],
    missing: Collection[float] | None = None,
) -> ColumnTable:
    """The columns of a table with names, or without them those of the keys `nameless`.

    missing: numbers that stand for a missing value, as written; None for digits of 9 that no value can be, or that are
    far beyond all others. Raises ValueError that names the line and the column.
    """
    return read_columns(*split_rows(text, path), path, meanings, nameless, missing)


def read_columns(
    rows: list[Row],
    comments: list[Row],
    path: Path,
    meanings: Sequence[Meaning],
    nameless: tuple[str, ...],
    missing: Collection[float] | None = None,
) -> ColumnTable:
    """The columns of rows, with their names in the first one, or in a comment before it. missing: as `read_table`."""
    by_name = {name: meaning for meaning in meanings for name in meaning.names}
    if not rows:
        raise argument_error("path", str(path), "a table with rows of numbers")
    has_time = any(meaning.kind is TIME for meaning in meanings)
    notes: list[str] = []
    before = lines_before(rows)
    if before:
        notes.append(f"{before} {'line' if before == 1 else 'lines'} before the names of the columns left out")
        rows = rows[before:]
    if all(is_value(word) or (has_time and is_time(word)) for word in rows[0].words):
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
    if has_time:
        head = with_clock(head, rows)
    count = len(head.words)
    for row in rows:
        if len(row.words) != count:
            raise line_error(path, row.number, f"{count} columns, not {len(row.words)}")
    columns: dict[str, Column] = {}
    left: list[str] = []
    rows_lost = rows_of_nines(head, rows, by_name, path) if missing is None else False
    times = joined(head.words, rows) if has_time else None
    if times is not None:
        meaning = next(one for one in meanings if one.kind is TIME)
        text = " and ".join(head.words[i] for i in (times.places[0], times.places[-1]))
        header = Header("", "", Convention(0.0, 1, False), False)
        columns[meaning.key] = read_time(header, text, times.words, rows, path, notes)
    for i, text in enumerate(head.words):
        if times is not None and i in times.places:
            continue
        header = header_of(text[:MAX_HEADER], by_name, path, head.number)
        meaning = by_name.get(header.name)
        if meaning is None:
            left.append(header_text(text) or f"number {i + 1}, without a name")
            continue
        if meaning.kind is TIME and times is not None:
            left.append(header_text(text))
            continue
        if meaning.key in columns:
            both = f"'{header_text(columns[meaning.key].header)}' and '{header_text(text)}'"
            raise argument_error("path", f"{path}, line {head.number}, columns {both}", f"one column of {meaning.key}")
        columns[meaning.key] = read_column(header, text, meaning, [row.words[i] for row in rows], rows, path, notes,
                                           missing, rows_lost)  # fmt: skip
    if left:
        more = f" and {len(left) - MAX_LISTED} more" if len(left) > MAX_LISTED else ""
        notes.append(f"columns left out: {', '.join(left[:MAX_LISTED])}{more}")
    return ColumnTable(columns, [row.number for row in rows], tuple(notes))


def impossible_nines(words: list[str], kind: Kind, factor: float) -> np.ndarray:
    """True (n,) for digits of 9 that no value of a kind can be. factor: of the unit."""
    numbers = np.array([(number_of(word) or 0.0) * factor for word in words])
    return of_nines(words) & ((numbers < kind.low) | (numbers > kind.high))


def rows_of_nines(head: Row, rows: list[Row], names: dict[str, Meaning], path: Path) -> np.ndarray:
    """True (n,) for rows with digits of 9 in a column in which no value can be so: 999 degrees."""
    rows_lost = np.zeros(len(rows), bool)
    for i, text in enumerate(head.words):
        header = header_of(text[:MAX_HEADER], names, path, head.number)
        meaning = names.get(header.name)
        if meaning is None or meaning.kind is TIME:
            continue
        words = [row.words[i] for row in rows]
        measure = measure_of(header.unit or meaning.default) if of_nines(words).any() else None
        factor = None if measure is None else factor_of(meaning.kind, measure)[0]
        if factor is not None:
            rows_lost |= impossible_nines(words, meaning.kind, factor)
    return rows_lost


def lines_before(rows: list[Row]) -> int:
    """Number of lines of words before the names of the columns, as programs write them; 0 for most tables.

    The names are the first line of words from which on all have equally many.
    """
    count = len(rows[-1].words)
    if count < 2 or len(rows[0].words) == count or any(is_value(word) for word in rows[0].words):
        return 0
    first = next((i for i in range(len(rows) - 1, -1, -1) if len(rows[i].words) != count), -1) + 1
    is_named = first + 1 < len(rows) and not any(is_value(word) for word in rows[first].words)
    return first if is_named and not any(is_value(word) for row in rows[:first] for word in row.words[:1]) else 0


def with_clock(head: Row, rows: list[Row]) -> Row:
    """The names of the columns, and one more if a stamp is a date and a clock with a space between them."""
    if not rows or len(rows[0].words) != len(head.words) + 1:
        return head
    for i, (word, after) in enumerate(itertools.pairwise(rows[0].words)):
        if is_time(word) and ":" not in word and is_time(after) and ":" in after:
            return Row(head.number, [*head.words[:i], "date", "clock", *head.words[i + 1 :]])
    return head


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
    header: Header,
    text: str,
    meaning: Meaning,
    words: list[str],
    rows: list[Row],
    path: Path,
    notes: list[str],
    missing: Collection[float] | None = None,
    rows_lost: np.ndarray | bool = False,
) -> Column:
    """A column of words. Raises ValueError that names the line and the header.

    rows_lost (n,): rows in which digits of 9 are missing values, as another column has some that no value can be.
    """
    kind = meaning.kind
    if kind is TIME:
        return read_time(header, text, words, rows, path, notes, missing or ())
    unit = header.unit or meaning.default
    measure = measure_of(unit)
    factor, is_angular = (None, None) if measure is None else factor_of(kind, measure)
    if factor is None:
        raise argument_error("path", f"{path}, column '{header_text(text)}'", f"a unit such as {kind.units}")
    if measure is not None and measure.dimensions == ENERGY:
        notes.append(f"'{header_text(text)}' is divided by rho g of sea water, {WEIGHT:.0f} N/m3")
    values, wrong = values_of(words, missing or (), header.unit)
    if wrong is not None:
        raise line_error(path, rows[wrong].number, f"numbers in the column '{header_text(text)}'")
    nines = of_nines(words) & np.isfinite(values)
    nines &= ~((values >= 0.0) & (values <= min(kind.nines, kind.high / factor)))
    written = np.where(nines, values, np.nan)
    if missing is None:
        lost = impossible_nines(words, kind, factor) | beyond_others(values, nines)
        values = np.where(nines & (lost | rows_lost), np.nan, values)
    if not header.unit and in_doubt(values, kind.doubt):
        raise argument_error(
            "path", f"{path}, column '{header_text(text)}'", f"its unit in the header, such as {kind.units}"
        )
    scale = factor * (2.0 if header.is_two_sided and kind is DENSITY else 1.0)
    values = values * scale
    bad = ~(np.isnan(values) | ((values >= kind.low) & (values <= kind.high)))
    if bad.any():
        i = int(bad.argmax())
        raise line_error(
            path, rows[i].number,
            f"{plainly(kind.low, factor)} to {plainly(kind.high, factor)} in the column '{header_text(text)}'; "
            f"{words[i]} is no {meaning.key} in {unit}; missing={words[i]} leaves out such numbers",
        )  # fmt: skip
    if kind is DIRECTION:
        values = header.convention.towards(values)
    return Column(text, values, is_angular, written * scale)


def read_time(
    header: Header,
    text: str,
    words: list[str],
    rows: list[Row],
    path: Path,
    notes: list[str],
    missing: Collection[float] = (),
) -> Column:
    """A column of times [s]: numbers, stamps or clocks. Raises ValueError that names the line and the header."""
    if any(is_time(word) for word in words[:3]):
        clock, wrong = stamps(words, frozenset(MISSING))
        if clock is None:
            raise line_error(path, rows[wrong].number, f"a time such as {words[0]} in the column '{header_text(text)}'")
    else:
        unit = header.unit.partition(" since ")[0]
        measure = measure_of(unit) if unit else None
        factor = None if measure is None else factor_of(TIME, measure)[0]
        if unit and factor is None:
            raise argument_error("path", f"{path}, column '{header_text(text)}'", f"a unit such as {TIME.units}")
        values, wrong = values_of(words, missing, unit)
        if wrong is not None:
            raise line_error(path, rows[wrong].number, f"numbers or times in the column '{header_text(text)}'")
        clock = of_numbers(words, values, factor, header.name)
        if not clock.form:
            check_step(clock.seconds, factor is not None, header_text(text), path, rows[0].number)
    if clock.form:
        begin = f", from {clock.begin}" if clock.begin else ""
        notes.append(f"'{header_text(text)}': {clock.form}{begin}, as seconds from the first row")
    seconds, note = evened(clock)
    if note:
        notes.append(note)
    return Column(text, seconds, None, None, clock.begin)


def notes_on_nines(column: Column, energy: np.ndarray, lines: Sequence[int]) -> list[str]:
    """A line on the numbers of digits of 9 in a column that may mean missing values, and the energy that they hold.

    energy (n,): of each row, over that of a value of 1 in the column's unit squared or not, as the caller weighs it.
    """
    if column.nines is None or not np.isfinite(column.nines).any():
        return []
    there = np.isfinite(column.nines)
    left = there & np.isnan(column.values)
    notes = []
    total = float(np.nansum(energy))
    for chosen, said in ((left, "counts as missing; missing=() takes it for a value, with"),
                         (there & ~left, "is taken for a value; missing=... leaves it out, with")):  # fmt: skip
        part = float(np.nansum(energy[chosen])) / total if total > 0.0 else 0.0
        if chosen.any() and part > LEAST_NAMED:
            i = int(chosen.argmax())
            more = f" and {int(chosen.sum()) - 1} more like it" if chosen.sum() > 1 else ""
            notes.append(f"line {lines[i]}: a number of digits of 9{more} {said} {100.0 * part:.3g} % of the energy")
    return notes


LEAST_NAMED = 0.01  # fraction of the energy in digits of 9, from which on they are named


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


def header_text(text: str) -> str:
    """A header as a message shows it."""
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}..."
