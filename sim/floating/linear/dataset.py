"""Linear coefficients of a hull from a dataset of Capytaine's (`capytaine.export_dataset`, netCDF; read by xarray).

    hull = with_dataset(Hull.load("barge.stl"), "barge.nc")

The dataset has the six motions of a body, added mass, damping, Froude-Krylov and diffraction forces, without forward
speed, in deep water or water of one depth. Its x, y are those that the hull was given in, its waterline lies at z = 0.
Of several bodies one is taken by its name: its own coefficients, while the others are held.
"""

import dataclasses
import math
import os
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.dispersion import wavenumber
from sim.floating.hulls.closed_mesh import ClosedMesh, check_hull
from sim.floating.hulls.hull import Hull
from sim.floating.linear.dataset_checks import doubts_of
from sim.floating.linear.hydrodynamics import (
    DIRECTIONS,
    MIRROR_X,
    MIRROR_Y,
    lagrange,
    table_length,
    velocity_at,
)
from sim.floating.linear.linear_table import LinearTable, not_finite
from sim.inputs.bounds import WARNING
from sim.numerics.angles import once_around, within_half_turn
from sim.validation import Refusals, argument_error, check_angle, check_kind, check_positive, check_vector

if TYPE_CHECKING:
    from xarray import Dataset

MOTIONS = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
FREQUENCIES = ("omega", "period", "wavelength", "freq", "wavenumber")  # coordinates; a dataset has one of them as axis
MATRICES, FORCES = ("added_mass", "radiation_damping"), ("diffraction_force", "Froude_Krylov_force")
AXES = {  # after omega
    **dict.fromkeys(MATRICES, ("influenced_dof", "radiating_dof")),
    **dict.fromkeys(FORCES, ("wave_direction", "influenced_dof")),
}
WANTED = (*MATRICES, *FORCES, "omega", "wave_direction", "influenced_dof", "radiating_dof", "rho", "g")
WIDEST_GAP = math.radians(31.0)  # between directions that are interpolated
SYMMETRY = 1e-3  # fraction of the greatest force that a hull's own symmetry may miss
SAME_DEPTH = 1e-3  # largest difference of a requested depth from one of the dataset
SAME_HEADING = 1e-3  # [rad] the same of a heading


def with_dataset(
    hull: Hull,
    path: str | Path,
    draft: float | None = None,
    *,
    body: str | None = None,
    depth: float | None = None,
    heading: float | None = None,
    rotation_center: Sequence[float] | None = None,
) -> Hull:
    """The hull with the linear coefficients of a dataset, for bodies of about its draft, in water of its depth and
    density.

    draft [m]: that of the dataset, where it does not say. body: name of one of several; the others are held. depth [m],
    or inf: one of several. heading [rad]: one of several, where they are too few to interpolate; a hull with one
    heading answers waves of that heading only. rotation_center (3,) [m]: of the motions, where the dataset does not
    say. A UserWarning names frequencies that are left out, as they have no numbers, and coefficients that physics
    contradicts: damping below 0, a spike, asymmetry, and damping that the exciting force contradicts.

    Raises ValueError for a file that is no such dataset, or does not fit; ModuleNotFoundError without xarray
    (`pip install xarray netCDF4`).
    """
    check_hull("hull", hull)
    # Before the file is read, which takes a second.
    if draft is not None:
        check_positive("draft", draft, "m")
    if depth is not None:
        check_positive("depth", depth, "m", allow_infinite=True)
    if body is not None:
        check_kind("body", body, str, "the name of a body")
    if heading is not None:
        check_angle("heading", heading)
    if rotation_center is not None:
        check_vector("rotation_center", rotation_center, "m")
    dataset = read_dataset(path)
    choice = {"body": body, "depth": depth, "heading": heading, "rotation_center": rotation_center}
    table = converted(dataset, str(path), hull, draft, **choice)
    return dataclasses.replace(hull, shape=dataclasses.replace(hull.shape, table=table))


def read_dataset(path: str | Path) -> "Dataset":
    """The dataset in a file. Raises ValueError for any other file, ModuleNotFoundError without xarray."""
    check_kind("path", path, str | os.PathLike, "the name of a file")
    from sim.inputs.kinds import check_file  # reading datasets is rare

    check_file("path", Path(path), ("dataset",), "a dataset written by capytaine.export_dataset")
    import xarray  # half a second, and not needed by most

    try:
        with xarray.open_dataset(path) as file:
            return file.load()
    except Exception as error:  # its readers raise errors of many types
        reason = " ".join(str(error).partition("\n")[0].split())
        allowed = f"a dataset written by capytaine.export_dataset ({reason or type(error).__name__})"
        raise argument_error("path", str(path), allowed) from error


def converted(
    dataset: "Dataset",
    path: str,
    mesh: ClosedMesh,
    draft: float | None = None,
    *,
    body: str | None = None,
    depth: float | None = None,
    heading: float | None = None,
    rotation_center: Sequence[float] | None = None,
) -> LinearTable:
    """The table of a hull from a dataset in memory, at its one draft [m]. Arguments and errors as of `with_dataset`."""
    missing = [name for name in WANTED if name not in dataset.variables]
    if missing:
        raise argument_error("path", path, f"a dataset of Capytaine's with {', '.join(missing)}, which this one lacks")
    dataset = with_speed_zero(dataset, path)
    check_asked(dataset, path, body, depth, draft, rotation_center)
    dataset, water = with_one_depth(dataset, path, depth)
    dataset = by_frequency(dataset, path)
    dataset, chosen = of_one_body(dataset, path, body)
    rho, g = (
        check_positive(name, scalar(dataset, name, path), unit) for name, unit in (("rho", "kg/m3"), ("g", "m/s2"))
    )
    draft = draft_of(dataset, path, chosen, draft)
    if not draft < float(mesh.size[2]):
        raise argument_error("draft", draft, f"less than the height of the hull, {mesh.size[2]:g} m")
    if not draft < water:
        raise argument_error("draft", draft, f"less than the depth of the water, {water:g} m")
    omega = numbers(dataset, "omega", ("omega",), path, allow_infinite=True)
    by_omega = {name: numbers(dataset, name, ("omega", *rest), path, check=False) for name, rest in AXES.items()}
    whole = np.all([np.isfinite(by_omega[name]).all(axis=(1, 2)) for name in MATRICES], axis=0)
    endless = np.flatnonzero(np.isinf(omega) & whole)
    whole &= np.all([np.isfinite(by_omega[name]).all(axis=(1, 2)) for name in FORCES], axis=0)
    in_range = np.isfinite(omega) & (omega > 0.0)
    waves = np.flatnonzero(in_range & whole)
    waves = waves[np.argsort(omega[waves])]
    if len(waves) < 4 or (np.diff(omega[waves]) <= 0.0).any():
        raise argument_error("path", path, "a dataset of at least four frequencies above 0 with numbers, each once")
    if (in_range & ~whole).any():
        left_out = ", ".join(f"{one:.4g}" for one in omega[in_range & ~whole])
        warnings.warn(f"{path}: not numbers, and left out, at omega {left_out} rad/s", UserWarning, stacklevel=3)
    length = table_length(mesh)
    offset = centre_of(dataset, path, chosen, rotation_center) - [mesh.centre[0], mesh.centre[1], 0.0]
    S = velocity_at(*offset)  # from the middle of the waterline to the centre of rotation

    def matrix(name: str) -> np.ndarray:
        """(frequencies, 6, 6) about the middle of the waterline, over density."""
        values = S.T @ by_omega[name] @ S / rho
        return (values + values.swapaxes(1, 2)) / 2

    unit = length ** np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    scale, root = np.outer(unit, unit) * length, math.sqrt(length)
    added = matrix("added_mass") / scale
    k = wavenumber(omega[waves] / math.sqrt(g), 1.0, water)
    headings, places = once_around(numbers(dataset, "wave_direction", ("wave_direction",), path))
    forces = np.sum([by_omega[name][waves][:, places] for name in FORCES], axis=0)
    path_length = mesh.centre[0] * np.cos(headings) + mesh.centre[1] * np.sin(headings)
    phase = np.exp(-1j * k[:, None] * path_length)[:, :, None]
    X = forces @ S * phase / (rho * g * unit * length)
    if heading is not None or len(headings) == 1:
        i = place_of_heading(headings, path, heading)
        excitation, only = np.repeat(X[:, i : i + 1], len(DIRECTIONS), axis=1), float(headings[i])
    else:
        excitation, only = resampled(X, headings, path), math.nan
    table = LinearTable(
        aspect=np.ones(1),
        draft=np.array([draft / length]),
        direction=DIRECTIONS,
        frequency=omega[waves] * math.sqrt(length / g),
        added_mass=added[waves][None, None],
        damping=(matrix("radiation_damping")[waves] / (scale * math.sqrt(g) / root))[None, None],
        infinite=added[(endless if len(endless) else waves[-1:])[0]][None, None],
        excitation=excitation[None, None],
        depth=water / length,
        heading=only,
        density=rho,
    )
    return checked(table, path, omega[waves], [by_omega[name][waves] for name in MATRICES], forces)


def checked(
    table: LinearTable, path: str, omega: np.ndarray, matrices: Sequence[np.ndarray], forces: np.ndarray
) -> LinearTable:
    """The table; a UserWarning for each coefficient of the file that physics contradicts.

    omega (n,) [rad/s], added mass and damping (n, 6, 6), forces (n, headings, 6): as the file has them. Raises
    ValueError for coefficients that are not finite.
    """
    if not_finite(table):
        raise argument_error("path", path, f"a dataset of finite coefficients; {not_finite(table)} is not")
    added, damping = matrices
    for text in doubts_of(omega, added, damping, forces, table, MOTIONS):
        warnings.warn(f"{path}: {text.removeprefix(WARNING)}", UserWarning, stacklevel=4)
    return table


def check_asked(
    dataset: "Dataset",
    path: str,
    body: str | None,
    depth: float | None,
    draft: float | None,
    rotation_center: Sequence[float] | None,
) -> None:
    """Raises ValueError with all that the dataset leaves open and its reader has not said, in one message."""
    asked, chosen = Refusals(), ""
    with asked:
        with_one_depth(dataset, path, depth)
    with asked:
        chosen = of_one_body(dataset, path, body)[1]
    axis = dataset["influenced_dof"]
    names = [chosen] if chosen or axis.ndim != 1 else [str(one).rpartition("__")[0] for one in axis.values]
    for needed in (lambda name: draft_of(dataset, path, name, draft),
                   lambda name: centre_of(dataset, path, name, rotation_center)):  # fmt: skip
        trials = [Refusals() for _ in names]
        for trial, name in zip(trials, names, strict=True):
            with trial:
                needed(name)
        if all(trial.reasons for trial in trials):
            asked.reasons.append(trials[0].reasons[0])
    asked.check()


def with_speed_zero(dataset: "Dataset", path: str) -> "Dataset":
    """The part of a dataset without forward speed. Raises ValueError if all of it has speed."""
    if "forward_speed" not in dataset.variables:
        return dataset
    speeds = np.atleast_1d(numbers(dataset, "forward_speed", None, path))
    if not (speeds == 0.0).any():
        raise argument_error("path", path, f"a dataset without forward speed; this one has {speeds[0]:g} m/s")
    if "forward_speed" in dataset.dims:
        dataset = dataset.isel(forward_speed=int(np.flatnonzero(speeds == 0.0)[0]))
    # beside those of other speeds, matrices without speed are there once for each direction
    for name in MATRICES:
        if "wave_direction" in dataset[name].dims:
            dataset[name] = dataset[name].isel(wave_direction=0)
    return dataset


def with_one_depth(dataset: "Dataset", path: str, depth: float | None) -> tuple["Dataset", float]:
    """The part of a dataset at the requested depth [m], and that depth. Raises ValueError without it."""
    depths = np.full(1, math.inf)
    if "water_depth" in dataset.variables:
        depths = np.atleast_1d(numbers(dataset, "water_depth", None, path, allow_infinite=True))
    if depths.ndim != 1 or not (depths > 0.0).all():
        raise argument_error("path", path, "a dataset of depths above 0 m")
    i = 0
    if depth is not None:
        depth = check_positive("depth", depth, "m", allow_infinite=True)
        fits = [one == depth or abs(one - depth) <= SAME_DEPTH * depth < math.inf for one in depths]
        i = fits.index(True) if True in fits else -1
    if i < 0 or (depth is None and len(depths) > 1):
        raise argument_error("depth", depth, f"one that the dataset has: {', '.join(f'{one:g}' for one in depths)} m")
    if "water_depth" in dataset.dims:
        dataset = dataset.isel(water_depth=i)
    return dataset, float(depths[i])


def by_frequency(dataset: "Dataset", path: str) -> "Dataset":
    """The dataset with `omega` as the axis of its frequencies. Raises ValueError if it has no such axis."""
    axes = [name for name in FREQUENCIES if name in dataset.dims]
    omega = dataset["omega"]
    if len(axes) != 1 or omega.dims != (axes[0],):
        raise argument_error("path", path, f"a dataset with one axis of frequencies, by {', '.join(FREQUENCIES)}")
    return dataset if axes == ["omega"] else dataset.swap_dims({axes[0]: "omega"})


def of_one_body(dataset: "Dataset", path: str, body: str | None) -> tuple["Dataset", str]:
    """The part of a dataset of one body with the six motions in their order, and the name before its motions.

    Raises ValueError if the body is not there, was not named, or lacks a motion.
    """
    parts = {}
    for axis in ("influenced_dof", "radiating_dof"):
        if dataset[axis].ndim != 1 or axis not in dataset.dims:
            raise argument_error("path", path, f"a dataset with the axis {axis}")
        parts[axis] = [str(name).rpartition("__")[::2] for name in dataset[axis].values]
    bodies = list(dict.fromkeys(name for name, _ in parts["influenced_dof"]))
    known = [*bodies, *(alone_name(dataset) if bodies == [""] else [])]
    if body is None and len(bodies) > 1:
        raise argument_error("body", body, f"one of the bodies of the dataset: {', '.join(bodies)}")
    if body is not None and body not in known:
        raise argument_error("body", body, f"one of the bodies of the dataset: {', '.join(filter(None, known))}")
    chosen = bodies[0] if len(bodies) == 1 else str(body)
    for axis, names in parts.items():
        wanted = [(chosen, motion) for motion in MOTIONS]
        if any(names.count(one) != 1 for one in wanted) or sum(name == chosen for name, _ in names) != len(MOTIONS):
            here = ", ".join(motion for name, motion in names if name == chosen)
            raise argument_error("path", path, f"a body with the motions {', '.join(MOTIONS)}; in {axis}: {here}")
        dataset = dataset.isel({axis: [names.index(one) for one in wanted]})
    return dataset, chosen


def alone_name(dataset: "Dataset") -> list[str]:
    """The name of the one body of a dataset, if it is said."""
    return [str(dataset[name].item()) for name in ("body", "body_name") if name in dataset and dataset[name].size == 1]


def of_body(dataset: "Dataset", name: str, body: str) -> np.ndarray | None:
    """Values of a variable that a dataset may have for each body; None without them, or where they are not numbers."""
    if name not in dataset.variables:
        return None
    values = dataset[name]
    axis = next((one for one in ("body", "body_name") if one in values.dims), "")
    if axis:
        names = [str(one) for one in values[axis].values] if axis in values.coords else []
        if body not in names:
            return None
        values = values.isel({axis: names.index(body)})
    array = values.values
    return array.astype(float) if array.dtype.kind in "iuf" and np.isfinite(array).all() else None


def draft_of(dataset: "Dataset", path: str, body: str, draft: float | None) -> float:
    """The draft [m] as given, or that of the dataset. Raises ValueError if neither is there."""
    if draft is not None:
        return check_positive("draft", draft, "m")
    draught = of_body(dataset, "draught", body)
    if draught is None or draught.ndim:
        raise argument_error("draft", draft, "a number above 0 m, as the dataset has no draught")
    return check_positive("draft", float(draught), "m")


def centre_of(dataset: "Dataset", path: str, body: str, center: Sequence[float] | None) -> np.ndarray:
    """The point (3,) [m] that the motions are about, as given, or that of the dataset.

    Without a centre of rotation it is the centre of mass. Raises ValueError if none is there.
    """
    if center is not None:
        return np.array(check_vector("rotation_center", center, "m"))
    for name in ("rotation_center", "center_of_mass"):
        point = of_body(dataset, name, body)
        if point is not None and point.shape == (3,):
            return point
    allowed = "a point (x, y, z) [m] that its motions are about, as the dataset has neither that nor a center_of_mass"
    raise argument_error("rotation_center", center, allowed)


def scalar(dataset: "Dataset", name: str, path: str) -> float:
    """The only number of a variable. Raises ValueError for several."""
    values = np.asarray(dataset[name].values)
    if values.size != 1 or values.dtype.kind not in "iuf":
        here = f"{values.size} of type {values.dtype}"
        raise argument_error("path", path, f"a dataset with one number {name}; this one has {here}")
    return float(values.reshape(-1)[0])


def numbers(
    dataset: "Dataset",
    name: str,
    axes: tuple[str, ...] | None,
    path: str,
    *,
    check: bool = True,
    allow_infinite: bool = False,
) -> np.ndarray:
    """The values of a variable along these axes, complex also where real and imaginary parts lie side by side.

    check: whether they have to be finite. Raises ValueError for other axes and numbers.
    """
    values: Any = dataset[name]
    if "complex" in values.dims and sorted(map(str, values["complex"].values)) == ["im", "re"]:
        values = values.sel(complex="re") + 1j * values.sel(complex="im")
    # a variable with one place along a further axis lies there
    values = values.squeeze([axis for axis in values.dims if axes and axis not in axes and values.sizes[axis] == 1])
    if axes is not None and set(values.dims) != set(axes):
        along = ", ".join(map(str, values.dims)) or "none"
        raise argument_error("path", path, f"a dataset with {name} along {', '.join(axes)}; in this one: {along}")
    array = np.asarray((values if axes is None else values.transpose(*axes)).values)
    if array.dtype.kind not in ("iufc" if name in FORCES else "iuf"):
        raise argument_error("path", path, f"a dataset of numbers; {name} has {array.dtype}")
    bad = ~(np.isfinite(array) | (allow_infinite & (array == np.inf)))
    if check and bad.any():
        raise argument_error("path", path, f"a dataset of finite numbers; of {name} {int(bad.sum())} are not")
    return array


def place_of_heading(headings: np.ndarray, path: str, heading: float | None) -> int:
    """Index of the requested one of headings (n,) [rad]. Raises ValueError without it."""
    if heading is None:
        return 0
    miss = np.abs(within_half_turn(headings - check_angle("heading", heading)))
    if not len(miss) or miss.min() > SAME_HEADING:
        known = ", ".join(f"{one:.4g}" for one in headings)
        raise argument_error("heading", heading, f"one that the dataset has: {known} rad")
    return int(miss.argmin())


def resampled(X: np.ndarray, headings: np.ndarray, path: str) -> np.ndarray:
    """Forces (n, 36, 6) in DIRECTIONS by cubics through those (n, headings, 6) of a dataset, at rising headings.

    Headings from 0 to 90, or to 180, degrees are mirrored, of a hull that is as symmetric as that needs.
    """
    for end, factor in ((math.pi / 2, MIRROR_X), (math.pi, MIRROR_Y)):
        if abs(headings[0]) < 1e-6 and abs(headings[-1] - end) < 1e-6:
            mirrored, at = X * factor, headings < end - 1e-6
            # a component that the mirror turns round is 0 in a wave that it leaves
            still = X[:, -1:] if factor is MIRROR_X else X[:, [0, -1]]
            if np.abs(still[:, :, factor < 0]).max() > SYMMETRY * np.abs(X).max():
                allowed = "directions all around a hull that is not symmetric, or one chosen by `heading`"
                raise argument_error("path", path, allowed)
            keep = at if factor is MIRROR_X else at & (headings > 1e-6)
            headings = np.concatenate([headings, (2.0 * end - headings[keep])[::-1]])
            X = np.concatenate([X, mirrored[:, keep][:, ::-1]], axis=1)
    around = np.concatenate([headings[-2:] - 2 * math.pi, headings, headings[:3] + 2 * math.pi])
    if np.diff(around).max() > WIDEST_GAP or len(headings) < 4:
        allowed = (
            "directions at most 30 degrees apart, all around or up to 90 or 180 degrees, or one chosen by `heading`"
        )
        raise argument_error("path", path, allowed)
    values = np.concatenate([X[:, -2:], X, X[:, :3]], axis=1)
    index, weights = lagrange(around, DIRECTIONS)
    return np.einsum("dw,ndwm->ndm", weights, values[:, index])
