"""Linear radiation and diffraction of a hull in deep water, by the boundary-element program Capytaine (extra `bem`).

All numbers are at unit density and unit gravity and in units of a length of the hull, so that they hold for every
size and planet. A motion is (surge, sway, heave, roll, pitch, yaw) about the point of the waterline above the origin.
Capytaine: Ancellin and Dias 2019, J. Open Source Software 4(36):1341.
"""

import importlib
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.floating.hulls.hull import Hull
from sim.floating.hulls.panels import WANTED_PANELS, wet_panels
from sim.floating.linear.hydrodynamics import DIRECTIONS, table_length
from sim.floating.linear.linear_table import LinearTable

# Frequencies omega sqrt(length/g): densest about resonance, up to three times it
FREQUENCIES = (
    0.15, 0.3, 0.45, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 2.8, 3.2,
)  # fmt: skip


class Solution(NamedTuple):
    """Linear coefficients of one hull at one draft, at unit density, gravity and length."""

    added_mass: np.ndarray  # (n, 6, 6) at each frequency
    damping: np.ndarray  # (n, 6, 6)
    infinite: np.ndarray  # (6, 6) added mass at infinite frequency
    # (n, m, 6) complex force of a wave of unit height a cos(k.x - omega t) from m directions: a Re(X exp(i(k.x - wt)))
    excitation: np.ndarray


def solve(
    vertices: np.ndarray,
    faces: np.ndarray,
    directions: np.ndarray,
    frequencies: tuple[float, ...] = FREQUENCIES,
    progress: Callable[[], None] = lambda: None,
) -> Solution:
    """The coefficients of the wet surface of vertices (v, 3) and faces (f, 4), outward, below the level z = 0.

    directions (m,) [rad] in which waves run. A triangle repeats its last vertex. A lid on the water inside the hull
    removes the irregular frequencies. `progress` is called after each frequency. Raises ModuleNotFoundError without
    Capytaine.
    """
    capytaine: Any = importlib.import_module("capytaine")
    capytaine.set_logging("ERROR")
    mesh = capytaine.Mesh(vertices=vertices, faces=faces)
    body = capytaine.FloatingBody(
        mesh,
        lid_mesh=mesh.generate_lid(),
        dofs=capytaine.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.0)),
        center_of_mass=(0.0, 0.0, 0.0),
    )
    names = ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")
    # Potentials instead of sources: on the panels of a ball the added mass is then right within 0.2 % instead of 2 %,
    # and damping and excitation agree within 0.2 % instead of 4 %.
    solver = capytaine.BEMSolver(method="direct")
    water = {"body": body, "water_depth": np.inf, "g": 1.0, "rho": 1.0}

    def radiate(omega: float) -> tuple[np.ndarray, np.ndarray]:
        results = [
            solver.solve(capytaine.RadiationProblem(radiating_dof=name, omega=omega, **water), keep_details=False)
            for name in names
        ]
        a = np.array([[result.added_masses[name] for name in names] for result in results])
        b = np.array([[result.radiation_dampings[name] for name in names] for result in results])
        return (a + a.T) / 2, (b + b.T) / 2

    added, damping, excitation = [], [], []
    for omega in frequencies:
        a, b = radiate(omega)
        added.append(a)
        damping.append(b)
        row = []
        for direction in directions:
            problem = capytaine.DiffractionProblem(wave_direction=float(direction), omega=omega, **water)
            result = solver.solve(problem, keep_details=False)
            pressure = capytaine.bem.airy_waves.froude_krylov_force(problem)
            row.append([result.forces[name] + pressure[name] for name in names])
        excitation.append(row)
        progress()
    infinite, _ = radiate(np.inf)
    return Solution(np.array(added), np.array(damping), infinite, np.array(excitation))


def panels_of(hull: Hull, draft: float) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of the wet surface of a hull at a draft [m], over `table_length`, as `solve` takes them."""
    panels = wet_panels(hull, draft, WANTED_PANELS) / table_length(hull)
    corner = np.arange(3 * len(panels)).reshape(-1, 3)
    return panels.reshape(-1, 3), np.column_stack([corner, corner[:, 2]])


def make_table(
    hull: Hull,
    drafts: Sequence[float],
    progress: Callable[[], None] = lambda: None,
    wet_surface: Callable[[Hull, float], tuple[np.ndarray, np.ndarray]] = panels_of,
) -> LinearTable:
    """The table of a hull at drafts (d,) [m], each less than its height; `progress` is called after each frequency.

    Raises ValueError for a mesh of too many triangles, ModuleNotFoundError without Capytaine.
    """
    length = table_length(hull)
    solutions = [solve(*wet_surface(hull, draft), DIRECTIONS, progress=progress) for draft in drafts]
    stacked: dict[str, Any] = {
        field: np.array([[getattr(one, field) for one in solutions]]) for field in Solution._fields
    }
    return LinearTable(
        aspect=np.ones(1), draft=np.array(drafts, float) / length, direction=DIRECTIONS,
        frequency=np.array(FREQUENCIES), **stacked,
    )  # fmt: skip
