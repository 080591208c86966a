"""Tables of linear coefficients: of the shipped shapes (`tables`), and of a custom hull, beside its file.

The table of a hull from a file lies in a file of the same name that ends with `.hydrodynamics.npz`. It is made by
`springtide hydrodynamics`, and belongs to that mesh only.
"""

import functools
import hashlib
import math
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sim.floating.hulls.closed_mesh import ClosedMesh
from sim.validation import argument_error

ENDING = ".hydrodynamics.npz"


class LinearTable(NamedTuple):
    """Linear coefficients of hulls by their sides and drafts.

    At unit density and gravity, in units of a length of the hull, about the waterline above its centre of mass.
    """

    aspect: np.ndarray  # (a,) length over width
    draft: np.ndarray  # (d,)
    direction: np.ndarray  # (m,) [rad] in which waves run: one, a quarter of the circle, or all of it
    frequency: np.ndarray  # (n,)
    added_mass: np.ndarray  # (a, d, n, 6, 6)
    damping: np.ndarray  # (a, d, n, 6, 6)
    infinite: np.ndarray  # (a, d, 6, 6) added mass at infinite frequency
    excitation: np.ndarray  # (a, d, n, m, 6) complex
    depth: float = math.inf  # of the water; inf: deep
    heading: float = math.nan  # [rad] the only heading with excitation data; nan: all headings
    density: float = math.nan  # [kg/m3] of the water of a dataset; nan: any


def table_from(arrays: Mapping[str, np.ndarray]) -> LinearTable:
    """The table in the arrays of a file. Raises KeyError, TypeError or ValueError for other arrays."""
    fields = {field: arrays[field] for field in LinearTable._fields if field in arrays}
    numbers = {field: float(fields[field]) for field in LinearTable._field_defaults if field in fields}
    table = LinearTable(**{**fields, **numbers})
    if not_finite(table):
        raise ValueError(f"{not_finite(table)} is not finite")
    return table


def not_finite(table: LinearTable) -> str:
    """The name of an array of a table with numbers that are not finite; "" without one."""
    arrays = (name for name in LinearTable._fields if name not in LinearTable._field_defaults)
    return next((name for name in arrays if not np.isfinite(getattr(table, name)).all()), "")


@functools.cache
def table_of(name: str) -> LinearTable:
    """A shipped table: "box", "cylinder" or "sphere"."""
    with files("sim.floating").joinpath(f"tables/{name}.npz").open("rb") as file, np.load(file) as arrays:
        return table_from(arrays)


def place_of_table(hull_file: str | Path) -> Path:
    """Path of the table of the hull in a file."""
    path = Path(hull_file)
    return path.with_name(path.stem + ENDING)


def fingerprint(mesh: ClosedMesh) -> str:
    """Hash of a mesh: two meshes have the same only if they are equal."""
    digest = hashlib.sha256(np.round(mesh.vertices, 6).tobytes())
    digest.update(mesh.faces.tobytes())
    return digest.hexdigest()


def write_table(path: Path, table: LinearTable, mesh: ClosedMesh) -> None:
    """Write the table of a mesh to a file. Raises OSError if that fails."""
    with path.open("wb") as file:
        np.savez_compressed(file, mesh=np.array(fingerprint(mesh)), **table._asdict())


def read_table(path: Path, mesh: ClosedMesh) -> LinearTable:
    """The table of a mesh. Raises ValueError for a file that is no table, or that of another mesh."""
    try:
        with np.load(path) as arrays:
            made_of = str(arrays["mesh"])
            table = table_from(arrays)
    except Exception as error:  # numpy's reader raises errors of many types
        raise argument_error("path", str(path), f"a table made by `springtide hydrodynamics` ({error})") from error
    if made_of != fingerprint(mesh):
        raise argument_error("path", str(path), "the table of this mesh: make it again with `springtide hydrodynamics`")
    return table
