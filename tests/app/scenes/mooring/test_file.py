"""The scene of a MoorDyn file: any number of lines, and the coupled points as one vessel."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from app.commands.run import run_to_file
from app.messages import GrabTo, Release
from app.panel.recording.recorder import Recorder
from app.panel.recording.recording_files import Plotted, recording_npz
from app.scenes.mooring import SCENE
from app.scenes.mooring.arrangement import depth_of, extent, has_body, water_of
from app.scenes.mooring.files.file_scene import FileScene, water_motion
from app.scenes.mooring.files.from_file import mooring_of
from app.scenes.mooring.line_scene import FADE
from app.scenes.mooring.parameters import MooringParams, hidden
from app.scenes.mooring.readings.report import notes_of
from app.scenes.mooring.readings.restoring import CurveInputs
from app.scenes.quantities import measured
from app.scenes.setups import described, missing_files, read_file, read_setup_text, write_file
from app.server.loop.sim_loop import SimLoop
from app.server.replay_file import replay_html
from sim.mooring import read_moordyn

FILES = Path(__file__).parents[3] / "sim/mooring/moordyn/files"
SHARED = str(FILES / "shared_line.txt")


def scene_of(name: str, **values: object) -> FileScene:
    scene = SCENE.make(MooringParams(moordyn_file=str(FILES / f"{name}.txt"), **{"time_step": 2e-3, **values}))  # type: ignore[arg-type]
    assert isinstance(scene, FileScene)
    return scene


def run_for(scene: FileScene, seconds: float) -> None:
    scene.advance(round(seconds / scene.step))


def test_a_file_is_at_rest_as_the_library_has_it():
    scene, rest = scene_of("shared_line", wave_height=0.0), read_moordyn(SHARED).at_rest()
    lines = scene.readings().lines
    assert [line.anchor for line in lines] == pytest.approx([rest.end_tension[i][0] for i in (1, 2, 3)], rel=1e-9)
    assert [line.fairlead for line in lines] == pytest.approx([rest.end_tension[i][1] for i in (1, 2, 3)], rel=1e-9)
    run_for(scene, 2.0)
    assert scene.readings().most_offset == 0.0
    assert scene.readings().lines[0].fairlead == pytest.approx(rest.end_tension[1][1], rel=1e-3)


def test_lines_of_unlike_segments_are_shown_from_their_anchors_on():
    scene = scene_of("shared_line", wave_height=0.0)
    rest = read_moordyn(SHARED).at_rest()
    frame = scene.frame()
    assert frame.points.shape == (3, 26, 3)
    assert frame.tension.shape == (3, 25)
    assert frame.points[0] == pytest.approx(rest.x[1], abs=1e-4)
    at = np.linspace(0.0, 20.0, 26)
    shared = np.stack([np.interp(at, np.arange(21), rest.x[2][:, e]) for e in range(3)], axis=1)
    assert frame.points[1] == pytest.approx(shared, abs=1e-4)
    assert len(frame.anchors) == len(frame.uplift) == 2
    assert len(frame.fairleads) == 4
    assert not frame.uplift.any()  # all lie on the bed there
    assert scene_of("taut", wave_height=0.0).frame().uplift.all()


def test_a_line_that_begins_at_the_vessel_is_shown_the_other_way_round(tmp_path):
    text = (FILES / "chain.txt").read_text(encoding="utf-8").replace("1 c 1 2 320.0", "1 c 2 1 320.0")
    path = tmp_path / "turned.txt"
    path.write_text(text, encoding="utf-8")
    turned = SCENE.make(MooringParams(moordyn_file=str(path), wave_height=0.0))
    there = scene_of("chain", wave_height=0.0)
    assert turned.frame().points == pytest.approx(there.frame().points, abs=1e-3)
    (now, end), (same, other) = (
        (one.readings().lines[0], one.readings().lines[0].at_fairlead) for one in (turned, there)
    )
    assert now[:2] + now[4:] == pytest.approx(same[:2] + same[4:], rel=1e-6, nan_ok=True)
    assert end[:4] == pytest.approx(other[:4], rel=1e-6)
    assert turned.force_of_lines() == pytest.approx(there.force_of_lines(), rel=1e-6, abs=1e-3)


def test_the_vessel_moves_as_the_water_does_and_its_points_as_one():
    scene = scene_of("shared_line", wave_height=3.0, wave_period=9.0, regular=True, follow=0.5, direction=30.0)
    run_for(scene, FADE + 3.0)
    assert scene.sea is not None
    wave, speed = water_motion(scene.sea, scene.middle, scene.time)
    later, _ = water_motion(scene.sea, scene.middle, scene.time + 1e-5)
    assert (later - wave) / 1e-5 == pytest.approx(speed, rel=1e-3, abs=1e-4)
    assert scene.body_place() - scene.middle == pytest.approx(0.5 * wave, abs=1e-6)
    system = scene.file.system
    for node in scene.file.vessel:
        assert scene.state.x[:, node] - system.points[node].position == pytest.approx(0.5 * wave, abs=1e-3)
        assert scene.state.v[:, node] == pytest.approx(0.5 * speed, abs=2e-2)
    # Circles of a wave in deep water: half a height of 3 m, and at depth more along than up.
    assert 1.0 < np.linalg.norm(wave) < 2.0
    held = scene_of("shared_line", wave_height=3.0, wave_period=9.0, follow=0.0)
    run_for(held, 1.0)
    assert held.body_place() == pytest.approx(held.middle, abs=1e-12)


def test_another_current_shows_in_the_tensions_before_the_next_step():
    scene = scene_of("chain", wave_height=0.0)
    run_for(scene, 0.5)
    before = scene.end_tension()
    scene.change_forces(dataclasses.replace(scene.params, current=2.0))
    after = scene.end_tension()
    assert not np.array_equal(before, after)
    scene.resume(scene.keep())
    np.testing.assert_array_equal(scene.end_tension(), after)


def test_the_mouse_drags_the_vessel_no_farther_than_its_lines_reach():
    scene = scene_of("chain", wave_height=0.0)
    scene.handle(GrabTo(0, (-1e4, 0.0, 7.0), 1))
    scene.handle(GrabTo(0, (1e4, 0.0, 7.0), 2))  # another browser, which does not hold it
    for _ in range(40):
        run_for(scene, 0.5)
    away = scene.body_place() - scene.middle
    assert -scene.file.farthest <= away[0] < -3.0
    pull = scene.frame().grab
    assert pull is not None
    assert (pull.load, pull.limit) == (1.0, "The lines hold: no farther")
    scene.handle(GrabTo(0, (scene.middle[0] - 0.5 * scene.file.farthest, scene.middle[1], 0.0), 1))
    pull = scene.frame().grab
    assert pull is not None
    assert pull.load == pytest.approx(0.5)
    scene.handle(GrabTo(0, (-1e4, 0.0, 7.0), 1))
    assert away[1:] == pytest.approx([0.0, 0.0])
    assert scene.readings().lines[0].fairlead > 1.5 * 444053.0
    scene.handle(Release(1))
    scene.handle(Release(2))
    kept = scene.keep()
    place, tension = scene.body_place(), scene.tension.copy()
    run_for(scene, 1.0)
    scene.resume(kept)
    assert scene.body_place() == pytest.approx(place)
    assert scene.tension == pytest.approx(tension)
    scene.reset()
    assert scene.body_place() == pytest.approx(scene.middle)


def test_the_restoring_curve_is_the_force_of_the_lines_on_the_vessel():
    scene = scene_of("shared_line", wave_height=0.0, plot_restoring=True)
    offset, force = scene.curve_inputs(2.0).curve(scene.rows)
    assert np.isfinite(force).all()
    assert (np.diff(force) > 0.0).all()
    middle = len(offset) // 2
    assert offset[middle] == pytest.approx(0.0, abs=1e-9)
    assert force[middle] == pytest.approx(-scene.force_of_lines()[0], rel=1e-6)
    rest = scene.system.at_rest()
    tension = np.concatenate([rest.tension[line.id] for line in scene.system.lines])[scene.rows.links]
    ends = {i: np.array(p.position) for i, p in enumerate(scene.system.points)}
    first, last = rest.x[1][-2] - ends[1], rest.x[3][-2] - ends[4]
    pull = rest.tension[1][-1] * first / np.linalg.norm(first) + rest.tension[3][-1] * last / np.linalg.norm(last)
    assert scene.rows.level_force(scene.rows.points(rest.nodes), tension) == pytest.approx(pull[:2], rel=1e-6)
    chart = (scene.curves() or {})["plot_restoring"]
    assert len(chart.columns) == 3


def test_the_restoring_curve_of_a_file_with_a_body_is_kept_and_found_again_when_it_is_read_again(monkeypatch):
    scene, found, curve = scene_of("buoy", plot_restoring=True), [], CurveInputs.curve
    monkeypatch.setattr(CurveInputs, "curve", lambda *given: found.append(curve(*given)) or found[-1])
    for _ in range(2):
        scene.curves()
        scene.curves()
        mooring_of.cache_clear()
        scene.reset()
    assert len(found) == 2
    np.testing.assert_array_equal(*found)


def test_water_numbers_and_texts_are_those_of_the_file():
    scene = scene_of("version1", wave_height=2.0)
    p = scene.params
    assert (depth_of(p), water_of(p).density) == (80.0, 1025.0)
    assert extent(p) == pytest.approx(260.0)
    run_for(scene, 0.1)
    assert measured(SCENE, scene)["largest_tension"].value > 7e4
    lines = {f"{name}_{i}" for i in range(1, 5) for name in ("x", "tension")}
    assert set(scene.arrays()) == {"vessel", "end_tension", *lines}
    at_anchor, at_fairlead = scene.arrays()["end_tension"][0][0]
    line = scene.system.at_rest().end_tension[1]
    assert sorted((at_anchor, at_fairlead)) == pytest.approx(sorted(line), rel=0.05)
    assert at_fairlead == scene.readings().lines[0].fairlead
    assert scene.arrays()["x_1"][0].shape == (16, 3)
    assert {"lines", "depth", "axial_stiffness", "size", "handles"} <= hidden(p)
    assert "follow" not in hidden(p)
    assert "follow" in hidden(MooringParams())
    from types import SimpleNamespace

    status = SimpleNamespace(halted="")
    snapshot = SimpleNamespace(params=p, frame=scene.frame(), readings=scene.readings(), status=status)
    notes = notes_of(snapshot)  # type: ignore[arg-type]
    assert "version1.txt" in notes["Files"]
    assert "4 lines, 6 points, 2 of them on the vessel" in notes["Files"]
    assert "dtM" in notes["Files"]
    assert SCENE.quantities["line_weight"].value(snapshot) == pytest.approx(
        9.81 * (120.0 - 1025.0 * np.pi / 4.0 * 0.08**2)
    )


def test_a_file_without_coupled_points_has_no_vessel(tmp_path):
    text = (FILES / "stiff_cable.txt").read_text(encoding="utf-8").replace("Coupled", "Fixed")
    path = tmp_path / "hanging.txt"
    path.write_text(text, encoding="utf-8")
    scene = SCENE.make(MooringParams(moordyn_file=str(path), time_step=2e-4, current=0.5))
    assert not has_body(scene.params)
    scene.advance(400)
    assert scene.readings().most_offset == 0.0
    assert np.isfinite(scene.frame().points).all()
    assert (scene.curve_inputs(1.0).curve(scene.rows)[1] == 0.0).all()


def test_a_setup_holds_the_name_of_the_file_only():
    params = MooringParams(moordyn_file="/home/anna/deck.dat", wave_height=1.0)
    content = json.loads(write_file(SCENE, params))
    assert content["mooring"] == "deck.dat"
    assert content["version"] == 2
    setup = read_file(json.dumps(content))
    assert setup.files == {"mooring": "deck.dat"}
    assert "--mooring deck.dat" in missing_files(setup)
    assert missing_files(setup, params) == ""


def test_recording_and_replay_hold_the_name_of_the_file_and_no_folder(tmp_path):
    folder = tmp_path / "of-nobody-else"
    folder.mkdir()
    path = folder / "deck.txt"
    path.write_text((FILES / "turned_body.txt").read_text(encoding="utf-8"), encoding="utf-8")
    loop, recorder = SimLoop(SCENE.make(MooringParams(moordyn_file=str(path), time_step=1e-3))), Recorder(SCENE.packing)
    for i in range(4):
        loop.tick(1 / 25)
        recorder.note(loop.latest, i / 25)
    page = replay_html(SCENE, recorder.all_frames(), Plotted((), {}))  # type: ignore[arg-type]
    file = tmp_path / "recording.npz"
    file.write_bytes(recording_npz(SCENE, recorder.all_frames()))  # type: ignore[arg-type]
    with np.load(file) as found:
        about = str(found["about"])
    for text in (page, about):
        assert "deck.txt" in text
        assert "of-nobody-else" not in text
    assert read_file(read_setup_text("set-up", file), scene="mooring").files == {"mooring": "deck.txt"}


def test_a_file_runs_without_a_browser(tmp_path, capsys):
    out = tmp_path / "run.npz"
    arguments = ["--seconds", "0.2", "--rate", "10", "--out", str(out)]
    assert main(["run", "mooring", "--mooring", str(FILES / "table.txt"), *arguments]) == 0
    assert capsys.readouterr().err == ""
    with np.load(out) as found:
        about = json.loads(str(found["about"]))
        assert found["x_2"].shape == (3, 19, 3)
        assert found["tension_2"][0] == pytest.approx(read_moordyn(FILES / "table.txt").at_rest().tension[2], rel=1e-6)
    assert about["parameters"]["moordyn_file"] == "table.txt"
    assert about["parameters"]["time_step"] < 0.02  # half the longest stable one
    assert main(["run", "mooring", "--preset", str(out), *arguments[:-1], str(tmp_path / "again.npz")]) == 0
    assert "The mooring table.txt is missing" in capsys.readouterr().err


def test_what_is_left_out_is_said_and_a_bad_file_ends_the_program_in_one_line(tmp_path, capsys):
    out = ["--seconds", "0.01", "--out", str(tmp_path / "out.npz")]
    assert main(["run", "mooring", "--mooring", str(FILES / "chain.txt"), *out]) == 0
    assert (
        capsys.readouterr().err
        == "springtide: chain.txt: left out, as they control MoorDyn only: cfl, ICgenDynamic, dtWave\n"
    )
    bad = tmp_path / "bad.txt"
    bad.write_text("--- FAILURE ---\na\nb\n1 r Free\n", encoding="utf-8")
    for arguments in (
        ["run", "mooring", *out, "--mooring", str(bad)],
        ["--mooring", str(bad), "--no-open", "--port", "0"],
    ):
        assert main(arguments) == 2
        said = capsys.readouterr()
        assert said.err.count("\n") == 1
        assert "'FAILURE'" in said.err
        assert said.out == ""  # nothing is served
    huge = tmp_path / "huge.txt"
    text = (FILES / "chain.txt").read_text(encoding="utf-8")
    huge.write_text(text.replace("1 c 1 2 320.0 20 p\n", "1 c 1 2 320 1500 p\n2 c 1 2 321 1500 p\n"), encoding="utf-8")
    assert main(["run", "mooring", *out, "--mooring", str(huge)]) == 2
    assert "3000 nodes" in capsys.readouterr().err.splitlines()[-1]
    for scene in (["run", "rope", *out], ["--scene", "rope", "--no-open", "--port", "0"]):
        assert main([*scene, "--mooring", str(FILES / "chain.txt")]) == 2
        assert "--mooring" in capsys.readouterr().err


def test_a_file_is_read_once():
    assert mooring_of(SHARED) is mooring_of(SHARED)


def test_files_of_a_run_say_what_the_mooring_s_file_holds(tmp_path):
    """Not the lengths, depths and diameters of the parameters, which have no effect."""
    path = FILES / "version1.txt"
    system, params = read_moordyn(path), MooringParams(moordyn_file=str(path), time_step=4e-3)
    out = tmp_path / "run.npz"
    assert run_to_file("mooring", SCENE, params, 0.1, 10.0, out) == 0
    with np.load(out) as arrays:
        about = json.loads(str(arrays["about"]))
        assert arrays["end_tension"].shape == (2, 4, 2)
    assert about["parameters"]["moordyn_file"] == "version1.txt"
    assert not {"length", "depth", "diameter", "line_mass", "segments", "reach"} & set(about["parameters"])
    assert about["units"]["end_tension"] == "N"
    found = about["mooring"]
    assert (found["depth"], found["density"], found["gravity"]) == (80.0, 1025.0, 9.81)
    assert [(line["length"], line["segments"]) for line in found["lines"]] == [
        (line.length, line.segments) for line in system.lines
    ]
    assert found["types"][0]["diameter"] == system.lines[0].type.diameter
    assert [tuple(point["position"]) for point in found["points"]] == [point.position for point in system.points]
    plain = described(SCENE, MooringParams())
    assert set(plain) == {"scene", "parameters"}
    assert set(plain["parameters"]) == set(vars(MooringParams()))
