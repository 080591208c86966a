"""Arguments of all commands that are refused: one line that names the argument, and no file."""

import json
import os

import pytest

from app.__main__ import main
from sim.validation import ConvergenceError

RUN = ("run", "rope", "--out", "a.npz", "--seconds", "1")
SEA = ("export", "square_sea", "--out", "a", "--seconds", "1")
FORMER = "scene: '{}' is not allowed; allowed: {}, its new name"
REFUSED: list[tuple[tuple[str, ...], tuple[str, ...]]] = [
    *(((*RUN, "--seconds", bad), ("--seconds",)) for bad in ("inf", "nan", "1e300", "0", "-1")),
    *(((*RUN, "--rate", bad), ("--rate",)) for bad in ("nan", "-1")),
    ((*RUN, "--seconds", "1e6", "--rate", "1e5", "--set", "time_step=1e-5"), ("GB",)),
    *(((*RUN, "--set", f"mass={bad}"), ("mass",)) for bad in ("inf", "1e999", "1,500", "")),
    ((*RUN, "--set", "=1"), ("no such parameter",)),
    ((*RUN, "--set", "points=" + "9" * 400), ("points",)),
    ((*RUN, "--set", "stiffness=-3"), ("stiffness", "-3", "1 to 1e9 N/m")),
    ((*RUN, "--set", "stiffness=nan"), ("stiffness", "nan", "N/m")),
    ((*RUN, "--set", "points=2.5"), ("points", "2.5", "whole number from 2 to 1000")),
    ((*RUN, "--set", "integrator=rk5"), ("integrator", "rk5", "leapfrog")),
    ((*RUN, "--set", "floor=maybe"), ("floor", "maybe", "true or false")),
    ((*RUN, "--set", "floor=2"), ("floor",)),
    ((*RUN, "--set", "colour"), ("--set", "colour", "name=value")),
    ((*RUN, "--set", "wobble=1"), ("wobble", "no such parameter")),
    ((*RUN, "--preset", "Moon"), ("--preset: 'Moon'", "Pendulum", ".json")),
    ((*RUN, "--out", "a.txt"), (".npz",)),
    ((*RUN, "--out", os.path.join("no", "a.npz")), ("folder",)),
    (("run", "moon", *RUN[2:]), ("rope",)),
    (("run", "phillips", *RUN[2:]), (FORMER.format("phillips", "square_sea"),)),
    (("--scene", "radial", "--no-open"), (FORMER.format("radial", "radial_sea"),)),
    (("--no-open", "--preset", "Moon"), ("Pendulum",)),
    (("--no-open", "--port", "70000"), ("--port",)),
    (("export", "rope", *SEA[2:]), ("SCENE",)),
    *(((*SEA, "--seconds", bad), ("--seconds",)) for bad in ("0", "nan")),
    ((*SEA, "--rate", "0.5"), ("--rate",)),
    ((*SEA, "--start", "-1"), ("--start",)),
    ((*SEA, "--format", "obj"), ("--format",)),
    (("export", "cloth", *SEA[2:], "--format", "png"), ("--format",)),
    ((*SEA, "--seconds", "1e5", "--rate", "1000"), ("GB",)),
    ((*SEA, "--set", "size=100"), ("size",)),
    (("run", "rope"), ("--seconds: missing",)),
    (("run", "ropes", *RUN[2:]), ("did you mean rope?",)),
    ((*RUN, "--preset", "Pendulm"), ("did you mean Pendulum?",)),
    ((*RUN, "--preset", "nowhere.json"), ("nowhere.json: no such file",)),
    (("sweep", "nowhere.toml", "--out", "a.nc"), ("nowhere.toml: no such file",)),
    (("hydrodynamics", "nowhere.stl"), ("nowhere.stl: no such file",)),
    (("hydrodynamics",), ("HULL: give a mesh file",)),
    *(((*words, "nowhere"), ("nowhere: no such folder",)) for words in (("lab",), ("lab", "check"))),
    (("beside", "planet"), ("did you mean planets?",)),
    (("bench", "ropes"), ("did you mean rope",)),
    (("stability", "--quick", "--out", os.path.join(os.devnull, "inner")), ("--out",)),
    (("warmup", "--into", os.path.join(os.devnull, "inner")), ("--into",)),
]
PRESETS = [
    b"{", b"[]", b"[" * 100_000, b"\x00", b"\xff\xfe", b'{"parameters": {"points": 1}}',
    b'{"scene": "moon", "parameters": {}}', b'{"parameters": {"wobble": 1}}', b'{"parameters": {"mass": NaN}}',
    b'{"parameters": {"mass": [1]}}', json.dumps({"parameters": {"a\nb\r\x1b[31m": 1}}).encode(),
]  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def refused(capsys, *arguments: str) -> str:
    """The one line that a command with a bad argument prints."""
    assert main(list(arguments)) == 2
    line = capsys.readouterr().err.strip()
    assert line.isprintable()
    return line


@pytest.mark.parametrize(("arguments", "words"), REFUSED)
def test_what_is_not_allowed_is_one_line_and_no_file(arguments, words, tmp_path, capsys):
    line = refused(capsys, *arguments)
    assert all(word in line for word in words), line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", PRESETS)
def test_a_hostile_preset_is_refused(text, tmp_path, capsys):
    (tmp_path / "p.json").write_bytes(text)
    refused(capsys, *RUN, "--preset", "p.json")
    assert [path.name for path in tmp_path.iterdir()] == ["p.json"]


def test_a_solver_that_fails_is_one_line_and_status_1(monkeypatch, capsys):
    def fail(*_, **__):
        raise ConvergenceError("a state of rest", "3 N at node 7", 40)

    monkeypatch.setattr("app.study.sweep.command.sweep", fail)
    assert main(["sweep", "a.toml", "--out", "a.nc"]) == 1
    assert (
        capsys.readouterr().err == "springtide: a state of rest: no solution after 40 iterations; 3 N at node 7 left\n"
    )


def test_a_lab_without_a_folder_says_what_to_give(capsys):
    with pytest.raises(SystemExit):
        main(["lab"])
    assert "DIR, new or check" in capsys.readouterr().err.splitlines()[-1]
