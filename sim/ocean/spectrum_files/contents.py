"""Common parts of all formats of spectra: the text of a file, times, directions, and the spectrum made of them."""

import datetime
import gzip
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.records.measured import measured_spectrum
from sim.ocean.spectra.record import Spectrum
from sim.validation import argument_error, unreadable

MAX_BYTES = 100_000_000  # of a text file, unpacked
DIRECTIONS = np.radians(np.arange(0.0, 360.0, 2.5))  # of spreadings that are made of moments
NEAREST = datetime.timedelta(hours=1.5)  # between the time that is asked for and a record of a file
FORMS = "a table (CSV), an NDBC text file, or a file of WAVEWATCH III or SWAN (with `wavespectra`)"


def read_time(text: str) -> datetime.datetime:
    """A date and time in UTC. Raises ValueError for another text."""
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
    """Directions [rad], from +x towards +y, of waves that come from these degrees, clockwise from north."""
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


def line_error(path: Path, number: int, allowed: str) -> ValueError:
    """The error of a line."""
    return argument_error("path", f"{path}, line {number}", allowed)
