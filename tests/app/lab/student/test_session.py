"""A student's folder while the lab is served: what is saved runs, what is wrong is named, and the lab continues."""

import contextlib
import dataclasses
import inspect
import re
import shutil
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.lab.check.program_check import Verdict, not_checked
from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.process.rope_march import REFERENCE
from app.lab.process.runner import RunError, Runner
from app.lab.student.background_check import BackgroundCheck
from app.lab.student.live_net import CLOTH, ROPE, StudentReport, bent_rope
from app.lab.student.live_tables import TableReport
from app.lab.student.saved import read_files
from app.lab.student.session import CodeState, Session
from app.lab.student.versions import Versions, stamps
from app.messages import GrabTo, Place, StudentAnswer
from app.panel.workbook.code_panel import (
    CHART_LEFT,
    CHART_WIDTH,
    code_lines,
    difference_chart,
    function_lines,
    headline,
    net_texts,
)
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene, rows_of
from tests.app.lab.check.test_true_sentences import CALLERS, source_of
from tests.waiting import wait_for

TASKS = load_tasks()
LIMIT = 1.0 if sys.platform == "linux" else 5.0  # [s] of a call; elsewhere other processes take a part of it
HEAD = "import numpy as np\n\n"
RIGHT = HEAD + inspect.getsource(REFERENCE["spring_force"])
# Line of spring_force -> kind of the error and a part of what is said; each is put before the right body.
ACCIDENTS = {
    "while True: pass": ("endless", "infinite loop"),
    "exit()": ("ended", "calls exit()"),
    "__import__('os')._exit(3)": ("ended", "exit status 3"),
    "np.ones(1 << 27)": ("memory", "MiB"),
    "for i in range(1_000_000): print(i)": ("printed", "10000 lines"),
    "return x1 + x3": ("raised", "NameError: name 'x3' is not defined"),
    "return np.zeros(4)": ("wrong shape", "spring_force returns an array of shape (4,)"),
    "return 'pull'": ("wrong type", "type str"),
    "return": ("returns nothing", "last line must be return"),
    "return np.sqrt(-abs(x1))": ("NaN", "spring_force returns NaN"),
    "return (": ("syntax", "SyntaxError"),
}


def with_line(line: str) -> str:
    return RIGHT.replace("    r = np", f"    {line}\n    r = np")


@contextlib.contextmanager
def working_in(folder: Path) -> Iterator[Session]:
    """A new folder of exercises that is being worked on."""
    make_folder(folder, TASKS)
    session = Session(folder, TASKS, time_limit=LIMIT)
    wait_for(lambda: session.state.version == 1)
    yield session
    session.close()


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    """The folder that most tests save into, one after the other."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e6)  # compiling takes seconds: see tests/stress
        with working_in(tmp_path_factory.mktemp("lab") / "mine") as session:
            yield session
            copies = session.versions.copies
    assert not copies.exists()


def save(session: Session, text: str, file: str = "rope.py") -> None:
    """Save a file, and wait until it has been taken up."""
    before = session.state.version
    (session.folder / file).write_bytes(text.encode())  # the ends of its lines are the same on Windows
    wait_for(lambda: session.state.version > before)


def taken(session: Session, name: str = "rope") -> int:
    """The version that moves the rope, or the cloth, or will; 0 without one."""
    use = (ROPE if name == "rope" else CLOTH).use
    return max((saved.number for saved in session.versions.worked.get(use, ())), default=0)


def of_rope(session: Session) -> int:
    """The version in which the rope's file was saved last."""
    saved = session.versions.of("rope.py")
    return 0 if saved is None else saved.number


def process(session: Session) -> Runner:
    """The process of the rope."""
    return session.versions.processes["rope", taken(session), False]


def run(scene: RopeScene, frames: int = 20) -> None:
    """Let a rope run, with as much time for the student's as it needs."""
    assert scene.student is not None
    for _ in range(frames):
        scene.advance(2)
        wait_for(lambda: scene.student.answers.qsize() or not scene.student.sent)
        scene.handle(StudentAnswer())


def make_scene(session: Session, **values: object) -> RopeScene:
    return RopeScene(dataclasses.replace(RopeParams(integrator="rk4"), **values), session.live)


@pytest.fixture
def right(session: Session) -> Session:
    """The session with a right `spring_force`, and nothing else, that moves the rope."""
    saved = session.versions.of("rope.py")
    if session.state.error is not None or saved is None or saved.texts["rope.py"] != RIGHT.encode():
        save(session, RIGHT)
    wait_for(lambda: session.state.error is None and taken(session) == of_rope(session))
    return session


@pytest.mark.parametrize("version", [0, 3])
@pytest.mark.parametrize("running", [False, True])
def test_the_headline_tells_whether_a_net_or_a_table_runs(version: int, running: bool) -> None:
    state = CodeState(version=5, saved_at="12:00:00")
    tables = TableReport(running={"gravity": "the pull"} if running else {})
    said = headline(state, StudentReport(version=version), tables, "rope")
    assert ("since 12:00:00" in said) is (version > 0 or running)
    assert ("uses none of your functions yet" in said) is (version == 0 and not running)
    assert ("runs, but" in headline(state, StudentReport(version=version), tables, "rope", "sign reversed")) is (
        version > 0 or running
    )


def test_the_course_of_the_difference_ends_at_the_edge_of_its_chart() -> None:
    report = StudentReport(times=np.array([1.0, 2.0, 4.0]), differences=np.array([0.0, 0.1, 0.2]))
    chart = difference_chart(report, "cloth")
    assert "Distance from the program&#39;s cloth [m]</text>" in chart
    (line,) = re.findall(r'<polyline points="([^"]+)"', chart)
    places = np.array([[float(one) for one in place.split(",")] for place in line.split()])
    parts = np.array([0.0, 1 / 3, 1.0])
    assert places[:, 0] == pytest.approx(CHART_LEFT + parts * (CHART_WIDTH - CHART_LEFT - 4), abs=0.06)
    assert (np.diff(places[:, 1]) < 0.0).all()
    assert re.findall(r">([\d.]+)</text>", chart)[:4] == ["1", "2", "3", "4"]


def test_functions_of_the_open_scene_stand_before_the_others_of_their_state() -> None:
    session: Any = SimpleNamespace(
        tasks=TASKS,
        values=SimpleNamespace(tables={}, errors={}),
        check=SimpleNamespace(waiting=()),
        versions=SimpleNamespace(
            verdicts={
                "line_tension": Verdict("right"), "spectrum": Verdict("wrong"), "spring_force": Verdict("right"),
                "step_rk4": Verdict("wrong"),
            }
        ),
    )  # fmt: skip
    for scene, order in (
        ("rope", ["step_rk4", "spectrum", "spring_force", "line_tension"]),
        ("square_sea", ["spectrum", "step_rk4"]),
    ):
        assert re.findall(r'data-function="(\w+)"', function_lines(session, scene))[: len(order)] == order


def test_without_a_function_there_is_no_second_rope(tmp_path: Path) -> None:
    with working_in(tmp_path / "mine") as session:
        scene = make_scene(session)
        run(scene, 3)
        assert scene.frame().reference is None
        assert session.rope.report.version == 0


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"integrator": "explicit_euler", "time_step": 1 / 480},
        {"integrator": "leapfrog", "damping": 0.0, "drag": 0.0, "floor": False},
        {"root_swing": 0.2, "swing_period": 2.0, "time_step": 1 / 480},
        {"units": "material", "points": 20, "length": 4.0, "time_step": 1 / 960, "friction": 0.0},
    ],
    ids=str,
)
def test_a_right_function_moves_the_rope_as_the_program_does(right: Session, values: dict[str, object]) -> None:
    scene = make_scene(right, **values)
    run(scene, 30)
    frame = scene.frame()
    assert frame.reference is not None
    assert np.abs(frame.points[:, 2].astype(float) - 3.0).max() > 0.01  # it has moved
    assert right.rope.report.difference < 1e-9
    assert scene.time == pytest.approx(right.rope.report.times[-1])


@pytest.mark.parametrize("law", ["clipped", "lab"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_floor_sphere_and_mouse_are_those_of_the_program(right: Session, law: str, friction: float) -> None:
    scene = make_scene(right, time_step=1 / 480, sphere=True, sphere_radius=0.6, contact_law=law, friction=friction)
    assert scene.student is not None
    scene.state.x[2] -= 2.98  # into the floor; some points are in the sphere as well
    scene.state.v[0] = 1.0
    scene.handles.sphere.place_at((-1.0, 0.1, 0.3))
    scene.change_forces(scene.params)
    scene.handle(Place("sphere", (-1.1, 0.1, 0.3)))
    scene.handle(GrabTo(9, (-2.0, 0.4, 0.5)))
    scene.student.restart(rows_of(scene.state.x), rows_of(scene.state.v))
    start = scene.state.x.copy()
    run(scene, 20)
    assert scene.net.grab is not None
    assert np.abs(scene.state.x - start).max() > 0.05
    # A step of the student has the moving sphere where it is in the middle of the step, not at each stage.
    assert right.rope.report.difference < 2e-5
    # The tasks know points only, so that the program's links do not touch either; the panel says so.
    assert not scene.net.links_touch
    said = any(
        "only the points of both ropes touch" in text for text in net_texts(right.state, right.rope.report, "rope")
    )
    assert said is (law == "clipped")


def test_a_wrong_function_leaves_the_program_s_rope_alone(right: Session) -> None:
    save(right, RIGHT.replace("return stiffness", "return -stiffness"))
    wait_for(lambda: taken(right) == right.state.version)
    scene, alone = make_scene(right), RopeScene(RopeParams(integrator="rk4"))
    run(scene, 60)
    alone.advance(120)
    assert np.isfinite(right.rope.report.left_at)
    assert np.array_equal(scene.state.x, alone.state.x)
    assert np.isfinite(scene.frame().points).all()


# The tests of the runner have these too.
ELSEWHERE = ("__import__('os')._exit(3)", "for i in range(1_000_000): print(i)", "return 'pull'")
no_limit = pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux only")
MARKS = {"np.ones(1 << 27)": no_limit, **dict.fromkeys(ELSEWHERE, pytest.mark.stress)}


@pytest.mark.parametrize("line", [pytest.param(line, marks=MARKS.get(line, ())) for line in ACCIDENTS])
def test_what_goes_wrong_is_named_and_the_last_version_goes_on(right: Session, line: str) -> None:
    working = taken(right)
    start = time.monotonic()
    save(right, with_line(line))
    wait_for(lambda: right.state.error)
    error = right.state.error
    assert error is not None
    assert error.kind == ACCIDENTS[line][0]
    assert ACCIDENTS[line][1] in error.text
    definition = error.kind in ("wrong shape", "wrong type", "returns nothing", "NaN")
    ended = error.line is None and "exit status" in error.text  # there is nobody left to ask
    assert (error.file, ended or error.line) == ("rope.py", ended or (3 if definition else 11))
    scene = make_scene(right)
    run(scene, 3)
    assert right.rope.report.version == working
    assert scene.frame().reference is not None
    assert time.monotonic() - start < 30.0


def test_an_error_that_comes_later_is_named_and_the_version_before_goes_on(right: Session) -> None:
    working = taken(right)
    save(right, with_line("if x2[2] < 2.9: raise ValueError('too low')"))
    wait_for(lambda: right.state.error)  # the rope that it is tried with is lower
    assert right.state.error is not None
    assert (right.state.error.file, right.state.error.line) == ("rope.py", 11)
    scene = make_scene(right)
    run(scene, 3)
    assert right.rope.report.version == working


def test_a_file_of_another_scene_does_not_begin_the_rope_again(right: Session) -> None:
    begun: list[int] = []
    right.rope.connect(lambda: None, lambda: begun.append(1))
    save(right, RIGHT + "\n# a new version\n")
    wait_for(lambda: len(begun) == 1)
    save(right, HEAD + "def cloth_links(rows, cols):\n    return []\n", "cloth.py")
    save(right, RIGHT + "\n# changed\n")
    wait_for(lambda: taken(right) == right.state.version and len(begun) > 1)
    assert begun == [1, 1]  # what the rope takes, it takes in order


def test_an_answer_to_a_scene_that_was_left_is_not_taken_by_the_next(right: Session) -> None:
    left, scene = make_scene(right, points=7), make_scene(right)
    assert left.student is not None
    assert scene.student is not None
    left.advance(2)
    scene.advance(2)
    wait_for(scene.student.answers.qsize)
    left.handle(StudentAnswer())  # its thread is still at work
    assert left.frame().points.shape == (7, 3)
    scene.handle(StudentAnswer())
    assert scene.frame().reference is not None
    assert scene.frame().points.shape == (scene.params.points, 3)


def test_why_nothing_is_compiled_is_said_where_nothing_is() -> None:
    report = StudentReport(1, frozenset({"step_euler"}), method="explicit_euler", seconds=1e-5, step=1 / 60)

    def text(why: str, *compiled: str) -> str:
        return code_lines(CodeState(1, not_compiled=why), report._replace(compiled=compiled), TableReport(), "rope")

    assert "Not compiled: rope_acceleration: no list" in text("rope_acceleration: no list")
    assert "With SciPy installed" in text("step_euler: np.linalg needs SciPy")
    assert "Not compiled" not in text("")
    told = text("rope_acceleration: no list", "step_euler")
    assert "step_euler compiled by numba" in told
    assert "no list" not in told


def test_where_no_process_can_be_started_that_is_said_and_tried_again(right: Session) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    wait_for(lambda: right.versions.spare is not None)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.lab.process.runner.Runner._started", refuse)
        process(right).close()  # as after an error
        scene = make_scene(right)
        run(scene, 3)
        wait_for(lambda: right.state.error)
        assert right.state.error is not None
        assert "no process can be started: Resource temporarily unavailable" in str(right.state.error)
        text = code_lines(right.state, right.rope.report, TableReport(), "rope")
        assert "could not be run (the machine is busy: no process" in text
        assert "trying again" in headline(right.state, right.rope.report, TableReport(), "rope")
        assert "stopped" not in text
        saved = right.state.version
        assert right.versions.spare is not None
        right.versions.spare.close()
        (right.folder / "rope.py").write_text(RIGHT + "\n# once more\n", "utf-8")
        wait_for(lambda: right.state.version > saved and right.state.error)
    wait_for(lambda: taken(right) == right.state.version and right.state.error is None)  # nothing is saved
    run(scene, 3)
    assert right.rope.report.version == right.state.version


def test_a_check_that_a_busy_machine_does_not_allow_is_made_again(
    right: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    wait_for(lambda: not right.check.waiting)
    answers = iter([not_checked("the machine is busy"), Verdict("right")])
    monkeypatch.setattr("app.lab.student.background_check.RETRY_INTERVAL", 0.3)
    monkeypatch.setattr(right.check, "ask", lambda folder, name: next(answers))
    save(right, RIGHT + "\n# to be checked\n")
    wait_for(lambda: right.versions.verdicts.get("spring_force") not in (None, Verdict("right")))
    assert "could not be checked (the machine is busy); trying again." in function_lines(right, "rope")
    assert right.check.waiting == {"spring_force"}
    wait_for(lambda: right.versions.verdicts.get("spring_force") == Verdict("right"))
    assert not right.check.waiting


def test_files_that_cannot_be_checked_are_taken_up_later(right: Session) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    before = right.state.version
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("app.lab.student.versions.store", full_disk)
        (right.folder / "rope.py").write_text(RIGHT + "\n# later\n", "utf-8")
        wait_for(lambda: right.state.error and "could not be loaded" in right.state.error.text)
        assert right.state.version == before
    wait_for(lambda: right.state.version > before and right.state.error is None)


def test_files_that_stay_as_they_are_are_not_read_again(right: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    looks, reads = [], []
    right.versions.files.sure_at = time.monotonic()  # not only seconds after the last change
    monkeypatch.setattr("app.lab.student.versions.stamps", lambda *of: looks.append(1) or stamps(*of))
    monkeypatch.setattr("app.lab.student.versions.read_files", lambda folder: reads.append(1) or read_files(folder))
    wait_for(lambda: len(looks) >= 2)
    assert not reads
    version = right.state.version
    save(right, RIGHT + "# once more\n")
    assert right.state.version > version
    assert reads


def test_a_folder_that_is_removed_and_made_again_is_followed(right: Session) -> None:
    files = {path.name: path.read_bytes() for path in right.folder.glob("*.*")}
    version = right.state.version
    shutil.rmtree(right.folder)
    time.sleep(0.01)
    right.folder.mkdir()
    for name, text in files.items():
        (right.folder / name).write_bytes(text)
    save(right, RIGHT + "# in the new folder\n")
    assert right.state.version > version
    wait_for(lambda: taken(right) == right.state.version)


def test_a_forged_answer_is_named(right: Session) -> None:
    x, v, segment = bent_rope(False)
    found = Runner(process(right).folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(found, "ask", lambda *_: (1, 2, 3))
        with pytest.raises(RunError, match="lab's pipe"):
            found.march({"spring_force"}, "step_rk4", x, v, [segment])


def test_the_end_does_not_wait_for_an_endless_function(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text(with_line("while True: pass"), "utf-8")
    session = Session(tmp_path, TASKS, time_limit=600.0)
    wait_for(lambda: [runner for runner in session.versions.processes.values() if runner.starts])
    with ThreadPoolExecutor(1) as pool:
        pool.submit(session.close).result(60.0)
    assert not session.thread.is_alive()


def test_what_is_no_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="DIR"):
        Session(tmp_path / "nothing", TASKS)


def test_the_functions_of_a_saved_file_are_checked_as_lab_check_does(right: Session) -> None:
    not_begun = "\n\ndef step_euler(x, v, h, acceleration):\n    ...\n"
    save(right, RIGHT.replace("return stiffness", "return -stiffness") + not_begun)
    save(right, HEAD + "def cloth_links(rows, cols):\n    return 1 / 0\n", "cloth.py")
    wait_for(lambda: {"spring_force", "cloth_links"} <= set(right.versions.verdicts) and not right.check.waiting)
    verdicts = right.versions.verdicts
    spring, cloth = verdicts["spring_force"], verdicts["cloth_links"]
    assert (spring.state, spring.mistake) == ("wrong", "sign of the spring reversed")
    assert (cloth.state, cloth.place) == ("failed", "cloth.py:4")
    assert cloth.text == "ZeroDivisionError: division by zero"
    assert verdicts["step_euler"].state == "not begun"
    page = function_lines(right, "rope")
    assert 'data-function="spring_force" data-state="wrong"' in page
    assert "sign of the spring reversed" in page.lower()
    assert page.index('data-function="cloth_links"') < page.index('data-function="spring_force"')  # failed, then wrong
    process = right.check.process
    assert process is not None
    process.kill()  # it is started again
    process.wait()
    save(right, RIGHT)
    wait_for(lambda: right.versions.verdicts.get("spring_force") == Verdict("right"))


CALLER = "\n\n" + source_of(
    next(task for task in TASKS if task.name == "rope_acceleration"), CALLERS["rope_acceleration"]
)


def test_in_the_panel_a_right_function_waits_for_the_wrong_one_that_it_calls(right: Session) -> None:
    save(right, RIGHT.replace("return stiffness", "return -stiffness") + CALLER)
    wait_for(lambda: {"spring_force", "rope_acceleration"} <= set(right.versions.verdicts) and not right.check.waiting)
    assert right.versions.verdicts["spring_force"].state == "wrong"
    page = function_lines(right, "rope")
    assert 'data-function="rope_acceleration" data-state="waits"' in page
    assert "it calls spring_force, which is wrong: mend that first" in page
    save(right, RIGHT + CALLER)
    states = lambda: {name: verdict.state for name, verdict in right.versions.verdicts.items()}  # noqa: E731
    wait_for(lambda: (states().get("spring_force"), states().get("rope_acceleration")) == ("right", "right"))


def test_a_check_that_is_killed_is_made_once_more_and_then_said(tmp_path: Path) -> None:
    (tmp_path / "rope.py").write_text("import time\ntime.sleep(60)\ndef spring_force(): return 1\n", "utf-8")
    versions = Versions(tmp_path, [task for task in TASKS if task.name == "spring_force"])
    check = BackgroundCheck(versions)
    try:
        versions.look()
        check.look()
        assert check.waiting
        wait_for(lambda: check.process is not None)
        first = check.process
        assert first is not None
        first.kill()
        wait_for(lambda: check.process is not first)
        assert check.waiting
        assert check.process is not None
        check.process.kill()
        wait_for(lambda: not check.waiting)
        assert versions.verdicts["spring_force"].state == "not checked"
    finally:
        check.close()
        versions.close()


def test_the_panel_says_what_runs_and_what_is_wrong(right: Session) -> None:
    scene = make_scene(right)
    run(scene, 3)
    text = code_lines(right.state, right.rope.report, TableReport(), "rope")
    assert "is driven by <b>spring_force</b> (reference: step_rk4)" in text
    assert "<b>Less than 1 µm</b>" in text
    assert "polyline" not in text
    save(right, with_line("return x1 + '<b>'"))
    wait_for(lambda: right.state.error)
    run(scene, 3)
    # A call that a busy machine has no time for is repeated.
    wait_for(lambda: right.rope.report.version or run(scene, 1))
    text = code_lines(right.state, right.rope.report, TableReport(), "rope")
    assert "<b>rope.py, line 11</b>: " in text
    assert "</b>: rope.py, line 11: " in headline(right.state, right.rope.report, TableReport(), "rope")
    assert "The last version that worked stays in use." in text
    save(right, RIGHT.replace("return stiffness", "return 0.9 * stiffness"))
    wait_for(lambda: taken(right) == right.state.version)
    run(scene, 10)
    text = code_lines(right.state, right.rope.report, TableReport(), "rope")
    assert "polyline" in text
    assert "stopped" not in text


def test_the_panel_says_which_functions_run_compiled_and_how_fast() -> None:
    state, own = CodeState(version=1), frozenset({"spring_force", "step_rk4"})
    compiled = ("links", "spring_force")
    report = StudentReport(version=1, own=own, compiled=compiled, method="rk4", seconds=80e-6, step=0.016)
    said = "spring_force compiled by numba, step_rk4 plain Python: 80 µs a step, 200 times real time."
    assert said in code_lines(state, report, TableReport(), "rope")
    assert "Plain Python: 80 µs" in code_lines(state, report._replace(compiled=()), TableReport(), "rope")


def test_an_error_of_syntax_starts_no_process_and_a_right_version_one(right: Session, monkeypatch) -> None:
    wait_for(lambda: right.versions.spare is not None and right.versions.spare.is_fresh)
    started: list[Path] = []
    start = Runner._started
    monkeypatch.setattr(Runner, "_started", lambda self, env: started.append(self.folder) or start(self, env))
    spare = right.versions.spare
    save(right, with_line("return ("))
    wait_for(lambda: right.state.error is not None and right.versions.spare is spare)
    assert right.state.error is not None
    assert (right.state.error.kind, right.state.error.file) == ("syntax", "rope.py")
    assert started == []
    save(right, RIGHT)
    wait_for(lambda: taken(right) == right.state.version and right.versions.spare not in (None, spare))
    assert len(started) == 1
