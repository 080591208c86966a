"""What a spec may say: everything is checked before any work, and refused in one line."""

import tomllib
from pathlib import Path

import pytest

from app.__main__ import main
from app.study.sweep.spec import make_spec, read_spec

ASSETS = Path(__file__).parents[4] / "assets" / "sweeps"
HEAD = 'scene = "rope"\nseconds = 1.0\n'
RANDOM = HEAD + 'design = "random"\ncases = 4\n'
PARAMETERS = "[parameters]\nmass = [1, 2]\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("seconds = 1\n" + PARAMETERS, ["scene", "missing"]),
        ('scene = "moon"\nseconds = 1\n' + PARAMETERS, ["scene", "moon", "rope"]),
        ('scene = ["rope"]\nseconds = 1\n' + PARAMETERS, ["scene", "rope"]),
        ('scene = "rope"\nseconds = nan\n' + PARAMETERS, ["seconds", "nan", "above 0"]),
        ('scene = "rope"\nseconds = 0\n' + PARAMETERS, ["seconds", "0", "above 0"]),
        ('scene = "rope"\nseconds = inf\n' + PARAMETERS, ["seconds", "inf"]),
        ('scene = "rope"\nseconds = "1"\n' + PARAMETERS, ["seconds", "'1'"]),
        ('scene = "rope"\nseconds = 1' + "0" * 400 + "\n" + PARAMETERS, ["seconds", "100000 s"]),
        (HEAD + "frames = 0\n" + PARAMETERS, ["frames", "0", "whole number"]),
        (HEAD + "frames = true\n" + PARAMETERS, ["frames", "True"]),
        (HEAD + 'design = "sobol"\n' + PARAMETERS, ["design", "sobol", "grid, random"]),
        (HEAD + 'preset = "Moon"\n' + PARAMETERS, ["preset", "Moon", "Pendulum"]),
        (HEAD + "preset = [1]\n" + PARAMETERS, ["preset", "[1]"]),
        (HEAD + "colour = 1\n" + PARAMETERS, ["colour", "no such key"]),
        (HEAD + "parameters = 3\n", ["parameters", "[parameters]"]),
        (HEAD + "[parameters]\n", ["parameters", "empty"]),
        (HEAD + "[parameters]\nwobble = [1]\n", ["wobble", "no such parameter"]),
        (HEAD + "[parameters]\nmass = []\n", ["mass", "[]"]),
        (HEAD + "[parameters]\nmass = 3\n", ["mass", "3", "list"]),
        (HEAD + "[parameters]\nmass = [1, 2, 1.0]\n", ["mass", "twice"]),
        (HEAD + "[parameters]\nmass = [1, nan]\n", ["mass", "nan", "0.001 to 1000 kg"]),
        (HEAD + "[parameters]\nmass = [1, -4]\n", ["mass", "-4", "0.001 to 1000 kg"]),
        (HEAD + "[parameters]\nmass = [[1], [2]]\n", ["mass", "[1]"]),
        (HEAD + "[parameters]\nmass = [2026-11-21]\n", ["mass", "2026"]),
        (HEAD + "[parameters]\nmass = [1" + "0" * 400 + "]\n", ["mass", "1000 kg"]),
        (HEAD + "[parameters]\npoints = [2.5]\n", ["points", "2.5", "whole number"]),
        (HEAD + '[parameters]\nintegrator = ["rk5"]\n', ["integrator", "rk5"]),
        (HEAD + "[parameters]\nintegrator = { from = 1, to = 2, count = 2 }\n", ["integrator", "list"]),
        (HEAD + "[parameters]\nmass = { from = 1, count = 2 }\n", ["mass", "from"]),
        (HEAD + "[parameters]\nmass = { from = 2, to = 1, count = 2 }\n", ["mass.to", "above"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 1e9, count = 2 }\n", ["mass.to", "1000 kg"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 2 }\n", ["mass.count", "missing"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 2, count = 1 }\n", ["mass.count", "1"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 2, count = 9e9 }\n", ["mass.count"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 2, count = 2, step = 1 }\n", ["mass.step"]),
        (HEAD + "[parameters]\nmass = { from = 1, to = 2, count = 2, log = 1 }\n", ["mass.log", "true or false"]),
        (HEAD + "[parameters]\ndrag = { from = 0, to = 2, count = 2, log = true }\n", ["drag.from", "above 0"]),
        (HEAD + "[parameters]\npoints = { from = 2, to = 4, count = 9 }\n", ["points.count", "9", "at most 3"]),
        (HEAD + "[parameters]\nmass = [1]\n[set]\nmass = 1\n", ["mass", "once"]),
        (HEAD + "[parameters]\nmass = [1]\n[set]\ndrag = nan\n", ["drag", "nan"]),
        (HEAD + "cases = 4\n" + PARAMETERS, ["cases", "random"]),
        (HEAD + 'design = "random"\n' + PARAMETERS, ["cases", "missing"]),
        (HEAD + 'design = "random"\ncases = 0\n' + PARAMETERS, ["cases", "0"]),
        (RANDOM + "seed = -1\n" + PARAMETERS, ["seed", "-1"]),
        (RANDOM + "[parameters]\nmass = { from = 1, to = 2, count = 2 }\n", ["mass.count", "grid"]),
        (
            HEAD
            + "[parameters]\nmass = { from = 1, to = 2, count = 1000 }\ndrag = { from = 1, to = 2, count = 1000 }\n",
            ["1000000 cases", "100000"],
        ),
        (HEAD + "frames = 10000\n[parameters]\nmass = { from = 1, to = 2, count = 2000 }\n", ["frames", "2000 cases"]),
        (HEAD + "[parameters]\naxial_stiffness = [100, 200]\n", ["axial_stiffness", "no effect"]),
    ],
)
def test_a_bad_spec_is_refused_in_words_before_any_work(text, words, tmp_path, capsys):
    (tmp_path / "s.toml").write_text(text, "utf-8")
    assert main(["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc")]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    for word in words:
        assert word in lines[0]
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_a_spec_that_cannot_be_read_or_is_no_toml_is_refused(tmp_path, capsys):
    (tmp_path / "s.toml").write_text("scene = ", "utf-8")
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe")
    for name in ("s.toml", "b.toml", "none.toml", "."):
        assert main(["sweep", str(tmp_path / name), "--out", str(tmp_path / "out.nc")]) == 2
        assert "SPEC" in capsys.readouterr().err


def test_an_out_that_cannot_be_is_refused(tmp_path, capsys):
    (tmp_path / "s.toml").write_text(HEAD + PARAMETERS, "utf-8")
    (tmp_path / "folder.nc").mkdir()
    for out in ("out.txt", "no/out.nc", "folder.nc", "x" * 300 + ".nc"):
        assert main(["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / out)]) == 2
        assert "--out" in capsys.readouterr().err


def test_presets_set_and_swept_parameters_go_over_each_other_in_that_order():
    spec = make_spec(
        tomllib.loads(HEAD + 'preset = "Stiff rope"\n[set]\ndamping_model = "axial"\n[parameters]\npoints = [3]\n')
    )
    params = spec.params(0)
    assert (params.points, params.axial_stiffness, params.damping_model) == (3, 2e5, "axial")
    assert params.plot_energy


def test_a_preset_of_a_file_lies_beside_the_spec(tmp_path):
    (tmp_path / "p.json").write_text('{"scene": "rope", "parameters": {"points": 7}}', "utf-8")
    (tmp_path / "s.toml").write_text(HEAD + 'preset = "p.json"\n' + PARAMETERS, "utf-8")
    assert read_spec(tmp_path / "s.toml").params(0).points == 7


def test_times_are_the_end_alone_or_equally_spaced_from_0():
    assert make_spec(tomllib.loads(HEAD + PARAMETERS)).times == (1.0,)
    assert make_spec(tomllib.loads(HEAD + "frames = 3\n" + PARAMETERS)).times == (0.0, 0.5, 1.0)


@pytest.mark.parametrize("path", sorted(ASSETS.glob("*.toml")), ids=lambda path: path.stem)
def test_the_examples_are_sound(path):
    spec = read_spec(path)
    assert len(spec.cases) > 20
