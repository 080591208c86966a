"""A cloth that a student's functions move beside the program's: right ones move it alike, faults are named."""

import dataclasses
import inspect
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.lab.course.task import load_tasks
from app.lab.student.session import Session
from app.messages import GrabTo, Place, StudentAnswer
from app.panel.workbook.code_panel import code_lines, net_texts, tables_of
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.scene import ClothScene
from tests.app.lab.student.test_session import save, taken, working_in
from tests.waiting import wait_for

TASKS = load_tasks()
SOURCES = {task.name: inspect.getsource(task.function) for task in TASKS if task.file == "cloth.py"}
RIGHT = "import numpy as np\n\n\n" + "\n\n".join(SOURCES.values())
SMALL = ClothParams(
    integrator="symplectic_euler", time_step=1 / 240, rows=5, cols=6, stiffness=100.0, shear=60.0, bend=3.0, gather=1.0
)
ACCIDENTS = {
    "while True: pass": ("endless", "infinite loop"),
    "exit()": ("ended", "calls exit()"),
    "return x + y": ("raised", "NameError"),
    "return np.zeros(3)": ("wrong shape", "cloth_forces returns an array of shape (3,)"),
    "return np.nan * x": ("NaN", "cloth_forces returns NaN"),
    "return": ("returns nothing", "last line must be return"),
}
WRONG_LINKS = {
    "return np.array([[0, 999]])": "returns a point that does not exist: a cloth of",
    "return np.array([[1, 1]])": "joins a point to itself",
    "return [[0, 1, 2]]": "expected an array of shape (1, 2)",
    "return [[0.5, 1.0]]": "returns a point that does not exist",
    "return 3": "expected an array",
}


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    with working_in(tmp_path_factory.mktemp("lab") / "mine") as session:
        yield session


@pytest.fixture
def right(session: Session) -> Session:
    """The session with right functions, which move the cloth."""
    saved = session.versions.of("cloth.py")
    if session.state.error is not None or saved is None or saved.texts["cloth.py"] != RIGHT.encode():
        save(session, RIGHT, "cloth.py")
        wait_for(lambda: session.state.error is None and taken(session, "cloth") == session.state.version)
    return session


def run(scene: ClothScene, frames: int = 20) -> None:
    """Let a cloth run, with as much time for the student's as it needs."""
    student = scene.student
    assert student is not None
    for _ in range(frames):
        scene.advance(4)
        wait_for(lambda: student.answers.qsize() or not student.sent)
        scene.handle(StudentAnswer())


def test_without_a_function_there_is_no_second_cloth(tmp_path: Path) -> None:
    with working_in(tmp_path / "mine") as session:
        scene = ClothScene(SMALL, session.live)
        run(scene, 2)
        assert scene.frame().student is None


@pytest.mark.parametrize(
    "values",
    [
        {"air": 0.0, "floor": False},
        {"wind": 4.0, "gust": 0.0},
        {"start": "level", "pinned": "corners", "sphere": True, "integrator": "rk4"},
        {"start": "level", "pinned": "free", "sphere": True, "contact_stiffness": 100.0},
    ],
    ids=str,
)
def test_right_functions_move_the_cloth_as_the_program_does(right: Session, values: dict[str, object]) -> None:
    scene = ClothScene(dataclasses.replace(SMALL, **values), right.live)
    start = scene.state.x.copy()
    run(scene, 25)
    assert np.abs(scene.state.x - start).max() > 0.01
    assert right.cloth.report.difference < 1e-6
    student = scene.frame().student
    assert student is not None
    assert np.allclose(student, scene.frame().points, atol=1e-5)
    assert "Your cloth is driven by <b>cloth_forces, cloth_links</b>." in code_lines(
        right.state, right.cloth.report, tables_of(right), "cloth"
    )


def test_only_points_touch_a_small_sphere_beside_a_student_s_cloth(right: Session) -> None:
    """Program's and student's cloth pass it alike, and the panel says so; without a student faces touch it."""
    level = {"start": "level", "pinned": "free", "sphere": True, "sphere_radius": 0.05, "floor": False}
    params = dataclasses.replace(SMALL, contact_stiffness=1000.0, **level)
    scene, alone = ClothScene(params, right.live), ClothScene(params)
    run(scene, 40)
    alone.advance(160)
    assert alone.net.faces_touch
    assert not scene.net.faces_touch
    assert alone.state.x[2].mean() > scene.state.x[2].mean() + 0.01
    assert right.cloth.report.difference < 1e-6
    said = "only the points of both cloths touch"
    assert any(said in text for text in net_texts(right.state, right.cloth.report, "cloth"))


def test_pins_and_mouse_move_both(right: Session) -> None:
    scene = ClothScene(dataclasses.replace(SMALL, air=0.0), right.live)
    run(scene, 2)
    scene.handle(Place("pin a", (-0.6, 0.2, 2.2)))
    scene.handle(GrabTo(20, (0.2, -0.5, 1.0)))
    run(scene, 20)
    assert scene.state.x[1, 0, 0] > 0.05
    assert right.cloth.report.difference < 1e-9


def test_a_large_cloth_has_a_coarser_one_beside_it(right: Session) -> None:
    scene = ClothScene(ClothParams(), right.live)
    run(scene, 6)
    frame = scene.frame()
    assert frame.student is not None
    assert frame.points.shape[:2] == (32, 32)
    assert frame.student.shape[0] in (6, 10)
    assert np.isfinite(frame.student).all()
    said = code_lines(right.state, right.cloth.report, tables_of(right), "cloth")
    assert f"{frame.student.shape[0]} × {frame.student.shape[1]} points, without pleats" in said


def test_a_coarser_cloth_hangs_on_the_same_pins(right: Session) -> None:
    scene = ClothScene(ClothParams(), right.live)
    run(scene, 3)
    scene.handle(Place("pin a", (-1.2, 0.1, 2.6)))
    run(scene, 6)
    frame = scene.frame()
    assert frame.student is not None
    assert frame.student[0, [0, -1]] == pytest.approx(frame.points[0, [0, -1]], abs=1e-5)


def test_a_coarser_cloth_takes_no_part_in_a_grab(right: Session) -> None:
    found = []
    for grabs in (False, True):
        scene = ClothScene(ClothParams(pinned="corners"), right.live)
        run(scene, 3)
        if grabs:
            scene.handle(GrabTo(32 * 16, (3.0, -3.0, 1.0)))
        run(scene, 20)
        found.append(scene.frame())
    assert np.abs(found[1].points - found[0].points).max() > 0.1
    assert found[1].student == pytest.approx(found[0].student, abs=1e-6)


def test_a_wrong_function_leaves_the_program_s_cloth_alone(right: Session) -> None:
    save(right, RIGHT.replace("force[j] -= pull", "force[j] += pull"), "cloth.py")
    wait_for(lambda: taken(right, "cloth") == right.state.version)
    scene, alone = ClothScene(SMALL, right.live), ClothScene(SMALL)
    run(scene, 30)
    for _ in range(30):
        alone.advance(4)
    assert np.isfinite(right.cloth.report.left_at) or right.cloth.report.difference > 0.05
    assert np.allclose(scene.state.x, alone.state.x, atol=1e-9)
    assert np.isfinite(scene.frame().points).all()


# That the process outlives them all is tested with the rope; here, what is the cloth's own.
@pytest.mark.parametrize(
    "line", [pytest.param(line, marks=[] if "np" in line else pytest.mark.stress) for line in ACCIDENTS]
)
def test_what_goes_wrong_is_named_and_the_last_version_goes_on(right: Session, line: str) -> None:
    working = taken(right, "cloth")
    save(right, RIGHT.replace("    x, v = np.asarray(x)", f"    {line}\n    x, v = np.asarray(x)"), "cloth.py")
    wait_for(lambda: right.state.error)
    assert right.state.error is not None
    assert right.state.error.kind == ACCIDENTS[line][0]
    assert ACCIDENTS[line][1] in right.state.error.text
    assert right.state.error.file == "cloth.py"
    assert right.state.error.line is not None
    scene = ClothScene(SMALL, right.live)
    run(scene, 3)
    assert right.cloth.report.version == working
    assert scene.frame().student is not None


def test_links_that_no_cloth_has_are_named(right: Session) -> None:
    for line, said in WRONG_LINKS.items():
        save(right, RIGHT.replace("    links = []", f"    {line}\n    links = []"), "cloth.py")
        wait_for(lambda said=said: right.state.error and said in right.state.error.text)


def test_a_cloth_that_is_saved_does_not_begin_another_scene_again(right: Session) -> None:
    begun: list[int] = []
    right.live.connect("rope", lambda: None, lambda: begun.append(1))
    save(right, RIGHT + "\n# changed\n", "cloth.py")
    wait_for(lambda: taken(right, "cloth") == right.state.version)
    assert begun == []


def test_many_steps_at_once_are_taken_in_parts_that_end_where_they_would(right: Session) -> None:
    scene = ClothScene(dataclasses.replace(SMALL, start="level", sphere=True, bob=0.2), right.live)
    student = scene.student
    assert student is not None
    for steps in (40, 7):
        scene.advance(steps)
        segments = [*student.sent, *student.waiting]
        assert [segment.steps for segment in segments] == {40: [16, 16, 8], 7: [7]}[steps]
        assert segments[-1].end == pytest.approx(scene.time)
        wait_for(lambda: scene.handle(StudentAnswer()) or not (student.sent or student.waiting))
    assert student.time == pytest.approx(scene.time)
    assert right.cloth.report.difference < 1e-6
