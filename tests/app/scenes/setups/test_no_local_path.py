"""Files that may be shared hold no path of this machine, and who reads them is told of the mesh that is missing."""

import dataclasses
import io
import json
import os
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.__main__ import main
from app.notebook.dataset import to_dataset
from app.notebook.lab import read_setup as read_notebook_setup
from app.panel.recording.recorder import Recorder
from app.panel.recording.recording_files import Plotted, recording_npz
from app.scenes import scene_named
from app.scenes.setups import (
    Setup,
    file_name,
    missing_files,
    preset_setup,
    read_file,
    read_query,
    read_setup,
    read_setup_text,
    write_file,
    write_query,
)
from app.server.loop.sim_loop import SimLoop
from app.server.replay_file import replay_html
from app.study.sweep.results import about
from app.study.sweep.spec import make_spec, read_spec

KIND = scene_named("radial_sea")
SMALL: dict[str, Any] = {"bodies": 1, "rings": 20, "spokes": 24, "wave_count": 20}
SECRET = "of-nobody-else"  # a folder above the mesh
CUBE = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
FACES = "1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"  # outward


@pytest.fixture(scope="module")
def mesh(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp(SECRET)
    lines = [f"v {x} {y} {z}" for x, y, z in CUBE]
    path = folder / "boat.obj"
    path.write_text("\n".join([*lines, *(f"f {face}" for face in FACES)]) + "\n", "utf-8")
    return path


@pytest.fixture(scope="module")
def written(mesh: Path) -> dict[str, bytes]:
    """Every file that may be shared, by its name."""
    params: Any = dataclasses.replace(KIND.params(**SMALL), hull=str(mesh))  # type: ignore[type-var]
    loop = SimLoop(KIND.make(params))
    recorder = Recorder(KIND.packing)
    for i in range(4):
        loop.tick(1 / 25)
        recorder.note(loop.latest, i / 25)
    out = mesh.with_name("run.npz")
    values = [f"{name}={value}" for name, value in SMALL.items()]
    command = ["run", "radial_sea", "--seconds", "0.1", "--out", str(out), "--hull", str(mesh), "--set", *values]
    assert main(command) == 0
    data = to_dataset(KIND, loop.scene, (), write_query(KIND, params))
    return {
        "recording.npz": recording_npz(KIND, recorder.all_frames()),
        "run.npz": out.read_bytes(),
        "setup.json": write_file(KIND, params, name="Mine").encode(),
        "replay.html": replay_html(KIND, recorder.all_frames(), Plotted((), {})).encode(),
        "link.txt": write_query(KIND, params).encode(),
        "dataset.json": json.dumps(data.to_dict(data=False), default=str).encode(),
    }


def text_of(name: str, content: bytes) -> str:
    """All text in a file; what is packed is unpacked."""
    if not name.endswith(".npz"):
        return content.decode()
    with np.load(io.BytesIO(content)) as arrays:
        return " ".join([*arrays.files, *(str(array) for array in arrays.values() if array.dtype.kind == "U")])


def test_no_file_holds_the_folder_of_the_mesh(written: dict[str, bytes], mesh: Path) -> None:
    for name, content in written.items():
        text = text_of(name, content)
        assert SECRET not in text, name
        assert str(mesh.parent) not in text, name
        assert mesh.name in text or name in ("link.txt", "dataset.json"), name
        assert str(Path.home()) not in text, name


@pytest.mark.parametrize("name", ["recording.npz", "run.npz", "setup.json", "replay.html"])
def test_a_reader_is_told_how_to_add_the_mesh(
    name: str, written: dict[str, bytes], mesh: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / name
    file.write_bytes(written[name])
    setup = read_setup(str(file))
    assert setup == read_file(read_setup_text("set-up", file), scene="radial_sea")
    assert setup.files == {"hull": "boat.obj"}
    assert setup.params == KIND.params(**SMALL)
    assert "hull boat.obj is missing" in missing_files(setup)
    assert "--hull boat.obj" in missing_files(setup)
    assert missing_files(setup, dataclasses.replace(KIND.params(), hull=str(mesh))) == ""
    out = ["run", "radial_sea", "--seconds", "0.1", "--out", str(tmp_path / "again.npz"), "--preset", str(file)]
    capsys.readouterr()
    assert main(out) == 0
    said = capsys.readouterr().err
    assert said == f"springtide: {missing_files(setup)}\n"
    assert main([*out, "--hull", str(mesh)]) == 0
    assert "missing" not in capsys.readouterr().err
    with pytest.raises(ValueError, match=r"preset: .* with the hull boat\.obj. is not allowed"):
        make_spec(
            {"scene": "radial_sea", "seconds": 1.0, "preset": str(file), "parameters": {"wind_speed": [5.0, 9.0]}}
        )
    with pytest.warns(UserWarning, match=r"boat\.obj is not in"):
        read_notebook_setup("radial_sea", str(file), {})


@pytest.mark.parametrize("written", [json.dumps, "'{}'".format], ids=["double quotes", "single quotes"])
def test_a_sweep_keeps_the_name_of_its_preset_only(tmp_path: Path, written: Callable[[str], str]) -> None:
    folder = tmp_path if os.name == "nt" else tmp_path / r"with\Users"
    folder.mkdir(exist_ok=True)
    file, path = folder / "setup.json", tmp_path / "spec.toml"
    file.write_text(write_file(KIND, KIND.params(**SMALL)), "utf-8")
    head = 'scene = "radial_sea"\nseconds = 1\n'
    path.write_text(f"{head}preset = {written(str(file))}\n[parameters]\nwind_speed = [5.0, 9.0]\n", "utf-8")
    kept = about(read_spec(path))
    assert f"preset = {written('setup.json')}" in kept["spec"]
    assert tmp_path.name not in str(kept)
    path.write_text(f'{head}preset = "{file}"\n', "utf-8")
    with pytest.raises(ValueError, match=r"is not TOML .*; a path with backslashes goes in single quotes"):
        read_spec(path)


def test_without_a_mesh_nothing_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "setup.json"
    file.write_text(write_file(KIND, KIND.params(**SMALL)), "utf-8")
    assert json.loads(file.read_text("utf-8"))["version"] == 1
    assert missing_files(preset_setup("--preset", str(file), KIND)) == ""
    assert missing_files(read_query("?scene=rope")) == ""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_notebook_setup("radial_sea", str(file), {})
    assert capsys.readouterr().err == ""


def test_of_a_path_of_any_system_only_the_last_part_is_read_and_written() -> None:
    assert (
        file_name("/home/anna/boat.stl") == file_name(r"C:\Users\anna\boat.stl") == file_name("boat.stl") == "boat.stl"
    )
    text = json.dumps({"version": 2, "scene": "radial_sea", "parameters": {}, "hull": "/home/anna/boat.stl"})
    assert read_file(text) == Setup("radial_sea", KIND.params(), {}, files={"hull": "boat.stl"})
    with pytest.raises(ValueError, match=r"hull: .* is not allowed"):
        read_file(json.dumps({"version": 2, "scene": "radial_sea", "parameters": {}, "hull": 3}))


@pytest.mark.parametrize("scene", ["square_sea", "radial_sea"])
def test_a_measured_spectrum_is_named_too(scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A recording opens with it again, and says how without it."""
    table = tmp_path / "buoy.csv"
    table.write_text(
        "f,S\n" + "".join(f"{0.01 * i:g},{max(0.0, 4.0 - (i - 12) ** 2):g}\n" for i in range(5, 40)), "utf-8"
    )
    out = tmp_path / "run.npz"
    command = ["run", scene, "--seconds", "0.1", "--out", str(out)]
    small = ["size=64", "mesh=32"] if scene == "square_sea" else ["bodies=0", "rig=false", "rings=16", "spokes=16"]
    assert main([*command, "--set", *small, "--spectrum", str(table)]) == 0
    setup = read_setup(str(out))
    assert setup.files == {"spectrum": "buoy.csv"}
    assert str(tmp_path) not in text_of("run.npz", out.read_bytes())
    capsys.readouterr()
    assert main([*command, "--preset", str(out)]) == 0
    assert "Restart with --spectrum buoy.csv" in capsys.readouterr().err
    assert main([*command, "--preset", str(out), "--spectrum", str(table)]) == 0
    assert "missing" not in capsys.readouterr().err
