"""Panels for boundary elements, and what is made of the answers of a boundary-element program."""

import math
import sys
import types

import numpy as np
import pytest

from assets.shape_panels import PANELS, clustered
from sim.floating.linear.boundary_elements import solve

VOLUMES = {
    "box": lambda draft: 4.0 * draft,
    "cylinder": lambda draft: math.pi * draft,
    "sphere": lambda draft: math.pi * draft**2 * (3.0 - draft) / 3.0,
}


def volume_below(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Volume between a surface of quadrilaterals, outward, and the plane z = 0: by the divergence theorem."""
    a, b, c, d = (vertices[faces[:, i]] for i in range(4))
    across = np.cross(c - a, d - b)[:, 2] / 2.0  # z component of area times normal
    return float((across * (a + b + c + d)[:, 2] / 4.0).sum())


@pytest.mark.parametrize("draft", [0.3, 1.1])
@pytest.mark.parametrize("name", list(PANELS))
def test_panels_enclose_the_displaced_volume_and_look_outward(name: str, draft: float) -> None:
    vertices, faces = PANELS[name](2.5 if name == "box" else 1.0, draft)
    assert volume_below(vertices, faces) == pytest.approx(VOLUMES[name](draft), rel=0.01)
    assert vertices[:, 2].max() == pytest.approx(0.0, abs=1e-12)
    assert vertices[:, 2].min() == pytest.approx(-draft, rel=1e-9)


def test_panels_are_closer_together_towards_an_edge() -> None:
    places = clustered(100)
    assert (places[0], places[-1]) == (0.0, 1.0)
    steps = np.diff(places)
    assert (np.diff(steps) < 0.0).all()
    assert steps[0] / steps[-1] == pytest.approx(1.0 + math.pi / 2.0, rel=0.03)


@pytest.mark.parametrize(("draft", "rows"), [(0.1, 3), (0.6, 5), (4.2, 11)])
def test_a_wall_has_a_row_of_panels_for_each_0_12_of_its_depth(draft: float, rows: int) -> None:
    _, faces = PANELS["cylinder"](1.0, draft)
    assert len(faces) == 40 * (rows + 9)


class KnownProgram(types.ModuleType):
    """In place of Capytaine: added mass of heave by surge is 2 and of surge by heave 4, and so on."""

    bem = types.SimpleNamespace(
        airy_waves=types.SimpleNamespace(froude_krylov_force=lambda problem: dict.fromkeys(problem["names"], 3.0j))
    )

    def __getattr__(self, name: str):
        return lambda *args, **values: None

    @staticmethod
    def Mesh(vertices, faces):
        return types.SimpleNamespace(generate_lid=lambda: "lid")

    @staticmethod
    def rigid_body_dofs(rotation_center):
        return ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")

    @staticmethod
    def FloatingBody(mesh, lid_mesh, dofs, center_of_mass):
        return dofs

    @staticmethod
    def RadiationProblem(radiating_dof, omega, body, **water):
        return {"dof": body.index(radiating_dof), "omega": omega, "names": body}

    @staticmethod
    def DiffractionProblem(wave_direction, omega, body, **water):
        return {"direction": wave_direction, "omega": omega, "names": body}

    @staticmethod
    def BEMSolver(method):
        def answer(problem, keep_details):
            row = np.arange(6) + 6.0 * problem.get("dof", 0)
            named = dict(zip(problem["names"], row, strict=True))
            return types.SimpleNamespace(
                added_masses=named, radiation_dampings={n: -v for n, v in named.items()},
                forces={n: v + problem.get("direction", 0.0) for n, v in named.items()},
            )  # fmt: skip

        return types.SimpleNamespace(solve=answer)


def test_coefficients_are_made_symmetric_and_forces_are_those_of_the_wave_and_of_diffraction(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "capytaine", KnownProgram("capytaine"))
    calls = []
    found = solve(np.zeros((4, 3)), np.array([[0, 1, 2, 3]]), np.array([0.0, 0.5]), (0.7, 1.3), lambda: calls.append(1))
    answers = np.arange(36.0).reshape(6, 6)
    np.testing.assert_allclose(found.added_mass, np.stack([(answers + answers.T) / 2] * 2))
    np.testing.assert_allclose(found.damping, -found.added_mass)
    np.testing.assert_allclose(found.infinite, found.added_mass[0])
    np.testing.assert_allclose(found.excitation[1, 1], np.arange(6) + 0.5 + 3.0j)
    assert len(calls) == 2
