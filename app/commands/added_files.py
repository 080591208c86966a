"""Files that options add to a scene's parameters: a hull, a measured spectrum, a mooring."""

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.commands.error_stream import one_line, say_on_error_stream

SCENE_OF_FILE = {"mooring": "mooring", "hull": "radial_sea", "spectrum": "square_sea"}  # option -> scene it opens
STEP_SAFETY = 0.5  # of the longest stable step at rest, for a mooring from a file
MAX_MOORING_NODES = 2000  # of a mooring from a file: all its modes are computed for the longest step
MAX_HULL_FACES = 20_000  # of a hull from a file: pressure is summed over all of them at each step


def with_hull(params: Any, path: Path, reading: Any) -> Any:
    """The parameters with one more hull. Its size, volume and draft are printed.

    Raises ValueError for a scene without bodies, or a mesh that is no hull.
    """
    import numpy as np

    from app.commands.hulls.mesh_facts import hull_line, size_warning
    from sim.floating import Hull
    from sim.validation import argument_error

    if not hasattr(params, "hull"):
        raise argument_error("--hull", str(path), "a hull with the scene radial_sea only")
    # of huge coordinates numpy would warn before they are refused
    with np.errstate(all="ignore"), naming_extra("meshes", path):
        hull = Hull.load(path, True, *reading)
    if len(hull.faces) > MAX_HULL_FACES:
        raise argument_error("--hull", f"{path} of {len(hull.faces)} triangles", f"at most {MAX_HULL_FACES}")
    print(one_line(hull_line(path.name, hull, params.density)), flush=True)
    warning = size_warning(path.name, hull.size, reading)
    if warning:
        say_on_error_stream(warning)
    how = {f"hull_{name}": value for name, value in reading._asdict().items()}
    return dataclasses.replace(params, hull=str(path), **how)


def with_spectrum(params: Any, path: Path, time: str, missing: str, has_length: bool) -> Any:
    """The parameters with the waves of a measured spectrum, and a tile that holds them unless a length was given.

    Raises ValueError for a scene without a sea, or a file that holds no spectrum.
    """
    from sim.validation import argument_error

    if not hasattr(params, "spectrum_file"):
        raise argument_error("--spectrum", str(path), "a spectrum with the scenes square_sea and radial_sea only")
    from app.scenes.sea_parameters import measured_spectrum, tile_length

    params = dataclasses.replace(params, spectrum_file=str(path), spectrum_time=time, spectrum_missing=missing)
    with naming_extra("spectra", path):
        spectrum = measured_spectrum(params)
    if has_length or not hasattr(params, "length"):
        return params
    return dataclasses.replace(params, length=tile_length(spectrum, params))


def with_mooring(params: Any, path: Path, setup: Any) -> Any:
    """The parameters with the mooring of a MoorDyn file, a stable time step, and no breaking load, which no file has.

    setup: its parameters keep their values, and its changes are those of the file that it names.
    Raises ValueError for another scene or a file that cannot be read, ConvergenceError for one without a state of rest.
    """
    from app.scenes.setups import with_changes
    from sim.mooring import critical_step
    from sim.parameters import clamp_value, parameters_of
    from sim.validation import argument_error

    if not hasattr(params, "moordyn_file"):
        raise argument_error("--mooring", str(path), "a MoorDyn file with the scene mooring only")
    from app.scenes.mooring.files.from_file import opened

    params = with_changes(dataclasses.replace(params, moordyn_file=str(path)), setup)
    system, values = opened(params).system, setup.values
    if system.node_count > MAX_MOORING_NODES:
        raise argument_error("--mooring", f"{path} of {system.node_count} nodes", f"at most {MAX_MOORING_NODES}")
    if "breaking_load" not in values:
        params = dataclasses.replace(params, breaking_load=0.0)
    if "time_step" in values:
        return params
    step = float(f"{STEP_SAFETY * critical_step(system, params.integrator):.1e}")
    return dataclasses.replace(params, time_step=clamp_value(parameters_of(params)["time_step"], step))


@contextlib.contextmanager
def naming_extra(extra: str, path: Path) -> Iterator[None]:
    """Inside, a library that a file needs and that is not installed becomes an OSError that says how to install it."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise OSError(f"{path}: {error.name} is not installed; install it with: pip install '.[{extra}]'") from None
