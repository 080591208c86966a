"""Makes assets/barge.nc: what Capytaine says of a barge of 60 m x 16 m x 6 m at a draft of 3 m, its own RAO included.

python -m assets.make_barge    (needs the extras `bem` and `sweep`; some minutes on one core)

The dataset is one that `capytaine.export_dataset` writes. Its centre of mass is 4 m over the keel, and its radii of
gyration are 5.6 m and 15 m. The restoring forces are the closed forms of a box: Capytaine's sums over the middles of
panels are 1.8 % lower in roll.
"""

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from assets.shape_panels import box

cpt: Any = importlib.import_module("capytaine")
LENGTH, WIDTH, DRAFT, CENTRE = 60.0, 16.0, 3.0, 1.0  # [m], the last one over the waterline
GYRATION = (5.6, 15.0, 15.0)  # [m]
OMEGA = (*np.arange(0.2, 2.01, 0.075), np.inf)  # [rad/s]
DIRECTIONS = np.radians(np.arange(0.0, 181.0, 10.0))


def barge() -> Any:
    """The barge, with its mass and its restoring forces."""
    unit = np.sqrt(LENGTH * WIDTH) / 2
    vertices, faces = box(LENGTH / WIDTH, DRAFT / unit)
    mesh = cpt.Mesh(vertices=unit * vertices, faces=faces, name="barge")
    centre = (0.0, 0.0, CENTRE)
    dofs = cpt.rigid_body_dofs(rotation_center=centre)
    body = cpt.FloatingBody(mesh, lid_mesh=mesh.generate_lid(), dofs=dofs, center_of_mass=centre, name="barge")
    mass = 1025.0 * LENGTH * WIDTH * DRAFT
    body.inertia_matrix = body.add_dofs_labels_to_matrix(np.diag([mass] * 3 + [mass * r**2 for r in GYRATION]))
    moments = [DRAFT / 2 + side**2 / (12 * DRAFT) - DRAFT - CENTRE for side in (WIDTH, LENGTH)]  # GM [m]
    stiffness = 9.81 * np.diag([0.0, 0.0, mass / DRAFT, mass * moments[0], mass * moments[1], 0.0])
    body.hydrostatic_stiffness = body.add_dofs_labels_to_matrix(stiffness)
    return body


if __name__ == "__main__":
    body = barge()
    water = {"body": body, "water_depth": np.inf, "rho": 1025.0, "g": 9.81}
    problems = [cpt.RadiationProblem(radiating_dof=dof, omega=omega, **water) for omega in OMEGA for dof in body.dofs]
    problems += [
        cpt.DiffractionProblem(wave_direction=direction, omega=omega, **water)
        for omega in OMEGA[:-1]
        for direction in DIRECTIONS
    ]
    results = cpt.BEMSolver(method="direct").solve_all(problems, keep_details=False)
    dataset = cpt.assemble_dataset(results)
    dataset["RAO"] = cpt.post_pro.rao(dataset.sel(omega=list(OMEGA[:-1])))
    cpt.export_dataset(Path(__file__).with_name("barge.nc"), dataset)
