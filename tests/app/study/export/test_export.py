"""`springtide export`: pictures and meshes hold the model's values, the tile closes, nothing is overwritten."""

import json
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest
import trimesh

from app.__main__ import main
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from app.scenes.square_sea.parameters import SquareSeaParams, conditions
from app.scenes.square_sea.scene import SquareSeaScene
from app.scenes.stepping import steps_to
from app.study.export.command import export
from sim.ocean import Sea

OpenEXR = pytest.importorskip("OpenEXR")
RATE, START, FRAMES = 24.0, 0.5, 3
SEA = SquareSeaParams(
    size="64", mesh="32", length=64.0, amplitude=1.2, wind_speed=12.0, foam_by_wind=False, foam_threshold=0.7
)


def write_sea(out: Path, form: str | None) -> dict:
    assert export("square_sea", SEA, FRAMES / RATE, RATE, START, form, out) == 0
    return json.loads((out / "sequence.json").read_text("utf-8"))


def field_of(pixels: np.ndarray) -> np.ndarray:
    """A picture as [i, j] of x and y: columns are x, rows are y from the bottom."""
    return np.swapaxes(pixels[::-1], 0, 1)


def expected(number: int) -> np.ndarray:
    """Displacement [m] of a frame by the model alone."""
    sea = Sea(64, 64.0, seed=SEA.seed, **conditions(SEA))
    sea.choppiness = SEA.choppiness * SEA.amplitude
    surface = sea.surface(START + number / RATE)
    return np.dstack([surface.displacement, SEA.amplitude * surface.height])


def test_exr_holds_the_displacement_of_the_model_at_any_rate(tmp_path):
    about = write_sea(tmp_path / "a", None)
    assert about["frames"] == FRAMES
    assert (about["start"], about["length"], about["size"]) == (START, 64.0, 64)
    assert about["parameters"] == vars(SEA)
    for number in range(FRAMES):
        file = OpenEXR.File(str(tmp_path / "a" / f"displacement.{number + 1:04d}.exr"))
        pixels = file.channels()["RGB"].pixels
        assert pixels.dtype == np.float32
        np.testing.assert_allclose(field_of(pixels), expected(number), atol=1e-5)


def test_foam_is_that_of_the_scene_on_the_solved_grid(tmp_path):
    write_sea(tmp_path / "a", "exr")
    scene = SquareSeaScene(SquareSeaParams(**{**vars(SEA), "mesh": "64", "statistics": False}), step=1.0 / 48.0)
    for _ in range(24 + 2):  # a frame of 1/24 s is two steps: foam is made 30 times a second at least
        scene.advance(1)
        foam = scene.frame().foam
    pixels = OpenEXR.File(str(tmp_path / "a" / "foam.0002.exr")).channels()["Y"].pixels
    assert pixels.max() > 0.1
    np.testing.assert_array_equal(field_of(pixels), foam)


@pytest.mark.parametrize("start", ["as set", "groups"])
def test_nonlinear_waves_are_written_as_they_are_drawn(tmp_path, start):
    params = SquareSeaParams(**{**vars(SEA), "order": 3, "start": start})
    assert export("square_sea", params, 2 / RATE, RATE, 0.0, "exr", tmp_path / "a") == 0
    scene = SquareSeaScene(params, step=1.0 / 48.0)
    scene.advance(2)
    height = np.broadcast_to(scene.marching.sea.height, (64, 64))
    pixels = field_of(OpenEXR.File(str(tmp_path / "a" / "displacement.0002.exr")).channels()["RGB"].pixels)
    np.testing.assert_allclose(pixels[..., 2], SEA.amplitude * height, atol=1e-5)
    assert not pixels[..., :2].any()


def test_the_tile_closes(tmp_path):
    write_sea(tmp_path / "a", "exr")
    pixels = OpenEXR.File(str(tmp_path / "a" / "displacement.0001.exr")).channels()["RGB"].pixels
    for axis in (0, 1):
        bend = np.abs(np.diff(pixels, 2, axis=axis)).max()
        around = np.take(pixels, [-2, -1, 0, 1], axis=axis)
        assert np.abs(np.diff(around, 2, axis=axis)).max() <= bend
        # A tile that is one row short would bend more at its seam than anywhere in it.
        short = np.take(pixels, range(63), axis=axis)
        cut = np.take(short, [-2, -1, 0, 1], axis=axis)
        assert np.abs(np.diff(cut, 2, axis=axis)).max() > np.abs(np.diff(around, 2, axis=axis)).max()


def test_half_floats_are_the_same_to_their_precision(tmp_path):
    write_sea(tmp_path / "a", "exr16")
    pixels = OpenEXR.File(str(tmp_path / "a" / "displacement.0002.exr")).channels()["RGB"].pixels
    assert pixels.dtype == np.float16
    np.testing.assert_allclose(field_of(pixels.astype(float)), expected(1), rtol=2**-11, atol=1e-5)


def test_png_holds_the_displacement_to_half_a_level_of_the_stated_scale(tmp_path):
    about = write_sea(tmp_path / "a", "png")
    largest = 0
    for number in range(FRAMES):
        for part, name in enumerate("xyz"):
            scale = about["files"][f"displacement_{name}.####.png"]
            pixels = imageio.imread(tmp_path / "a" / f"displacement_{name}.{number + 1:04d}.png")
            assert pixels.dtype == np.uint16
            largest = max(largest, int(pixels.max()))
            value = (field_of(pixels).astype(float) - scale["zero"]) * scale["step"]
            np.testing.assert_allclose(value, expected(number)[..., part], atol=0.5 * scale["step"] + 1e-5)
    assert largest > 65000  # the scale is that of the largest value
    assert imageio.imread(tmp_path / "a" / "foam.0003.png").max() > 1000


def test_the_cloth_is_a_sequence_of_meshes(tmp_path):
    params = ClothParams(rows=6, cols=9)
    assert export("cloth", params, 0.2, 20.0, 0.1, None, tmp_path / "a") == 0
    scene = ClothScene(params)  # its step divides the interval
    for number in range(4):
        scene.advance(steps_to(scene, 0.1 + number / 20.0))
        mesh = trimesh.load(tmp_path / "a" / f"cloth.{number + 1:04d}.obj", process=False)
        x = np.moveaxis(scene.state.x, 0, -1).astype(np.float32).reshape(-1, 3)
        np.testing.assert_array_equal(np.asarray(mesh.vertices, np.float32), x)
        assert len(mesh.faces) == 2 * 5 * 8
        assert mesh.area == pytest.approx(trimesh.Trimesh(x, mesh.faces, process=False).area)
        np.testing.assert_allclose(mesh.visual.uv[[0, 8, -1]], [[0, 1], [1, 1], [1, 0]])
    assert json.loads((tmp_path / "a" / "sequence.json").read_text("utf-8"))["rows"] == 6


def test_steps_are_shortened_where_they_do_not_divide_a_frame(tmp_path):
    assert export("cloth", ClothParams(rows=4, cols=4, time_step=0.001), 0.2, 24.0, 0.0, None, tmp_path / "a") == 0
    assert json.loads((tmp_path / "a" / "sequence.json").read_text("utf-8"))["time_step"] == pytest.approx(1 / 24 / 42)


def test_a_run_that_diverges_keeps_the_frames_before_that(tmp_path, capsys):
    params = ClothParams(rows=6, cols=6, time_step=0.02, stiffness=1e4)
    assert export("cloth", params, 5.0, 50.0, 0.0, None, tmp_path / "a") == 1
    about = json.loads((tmp_path / "a" / "sequence.json").read_text("utf-8"))
    assert about["diverged"]
    assert len(list((tmp_path / "a").glob("*.obj"))) == about["frames"] < 250
    assert "ended early" in capsys.readouterr().out


@pytest.mark.parametrize("taken", ["file", "folder", "link"])
def test_nothing_is_overwritten(taken, tmp_path, capsys):
    out = tmp_path / "a"
    if taken == "file":
        out.write_text("mine", "utf-8")
    elif taken == "folder":
        out.mkdir()
        (out / "mine").write_text("mine", "utf-8")
    else:
        out.symlink_to(tmp_path / "nowhere")
    assert main(["export", "cloth", "--seconds", "0.1", "--out", str(out)]) == 2
    assert "overwritten" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [out]


def test_an_export_that_fails_leaves_nothing(tmp_path, monkeypatch):
    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("app.study.export.cloth_meshes.obj_of", fail)
    with pytest.raises(OSError, match="disk full"):
        export("cloth", ClothParams(rows=4, cols=4), 0.1, 30.0, 0.0, None, tmp_path / "a")
    assert list(tmp_path.iterdir()) == []


def test_the_reason_is_said_where_the_draft_of_an_export_is_gone(tmp_path, monkeypatch):
    def fail(sequence: object, draft: Path, *_: object) -> None:
        draft.rmdir()
        raise OSError("the disk was removed")

    monkeypatch.setattr("app.study.export.command.write_frames", fail)
    with pytest.raises(OSError, match="the disk was removed"):
        export("cloth", ClothParams(rows=4, cols=4), 0.1, 30.0, 0.0, None, tmp_path / "a")


def test_without_openexr_a_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"OpenEXR is not installed .*png"):
        export("square_sea", SEA, 0.1, 30.0, 0.0, "exr", tmp_path / "a")
    assert list(tmp_path.iterdir()) == []
    assert export("square_sea", SEA, 0.1, 30.0, 0.0, None, tmp_path / "a") == 0
    assert json.loads((tmp_path / "a" / "sequence.json").read_text("utf-8"))["format"] == "png"
