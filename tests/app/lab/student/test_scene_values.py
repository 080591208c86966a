"""A student's functions at the numbers of a scene: right ones give what the program has."""

import dataclasses
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.lab.course.folder import make_folder
from app.lab.course.live_values import LiveNumber
from app.lab.course.task import load_tasks
from app.lab.student.live_tables import LiveTables
from app.lab.student.scene_values import VALUES, calls_here
from app.lab.student.versions import Versions
from app.panel.workbook.code_panel import compared_text
from app.panel.workbook.guide import SnapshotValues
from app.scenes import scene_named
from app.server.loop.sim_loop import SimLoop
from tests.waiting import wait_for

TASKS = {task.name: task for task in load_tasks()}
RADIAL = {"extra_draft", "draft", "net_buoyancy", "wave_decay", "reflectance"}
SCENES = [
    ("radial_sea", {"spill": "layer", "oil": "Alaska North Slope 2002"}, RADIAL),
    ("radial_sea", {"spill": "mixed"}, {"net_buoyancy", "mixture_viscosity", "wave_decay", "reflectance"}),
    (
        "square_sea",
        {"viscosity": 1e-3, "loop_period": 20.0, "statistics": True, "size": "64", "spectrum": "phillips"},
        {"gravity", "damping_length", "dispersion", "spectrum"},
    ),
    ("cloth", {"rows": 5, "cols": 4}, {"cloth_links"}),
]
CLOTH = {"rows": 5.0, "cols": 4.0, "structural_links": 31.0, "shear_links": 24.0, "bend_links": 22.0}


@pytest.fixture
def values(tmp_path: Path) -> Iterator[LiveTables]:
    (tmp_path / "mine").mkdir()
    versions = Versions(tmp_path / "mine", list(TASKS.values()), 20.0)
    found = LiveTables(versions, TASKS.values(), "values")
    yield found
    found.close()
    versions.close()


@pytest.mark.parametrize(
    ("scene", "settings", "expected"), SCENES, ids=[f"{scene}-{number}" for number, (scene, _, _) in enumerate(SCENES)]
)
def test_the_reference_solutions_give_the_numbers_of_the_program(
    values: LiveTables, scene: str, settings: dict[str, object], expected: set[str]
) -> None:
    make_folder(values.versions.folder, list(TASKS.values()), solutions=True)
    saved = values.versions.look()
    assert saved is not None
    kind = scene_named(scene)
    loop = SimLoop(kind.make(dataclasses.replace(kind.params(), **settings)))
    loop.tick(0.1)

    def is_found() -> bool:
        values.want(calls_here(scene, saved.begun, SnapshotValues(kind, loop.latest)))
        time.sleep(0.05)
        loop.tick(0.05)
        return set(values.tables) == expected

    wait_for(is_found)
    assert not values.errors
    for task, table in values.tables.items():
        tolerance = 0.02 if task == "wave_decay" else 1e-6  # Lamb's law is that of a small viscosity
        assert table.values[0] == pytest.approx(table.call.program, rel=tolerance), task
        assert VALUES[scene, task].what in compared_text(scene, task, values)


def test_every_value_is_of_a_task_of_that_scene() -> None:
    assert {TASKS[task].file for _, task in VALUES} == {"radial_sea.py", "square_sea.py", "cloth.py"}
    assert all(TASKS[task].file == f"{scene}.py" for scene, task in VALUES)


@pytest.mark.parametrize("wrong", ["1 / 0", "5", "[0] * rows + [0] * (rows / cols)"])
def test_a_function_without_a_number_is_left_to_its_check(values: LiveTables, wrong: str) -> None:
    calls = calls_here("cloth", {"cloth_links"}, {name: LiveNumber(value) for name, value in CLOTH.items()})
    assert calls["cloth_links"].program == 77.0
    values.want(calls)
    for number, body in enumerate(("[0] * rows", wrong), 1):
        (values.versions.folder / "cloth.py").write_text(f"def cloth_links(rows, cols):\n    return {body}\n", "utf-8")
        assert values.versions.look() is not None
        values.look()
        wait_for(lambda expected=number == 2: bool(values.tables) and bool(values.errors) is expected)
        assert values.tables["cloth_links"].values[0] == 5.0  # of the version that works
        assert ("program 77" in compared_text("cloth", "cloth_links", values)) is (number == 1)
