"""`springtide hull`, and what every start with a mesh prints."""

import re
from pathlib import Path

import pytest
import trimesh

from app.__main__ import main
from tests.sim.floating.hulls.test_mesh_files import DECK, SIDES, VERTICES, gdf, stl

FACES = [*DECK.tolist(), *SIDES.tolist()]


@pytest.fixture
def no_server(monkeypatch):
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda *_, **__: 0)


def test_the_facts_of_a_hull_are_printed(tmp_path, capsys):
    path = stl(tmp_path / "wedge.stl", VERTICES, FACES)
    assert main(["hull", str(path), "--density", "300"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "size: 20 m long, 6 m wide, 3 m high" in said
    assert "volume: 240 m3 of 12 triangles, closed" in said
    assert "draft: 1.242 m in sea water at 300 kg/m3, a mass of 7.2e+04 kg" in said
    T = 1.2420  # the half width at a height z is 1 + 2 z/3
    buoyancy = 40.0 * (T**2 / 2 + 2 * T**3 / 9) / (240.0 * 300.0 / 1025.0)
    height = buoyancy + 20.0 * (2 + 4 * T / 3) ** 3 / 12 / (240.0 * 300.0 / 1025.0) - 1.75
    found = re.search(r"GM: (\S+) m with the centre of gravity 1.75 m over the keel GZ:", said)
    assert float(found[1]) == pytest.approx(height, abs=1e-3)  # type: ignore[index]
    assert re.findall(r"at (\d+) deg", said) == ["5", "10", "15", "20", "30", "40", "50", "60"]
    assert main(["hull", str(path), "--kg", "2.9 m"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "2.9 m over the keel: not stable upright GZ: -" in said


def test_a_box_has_the_closed_forms(tmp_path, capsys):
    """KB + I/V - KG of a box of half the density of sea water, afloat to half its height."""
    trimesh.creation.box((20.0, 6.0, 3.0)).export(tmp_path / "box.stl")
    assert main(["hull", str(tmp_path / "box.stl"), "--density", "512.5", "--kg", "1"]) == 0
    said = capsys.readouterr().out
    assert "draft: 1.5 m" in said
    assert f"GM: {0.75 + 6.0**2 / (12 * 1.5) - 1.0:.4g} m" in said


def test_an_open_mesh_is_shown_with_its_place_and_the_remedy(tmp_path, capsys):
    path = stl(tmp_path / "shell.stl", VERTICES, SIDES)
    assert main(["hull", str(path)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert (
        "open: 4 edges without exactly one opposite, at x -10 to 10, y -3 to 3, z 3 to 3 m closed by: --cap deck"
        in said
    )
    assert main(["hull", str(path), "--cap", "deck"]) == 0
    assert "closed" in capsys.readouterr().out
    assert main(["hull", str(path), "--density", "2000"]) == 2
    assert main(["hull", str(stl(tmp_path / "whole.stl", VERTICES, FACES)), "--kg", "9"]) == 2
    assert "0 to 3 m" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("scale", "unit", "warned"), [(1.0, "m", False), (100.0, "m", True), (100.0, "cm", False), (0.001, "m", True)]
)
def test_every_start_prints_the_size_and_warns_of_an_unlikely_one(tmp_path, capsys, no_server, scale, unit, warned):
    path = stl(tmp_path / "wedge.stl", scale * VERTICES, FACES)
    assert main(["--scene", "radial_sea", "--no-open", "--hull", str(path), "--hull-unit", unit]) == 0
    shown = capsys.readouterr()
    factor = scale * {"m": 1.0, "cm": 0.01}[unit]
    assert shown.out.startswith(
        f"wedge.stl: {20 * factor:.4g} m long, {6 * factor:.4g} m wide, {3 * factor:.4g} m high, "
    )
    assert f"floats {1.686 * factor:.3g} m deep at 450 kg/m3" in shown.out
    assert ("--hull-unit takes m, cm, mm or ft" in shown.err) == warned


def test_a_repaired_mesh_floats_in_the_scene(tmp_path: Path, capsys):
    """The options of the command line reach the scene."""
    path = tmp_path / "half.gdf"
    path.write_text(gdf(), encoding="utf-8")
    run = ["run", "radial_sea", "--seconds", "0.1", "--out", str(tmp_path / "a.npz"), "--hull", str(path)]
    assert main(run) == 2
    assert "--cap deck closes it" in capsys.readouterr().err
    assert main([*run, "--cap", "deck", "--set", "bodies=0", "rig=false", "wave_count=8"]) == 0
    assert "half.gdf: 20 m long, 6 m wide, 3 m high, 240 m3" in capsys.readouterr().out


def test_without_meshio_one_line_says_how_to_install_it(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "meshio", None)
    (tmp_path / "a.msh").write_text("$MeshFormat\n", encoding="utf-8")
    assert main(["hull", str(tmp_path / "a.msh")]) == 1
    assert "pip install '.[meshes]'" in capsys.readouterr().err
