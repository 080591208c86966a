"""`springtide run` under hostile words, full disks and folders that cannot be written."""

import json
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main


def run(out: Path | str, *more: str) -> int:
    return main(["run", "rope", "--out", str(out), *more])


@pytest.mark.parametrize("out", ["/proc/a.npz", "x" * 300 + ".npz", "folder.npz", "file/a.npz"])
def test_an_out_that_cannot_be_written_is_refused_before_any_work(out, tmp_path, capsys):
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "file").write_text("")
    assert run(tmp_path / out, "--seconds", "1e4") == 2
    assert "--out" in capsys.readouterr().err


@pytest.mark.parametrize(("rate", "step"), [("1e5", 0.02), ("30", 0.02), ("30", 0.05), ("7", 1 / 60), ("0.1", 0.01)])
def test_a_run_ends_at_the_first_step_at_or_after_the_time_asked_for(rate, step, tmp_path):
    parameters = ("--set", f"time_step={step}", "stiffness=100")
    assert run(tmp_path / "a.npz", "--seconds", "0.99", "--rate", rate, *parameters) == 0
    t = np.load(tmp_path / "a.npz")["t"]
    assert 0.99 - 1e-9 <= t[-1] < 0.99 + step
    assert (np.diff(t) > 0.9 * step).all()


def test_the_file_may_be_read_by_whom_any_new_file_may(tmp_path):
    (tmp_path / "other").write_text("")
    assert run(tmp_path / "a.npz", "--seconds", "0.1") == 0
    assert (tmp_path / "a.npz").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_a_full_disk_ends_it_with_a_line_and_the_old_file_in_place(tmp_path):
    out = tmp_path / "a.npz"
    out.write_bytes(b"precious")
    command = [sys.executable, "-m", "app", "run", "rope", "--seconds", "20", "--out", str(out)]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=250,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
        check=False,
    )
    assert done.returncode == 1
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert out.read_bytes() == b"precious"
    assert list(tmp_path.iterdir()) == [out]


def test_parameters_in_the_file_are_json_whatever_they_are(tmp_path):
    assert run(tmp_path / "a.npz", "--seconds", "0.1", "--set", "mass=1000", "stiffness=1e9", "time_step=1e-5") in (
        0,
        1,
    )
    assert json.loads(str(np.load(tmp_path / "a.npz")["about"]))["parameters"]["stiffness"] == 1e9
