"""A sea that runs by a student's functions: right ones leave it as it is, wrong ones show, faults are named."""

import dataclasses
import inspect
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.lab.course.task import load_tasks
from app.lab.student.live_code import LiveCode
from app.lab.student.live_net import CLOTH, ROPE, LiveNet
from app.lab.student.live_tables import LiveTables
from app.lab.student.versions import Versions
from app.messages import StudentAnswer
from app.panel.workbook.code_panel import sea_texts
from app.scenes.radial_sea.bodies import box_of
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.scene import RadialSeaScene
from app.scenes.square_sea.parameters import SquareSeaParams
from app.scenes.square_sea.scene import SquareSeaScene
from sim.ocean.fluids.emulsions import arrhenius
from tests.waiting import wait_for

TASKS = {task.name: task for task in load_tasks()}
HEAD = "import numpy as np\n\n\n"
PHILLIPS = SquareSeaParams(size="64", mesh="32", spectrum="phillips", length=400.0, wind_speed=9.0, foam=False)
# What a function does in place of its body -> kind of the error and a part of what is said.
FAULTS = {
    "return 1 / 0": ("raised", "ZeroDivisionError"),
    "while True: pass": ("endless", "infinite loop"),
    "exit()": ("ended", "calls exit()"),
    "return np.zeros(2)": ("wrong shape", "expected a number"),
    "return np.nan": ("NaN", "returns NaN"),
    "return -3.0": ("out of range", "returns -3; expected"),
    "return np.inf": ("out of range", "returns inf"),
    "return 'high'": ("wrong type", "type str"),
    "return": ("returns nothing", "last line must be return"),
}
# Those that come to a result, so that the process lives on.
WRONG_VALUES = {line: said for line, said in FAULTS.items() if said[0] not in ("raised", "endless", "ended")}


def source(*names: str) -> str:
    return HEAD + "\n\n".join(inspect.getsource(TASKS[name].function) for name in names)


def with_fault(name: str, line: str) -> str:
    arguments = ", ".join(TASKS[name].arguments)
    return f"{HEAD}def {name}({arguments}):\n    {line}\n"


class Folder:
    """Versions of a student's file, and what runs them."""

    def __init__(self, path: Path) -> None:
        self.path, self.versions = path / "mine", Versions(path / "mine", list(TASKS.values()), 1.0)
        self.path.mkdir()
        self.versions.look()
        self.tables = LiveTables(self.versions, TASKS.values(), "sea")
        rope, cloth = self.nets = [LiveNet(material, self.versions) for material in (ROPE, CLOTH)]
        self.live = LiveCode(rope, cloth, self.tables)

    def save(self, text: str, file: str = "square_sea.py") -> int:
        (self.path / file).write_text(text, "utf-8")
        saved = self.versions.look()
        assert saved is not None
        self.tables.look()
        return saved.number


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Folder]:
    found = Folder(tmp_path)
    yield found
    found.versions.abort()
    found.tables.close()
    for net in found.nets:
        net.close()
    found.versions.close()


def settle(scene: SquareSeaScene | RadialSeaScene, folder: Folder, version: int, names: set[str]) -> None:
    """Let a scene run by these functions of a version."""

    def is_taken() -> bool:
        scene.handle(StudentAnswer())
        taken = scene.student.taken if scene.student is not None else {}
        return set(taken) == names and all(table.version == version for table in taken.values())

    wait_for(is_taken)


@pytest.mark.parametrize(
    "values",
    [{}, {"planet_mass": 20.0, "loop_period": 20.0, "dispersion_scale": 0.5}, {"wind_direction": 77.0}],
    ids=str,
)
def test_right_functions_make_the_sea_of_the_program(folder: Folder, values: dict[str, object]) -> None:
    params = dataclasses.replace(PHILLIPS, **values)
    scene, alone = SquareSeaScene(params, folder.live), SquareSeaScene(params)
    names = ("gravity", "spectrum", "dispersion")
    settle(scene, folder, folder.save(source(*names)), set(names))
    own, program = scene.sea, alone.sea
    assert own.significant_height_at(0.0) == pytest.approx(program.significant_height_at(0.0), rel=2e-3)
    waves = program.energy_at(0.0) > 1e-4 * program.energy_at(0.0).max()
    # The student's dispersion is that of deep water without surface tension, rounded to 2 pi/100000 s.
    assert np.allclose(own.frequencies[waves], program.frequencies[waves], rtol=1e-3, atol=1e-4)
    for _, student, reference, _ in folder.tables.report.differences:
        assert student == pytest.approx(reference, rel=5e-3)


def test_wrong_functions_show_and_a_switch_shows_the_program_s_sea(folder: Folder) -> None:
    scene, alone = SquareSeaScene(PHILLIPS, folder.live), SquareSeaScene(PHILLIPS)
    twice = source("spectrum").replace("return amplitude", "return 4 * amplitude")
    settle(scene, folder, folder.save(twice), {"spectrum"})
    program = alone.sea.significant_height_at(0.0)
    assert scene.sea.significant_height_at(0.0) == pytest.approx(2.0 * program, rel=2e-3)
    said = "".join(sea_texts(folder.tables.report))
    assert "The sea uses your <b>spectrum</b> (heights of the waves)." in said
    (what, own, reference, unit), *_ = folder.tables.report.differences
    assert own == pytest.approx(2.0 * reference, rel=2e-3)
    assert f"{what} <b>{own:.2f} {unit}</b> (program {reference:.2f} {unit})" in said
    folder.tables.show(False)
    scene.handle(StudentAnswer())
    assert scene.sea.significant_height_at(0.0) == pytest.approx(program, rel=1e-9)
    assert folder.tables.report.running == {}
    folder.tables.show(True)
    scene.handle(StudentAnswer())
    assert scene.sea.significant_height_at(0.0) > 1.9 * program


def test_a_change_of_the_wind_is_followed_and_another_spectrum_is_the_program_s(folder: Folder) -> None:
    scene = SquareSeaScene(PHILLIPS, folder.live)
    version = folder.save(source("spectrum"))
    settle(scene, folder, version, {"spectrum"})
    scene.advance(60)
    scene.change_forces(dataclasses.replace(PHILLIPS, wind_speed=14.0, transition=0.0))
    alone = SquareSeaScene(scene.params)
    wait_for(lambda: folder.tables.tables["spectrum"].call.columns[1][0, 0] > 12.0)
    scene.handle(StudentAnswer())
    assert scene.sea.significant_height_at(1.0) == pytest.approx(alone.sea.significant_height_at(0.0), rel=2e-3)
    scene.change_forces(dataclasses.replace(PHILLIPS, spectrum="jonswap"))
    assert scene.student is not None
    assert scene.student.taken == {}
    assert scene.sea.spectrum.name == "jonswap"
    assert "choose the spectrum Phillips" in folder.tables.report.idle["spectrum"]
    scene.params = dataclasses.replace(PHILLIPS, order=2, size="64", mesh="32")
    scene.reset()
    assert set(folder.tables.report.idle) == {"gravity", "spectrum", "dispersion"}
    assert "choose order 1" in folder.tables.report.idle["dispersion"]
    assert scene.marching is not None
    scene.handle(StudentAnswer())
    assert scene.student.taken == {}


def test_the_scene_is_told_of_every_new_table(folder: Folder) -> None:
    scene, told = SquareSeaScene(PHILLIPS, folder.live), threading.Event()
    folder.tables.wake = told.set
    for factor in (1, 4):
        told.clear()
        version = folder.save(source("spectrum").replace("return amplitude", f"return {factor} * amplitude"))
        assert told.wait(60.0)
        assert folder.tables.tables["spectrum"].version == version
    assert scene.student is not None


@pytest.mark.parametrize(
    ("name", "faults"),
    [
        ("gravity", FAULTS),
        ("spectrum", WRONG_VALUES),
        pytest.param("dispersion", WRONG_VALUES, marks=pytest.mark.stress),
        *(pytest.param(name, FAULTS, marks=pytest.mark.stress) for name in ("spectrum", "dispersion")),
    ],
)
def test_a_fault_is_named_and_the_last_version_goes_on(
    folder: Folder, name: str, faults: dict[str, tuple[str, str]]
) -> None:
    scene = SquareSeaScene(PHILLIPS, folder.live)
    works = folder.save(source(name))
    settle(scene, folder, works, {name})
    for line, (kind, said) in faults.items():
        folder.save(with_fault(name, line))
        wait_for(lambda said=said: name in folder.tables.errors and said in folder.tables.errors[name].text)
        error = folder.tables.errors[name]
        assert error.kind == kind
        assert (error.file, error.line) in (("square_sea.py", 5), ("square_sea.py", 4))
        scene.handle(StudentAnswer())
        scene.advance(1)
        assert np.isfinite(scene.frame().vertices).all()
        assert scene.student is not None
        assert scene.student.taken[name].version == works
    settle(scene, folder, folder.save(source(name)), {name})
    assert folder.tables.errors == {}


def test_an_endless_function_is_called_once_however_the_scene_changes(folder: Folder) -> None:
    scene = SquareSeaScene(PHILLIPS, folder.live)
    number = folder.save(f"{HEAD}def gravity(mass_ratio):\n    open('calls', 'a').write('x')\n    while True: pass\n")
    wait_for(lambda: folder.tables.errors)
    for mass in (2.0, 3.0):
        scene.change_forces(dataclasses.replace(scene.params, planet_mass=mass))
        wait_for(lambda mass=mass: folder.tables.asked["gravity"][1].columns[0][0] == mass)
    assert (folder.versions.copies / str(number) / "calls").read_text("utf-8") == "x"
    assert "infinite loop" in folder.tables.errors["gravity"].text


def test_a_moment_that_comes_back_runs_by_the_functions_of_now(folder: Folder) -> None:
    scene = SquareSeaScene(PHILLIPS, folder.live)
    kept = scene.keep()
    twice = source("spectrum").replace("return amplitude", "return 4 * amplitude")
    settle(scene, folder, folder.save(twice), {"spectrum"})
    high = scene.sea.significant_height_at(0.0)
    scene.resume(kept)
    assert scene.sea.significant_height_at(0.0) == pytest.approx(high, rel=1e-6)


RADIAL = ("mixture_viscosity", "wave_decay", "reflectance", "draft")
OIL = RadialSeaParams(spill="layer", thickness=0.2, waves=False, rig=False, ripples=False, rings=16, spokes=16)


def test_the_radial_sea_runs_by_right_functions_as_the_program_does(folder: Folder) -> None:
    mixed = dataclasses.replace(OIL, spill="mixed", fraction=0.4, mixture_law="arrhenius", exposure=60.0, waves=True)
    scene, alone = RadialSeaScene(mixed, folder.live), RadialSeaScene(mixed)
    version = folder.save(source(*RADIAL), "radial_sea.py")
    settle(scene, folder, version, {"mixture_viscosity", "wave_decay"})
    column = scene.column
    assert column.surface.viscosity == pytest.approx(
        arrhenius(column.oil.viscosity, column.water.viscosity, 0.4), rel=1e-9
    )
    assert scene.sum.significant_height == pytest.approx(alone.sum.significant_height, rel=1e-3)
    told = {what for what, *_ in folder.tables.report.differences}
    assert "A wave of 1 m falls to 37 % in" in told
    assert "Draft of the box" not in told  # the function gives none of a box in a mixture
    scene.change_forces(dataclasses.replace(mixed, spill="layer"))
    settle(scene, folder, version, {"wave_decay", "reflectance", "draft"})
    scene.advance(1)
    assert scene.frame().column.oil.refractive_index == pytest.approx(scene.column.oil.refractive_index, rel=1e-9)
    told = {what: (own, program) for what, own, program, _ in folder.tables.report.differences}
    assert told["Draft of the box"] == pytest.approx((told["Draft of the box"][1],) * 2, rel=1e-3)
    assert "mix oil and water entirely" in folder.tables.report.idle["mixture_viscosity"]
    scene.change_forces(dataclasses.replace(mixed, spill="none"))
    assert scene.column == RadialSeaScene(scene.params).column


def test_a_wrong_draft_lets_the_box_bob(folder: Folder) -> None:
    scene = RadialSeaScene(OIL, folder.live)
    box = box_of(scene.bodies)
    assert box is not None
    right = float(scene.bodies.fleet.position[box, 2])
    settle(scene, folder, folder.save(source("draft"), "radial_sea.py"), {"draft"})
    assert scene.bodies.fleet.position[box, 2] == pytest.approx(right, abs=1e-3)
    early = "return body_density * height / water_density\n    load = body_density"
    in_water = source("draft").replace("load = body_density", early)
    settle(scene, folder, folder.save(in_water, "radial_sea.py"), {"draft"})
    assert scene.bodies.fleet.position[box, 2] - right == pytest.approx(0.2 * (1 - 866 / 1025), rel=0.2)
    scene.advance(10)
    assert scene.bodies.fleet.velocity[box, 2] < -0.01  # it sinks to where it floats


@pytest.mark.parametrize("name", ["wave_decay", "draft"])
def test_the_radial_sea_keeps_the_last_version_that_worked(folder: Folder, name: str) -> None:
    scene = RadialSeaScene(OIL, folder.live)
    works = folder.save(source(name), "radial_sea.py")
    settle(scene, folder, works, {name})
    for line, (kind, said) in FAULTS.items():
        if kind == "endless":  # takes its time, and is that of the other sea
            continue
        folder.save(with_fault(name, line), "radial_sea.py")
        wait_for(lambda said=said: name in folder.tables.errors and said in folder.tables.errors[name].text)
        assert folder.tables.errors[name].kind == kind
        scene.handle(StudentAnswer())
        scene.advance(1)
        assert scene.student is not None
        assert scene.student.taken[name].version == works


def test_an_error_of_the_lab_is_shown_and_the_next_version_runs(
    folder: Folder, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise TypeError("not what was expected")

    scene = SquareSeaScene(PHILLIPS, folder.live)
    with monkeypatch.context() as patch:
        patch.setattr("app.lab.process.runner.Runner.table", fail)
        folder.save(source("gravity"))
        wait_for(lambda: folder.tables.errors)
        assert "TypeError: not what was expected" in str(next(iter(folder.tables.errors.values())))
    settle(scene, folder, folder.save(source("gravity") + "\n# saved again\n"), {"gravity"})
    assert folder.tables.errors == {}
