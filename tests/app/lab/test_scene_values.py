"""A student's functions at the numbers of a scene: right ones give what the program has."""

import dataclasses
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from app.lab.folder import make_folder
from app.lab.live_values import LiveNumber
from app.lab.program_check import Verdict
from app.lab.runner import Runner
from app.lab.saved import keep, read_files
from app.lab.scene_values import VALUES, Compared, SceneValues
from app.lab.task import load_tasks
from app.panel.code_panel import function_line
from app.panel.guide import live_values
from app.scenes import scene_named
from app.server.loop import SimLoop
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


@pytest.fixture
def make() -> Iterator[Callable[[float], SceneValues]]:
    """Makes values that calls of so many seconds may find, and closes them after the test."""
    made: list[SceneValues] = []

    def make_one(seconds: float) -> SceneValues:
        made.append(SceneValues(TASKS, seconds))
        return made[-1]

    yield make_one
    for one in made:
        one.close()


def links_of(found: SceneValues, folder: Path, rows: int) -> Compared:
    """What the student's `cloth_links` gives in a cloth of so many rows."""
    before, links = found.found, {"structural_links": 1.0, "shear_links": 1.0, "bend_links": 1.0}
    live = {name: LiveNumber(value) for name, value in {"rows": rows, "cols": 4, **links}.items()}
    found.ask("cloth", keep(read_files(folder), folder, 1, list(TASKS.values())), live)
    wait_for(lambda: found.found is not before)
    return found.found["cloth_links"]


@pytest.mark.parametrize(
    ("scene", "values", "expected"), SCENES, ids=[f"{scene}-{number}" for number, (scene, _, _) in enumerate(SCENES)]
)
def test_the_reference_solutions_give_the_numbers_of_the_program(
    make: Callable[[float], SceneValues], tmp_path: Path, scene: str, values: dict[str, object], expected: set[str]
) -> None:
    make_folder(tmp_path / "solutions", list(TASKS.values()), solutions=True)
    saved = keep(read_files(tmp_path / "solutions"), tmp_path / "solutions", 1, list(TASKS.values()))
    kind = scene_named(scene)
    loop = SimLoop(kind.make(dataclasses.replace(kind.params(), **values)))
    loop.tick(0.1)
    found = make(20.0)

    def is_found() -> bool:
        found.ask(scene, saved, live_values(kind, loop.latest))
        time.sleep(0.05)
        loop.tick(0.05)
        return set(found.found) == expected

    wait_for(is_found)
    for task, compared in found.found.items():
        tolerance = 0.02 if task == "wave_decay" else 1e-6  # Lamb's law is that of a small viscosity
        assert compared.error == ""
        assert compared.student == pytest.approx(compared.program, rel=tolerance), task
        assert compared.value.what in function_line(TASKS[task], Verdict("right"), compared)


def test_every_value_is_of_a_task_of_that_scene() -> None:
    assert {TASKS[task].file for _, task in VALUES} == {"radial_sea.py", "square_sea.py", "cloth.py"}
    assert all(TASKS[task].file == f"{scene}.py" for scene, task in VALUES)


def test_an_endless_function_is_called_once(make: Callable[[float], SceneValues], tmp_path: Path) -> None:
    source = "def cloth_links(rows, cols):\n    open('calls', 'a').write('x')\n    while True: pass\n"
    (tmp_path / "cloth.py").write_text(source)
    found = make(0.5)
    for rows in (5, 6):
        assert "endless loop" in links_of(found, tmp_path, rows).error
    assert (tmp_path / "calls").read_text() == "x"


def test_a_function_without_a_number_is_left_to_its_check(make: Callable[[float], SceneValues], tmp_path: Path) -> None:
    (tmp_path / "cloth.py").write_text("def cloth_links(rows, cols):\n    return 1 / 0\n")
    compared = links_of(make(20.0), tmp_path, 5)
    assert (compared.student, compared.error) == (None, "cloth.py, line 2: ZeroDivisionError: division by zero")
    assert "program" not in function_line(TASKS["cloth_links"], Verdict("failed", compared.error), compared)


def test_an_error_of_the_labs_own_leaves_the_thread_alive(
    make: Callable[[float], SceneValues], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cloth.py").write_text("def cloth_links(rows, cols):\n    return [0] * int(rows)\n")
    starts: list[Any] = []

    def runner(*arguments: Any) -> Runner:
        starts.append(arguments)
        if len(starts) == 1:
            raise OSError("no more files")
        return Runner(*arguments)

    monkeypatch.setattr("app.lab.scene_values.Runner", runner)
    found = make(20.0)
    for rows, student in ((5, None), (6, 6.0)):
        compared = links_of(found, tmp_path, rows)
        assert compared.student == student
        assert ("no more files" in compared.error) is (student is None)
