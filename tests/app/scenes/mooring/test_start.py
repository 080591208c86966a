"""The check of a mooring before it runs: what is found, what is advised, and that advice which is followed helps."""

import dataclasses
import math
import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.__main__ import main
from app.scenes.contract import Advice
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.files.file_scene import FileScene
from app.scenes.mooring.line_scene import LineScene
from app.scenes.mooring.parameters import PRESETS, MooringParams
from app.scenes.mooring.readings.report import figures_of, marks_of, notes_of
from app.scenes.mooring.scene import advice, remedy, scene_of, warnings
from app.scenes.mooring.start import NO_REST
from app.scenes.mooring.start_check import MAX_REST_STRETCH, rounded_up
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record
from sim.validation import ConvergenceError
from tests.app.scenes.mooring.test_mooring import random_params

FILES = Path(__file__).parents[3] / "sim/mooring/moordyn/files"
FEW: dict[str, Any] = {"segments": 12, "wave_height": 0.0}


def scene_with(**values: Any) -> LineScene:
    return scene_of(check_record(MooringParams, {**FEW, **values}))


def snapshot_of(scene: LineScene) -> Any:
    status = SimpleNamespace(halted="")
    return SimpleNamespace(params=scene.params, frame=scene.frame(), readings=scene.readings(), status=status)


def edited(tmp_path: Path, name: str, *changes: tuple[str, str]) -> str:
    """A copy of a MoorDyn file with other words."""
    text = (FILES / f"{name}.txt").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / f"{name}.txt"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("preset", PRESETS)
def test_no_preset_has_a_fault(preset):
    scene = scene_of(check_record(MooringParams, PRESETS[preset]))
    assert scene.start.fault is None
    assert warnings(scene) == []


@pytest.mark.parametrize(
    ("values", "reach"), [({"length": 40.0}, 80.0), ({"length": 30.0, "reach": 0.5, "lines": 1}, 0.5)]
)
def test_lines_that_cannot_reach_their_anchors_are_named_before_the_first_step(values, reach):
    """By Pythagoras: from an anchor on the bed to the lower edge of a buoy 9 m wide and 0.55 as high, 45 % of it wet.

    The second body is drawn under water, and its line is hardly stretched.
    """
    scene = scene_with(**values)
    height = 0.55 * 9.0
    way = math.hypot(reach - 4.5, 40.0 - 450.0 / 1025.0 * height)
    fault = scene.start.fault
    assert fault is not None
    assert fault.parameter == "length"
    assert fault.advice is not None
    assert way <= fault.advice.value < way + 0.11
    assert fault.said.startswith(f"{values['length']:g} m cannot reach an anchor {reach:g} m away in 40 m of water: at")
    shown = snapshot_of(scene)
    assert fault.short in figures_of(shown)
    assert fault.said in marks_of(shown)["length"]
    assert marks_of(shown)["axial_stiffness"] == ""
    assert advice(shown) == fault.advice
    assert warnings(scene) == [fault.said]


def test_a_line_that_is_a_little_too_short_is_named_with_its_stretch():
    taut, short = scene_with(length=82.0), scene_with(length=78.0)
    assert taut.start.fault is None  # by 3 %, as taut moorings are laid
    assert short.start.stretch.max() == pytest.approx(0.0545, abs=2e-3)
    fault = short.start.fault
    assert fault is not None
    assert fault.said.startswith("Line 1 is stretched by 5.4\u00a0% at rest: shorter than the way to its anchor")
    assert not fault.is_grave  # a run that diverges then is said to have too long a step


def test_a_line_that_is_too_soft_for_its_load_is_advised_the_stiffness_that_its_load_needs():
    values = {"lines": 1, "axial_stiffness": 2e6, "steady_force": 500.0, "integrator": "leapfrog"}
    scene = scene_with(**values)
    load = scene.readings().lines[0].fairlead
    assert scene.start.fault is not None
    assert scene.start.fault.parameter == "axial_stiffness"
    assert scene.start.fault.advice is not None
    assert 1.0 < scene.start.fault.advice.value / (load / MAX_REST_STRETCH) < 1.4
    scene.change_forces(dataclasses.replace(scene.params, axial_stiffness=scene.start.fault.advice.value))
    assert scene.start.fault is None  # at once, as the motion continues
    scene.change_forces(dataclasses.replace(scene.params, axial_stiffness=2e6))
    assert scene.start.fault is not None
    scene.change_forces(dataclasses.replace(scene.params, steady_force=10.0))
    assert scene.start.fault is None


def test_advice_that_is_followed_helps():
    rng, followed = random.Random(7), 0
    for _ in range(30):
        scene = scene_of(random_params(rng))
        for _ in range(6):  # heavy lines that are nearly straight need several
            if (found := advice(snapshot_of(scene))) is None:
                break
            followed += 1
            scene = scene_of(dataclasses.replace(scene.params, **{found.name: found.value}))
        assert advice(snapshot_of(scene)) is None
    assert followed > 10


def test_a_shorter_step_is_advised_only_if_the_start_is_not_at_fault(monkeypatch):
    for length, name in ((40.0, "length"), (78.0, "time_step"), (96.0, "time_step")):
        found = remedy(snapshot_of(scene_with(length=length, time_step=0.01)))
        assert found is not None
        assert found.name == name

    def fail(system):
        raise ConvergenceError("static state of the mooring", "3 N", 40)

    monkeypatch.setattr("app.scenes.mooring.start.at_rest", fail)
    restless = scene_with()
    assert remedy(snapshot_of(restless)) is None
    assert NO_REST in figures_of(snapshot_of(restless))
    loop = SimLoop(scene_with(length=40.0), effort=lambda: 0.0)
    for _ in range(3):
        loop.tick(1 / 60)
    assert loop.run.halted.startswith("40 m cannot reach")


def test_a_fault_is_that_of_the_place_of_a_dragged_anchor():
    scene = MooringScene(check_record(MooringParams, {**FEW, "lines": 1}))
    scene.attached.anchors[0].place_at((-140.0, 0.0, -40.0))
    scene.change_forces(dataclasses.replace(scene.params, axial_stiffness=6e7))
    assert scene.start.fault is not None
    assert scene.start.fault.said.startswith("96 m cannot reach an anchor 140 m away")


def test_lines_and_points_of_a_file(tmp_path):
    plain = FileScene(MooringParams(moordyn_file=str(FILES / "chain.txt"), wave_height=0.0, time_step=2e-3))
    assert warnings(plain) == []
    short = edited(tmp_path, "chain", ("1 c 1 2 320.0", "1 c 1 2 120.0"))
    scene = FileScene(MooringParams(moordyn_file=short, wave_height=0.0, time_step=1e-3))
    first, last = (point.position for point in scene.file.system.points)
    way = rounded_up(math.dist(first, last))
    said = f"Line 1 of 120 m cannot reach from point 1 to point 2: at least {way:g} m."
    assert warnings(scene) == [said]
    shown = snapshot_of(scene)
    assert said in notes_of(shown)["Files"]
    assert said.partition(":")[0] in figures_of(shown)
    assert remedy(shown) is None
    assert advice(shown) is None


def test_fixed_points_above_the_bed_and_the_water_are_said(tmp_path):
    hung = edited(tmp_path, "stiff_cable", ("Coupled", "Fixed"))
    scene = FileScene(MooringParams(moordyn_file=hung, time_step=2e-4))
    depth = scene.system.water.depth
    heights = [point.position[2] + depth for point in scene.file.system.points if point.kind == "fixed"]
    raised = [h for h in heights if h > 1e-3 * depth]
    found = warnings(scene)
    assert len(found) == len(raised) > 0
    assert all("above the bed" in said or "above the water" in said for said in found)


def test_springtide_run_warns_in_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    out = str(tmp_path / "run.npz")
    arguments = ["run", "mooring", "--seconds", "0.01", "--out", out, "--set", "segments=12", "time_step=0.0005"]
    assert main([*arguments, "length=40"]) == 0
    said = "Warning: 40 m cannot reach an anchor 80 m away in 40 m of water: at least 84.5 m."
    assert capsys.readouterr().out.splitlines()[0] == said
    assert main([*arguments, "length=96"]) == 0
    assert "Warning" not in capsys.readouterr().out


@pytest.mark.parametrize(("value", "expected"), [(84.41, 84.5), (84.5, 84.5), (1234.0, 1240.0), (0.12301, 0.124)])
def test_advised_values_are_rounded_up(value, expected):
    assert rounded_up(value) == expected
    assert Advice("length", expected, "").value >= value
