"""Measured spectra from files: tables (CSV), files of buoys and other instruments, and of wave models. One module each.

    sea = Sea(256, 1500.0, read_spectrum("44013w2020.txt", "2020-01-02 05:00"))

Files have directions that waves come from, clockwise from north, and densities in m2/Hz, or m2/Hz/degree. They become
those that waves go to, from +x, which is east, towards +y, north.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.inputs.kinds import check_file
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.buoys import from_buoy, from_summary
from sim.ocean.spectrum_files.contents import FORMS, SpectrumSeries, read_time
from sim.ocean.spectrum_files.instruments import from_awac, from_datawell, is_datawell
from sim.ocean.spectrum_files.records import missing_numbers
from sim.ocean.spectrum_files.swan import from_swan
from sim.ocean.spectrum_files.tables import from_table
from sim.ocean.spectrum_files.wave_models import NETCDF, from_wavespectra, text_reader
from sim.tables import number_of, read_text
from sim.validation import argument_error, check_kind, is_whole_number

__all__ = ["SpectrumSeries", "read_spectra", "read_spectrum"]


def read_spectrum(
    path: str | Path,
    time: str | None = None,
    place: int | None = None,
    missing: float | Sequence[float] | None = None,
) -> Spectrum[Any]:
    """The spectrum in a file, or its record nearest to a time, "2020-01-02 05:00", by default its last one.

    place: of a file with several, from 1; by default the first one with data at any time. missing: numbers that stand
    for a missing value in a table; None for digits of 9 far beyond all other values.
    With directions the spectrum has those of the file, else waves spread about the wind's direction. Its `notes` say
    what was read, and what was left out.

    Raises ValueError for a file that holds none, in one line; ModuleNotFoundError without `wavespectra` or xarray,
    where the format needs them.
    """
    when = None if time is None else read_time(time)
    content = contents(path, place, missing)
    if isinstance(content, SpectrumSeries):
        return content.nearest(when)
    if when is not None:
        raise argument_error("time", time, "a time for a file with records of several times; this is a table of one")
    return content


def read_spectra(
    path: str | Path, place: int | None = None, missing: float | Sequence[float] | None = None
) -> SpectrumSeries:
    """All spectra of a file with records of several times, which is read once: a mapping from their times in UTC.

        heights = {time: spectrum.moments().significant_height for time, spectrum in read_spectra(path).items()}

    Arguments and errors as of `read_spectrum`; raises ValueError for a file without times, too.
    """
    content = contents(path, place, missing)
    if not isinstance(content, SpectrumSeries):
        raise argument_error("path", str(path), "a file with times; this has one spectrum, which `read_spectrum` reads")
    return content


def contents(
    path: str | Path, place: int | None, missing: float | Sequence[float] | None
) -> Spectrum[Any] | SpectrumSeries:
    """The spectra of a file by their times, or its only one; arguments and errors as of `read_spectrum`."""
    check_kind("path", path, str | os.PathLike, "the name of a file")
    path = Path(path)
    if place is not None and not (is_whole_number(place) and place > 0):
        raise argument_error("place", place, "a whole number of at least 1")
    numbers = missing_numbers(missing)
    check_file("path", path, ("spectrum",), FORMS)
    if path.suffix.lower() in NETCDF:
        return from_wavespectra(path, place)
    text = read_text(path, FORMS)
    head = next((line for line in text.splitlines() if line.strip()), "")
    words = head.lstrip("# ").split()
    kind = head.lstrip("'\" ").upper()
    if kind.startswith("SWAN"):
        return from_swan(text, path, place)
    if place is not None:
        raise argument_error("place", place, "a place of a file with several, of SWAN or netCDF")
    reader = text_reader(text)
    if reader:
        return from_wavespectra(path, reader=reader)
    if kind.startswith("$PNOR"):
        return from_awac(text, path)
    if words[:4] and words[0].strip("#") in ("YY", "YYYY") and words[1:3] == ["MM", "DD"]:
        is_spectrum = all(number_of(word) is not None for word in words[5:]) or "(" in text.partition("\n")[0]
        return from_buoy(text, path) if is_spectrum else from_summary(text, path)
    return from_datawell(text, path) if is_datawell(text) else from_table(text, path, numbers)
