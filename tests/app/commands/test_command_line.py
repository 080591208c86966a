"""`springtide` as a user types it."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main


def refused(capsys: pytest.CaptureFixture, *arguments: str) -> str:
    """The one line that a refused command prints."""
    assert main(list(arguments)) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1, lines
    return lines[0]


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("stiffness=-3", ["stiffness", "-3", "1 to 1e9 N/m"]),
        ("stiffness=nan", ["stiffness", "nan", "N/m"]),
        ("points=2.5", ["points", "2.5", "whole number from 2 to 1000"]),
        ("integrator=rk5", ["integrator", "rk5", "leapfrog"]),
        ("floor=maybe", ["floor", "maybe", "true or false"]),
        ("colour", ["--set", "colour", "name=value"]),
        ("wobble=1", ["wobble", "no such parameter"]),
    ],
)
def test_a_bad_parameter_ends_with_one_line_that_names_it(
    capsys: pytest.CaptureFixture, tmp_path: Path, assignment: str, words: list[str]
) -> None:
    line = refused(capsys, "run", "rope", "--seconds", "1", "--out", str(tmp_path / "a.npz"), "--set", assignment)
    for word in words:
        assert word in line


def test_bad_arguments_of_run_are_refused_before_any_work(capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    out = str(tmp_path / "a.npz")
    assert "--seconds" in refused(capsys, "run", "rope", "--seconds", "nan", "--out", out)
    assert "--seconds" in refused(capsys, "run", "rope", "--seconds", "-1", "--out", out)
    assert ".npz" in refused(capsys, "run", "rope", "--seconds", "1", "--out", str(tmp_path / "a.txt"))
    assert "folder" in refused(capsys, "run", "rope", "--seconds", "1", "--out", str(tmp_path / "no" / "a.npz"))
    assert "--port" in refused(capsys, "--port", "70000", "--no-open")
    assert list(tmp_path.iterdir()) == []


def test_a_method_that_refuses_the_net_is_refused_where_nobody_looks(
    capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    out = tmp_path / "a.npz"
    line = refused(capsys, "run", "rope", "--seconds", "1", "--out", str(out), "--set", "integrator=pefrl")
    assert "integrator: 'pefrl' is not allowed" in line
    assert not out.exists()


def test_a_preset_file_sets_parameters_and_a_bad_one_is_refused(capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    preset = tmp_path / "p.json"
    preset.write_text(json.dumps({"scene": "rope", "parameters": {"points": 5, "gravity": 3.0}}))
    out = tmp_path / "a.npz"
    arguments = ["run", "rope", "--seconds", "0.5", "--out", str(out), "--preset", str(preset), "--set", "gravity=4"]
    assert main(arguments) == 0
    about = json.loads(str(np.load(out)["about"]))
    assert about["parameters"]["points"] == 5
    assert about["parameters"]["gravity"] == 4.0
    capsys.readouterr()
    for text in (
        "{",
        "[]",
        '{"parameters": {"points": 1}}',
        '{"scene": "moon", "parameters": {}}',
        '{"parameters": {"wobble": 1}}',
    ):
        preset.write_text(text)
        refused(capsys, *arguments)


def test_run_writes_arrays_units_and_all_parameters(tmp_path: Path) -> None:
    out = tmp_path / "rope.npz"
    assert main(["run", "rope", "--seconds", "1", "--out", str(out), "--set", "points=20", "integrator=rk4"]) == 0
    data = np.load(out)
    assert data["x"].shape == (len(data["t"]), 20, 3)
    assert data["t"][-1] == pytest.approx(1.0)
    about = json.loads(str(data["about"]))
    assert about["units"]["x"] == "m"
    assert about["parameters"]["integrator"] == "rk4"
    assert np.isfinite(data["x"]).all()


def test_a_diverging_run_keeps_what_it_had_and_says_so(capsys: pytest.CaptureFixture, tmp_path: Path) -> None:
    out = tmp_path / "boom.npz"
    assert main(["run", "rope", "--seconds", "5", "--out", str(out), "--set", "integrator=explicit_euler"]) == 1
    assert "exceeds the limit of explicit Euler" in capsys.readouterr().out
    data = np.load(out)
    assert 0 < data["t"][-1] < 5
    assert np.isfinite(data["x"]).all()


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "rope.npz"
    out.write_bytes(b"precious")

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", fail)
    assert main(["run", "rope", "--seconds", "0.2", "--out", str(out)]) == 1
    assert out.read_bytes() == b"precious"
    assert list(tmp_path.iterdir()) == [out]


def imported(code: str, names: tuple[str, ...]) -> str:
    """Run code in a new Python that has no scipy, and print which of the names it has loaded.

    Where scipy is installed numba itself loads scipy.linalg, for its BLAS; nothing of ours may need it.
    """
    script = f"import sys; sys.modules['scipy'] = None; {code}; print([m for m in {names} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return done.stdout.strip().splitlines()[-1]


def test_a_headless_rope_imports_no_viewer_and_no_transforms(tmp_path: Path) -> None:
    command = f"['run', 'rope', '--seconds', '0.1', '--out', r'{tmp_path / 'a.npz'}']"
    code = f"from app.__main__ import main; main({command})"
    assert imported(code, ("viser", "trimesh", "pyfftw", "matplotlib")) == "[]"


def test_serving_the_rope_imports_no_transforms() -> None:
    code = "from app.server.viewer import Viewer; v = Viewer('127.0.0.1', 0); v.open('rope'); v.shut()"
    assert imported(code, ("pyfftw", "matplotlib", "trimesh")) == "[]"
