"""Measured spectra from files: tables (CSV), text files of NDBC's buoys, and those of wave models. One module each.

    sea = Sea(256, 1500.0, read_spectrum("44013w2020.txt", "2020-01-02 05:00"))

Files have directions that waves come from, clockwise from north, and densities in m2/Hz, or m2/Hz/degree. They become
those that waves go to, from +x, which is east, towards +y, north.
"""

import os
from pathlib import Path
from typing import Any

from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.buoys import from_buoy, from_summary
from sim.ocean.spectrum_files.contents import read_text, read_time
from sim.ocean.spectrum_files.tables import from_table
from sim.ocean.spectrum_files.wave_models import NETCDF, from_wavespectra
from sim.validation import argument_error, check_kind

__all__ = ["read_spectrum"]


def read_spectrum(path: str | Path, time: str | None = None) -> Spectrum[Any]:
    """The spectrum in a file, or its record nearest to a time, "2020-01-02 05:00", by default its last one.

    With directions it has those of the file, else waves spread about the wind's direction. Raises ValueError for a file
    that holds none, in one line; ModuleNotFoundError without `wavespectra` or xarray, where the format needs them.
    """
    check_kind("path", path, str | os.PathLike, "the name of a file")
    path = Path(path)
    when = None if time is None else read_time(time)
    if path.suffix.lower() in NETCDF:
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
