"""Common parts of all formats of spectra: times, directions, and the spectrum made of them."""

import datetime
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.records.measured import measured_spectrum
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.sea_summary import spike_of, summary_of
from sim.validation import argument_error

DIRECTIONS = np.radians(np.arange(0.0, 360.0, 2.5))  # of spreadings that are made of moments
NEAREST = datetime.timedelta(hours=1.5)  # between the requested time and a record of a file
FORMS = "a table (CSV), a file of NDBC, SWAN, Datawell or AWAC, or one that `wavespectra` reads"
MAGNETIC = "directions are those of the instrument's compass: from magnetic north, unless it was set otherwise"


def read_time(text: str) -> datetime.datetime:
    """A date and time in UTC. Raises ValueError for another text."""
    try:
        found = datetime.datetime.fromisoformat(str(text).strip())
    except ValueError:
        raise argument_error("time", text, "a time such as 2020-01-02 05:00") from None
    return found.replace(tzinfo=None) if found.tzinfo is None else found.astimezone(datetime.UTC).replace(tzinfo=None)


def titled(path: Path, time: datetime.datetime | None) -> str:
    """The name of a spectrum: file and time."""
    return path.name if time is None else f"{path.name}, {time:%Y-%m-%d %H:%M}"


def towards(degrees: np.ndarray) -> np.ndarray:
    """Directions [rad], from +x towards +y, of waves that come from these degrees, clockwise from north."""
    return np.radians(270.0 - np.asarray(degrees))


def made(path: Path, time: datetime.datetime | None, *given: Any, notes: Sequence[str] = ()) -> Spectrum[Any]:
    """`measured_spectrum` of these arrays; notes: a line on each thing that was left out, or assumed.

    Raises ValueError that names the file.
    """
    try:
        found = measured_spectrum(*given, name=titled(path, time))
    except ValueError as error:
        raise ValueError(f"path: {path}: {error}") from None
    total = np.asarray(given[1]) if len(given) == 2 else np.asarray(given[1]).sum(axis=1)
    return found._replace(notes=(*summary_of(found), *spike_of(np.asarray(given[0]), total), *notes))


def filled(frequency: np.ndarray, own: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (n,) at frequencies (n,), each that of the nearest of its own frequencies (m,) that has one, or nan."""
    there = np.isfinite(values)
    if not there.any():
        return np.full(len(frequency), np.nan)
    return values[there][np.abs(frequency[:, None] - own[there]).argmin(axis=1)]


def unrepeated(direction: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions (m,) [rad] and densities (n, m) without the last, where it is the first one after a turn."""
    turns = (direction[-1] - direction[0]) / (2.0 * np.pi)
    is_repeated = abs(turns) > 0.5 and abs(turns - round(turns)) < 1e-6 and np.allclose(density[:, -1], density[:, 0])
    return (direction[:-1], density[:, :-1]) if is_repeated else (direction, density)


def nearest(
    times: Sequence[datetime.datetime],
    when: datetime.datetime | None,
    path: Path,
    has_data: Sequence[bool] | np.ndarray | None = None,
) -> int:
    """Index of the record nearest to a time, or of the last one with data. has_data: of each record, None for all.

    Raises ValueError if none is near, or if the nearest one has no data.
    """
    whole = [True] * len(times) if has_data is None else [bool(one) for one in has_data]
    known = [one for one, has in zip(times, whole, strict=True) if has]
    if when is None:
        return max((j for j in range(len(times)) if whole[j]), key=times.__getitem__)
    i = min(range(len(times)), key=lambda j: abs(times[j] - when))
    if abs(times[i] - when) > NEAREST:
        allowed = f"{min(known):%Y-%m-%d %H:%M} to {max(known):%Y-%m-%d %H:%M}, near a record of {path.name}"
        raise argument_error("time", f"{when:%Y-%m-%d %H:%M}", allowed)
    if not whole[i]:
        next_one = min(known, key=lambda one: abs(one - when))
        allowed = (
            f"a time with data; the record at {times[i]:%Y-%m-%d %H:%M} has none, that at {next_one:%Y-%m-%d %H:%M} has"
        )
        raise argument_error("time", f"{when:%Y-%m-%d %H:%M}", allowed)
    return i
