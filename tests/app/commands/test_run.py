"""`springtide run` as a user types it, also with hostile words, full disks and folders that cannot be written."""

import json
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from tests.full_disk import full_disk


def run(out: Path | str, *more: str) -> int:
    return main(["run", "rope", "--out", str(out), *more])


@pytest.mark.parametrize("out", ["/proc/a.npz", "x" * 300 + ".npz", "folder.npz", "file/a.npz"])
def test_an_out_that_cannot_be_written_is_refused_before_any_work(out, tmp_path, capsys):
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "file").write_text("", "utf-8")
    assert run(tmp_path / out, "--seconds", "1e4") == 2
    assert "--out" in capsys.readouterr().err


def test_a_method_that_refuses_the_net_is_refused_where_nobody_looks(tmp_path, capsys):
    assert run(tmp_path / "a.npz", "--seconds", "1", "--set", "integrator=pefrl") == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "integrator: 'pefrl' is not allowed" in line
    assert not list(tmp_path.iterdir())


def test_run_writes_arrays_units_and_all_parameters(tmp_path):
    (tmp_path / "other").write_text("", "utf-8")
    out = tmp_path / "rope.npz"
    assert run(out, "--seconds", "1", "--set", "points=20", "integrator=rk4") == 0
    with np.load(out) as file:  # Windows replaces no file that is open
        data = dict(file)
    assert data["x"].shape == (len(data["t"]), 20, 3)
    assert data["t"][-1] == pytest.approx(1.0)
    assert np.isfinite(data["x"]).all()
    about = json.loads(str(data["about"]))
    assert about["units"]["x"] == "m"
    assert about["parameters"]["integrator"] == "rk4"
    assert out.stat().st_mode == (tmp_path / "other").stat().st_mode  # whom any new file may be read by
    assert run(out, "--seconds", "0.1", "--set", "mass=1000", "stiffness=1e9", "time_step=1e-5") in (0, 1)
    assert json.loads(str(np.load(out)["about"]))["parameters"]["stiffness"] == 1e9


def test_a_diverging_run_keeps_what_it_had_and_says_so(tmp_path, capsys):
    assert run(tmp_path / "boom.npz", "--seconds", "5", "--set", "integrator=explicit_euler") == 1
    assert "of the largest stable one for explicit Euler" in capsys.readouterr().out
    data = np.load(tmp_path / "boom.npz")
    assert 0 < data["t"][-1] < 5
    assert np.isfinite(data["x"]).all()


@pytest.mark.parametrize(("rate", "step"), [("1e5", 0.02), ("30", 0.02), ("30", 0.05), ("7", 1 / 60), ("0.1", 0.01)])
def test_a_run_ends_at_the_first_step_at_or_after_the_time_asked_for(rate, step, tmp_path):
    parameters = ("--set", f"time_step={step}", "stiffness=100")
    assert run(tmp_path / "a.npz", "--seconds", "0.99", "--rate", rate, *parameters) == 0
    t = np.load(tmp_path / "a.npz")["t"]
    assert 0.99 - 1e-9 <= t[-1] < 0.99 + step
    assert (np.diff(t) > 0.9 * step).all()


def test_a_full_disk_ends_it_with_a_line_and_the_old_file_in_place(tmp_path, capsys):
    out = tmp_path / "a.npz"
    out.write_bytes(b"precious")
    with full_disk(20_000):
        assert run(out, "--seconds", "20") == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert out.read_bytes() == b"precious"
    assert list(tmp_path.iterdir()) == [out]
