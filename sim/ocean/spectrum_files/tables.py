"""Tables of spectra: a row a frequency, with columns by name, or densities under a row of directions."""

import datetime
import math
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sim.ocean.records.measured import spread_by_mean
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.buoys import shares
from sim.ocean.spectrum_files.contents import DIRECTIONS, FORMS, filled, made, unrepeated
from sim.tables import ColumnTable, Meaning, Row, line_error, number_of, read_columns, split_rows, values_of
from sim.tables.columns import (
    DENSITY,
    DIRECTION,
    FREQUENCY,
    OMEGA,
    SHARE,
    SPREAD,
    TURN,
    factor_of,
    header_of,
    in_doubt,
    notes_on_nines,
)
from sim.tables.headers import BRACKETS, Convention, letters_of
from sim.tables.numbers import beyond_others, of_nines
from sim.units import measure_of
from sim.validation import argument_error

MEANINGS = (
    Meaning("frequency", FREQUENCY, ("frequency", "freq", "f", "wavefrequency"), "Hz"),
    Meaning("frequency", OMEGA, ("omega", "w", "ω", "angularfrequency", "circularfrequency"), "rad/s"),
    Meaning(
        "density", DENSITY,
        ("density", "s", "energy", "spectraldensity", "spectralenergy", "energydensity", "psd", "e", "variancedensity",
         "spectrum", "sf", "ef", "sw", "sω", "efth", "wavespectrum", "wavespectraldensity"), "m2 s",
    ),
    Meaning(
        "direction", DIRECTION,
        ("direction", "dir", "alpha1", "meandirection", "mwd", "theta", "θ", "a1", "mdir", "wavedirection",
         "meanwavedirection", "dirmean"), "deg",
    ),
    Meaning("r1", SHARE, ("r1",), "1"),
    Meaning(
        "spread", SPREAD,
        ("spread", "spreading", "spr", "directionalspread", "directionalspreading", "sigma", "dspr"), "deg",
    ),
)  # fmt: skip
OMEGA_NAMES = next(meaning.names for meaning in MEANINGS if meaning.kind is OMEGA)
LARGEST_FREQUENCY = 5.0  # [Hz] of sea waves
LEAST_DIRECTIONS = 4  # columns of a table with a row of directions


def from_table(text: str, path: Path, missing: Collection[float] | None = None) -> Spectrum[Any]:
    """The spectrum of a table with one row a frequency.

    Columns by name, or frequency and density without names; or a first row of directions, and densities over both.
    missing: numbers that stand for a missing value.
    """
    rows, comments = split_rows(text, path)
    if len(rows) < 3:
        raise argument_error("path", str(path), FORMS)
    head = rows[0].words
    numbers = [number_of(word) is not None for word in head]
    if len(head) > LEAST_DIRECTIONS and all(numbers[1:]) and (not numbers[0] or len(head) > len(MEANINGS)):
        return from_matrix(rows, path, missing)
    table = read_columns(rows, comments, path, MEANINGS, ("frequency", "density"), missing)
    if "frequency" not in table.columns or "density" not in table.columns:
        raise line_error(
            path, rows[0].number, "the columns frequency [Hz] and density [m2/Hz]; and direction and spread, or r1"
        )
    return from_columns(table, path)


def from_columns(table: ColumnTable, path: Path, time: datetime.datetime | None = None) -> Spectrum[Any]:
    """The spectrum of the columns of a table; rows without frequency or density are left out. time: of its record."""
    axis, density = table.columns["frequency"], table.columns["density"]
    f, S = axis.values, density.values
    if density.is_angular is None and axis.is_angular:
        S = TURN * S
    written = density.nines
    energy = (S if written is None else np.where(np.isfinite(written), written, S)) * np.abs(np.gradient(f))
    notes = [*table.notes, *notes_on_nines(density, energy, table.lines)]
    there = np.isfinite(f) & np.isfinite(S)
    if not there.all():
        lost = ", ".join(f"{one:.4g}" for one in f[~there & np.isfinite(f)][:6])
        notes.append(f"{rows_of(np.asarray(~there))} without a value left out{f', at {lost} Hz' if lost else ''}")
    order = np.flatnonzero(there)[np.argsort(f[there], kind="stable")]
    f, S = f[order], S[order]
    direction, spread, r1 = (table.columns.get(key) for key in ("direction", "spread", "r1"))
    if direction is None or (spread is None and r1 is None):
        if direction is not None or spread is not None or r1 is not None:
            notes.append("directions left out: they need a column of direction, and one of spread or r1")
        return made(path, time, f, S, notes=notes)
    mean = filled(f, f, direction.values[order])
    if r1 is not None:
        first = shares(filled(f, f, r1.values[order]))
    else:
        assert spread is not None
        # the spread of a buoy is sqrt(2 - 2 r1), Kuik, van Vledder, Holthuijsen 1988, J. Phys. Oceanogr. 18:1020
        first = np.clip(1.0 - 0.5 * filled(f, f, spread.values[order]) ** 2, 0.0, 1.0)
    if not (np.isfinite(mean).all() and np.isfinite(first).all()):
        raise argument_error("path", str(path), "directions with at least one value")
    return made(path, time, f, S[:, None] * spread_by_mean(DIRECTIONS, mean, first), DIRECTIONS, notes=notes)


def rows_of(chosen: np.ndarray) -> str:
    """The number of chosen rows (n,), in words."""
    count = int(chosen.sum())
    return "1 row" if count == 1 else f"{count} rows"


class Corner(NamedTuple):
    """Units and convention in the first word of a row of directions."""

    frequency: float  # [Hz] of its unit
    angle: float  # [rad] of the unit of directions
    is_given: bool  # the unit of directions is there
    density: float  # [m2/Hz/rad] of the unit of densities
    convention: Convention


def read_corner(text: str, path: Path, number: int) -> Corner:
    """The parts of a first word such as "f (Hz), to (deg), S (m2/Hz/deg)".

    Without them they are Hz, degrees that waves come from, and densities over both. Raises ValueError for other units.
    """
    convention = header_of(text, {}, path, number).convention
    is_angular = letters_of(re.split(r"[\W_]", text.strip(), maxsplit=1)[0]) in OMEGA_NAMES
    frequency, per_hertz = (1.0 / TURN, TURN) if is_angular else (1.0, 1.0)
    angle, density, is_given = math.pi / 180.0, math.nan, False
    for unit in filter(None, (header_of(f"x ({part})", {}, path, number).unit for part in BRACKETS.findall(text))):
        measure = measure_of(unit)
        factor, angular = (None, None) if measure is None else factor_of(OMEGA if is_angular else FREQUENCY, measure)
        if factor is not None:
            frequency, per_hertz = factor, TURN if angular else 1.0
        elif measure is not None and not measure.dimensions and measure.angle == 1.0:
            angle, is_given = measure.factor, True
        elif (
            measure is not None
            and measure.dimensions == DENSITY.dimensions
            and measure.angle == (-1.0 if measure.is_cyclic else -2.0)
        ):
            density = measure.factor * (1.0 if measure.is_cyclic else TURN)
        else:
            raise line_error(path, number, f"units as in 'f (Hz), direction (deg), S (m2/Hz/deg)', not {unit}")
    return Corner(frequency, angle, is_given, per_hertz / angle if math.isnan(density) else density, convention)


def from_matrix(rows: list[Row], path: Path, missing: Collection[float] | None = None) -> Spectrum[Any]:
    """The spectrum of rows of densities behind a frequency, under a row of directions. missing: as `from_table`."""
    head, rows = rows[0], rows[1:]
    corner = read_corner(head.words[0], path, head.number)
    angles = np.array([number_of(word) for word in head.words[1:]], float)
    down = np.array([number_of(row.words[0]) or 0.0 for row in rows])
    if not corner.is_given and angles.max() <= LARGEST_FREQUENCY and down.max() > 2.0 * TURN:
        allowed = (
            "frequencies in the first column and directions in the first row; here they seem exchanged: transpose it"
        )
        raise line_error(path, head.number, allowed)
    if not corner.is_given and in_doubt(angles, DIRECTION.doubt):
        raise line_error(path, head.number, "the unit of the directions in its first word, as 'f (Hz), dir (rad)'")
    for row in rows:
        if len(row.words) != len(head.words):
            raise line_error(path, row.number, f"{len(head.words)} columns, not {len(row.words)}")
    columns = []
    for i in range(len(head.words)):
        words = [row.words[i] for row in rows]
        values, wrong = values_of(words, (missing or ()) if i else ())
        if wrong is not None:
            raise line_error(path, rows[wrong].number, "numbers")
        nines = of_nines(words)
        columns.append(np.where(nines & beyond_others(values, nines), np.nan, values) if missing is None else values)
    values = np.stack(columns, axis=1)
    there = np.isfinite(values)
    whole, some = there.all(axis=1), there[:, 0] & there[:, 1:].any(axis=1)
    if (some & ~whole).any():
        raise line_error(path, rows[int((some & ~whole).argmax())].number, "a density for each direction")
    notes = [f"{rows_of(np.asarray(~whole))} without values left out"] if not whole.all() else []
    values = values[whole]
    values = values[np.argsort(values[:, 0], kind="stable")]
    theta, S = unrepeated(corner.convention.towards(angles * corner.angle), values[:, 1:] * corner.density)
    return made(path, None, values[:, 0] * corner.frequency, S, theta, notes=notes)
