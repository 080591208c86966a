"""Files of wave models and of Spotter and Triaxys buoys by the library `wavespectra`, and NDBC's netCDF."""

import contextlib
import datetime
import functools
import importlib
import math
import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.inputs.kinds import HEAD, WAVE_TEXTS
from sim.ocean.records.measured import spread_by_moments
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.buoys import shares
from sim.ocean.spectrum_files.contents import DIRECTIONS, FORMS, MAGNETIC, SpectrumSeries, made, towards, unrepeated
from sim.validation import argument_error, unreadable

NETCDF = (".nc", ".nc4", ".cdf")
# Names in a file of netCDF, and the reader of wavespectra; the last one is SWAN's.
READERS = (
    ({"freq", "efth"}, "read_netcdf"), ({"efth"}, "read_ww3"), ({"d2fd"}, "read_era5"), ({"AC", "SPSIG"}, "read_wwm"),
    (set(), "read_ncswan"),
)  # fmt: skip
NDBC_NETCDF = {"spectral_wave_density", "frequency"}
ALPHA1, ALPHA2, R1, R2 = "mean_wave_dir", "principal_wave_dir", "wave_spectrum_r1", "wave_spectrum_r2"
MAGNETIC_READERS = ("read_triaxys",)


def text_reader(text: str) -> str:
    """The reader of wavespectra for a text file, "" for another."""
    head = text[:HEAD].lower().lstrip("'\" #\n\r")
    return next((name for words, name, _ in WAVE_TEXTS if re.match(words, head, re.DOTALL)), "")


def from_wavespectra(path: Path, place: int | None = None, reader: str = "") -> Spectrum[Any] | SpectrumSeries:
    """The spectra at a place, counted from 1, or the first one with data; the only one of a file without times.

    reader: of wavespectra, for a text file.
    """
    if not path.is_file():
        raise unreadable("path", path, FileNotFoundError())
    wavespectra: Any = importlib.import_module("wavespectra")  # optional, and slow to import
    with refused_in_one_line(path):
        data = opened(wavespectra, path, reader)
        places = [axis for axis in data.dims if axis not in ("time", "freq", "dir")]
        notes = [MAGNETIC] if reader in MAGNETIC_READERS else []
        if places:
            data = data.stack(place=places)
            count = data.sizes["place"]
            there = (data > 0.0).any([axis for axis in data.dims if axis != "place"]).values
            if place is not None and place > count:
                raise argument_error("place", place, f"1 to {count}, the places of {path.name}")
            number = place or int(there.argmax()) + 1
            if not there[number - 1]:
                raise argument_error("place", number, f"a place of {path.name} with data")
            data = data.isel(place=number - 1)
            notes += [f"place {number} of {count}"] if count > 1 else []
        if "time" not in data.dims:
            return one_of(data, path, None, notes)
        whole = (data > 0.0).any([axis for axis in data.dims if axis != "time"]).values
        times = [datetime.datetime.fromisoformat(str(one)[:19]) for one in data["time"].values]
        has_data = whole if whole.any() else np.ones(len(times), bool)
    return SpectrumSeries(path, times, functools.partial(at_time, data, path, times, notes), has_data)


def at_time(data: Any, path: Path, times: Sequence[datetime.datetime], notes: Sequence[str], i: int) -> Spectrum[Any]:
    """The spectrum of one of the times."""
    return one_of(data.isel(time=i), path, times[i], notes)


def one_of(data: Any, path: Path, time: datetime.datetime | None, notes: Sequence[str]) -> Spectrum[Any]:
    """The spectrum of densities [m2/Hz/degree] along freq, and dir [degrees that waves come from]."""
    with refused_in_one_line(path):
        notes, lost = [*notes], data.isnull().any([axis for axis in data.dims if axis != "freq"]).values
        if lost.any():
            data = data.isel(freq=np.flatnonzero(~lost))
            notes.append(f"left out, as they have no value: {int(lost.sum())} of {len(lost)} frequencies")
        f = np.asarray(data["freq"].values, float)
        if "dir" not in data.dims or data.sizes["dir"] < 2:
            return made(path, time, f, np.asarray(data.squeeze().values, float), notes=notes)
        density = np.asarray(data.transpose("freq", "dir").values, float) * (180.0 / math.pi)
        degrees = np.asarray(data["dir"].values, float)
        theta, density = unrepeated(towards(degrees), density)
        return made(path, time, f, density, theta, notes=notes)


@contextlib.contextmanager
def refused_in_one_line(path: Path) -> Iterator[None]:
    """Turn any error of `wavespectra` into a ValueError of one line."""
    try:
        yield
    except ValueError as error:
        if str(error).startswith(("path: ", "time: ", "place: ")):
            raise
        raise refused(path, error) from error
    except Exception as error:  # its readers raise errors of many types
        raise refused(path, error) from error


def refused(path: Path, error: Exception) -> ValueError:
    """The error of a file that `wavespectra` cannot read."""
    reason = " ".join(str(error).partition("\n")[0].split()) or type(error).__name__
    return argument_error("path", str(path), f"{FORMS} ({reason[:120]})")


def opened(wavespectra: Any, path: Path, reader: str) -> Any:
    """The densities [m2/Hz/degree] of a file, along freq, dir [degrees that waves come from] and optionally time.

    reader: of wavespectra, "" for that which the names in a file of netCDF tell.
    """
    if not reader:
        import xarray

        with xarray.open_dataset(path) as file:
            names = {*map(str, file.variables), *map(str, file.dims)}
            if names >= NDBC_NETCDF:
                return of_ndbc(file.load())
        reader = next(name for needed, name in READERS if needed <= names)
    more = {"filetype": "json" if path.suffix.lower() == ".json" else "csv"} if reader == "read_spotter" else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        densities = getattr(wavespectra, reader)(str(path), **more)["efth"].load()
    return densities.sortby("freq")


def of_ndbc(file: Any) -> Any:
    """The densities [m2/Hz/degree] of NDBC's netCDF, spread as those of its text files, or [m2/Hz] without directions.

    `wavespectra` takes two terms of Fourier's series, which are negative in places.
    """
    S = file["spectral_wave_density"].rename(frequency="freq")
    if not {ALPHA1, ALPHA2, R1, R2} <= set(file.variables):
        return S
    parts = [file[name].rename(frequency="freq").transpose(*S.dims).values for name in (ALPHA1, ALPHA2, R1, R2)]
    first, second, r1, r2 = (part.reshape(-1) for part in parts)
    whole = np.isfinite(np.stack(parts)).all(axis=0).reshape(-1)
    D = np.full((len(whole), len(DIRECTIONS)), 1.0 / (2.0 * math.pi))
    D[whole] = spread_by_moments(
        DIRECTIONS, towards(first[whole]), shares(r1[whole]), towards(second[whole]), shares(r2[whole])
    )
    bearings = np.mod(270.0 - np.degrees(DIRECTIONS), 360.0)
    return S.expand_dims(dir=bearings, axis=-1) * (D.reshape(*S.shape, -1) * (math.pi / 180.0))
