"""Common parts of all formats of spectra: times, directions, and the spectrum made of them."""

import datetime
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.records.measured import measured_spectrum
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.sea_summary import spike_of, summary_of
from sim.records import equal_to_itself
from sim.validation import argument_error

DIRECTIONS = np.radians(np.arange(0.0, 360.0, 2.5))  # of spreadings that are made of moments
NEAREST = datetime.timedelta(hours=1.5)  # between the requested time and a record of a file
FORMS = "a table (CSV), a file of NDBC, SWAN, Datawell or AWAC, or one that `wavespectra` reads"
MAGNETIC = "directions are those of the instrument's compass: from magnetic north, unless it was set otherwise"


def read_time(text: str) -> datetime.datetime:
    """A date and time in UTC. Raises ValueError for another text."""
    try:
        time = datetime.datetime.fromisoformat(str(text).strip())
    except ValueError:
        raise argument_error("time", text, "a time such as 2020-01-02 05:00") from None
    return time.replace(tzinfo=None) if time.tzinfo is None else time.astimezone(datetime.UTC).replace(tzinfo=None)


def titled(path: Path, time: datetime.datetime | None) -> str:
    """The name of a spectrum: file and time."""
    return path.name if time is None else f"{path.name}, {time:%Y-%m-%d %H:%M}"


def towards(degrees: np.ndarray) -> np.ndarray:
    """Directions [rad], from +x towards +y, of waves that come from these degrees, clockwise from north."""
    return np.radians(270.0 - np.asarray(degrees))


def made(path: Path, time: datetime.datetime | None, *arrays: Any, notes: Sequence[str] = ()) -> Spectrum[Any]:
    """`measured_spectrum` of these arrays; notes: a line on each thing that was left out, or assumed.

    Raises ValueError that names the file.
    """
    try:
        spectrum = measured_spectrum(*arrays, name=titled(path, time))
    except ValueError as error:
        raise ValueError(f"path: {path}: {error}") from None
    total = np.asarray(arrays[1]) if len(arrays) == 2 else np.asarray(arrays[1]).sum(axis=1)
    return spectrum._replace(notes=(*summary_of(spectrum), *spike_of(np.asarray(arrays[0]), total), *notes))


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


@equal_to_itself
class SpectrumSeries(Mapping[datetime.datetime, Spectrum[Any]]):
    """The spectra of a file that was read once, by their times in UTC. Records without data are left out.

    A spectrum is computed when it is asked for. Of records of the same time it has the first.
    """

    def __init__(
        self,
        path: Path,
        times: Sequence[datetime.datetime],
        at: Callable[[int], Spectrum[Any]],
        has_data: Sequence[bool] | np.ndarray,
        without_data: Callable[[int], ValueError] | None = None,
    ) -> None:
        """at: the spectrum of a record by its index; has_data: of each record, True for at least one; without_data: the
        error of a record without any, None for one that names the nearest time with data."""
        self._path, self._times, self._at, self._without_data = path, times, at, without_data
        self._has_data = [bool(one) for one in has_data]
        records = (i for i in range(len(times)) if self._has_data[i])
        self._index: dict[datetime.datetime, int] = {}
        for i in sorted(records, key=times.__getitem__):
            self._index.setdefault(times[i], i)

    def __getitem__(self, time: datetime.datetime) -> Spectrum[Any]:
        return self._at(self._index[time])

    def __iter__(self) -> Iterator[datetime.datetime]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def nearest(self, when: datetime.datetime | None) -> Spectrum[Any]:
        """The record nearest to a time, or the last one with data.

        Raises ValueError if none is near, or if the nearest one has no data.
        """
        times, known = self._times, list(self._index)
        if when is None:
            return self[known[-1]]
        i = min(range(len(times)), key=lambda j: abs(times[j] - when))
        if abs(times[i] - when) > NEAREST:
            allowed = f"{known[0]:%Y-%m-%d %H:%M} to {known[-1]:%Y-%m-%d %H:%M}, near a record of {self._path.name}"
            raise argument_error("time", f"{when:%Y-%m-%d %H:%M}", allowed)
        if not self._has_data[i] and self._without_data is not None:
            raise self._without_data(i)
        if not self._has_data[i]:
            other = min(known, key=lambda one: abs(one - when))
            has, lacks = (f"{one:%Y-%m-%d %H:%M}" for one in (other, times[i]))
            allowed = f"a time with data; the record at {lacks} has none, that at {has} has"
            raise argument_error("time", f"{when:%Y-%m-%d %H:%M}", allowed)
        return self._at(i)
