"""Records of the height of the water in tables, for `recorded_waves`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.inputs.bounds import beyond
from sim.inputs.kinds import check_file
from sim.ocean.records.wave_record import zero_crossings
from sim.ocean.spectrum_files.sea_summary import warnings_of
from sim.tables import Meaning, line_error, read_table, read_text
from sim.tables.columns import LENGTH, TIME, notes_on_nines
from sim.tables.times import NAMES, gaps_of
from sim.validation import argument_error, as_array, check_kind

LEAST_SAMPLES = 8
MAX_GAPS = 3  # that are named
COLUMNS = (
    Meaning("t", TIME, NAMES, "s"),
    Meaning(
        "height", LENGTH,
        ("height", "eta", "\u03b7", "elevation", "surfaceelevation", "waveelevation", "heave", "z", "surface",
         "displacement", "level", "waterlevel", "wave1elev", "wseleva", "zpos", "heavedisplacement"), "m",
    ),
)  # fmt: skip


class HeightRecord(NamedTuple):
    """A record of the height of the water at one place."""

    t: np.ndarray  # (n,) [s]
    height: np.ndarray  # (n,) [m]
    notes: tuple[str, ...]  # lines on what was read, and on what was left out


def missing_numbers(missing: object) -> tuple[float, ...] | None:
    """Numbers that stand for missing values, as a reader's argument `missing` gives them. Raises ValueError."""
    if missing is None:
        return None
    allowed = "a number, or several, as the file has them for a missing value"
    return tuple(np.atleast_1d(as_array("missing", missing, allowed)).ravel().tolist())


def read_record(path: str | Path, missing: float | Sequence[float] | None = None) -> HeightRecord:
    """The record in a table (CSV) of times and heights, by name with units, or in this order in s and m.

    Times may be numbers, stamps, clocks, or columns of year to millisecond (see `sim.tables.times`). missing: numbers
    that stand for a missing height; None for digits of 9 far beyond all other heights. Rows at the ends without a
    height are left out. `recorded_waves(record.t, record.height)` makes waves of it.
    Raises ValueError for a file that holds none, times that do not rise, and heights that are missing between others.
    """
    check_kind("path", path, str | os.PathLike, "the name of a file")
    path, numbers = Path(path), missing_numbers(missing)
    check_file("path", path, ("record",), "a table (CSV) of times and heights")
    table = read_table(read_text(path, "a table (CSV)"), path, COLUMNS, ("t", "height"), numbers)
    if not {"t", "height"} <= table.columns.keys():
        raise argument_error("path", str(path), "a table with the columns t [s] and height [m]")
    t, height = table.columns["t"].values, table.columns["height"].values
    there = np.isfinite(height) & np.isfinite(t)
    if there.sum() < LEAST_SAMPLES:
        raise argument_error("path", f"{path} with {int(there.sum())} heights", f"at least {LEAST_SAMPLES}")
    written = table.columns["height"].nines
    values = height if written is None else np.where(np.isfinite(written), written, height)
    nines = notes_on_nines(table.columns["height"], (values - np.nanmedian(values)) ** 2, table.lines)
    first, end = int(there.argmax()), len(there) - int(there[::-1].argmax())
    if not there[first:end].all():
        gap = first + int((~there[first:end]).argmax())
        after = gap + int(there[gap:].argmax())
        raise line_error(
            path, table.lines[gap],
            f"a height at each time between the first one and the last; {after - gap} are missing from t = {t[gap]:g} s"
            + "".join(f"; {note}" for note in nines),
        )  # fmt: skip
    t, height = t[first:end], height[first:end]
    if not (np.diff(t) > 0.0).all():
        raise line_error(path, table.lines[first + int((np.diff(t) <= 0.0).argmax()) + 1], "times that rise")
    lost = len(there) - len(t)
    notes = [*table.notes, *nines, *([f"{lost} rows without a height left out at the ends"] if lost else [])]
    gaps = gaps_of(t)
    notes += [f"Warning: no samples for {length:g} s after t = {t[i]:g} s, line {table.lines[first + i]}"
              for i, length in gaps[:MAX_GAPS]]  # fmt: skip
    notes += [f"Warning: {len(gaps) - MAX_GAPS} more gaps"] if len(gaps) > MAX_GAPS else []
    return HeightRecord(t, height, (*summary_of_record(t, height), *notes))


def summary_of_record(t: np.ndarray, height: np.ndarray) -> list[str]:
    """A line with Hs, Tz and duration of a record of heights (n,) [m] at times (n,) [s], and warnings."""
    Hs, Tz = 4.0 * float(height.std()), zero_crossings(t, height).mean_period
    line = f"Hs {Hs:.3g} m, Tz {Tz:.3g} s, {t[-1] - t[0]:.4g} s long in {len(t)} samples"
    far = np.abs(height - height.mean())
    at, ratio = int(far.argmax()), float(far.max() / height.std()) if height.std() > 0.0 else 0.0
    said = f"the height {height[at]:.3g} m, {ratio:.3g} standard deviations from the mean,"
    spike = beyond("record", "largest height over the standard deviation", ratio, f"t = {t[at]:g} s", said)
    return [line, *(warnings_of(Hs, Tz, name="Tz") if np.isfinite(Tz) else []), *spike]
