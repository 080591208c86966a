"""The outcomes of a sweep as one labelled xarray dataset, written as one NetCDF file."""

import datetime
import json
import math
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from app.study.sweep.case import ENDS, Outcome, program
from app.study.sweep.spec import Spec
from sim.files import replacing
from sim.parameters import parameters_of

PACKAGES = ("numpy", "numba", "xarray", "netCDF4")


def to_dataset(spec: Spec, outcomes: dict[int, Outcome]) -> Any:
    """An `xarray.Dataset` of all cases, over the swept parameters of a grid or over `case`, and over time."""
    import xarray as xr

    known = parameters_of(spec.kind.params)
    ordered = [outcomes[index] for index in range(len(spec.cases))]
    shape = tuple(len(values) for values in spec.swept.values()) if spec.design == "grid" else (len(ordered),)
    dims = tuple(spec.swept) if spec.design == "grid" else ("case",)
    coordinates: dict[str, Any] = {}
    for name, values in spec.swept.items():
        parameter = known[name]
        attributes = {"long_name": parameter.doc, "units": parameter.unit or "1"}
        if parameter.choices or parameter.kind is bool:
            del attributes["units"]
        coordinates[name] = (name if spec.design == "grid" else "case", np.array(values), attributes)
    if spec.design == "random":
        coordinates["case"] = ("case", np.arange(len(ordered)), {"long_name": "Number of the case"})
    over_time, time_shape = dims, shape
    if spec.frames > 1:
        label = {"long_name": "Simulated time; a case is measured at its first whole step at or after", "units": "s"}
        coordinates["time"] = ("time", np.array(spec.times), label)
        over_time, time_shape = (*dims, "time"), (*shape, spec.frames)
    labels = {name: label for outcome in ordered for name, label in outcome.labels.items()}
    nothing = [math.nan] * spec.frames
    variables: dict[str, Any] = {}
    for name, (unit, meaning) in labels.items():
        values = np.array([outcome.measures.get(name, nothing) for outcome in ordered]).reshape(time_shape)
        variables[name] = (over_time, values, {"long_name": meaning, "units": unit or "1"})

    def per_case(values: list[Any], **attributes: Any) -> Any:
        return dims, np.array(values).reshape(shape), attributes

    variables["diverged_at"] = per_case(
        [o.diverged_at for o in ordered], long_name="Last time with a good state of a run that diverged", units="s"
    )
    variables["run_time"] = per_case([o.run_time for o in ordered], long_name="Processor time", units="s")
    variables["end"] = per_case(
        [np.int8(ENDS.index(o.end)) for o in ordered],
        long_name="Outcome of the case",
        flag_values=np.arange(len(ENDS), dtype=np.int8),
        flag_meanings=" ".join(ENDS),
    )
    variables["message"] = per_case(
        [o.message for o in ordered], long_name="Reason why the case did not finish; empty if it did"
    )
    return xr.Dataset(variables, coordinates, about(spec))


def about(spec: Spec) -> dict[str, Any]:
    """The attributes of the file: all that is needed to make it again."""
    fixed = {name: getattr(spec.params(0), name) for name in parameters_of(spec.kind.params) if name not in spec.swept}
    versions = ", ".join([f"Python {platform.python_version()}", *(f"{name} {version(name)}" for name in PACKAGES)])
    return {
        "title": f"Springtide sweep of the scene {spec.scene} over {', '.join(spec.swept)}",
        "scene": spec.scene,
        "seconds": spec.seconds,
        "design": spec.design,
        "seed": "none" if spec.seed is None else spec.seed,
        "parameters": json.dumps(fixed),
        "spec": spec.text,
        "identity": json.dumps(identity(spec)),
        "program": program(),
        "versions": versions,
        "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    }


def identity(spec: Spec) -> dict[str, Any]:
    """The identity of a sweep: sweeps with equal identities have equal results."""
    return {"spec": spec.identity(), "program": program()}


def identity_in(path: Path) -> dict[str, Any] | None:
    """The identity of the sweep that a file holds, or None if it is no finished sweep."""
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            return json.loads(dataset.attrs["identity"])
    except (OSError, KeyError, ValueError):
        return None


def write(dataset: Any, path: Path) -> None:
    """Write the NetCDF file completely, or leave the old file and raise OSError."""
    packed = {name: {"zlib": True} for name, v in dataset.data_vars.items() if v.dtype.kind == "f" and v.ndim}
    try:
        with replacing(path) as draft:
            dataset.to_netcdf(draft, engine="netcdf4", format="NETCDF4", encoding=packed)
    except RuntimeError as error:
        # netCDF4 raises this for a full disk, too.
        raise OSError(f"{path} cannot be written ({error}); the finished cases are kept") from None
