"""`springtide hydrodynamics`, without Capytaine: a solver that knows the box stands in for it."""

import dataclasses
import importlib.util
from pathlib import Path

import numpy as np
import pytest
import trimesh

from app.__main__ import main
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.report import forces_html
from app.scenes.radial_sea.scene import RadialSeaScene
from sim.floating import Hull, equilibrium_draft, shape_from_file
from sim.floating.hulls.panels import areas_of, wet_panels
from sim.floating.linear import boundary_elements
from sim.floating.linear.boundary_elements import FREQUENCIES, Solution
from sim.floating.linear.hydrodynamics import around, interpolated, linear_hull
from sim.floating.linear.linear_table import table_of

EDGE, HEIGHT, DENSITY = 2.0, 1.0, 400.0
WATER = ((1025.0, float("inf")),)


@pytest.fixture
def box_file(tmp_path: Path) -> Path:
    path = tmp_path / "box.stl"
    trimesh.creation.box((EDGE, EDGE, HEIGHT)).export(path)
    return path


def known_box(vertices: np.ndarray, *_, **__) -> Solution:
    """The committed coefficients of the square box that reaches as deep as these vertices."""
    found = interpolated(table_of("box"), 1.0, float(-vertices[:, 2].min()))
    whole = around(found.excitation, found.direction)
    return Solution(found.added_mass, found.damping, found.infinite, whole)


@pytest.fixture
def solver(monkeypatch: pytest.MonkeyPatch) -> None:
    known = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name == "capytaine" or known(name))
    monkeypatch.setattr(boundary_elements, "solve", known_box)


@pytest.mark.usefixtures("solver")
def test_the_table_of_a_hull_is_found_beside_it_and_used(box_file: Path) -> None:
    before = shape_from_file(box_file)
    assert main(["hydrodynamics", str(box_file)]) == 0
    own = Hull.load(box_file)
    assert before.table is None
    assert own.shape.table is not None
    assert own.shape.table.frequency.tolist() == list(FREQUENCIES)
    box = Hull.box(EDGE, EDGE, HEIGHT)
    draft = equilibrium_draft(box, DENSITY, WATER)
    found, wanted = linear_hull(own, draft), linear_hull(box, draft)
    for name in ("added_mass", "damping", "infinite", "excitation"):
        scale = np.abs(getattr(wanted, name)).max()
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), atol=0.03 * scale)


@pytest.mark.usefixtures("solver")
def test_the_page_says_that_a_hull_is_taken_for_a_box_until_it_has_its_own_table(box_file: Path) -> None:
    scene = RadialSeaScene(dataclasses.replace(RadialSeaParams(), hull=str(box_file)))
    assert "springtide hydrodynamics" in forces_html(scene.readings())
    assert main(["hydrodynamics", str(box_file)]) == 0
    scene = RadialSeaScene(dataclasses.replace(RadialSeaParams(), hull=str(box_file)))
    assert "springtide hydrodynamics" not in forces_html(scene.readings())


@pytest.mark.usefixtures("solver")
def test_a_table_of_another_mesh_or_rubbish_is_refused(box_file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["hydrodynamics", str(box_file)]) == 0
    trimesh.creation.box((EDGE, EDGE, 2 * HEIGHT)).export(box_file)
    with pytest.raises(ValueError, match="the table of this mesh"):
        Hull.load(box_file)
    assert main(["hydrodynamics", str(box_file)]) == 0  # the command itself makes it anew
    assert Hull.load(box_file).shape.table is not None
    box_file.with_name("box.hydrodynamics.npz").write_bytes(b"no table")
    with pytest.raises(ValueError, match="a table made by `springtide hydrodynamics`"):
        Hull.load(box_file)
    capsys.readouterr()


def test_what_is_missing_or_wrong_is_said(
    box_file: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    for words, status, text in (
        ([str(box_file)], 1, "pip install '.[bem]'"),
        (["--compare"], 1, "pip install '.[bem]'"),
        ([], 2, "a mesh file, or --compare"),
        ([str(box_file), "--compare"], 2, "a mesh file, or --compare"),
        ([str(box_file.with_name("none.stl"))], 2, "none.stl: no such file"),
        ([str(box_file), "--out", str(box_file / "no" / "out.npz")], 2, "a folder that exists"),
    ):
        assert main(["hydrodynamics", *words]) == status
        assert text in capsys.readouterr().err
    open_mesh = trimesh.creation.box((1.0, 1.0, 1.0))
    open_mesh.update_faces(np.arange(11))
    open_mesh.export(box_file)
    assert main(["hydrodynamics", str(box_file)]) == 2
    assert "closed" in capsys.readouterr().err


def test_panels_are_the_wet_surface() -> None:
    hull = Hull.sphere(1.0, 6)
    for draft in (0.3, 1.0, 1.7):
        panels = wet_panels(hull, draft, 300)
        assert 300 <= len(panels) <= 700
        assert panels[:, :, 2].max() <= 1e-12
        assert areas_of(panels).sum() == pytest.approx(2 * np.pi * draft, rel=0.03)
        normal = np.cross(panels[:, 1] - panels[:, 0], panels[:, 2] - panels[:, 0]) / 2
        volume = (panels[:, :, 2].mean(axis=1) * normal[:, 2]).sum()
        assert volume == pytest.approx(np.pi * draft**2 * (3 - draft) / 3, rel=0.01)
