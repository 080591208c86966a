"""The waves of a measured spectrum in the scenes of both seas, from the command line on."""

import html
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main, make_parser
from app.commands.options import read_params
from app.scenes import scene_named
from app.scenes.radial_sea.report import readout_of
from app.scenes.radial_sea.view import RadialSeaView
from app.scenes.sea_parameters import measured_spectrum
from app.scenes.square_sea.report import readout
from app.scenes.square_sea.view import SquareSeaView
from app.server.loop.sim_loop import SimLoop
from sim.ocean.statistics.statistics import expected
from tests.sim.floating.hulls.test_mesh_files import DECK, SIDES, VERTICES, stl

FREQUENCY = np.arange(0.04, 0.4, 0.005)
DENSITY = 6.0 * np.exp(-(((FREQUENCY - 0.09) / 0.012) ** 2)) + 0.5 * np.exp(
    -(((FREQUENCY - 0.22) / 0.05) ** 2)
)  # [m2/Hz]
HEIGHT = 4.0 * math.sqrt((0.5 * (DENSITY[1:] + DENSITY[:-1]) * np.diff(FREQUENCY)).sum())


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """A file of the spectrum, with the waves from the north-west."""
    rows = "".join(f"{f:.3f},{S:.6f},315,25\n" for f, S in zip(FREQUENCY, DENSITY, strict=True))
    path = tmp_path / "buoy.csv"
    path.write_text("f,S,direction,spread\n" + rows, encoding="utf-8")
    return path


def snapshot_of(scene: str, *words: str):
    """The set-up of a command line after a while, and its snapshot."""
    kind = scene_named(scene)
    loop = SimLoop(kind.make(read_params(kind, make_parser().parse_args(list(words)))))
    for _ in range(6):
        loop.tick(0.2)
    return kind, loop.scene, loop.latest


def test_the_square_sea_takes_a_tile_that_holds_the_file(table):
    kind, scene, latest = snapshot_of("square_sea", "--spectrum", str(table))
    sea = scene.sea
    wave = 9.81 / (2.0 * math.pi * 0.09**2)
    assert sea.length == pytest.approx(10.0 * wave, rel=0.05)
    found = expected(sea)
    assert found.significant_height == pytest.approx(HEIGHT, rel=5e-3)
    assert found.peak_period == pytest.approx(1.0 / 0.09, rel=0.02)
    assert found.direction == pytest.approx(-math.pi / 4, abs=0.03)  # to the south-east
    assert {"spectrum", "spreading", "hs", "fetch", "wind_direction"} <= kind.hidden(scene.params)
    text = re.sub(r"<[^>]*>", "", str(readout(latest)))
    assert f"Measured, buoy.csv: significant height {HEIGHT:.3g} m, peak period 11.1 s." in text
    short = re.sub(r"<[^>]*>", "", str(SquareSeaView.figures(None, latest)))  # type: ignore[arg-type]
    assert re.search(rf"File: {HEIGHT:.3g} m, 11\.1 s; the tile holds 100.%\.", short), short


def test_a_tile_that_is_given_stays_and_shows_what_it_holds(table):
    _, scene, latest = snapshot_of("square_sea", "--spectrum", str(table), "--set", "length=100", "size=64", "mesh=32")
    assert scene.sea.length == 100.0
    share = expected(scene.sea).significant_height / HEIGHT
    assert share < 0.9
    assert f"{100 * share:.1f}" in SquareSeaView.figures(None, latest).replace("\xa0", " ")  # type: ignore[arg-type]


def test_the_sum_of_waves_has_the_height_of_the_file(table):
    kind, scene, latest = snapshot_of("radial_sea", "--spectrum", str(table), "--set", "bodies=0", "rig=false")
    assert "wind_direction" in kind.hidden(scene.params)
    assert scene.sum.significant_height == pytest.approx(HEIGHT, rel=2e-3)
    assert "Measured, buoy.csv" in str(readout_of(latest))
    tile = scene.tile_now()
    assert tile.spectrum is scene.wave_choice.spectrum


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--scene", "rope"], "square_sea and radial_sea only"),
        (["--scene", "square_sea", "--spectrum-time", "noon"], "such as 2020-01-02 05:00"),
        (["--scene", "square_sea", "--spectrum-time", "2020-01-02"], "table of one"),
        (["--scene", "square_sea", "--spectrum-missing", "99;x"], 'such as 99,999, or "none"'),
        (["--scene", "square_sea", "--spectrum-missing", "nan"], 'such as 99,999, or "none"'),
    ],
)
def test_a_spectrum_that_does_not_fit_ends_with_one_line(table, words, said, monkeypatch, capsys):
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda *_, **__: pytest.fail("the server was started"))
    assert main([*words, "--spectrum", str(table), "--no-open"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_file_alone_opens_its_scene(table, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda name, *_, **__: opened.append(name) or 0)
    mesh = stl(tmp_path / "wedge.stl", VERTICES, np.concatenate([DECK, SIDES]))
    for words in (["--spectrum", str(table)], ["--hull", str(mesh)], ["--spectrum", str(table), "--hull", str(mesh)]):
        assert main([*words, "--no-open"]) == 0
    assert opened == ["square_sea", "radial_sea", "radial_sea"]


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (["--spectrum-time", "2020-01-01"], "spectrum"),
        (["--spectrum-missing", "99"], "spectrum"),
        (["--weld", "1e-5"], "hull"),
        (["--hull-unit", "mm"], "hull"),
    ],
)
def test_an_option_about_a_file_needs_the_file(words, file, monkeypatch, capsys):
    monkeypatch.setattr("app.commands.serve.serve_lab", lambda *_, **__: pytest.fail("the server was started"))
    assert main([*words, "--no-open"]) == 2
    assert f"it needs --{file} FILE" in capsys.readouterr().err
    assert main(["run", "radial_sea", "--seconds", "1", "--out", "x.npz", *words]) == 2
    assert f"it needs --{file} FILE" in capsys.readouterr().err


@pytest.mark.parametrize(("missing", "share"), [("", 1.0), ("none", 1.0), ("7", 1.0 - 1.0 / 3.0), ("7,8", 1.0 / 3.0)])
def test_numbers_that_stand_for_a_missing_value_are_an_option(tmp_path, missing, share):
    """Three bands of nearly equal energy, of which two have a density that may mean "missing"."""
    path = tmp_path / "three.csv"
    path.write_text("f,S\n0.05,0\n0.1,7\n0.15,0\n0.2,7.5\n0.25,0\n0.3,8\n0.35,0\n", encoding="utf-8")
    options = ["--spectrum-missing", missing] if missing else []
    _, scene, _ = snapshot_of("square_sea", "--spectrum", str(path), *options, "--set", "size=64", "mesh=32")
    energy = measured_spectrum(scene.params).moments().significant_height ** 2 / 16.0
    assert energy == pytest.approx(0.05 * 22.5 * share, rel=0.05)


@pytest.mark.parametrize("scene", ["square_sea", "radial_sea"])
def test_the_lines_on_a_file_are_printed_shown_and_kept(scene, tmp_path, capsys):
    """By the command, in the page's folder "Files", and in the file of the run: one source for all."""
    path, out = tmp_path / "buoy.csv", tmp_path / "run.npz"
    rows = "".join(f"{f:.3f},{400.0 * S:.6f},315,25,good\n" for f, S in zip(FREQUENCY, DENSITY, strict=True))
    path.write_text("f,S,direction,spread,quality\n" + rows, encoding="utf-8")
    small = ["--set", "size=64", "mesh=32"] if scene == "square_sea" else ["--set", "bodies=0", "rig=false"]
    assert main(["run", scene, "--spectrum", str(path), "--seconds", "0.1", "--out", str(out), *small]) == 0
    printed = [line.removeprefix("springtide: buoy.csv: ") for line in capsys.readouterr().err.strip().splitlines()]
    with np.load(out) as file:
        kept = json.loads(str(file["about"]))["notes"]
    assert printed == kept
    assert kept[0].endswith("waves come from 315° (NW)")
    assert kept[1].startswith("Warning: Hs ")
    assert kept[-1] == "columns left out: quality"
    _, _, latest = snapshot_of(scene, "--spectrum", str(path), *small)
    view = SquareSeaView if scene == "square_sea" else RadialSeaView
    shown = re.sub(r"<[^>]*>", "\n", view.notes(None, latest)["Files"])  # type: ignore[arg-type]
    assert all(note in html.unescape(shown) for note in kept)
    _, _, other = snapshot_of(scene, *small)
    assert "Files" not in view.notes(None, other)  # type: ignore[arg-type]
