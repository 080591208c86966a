"""Makes the datasets of this folder by Capytaine 3, with its own RAO (needs the extras `bem` and `sweep`; 10 s).

python -m tests.sim.floating.datasets.make

depths.nc: a box of 20 m x 10 m at a draft of 2 m, in water 20 m deep and in deep water, by omega. bodies.nc: the same
box beside another of 8 m x 8 m, in water 20 m deep, by period. The restoring forces are the closed forms of a box, and
coefficients are made symmetric, before Capytaine solves for the RAO. Each body moves alone.
"""

import importlib
from pathlib import Path
from typing import Any

import numpy as np

cpt: Any = importlib.import_module("capytaine")
xarray: Any = importlib.import_module("xarray")
HERE = Path(__file__).parent
DRAFT, HEIGHT, DENSITY, GRAVITY = 2.0, 4.0, 1025.0, 9.81
BOXES = {"fore": ((20.0, 10.0), (-20.0, 0.0, -0.5)), "aft": ((8.0, 8.0), (10.0, 5.0, -0.3))}  # sides, centre of mass
OMEGA = np.array([0.35, 0.5, 0.7, 0.9, 1.1, 1.3, 1.6, 2.0])
MATRICES = ("added_mass", "radiation_damping")
FORCES = ("diffraction_force", "Froude_Krylov_force")


def mass_and_stiffness(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Mass and restoring matrices (6, 6) of a solid box about its centre of mass, in closed form."""
    (x, y), (_, _, z) = BOXES[name]
    mass = DENSITY * x * y * DRAFT
    inertia = mass / 12.0 * np.array([y**2 + HEIGHT**2, x**2 + HEIGHT**2, x**2 + y**2])
    metacentric = [side**2 / (12.0 * DRAFT) - DRAFT / 2 - z for side in (y, x)]
    stiffness = GRAVITY * mass * np.array([0.0, 0.0, 1.0 / DRAFT, *metacentric, 0.0])
    return np.diag([mass] * 3 + [*inertia]), np.diag(stiffness)


def box(name: str, centre: tuple[float, float, float], panels: tuple[int, int, int]) -> Any:
    """A box with its centre of mass there."""
    (x, y), _ = BOXES[name]
    whole = cpt.mesh_parallelepiped(size=(x, y, HEIGHT), resolution=panels, center=(*centre[:2], 0.0), name=name)
    dofs = cpt.rigid_body_dofs(rotation_center=centre)
    return cpt.FloatingBody(whole.immersed_part(), dofs=dofs, center_of_mass=centre, name=name)


def with_rao(dataset: Any, names: dict[str, str]) -> Any:
    """The dataset with symmetric coefficients and the RAO of each body by Capytaine, names: prefix of dofs -> box."""
    for name in MATRICES:
        turned = dataset[name].rename(influenced_dof="radiating_dof", radiating_dof="influenced_dof")
        dataset[name] = 0.5 * (dataset[name] + turned.transpose(*dataset[name].dims))
    found = []
    for prefix, which in names.items():
        dofs = [f"{prefix}{motion}" for motion in ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")]
        part = dataset.sel(influenced_dof=dofs, radiating_dof=dofs)
        part = part.sel(omega=np.isfinite(part["omega"])) if "omega" in part.dims else part
        for matrix, values in zip(("inertia_matrix", "hydrostatic_stiffness"), mass_and_stiffness(which), strict=True):
            part[matrix] = part[matrix].copy(data=values)
        found.append(cpt.post_pro.rao(part))
    return dataset.assign(RAO=xarray.concat(found, "radiating_dof"))


def write(dataset: Any, path: Path) -> None:
    """Write a dataset without what follows from the rest, large arrays in single precision."""
    dataset = dataset.drop_vars(["excitation_force", "hydrostatic_stiffness", "inertia_matrix", "disp_mass"])
    cpt.export_dataset(path, dataset)
    with xarray.open_dataset(path) as file:
        written = file.load()
    large = {name: {"dtype": "float32"} for name in (*MATRICES, *FORCES, "RAO")}
    written.to_netcdf(path, encoding=large)


def solved(body: Any, **grid: Any) -> Any:
    """The dataset of a body over a grid."""
    grid = {"rho": DENSITY, "g": GRAVITY, "radiating_dof": [*body.dofs], **grid}
    return cpt.BEMSolver().fill_dataset(xarray.Dataset(coords=grid), body, progress_bar=False)


if __name__ == "__main__":
    cpt.set_logging("ERROR")
    alone = box("fore", (0.0, 0.0, -0.5), (8, 5, 2))
    directions = np.radians(np.arange(0.0, 91.0, 15.0))
    omega = np.append(OMEGA, np.inf)
    write(
        with_rao(solved(alone, omega=omega, water_depth=[20.0, np.inf], wave_direction=directions), {"": "fore"}),
        HERE / "depths.nc",
    )
    both = box("fore", BOXES["fore"][1], (8, 5, 2)) + box("aft", BOXES["aft"][1], (4, 4, 2))
    period, directions = 2.0 * np.pi / OMEGA[::-1], np.radians(np.arange(0.0, 360.0, 30.0))
    names = {"fore__": "fore", "aft__": "aft"}
    write(
        with_rao(solved(both, period=period, water_depth=[20.0], wave_direction=directions), names), HERE / "bodies.nc"
    )
