"""Files of WAVEWATCH III, and those of netCDF, by the library `wavespectra`."""

import datetime
import importlib
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.contents import FORMS, made, nearest, towards, unrepeated
from sim.validation import argument_error, unreadable

NETCDF = (".nc", ".nc4", ".cdf")
READERS = (({"freq", "efth"}, "read_netcdf"), ({"efth"}, "read_ww3"))  # names in a file of netCDF -> of wavespectra


def from_wavespectra(path: Path, when: datetime.datetime | None, place: int | None = None) -> Spectrum[Any]:
    """The spectrum at a place, counted from 1, or the first one with data, at the time asked for, or the last one."""
    if not path.is_file():
        raise unreadable("path", path, FileNotFoundError())
    wavespectra: Any = importlib.import_module("wavespectra")  # optional, and slow to import
    try:
        data = opened(wavespectra, path)
        places = [axis for axis in data.dims if axis not in ("time", "freq", "dir")]
        notes = []
        if places:
            data = data.stack(place=places)
            count = data.sizes["place"]
            there = data.notnull().any([axis for axis in data.dims if axis != "place"]).values
            if place is not None and place > count:
                raise argument_error("place", place, f"1 to {count}, the places of {path.name}")
            number = place or int(there.argmax()) + 1
            if not there[number - 1]:
                raise argument_error("place", number, f"a place of {path.name} with data")
            data = data.isel(place=number - 1)
            notes = [f"place {number} of {count}"] if count > 1 else []
        time, i = None, 0
        if "time" in data.dims:
            times = [datetime.datetime.fromisoformat(str(one)[:19]) for one in data["time"].values]
            i = nearest(times, when, path)
            data, time = data.isel(time=i), times[i]
        f = np.asarray(data["freq"].values, float)
        if "dir" not in data.dims or data.sizes["dir"] < 2:
            return made(path, time, f, np.asarray(data.squeeze().values, float), notes=notes)
        density = np.asarray(data.transpose("freq", "dir").values, float) * (180.0 / math.pi)
        degrees = np.asarray(data["dir"].values, float)
        theta, density = unrepeated(towards(degrees), density)
        return made(path, time, f, density, theta, notes=notes)
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


def opened(wavespectra: Any, path: Path) -> Any:
    """The densities [m2/Hz/degree] of a file, along freq, dir [degrees that waves come from] and maybe time."""
    if path.suffix.lower() in NETCDF:
        import xarray

        with xarray.open_dataset(path) as file:
            names = {*map(str, file.variables), *map(str, file.dims)}
        own = next((reader for needed, reader in READERS if needed <= names), "read_ncswan")
    else:
        own = "read_ww3_station"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return getattr(wavespectra, own)(str(path))["efth"].load()
