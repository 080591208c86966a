"""Records of the height of the water in tables, for `recorded_waves`."""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.ocean.records.wave_record import zero_crossings
from sim.ocean.spectrum_files.sea_summary import warnings_of
from sim.tables import Meaning, line_error, read_table, read_text
from sim.tables.columns import LENGTH, TIME
from sim.validation import argument_error, check_kind

LEAST_SAMPLES = 8
COLUMNS = (
    Meaning("t", TIME, ("t", "time", "times", "seconds", "elapsedtime"), "s"),
    Meaning(
        "height", LENGTH,
        ("height", "eta", "\u03b7", "elevation", "surfaceelevation", "waveelevation", "heave", "z", "surface",
         "displacement", "level", "waterlevel"), "m",
    ),
)  # fmt: skip


class HeightRecord(NamedTuple):
    """A record of the height of the water at one place."""

    t: np.ndarray  # (n,) [s]
    height: np.ndarray  # (n,) [m]
    notes: tuple[str, ...]  # lines on what was read, and on what was left out


def read_record(path: str | Path) -> HeightRecord:
    """The record in a table (CSV) of times and heights, by name with units, or in this order in s and m.

    Rows at the ends without a height are left out. `recorded_waves(record.t, record.height)` makes waves of it.
    Raises ValueError for a file that holds none, times that do not rise, and heights that are missing between others.
    """
    check_kind("path", path, str | os.PathLike, "the name of a file")
    path = Path(path)
    table = read_table(read_text(path, "a table (CSV)"), path, COLUMNS, ("t", "height"))
    if not {"t", "height"} <= table.columns.keys():
        raise argument_error("path", str(path), "a table with the columns t [s] and height [m]")
    t, height = table.columns["t"].values, table.columns["height"].values
    there = np.isfinite(height) & np.isfinite(t)
    if there.sum() < LEAST_SAMPLES:
        raise argument_error("path", f"{path} with {int(there.sum())} heights", f"at least {LEAST_SAMPLES}")
    first, end = int(there.argmax()), len(there) - int(there[::-1].argmax())
    if not there[first:end].all():
        gap = first + int((~there[first:end]).argmax())
        raise line_error(path, table.lines[gap], "a height at each time between the first one and the last")
    t, height = t[first:end], height[first:end]
    if not (np.diff(t) > 0.0).all():
        raise line_error(path, table.lines[first + int((np.diff(t) <= 0.0).argmax()) + 1], "times that rise")
    lost = len(there) - len(t)
    notes = [*table.notes, *([f"{lost} rows without a height left out at the ends"] if lost else [])]
    return HeightRecord(t, height, (*summary_of_record(t, height), *notes))


def summary_of_record(t: np.ndarray, height: np.ndarray) -> list[str]:
    """A line with Hs, Tz and duration of a record of heights (n,) [m] at times (n,) [s], and warnings."""
    Hs, Tz = 4.0 * float(height.std()), zero_crossings(t, height).mean_period
    line = f"Hs {Hs:.3g} m, Tz {Tz:.3g} s, {t[-1] - t[0]:.4g} s long in {len(t)} samples"
    return [line, *(warnings_of(Hs, Tz, name="Tz") if np.isfinite(Tz) else [])]
