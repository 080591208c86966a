"""Linear coefficients of a hull from a dataset of Capytaine's (`capytaine.export_dataset`, netCDF; read by xarray).

    hull = with_dataset(Hull.load("barge.stl"), "barge.nc")

The dataset is that of one body in deep water without forward speed, with the six motions, added mass, damping,
Froude-Krylov and diffraction forces. Its x, y are those that the hull was given in, its waterline lies at z = 0.
"""

import dataclasses
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.floating.closed_mesh import ClosedMesh, check_hull
from sim.floating.hull import Hull
from sim.floating.hydrodynamics import DIRECTIONS, MIRROR_X, MIRROR_Y, lagrange, table_length, velocity_at
from sim.floating.linear_table import LinearTable
from sim.validation import argument_error, check_kind, check_positive

if TYPE_CHECKING:
    from xarray import Dataset

MOTIONS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
WANTED = ("added_mass", "radiation_damping", "diffraction_force", "Froude_Krylov_force", "omega", "wave_direction")
WIDEST_GAP = math.radians(31.0)  # between directions that are interpolated
SYMMETRY = 1e-3  # share of the greatest force that a hull's own symmetry may miss


def with_dataset(hull: Hull, path: str | Path, draft: float | None = None) -> Hull:
    """The hull with the linear coefficients of a dataset, for bodies of about its draft.

    draft [m]: that of the dataset, where it does not say. Raises ValueError for a file that is no dataset of one body,
    or does not fit; ModuleNotFoundError without xarray (`pip install xarray netCDF4`).
    """
    check_hull("hull", hull)
    if draft is not None:
        check_positive("draft", draft, "m")
    shape = dataclasses.replace(hull.shape, table=table_of_dataset(path, hull, draft))
    return dataclasses.replace(hull, shape=shape)


def table_of_dataset(path: str | Path, mesh: ClosedMesh, draft: float | None = None) -> LinearTable:
    """The table of a hull from a dataset, at its one draft [m]; None: the `draught` of the dataset.

    Raises ValueError for a file that is no such dataset, ModuleNotFoundError without xarray.
    """
    check_kind("path", path, str | os.PathLike, "the name of a file")
    import xarray  # half a second, and not needed by most

    try:
        with xarray.open_dataset(path) as file:
            dataset = file.load()
    except (OSError, ValueError) as error:
        reason = str(error).partition("\n")[0]
        raise argument_error("path", str(path), f"a dataset written by capytaine.export_dataset ({reason})") from error
    return converted(dataset, str(path), mesh, draft)


def converted(dataset: "Dataset", path: str, mesh: ClosedMesh, draft: float | None) -> LinearTable:
    """The same of a dataset in memory."""
    missing = [name for name in WANTED if name not in dataset.variables]
    if missing:
        raise argument_error("path", path, f"a dataset of one body with {', '.join(missing)}")
    motions = tuple(str(name).rpartition("__")[2] for name in dataset["influenced_dof"].values)
    if sorted(motions) != sorted(MOTIONS):
        raise argument_error("path", path, f"a dataset of one body with the motions {', '.join(MOTIONS)}")
    if not math.isinf(float(dataset["water_depth"])) or float(dataset.get("forward_speed", 0.0)) != 0.0:
        raise argument_error("path", path, "a dataset in deep water, without forward speed")
    if draft is None and "draught" not in dataset.variables:
        raise argument_error("draft", draft, "a number above 0 m, as the dataset has no draught")
    depth = check_positive("draft", float(dataset["draught"]), "m") if draft is None else draft
    order = [motions.index(name) for name in MOTIONS]
    omega = dataset["omega"].values
    waves = np.flatnonzero(np.isfinite(omega) & (omega > 0.0))
    waves = waves[np.argsort(omega[waves])]
    if len(waves) < 4:
        raise argument_error("path", path, "a dataset of at least four frequencies")
    rho, g = float(dataset["rho"]), float(dataset["g"])
    length = table_length(mesh)
    centre = dataset["rotation_center" if "rotation_center" in dataset.variables else "center_of_mass"].values
    offset = centre - [mesh.centre[0], mesh.centre[1], 0.0]
    S = velocity_at(*offset)  # from the middle of the waterline to the centre of rotation

    def matrix(name: str) -> np.ndarray:
        """(frequencies, 6, 6) about the middle of the waterline, over density."""
        values = dataset[name].transpose("omega", "influenced_dof", "radiating_dof").values[:, order][:, :, order]
        values = S.T @ values @ S / rho
        return (values + values.swapaxes(1, 2)) / 2

    unit = length ** np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    scale, root = np.outer(unit, unit) * length, math.sqrt(length)
    added, endless = matrix("added_mass") / scale, np.isinf(omega)
    k = omega[waves] ** 2 / g
    X = np.stack([force_of(dataset, name)[waves][:, :, order] for name in ("diffraction_force", "Froude_Krylov_force")])
    headings = np.mod(dataset["wave_direction"].values, 2 * math.pi)
    path_length = mesh.centre[0] * np.cos(headings) + mesh.centre[1] * np.sin(headings)
    phase = np.exp(-1j * k[:, None] * path_length)[:, :, None]
    excitation = resampled(X.sum(axis=0) @ S * phase / (rho * g * unit * length), headings, path)
    return LinearTable(
        aspect=np.ones(1),
        draft=np.array([depth / length]),
        direction=DIRECTIONS,
        frequency=omega[waves] * math.sqrt(length / g),
        added_mass=added[waves][None, None],
        damping=(matrix("radiation_damping")[waves] / (scale * math.sqrt(g) / root))[None, None],
        infinite=added[endless if endless.any() else waves[-1:]][0][None, None],
        excitation=excitation[None, None],
    )


def force_of(dataset: "Dataset", name: str) -> np.ndarray:
    """A force (frequencies, directions, 6), complex, also where real and imaginary parts lie side by side."""
    values: Any = dataset[name]
    if "complex" in values.dims:
        values = values.sel(complex="re") + 1j * values.sel(complex="im")
    return values.transpose("omega", "wave_direction", "influenced_dof").values


def resampled(X: np.ndarray, headings: np.ndarray, path: str) -> np.ndarray:
    """Forces (n, 36, 6) in DIRECTIONS by cubics through those (n, headings, 6) of a dataset.

    Headings from 0 to 90, or to 180, degrees are mirrored, of a hull that is as symmetric as that needs.
    """
    order = np.argsort(headings)
    headings, X = headings[order], X[:, order]
    for end, factor in ((math.pi / 2, MIRROR_X), (math.pi, MIRROR_Y)):
        if abs(headings[0]) < 1e-6 and abs(headings[-1] - end) < 1e-6:
            mirrored, at = X * factor, headings < end - 1e-6
            # what the mirror turns round is 0 in a wave that it leaves
            still = X[:, -1:] if factor is MIRROR_X else X[:, [0, -1]]
            if np.abs(still[:, :, factor < 0]).max() > SYMMETRY * np.abs(X).max():
                raise argument_error("path", path, "directions all around a hull that is not symmetric")
            keep = at if factor is MIRROR_X else at & (headings > 1e-6)
            headings = np.concatenate([headings, (2.0 * end - headings[keep])[::-1]])
            X = np.concatenate([X, mirrored[:, keep][:, ::-1]], axis=1)
    around = np.concatenate([headings[-2:] - 2 * math.pi, headings, headings[:3] + 2 * math.pi])
    if np.diff(around).max() > WIDEST_GAP or len(headings) < 4:
        raise argument_error("path", path, "directions at most 30 degrees apart, all around or up to 90 or 180 degrees")
    values = np.concatenate([X[:, -2:], X, X[:, :3]], axis=1)
    index, weights = lagrange(around, DIRECTIONS)
    return np.einsum("dw,ndwm->ndm", weights, values[:, index])
