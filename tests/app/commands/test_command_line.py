"""`springtide` as a user types it."""

import json
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


def test_a_method_that_refuses_the_net_is_refused_where_nobody_looks(
    capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    out = tmp_path / "a.npz"
    line = refused(capsys, "run", "rope", "--seconds", "1", "--out", str(out), "--set", "integrator=pefrl")
    assert "integrator: 'pefrl' is not allowed" in line
    assert not out.exists()


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
    assert "of the largest stable one for explicit Euler" in capsys.readouterr().out
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
