"""`springtide lab DIR` under accidents in every function of the rope; how fast what is saved moves it; compiling."""

import inspect
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.lab.course.folder import make_folder
from app.lab.course.task import load_tasks
from app.lab.process.rope_march import REFERENCE
from app.lab.student.live_net import ROPE
from app.lab.student.session import Session
from app.server.viewer import Viewer
from tests.app.lab.student.test_session import ACCIDENTS, HEAD, RIGHT, make_scene, run, save, taken
from tests.waiting import wait_for

TASKS = load_tasks()
METHODS = {"step_euler": "explicit_euler", "step_rk4": "rk4", "step_leapfrog": "leapfrog"}


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    """A folder of exercises, with the limits that students have."""
    make_folder(tmp_path / "mine", TASKS)
    session = Session(tmp_path / "mine", TASKS)
    wait_for(lambda: session.state.version == 1)
    yield session
    session.close()


@pytest.mark.parametrize("line", [line for line in ACCIDENTS if "x1" not in line])
@pytest.mark.parametrize("name", REFERENCE)
def test_every_accident_in_every_function_is_named_within_three_seconds(
    session: Session, monkeypatch: pytest.MonkeyPatch, name: str, line: str
) -> None:
    monkeypatch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e6)
    session.rope.method, session.rope.sphere = METHODS.get(name, "rk4"), name == "sphere_force"
    assert name in (ROPE.step_of(session.rope.method), "spring_force", "rope_acceleration", "sphere_force")
    source = inspect.getsource(REFERENCE[name])
    body = source.index('"""', source.index('"""') + 3) + 3
    time.sleep(1.0)  # a student takes longer between two saves: the process for the next one runs
    start = time.monotonic()
    save(session, f"{HEAD}{source[:body]}\n    {line}{source[body:]}")
    wait_for(lambda: session.state.error)
    taken = time.monotonic() - start
    assert session.state.error is not None
    assert session.state.error.kind == ACCIDENTS[line][0]
    assert taken < 3.0


def test_the_rope_moves_by_what_is_saved_within_a_second(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Viewer, "audience", lambda self: 1)
    viewer = Viewer("127.0.0.1", 0, session=session)
    try:
        viewer.open("rope")
        times = []
        for i in range(5):
            time.sleep(2.0)
            start, before = time.monotonic(), taken(session)
            (session.folder / "rope.py").write_text(f"{RIGHT}\n# {i}\n", "utf-8")
            wait_for(lambda before=before: session.rope.report.version > before)
            wait_for(lambda: viewer.loop.latest.frame.reference is not None)
            times.append(time.monotonic() - start)
        print("from saving to moving [s]:", [round(t, 3) for t in times])
        assert np.median(times) < 1.0
    finally:
        viewer.shut()


def test_what_numba_can_compile_it_compiles(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e-6)
    save(session, RIGHT)
    wait_for(lambda: taken(session) == session.state.version)
    scene = make_scene(session)
    run(scene)
    plain = session.rope.report
    assert plain.compiled == ()
    wait_for(lambda: ROPE.use in session.versions.compiled, 120.0)
    scene = make_scene(session)
    run(scene)
    report = session.rope.report
    assert "spring_force" in report.compiled
    assert report.difference < 1e-9
    print("a step [us]: plain", 1e6 * plain.seconds, "compiled", 1e6 * report.seconds)
    assert report.seconds < plain.seconds
    later = RIGHT.replace("    r = np", "    globals()\n    r = np")  # which numba does not know
    save(session, later)
    wait_for(lambda: taken(session) == session.state.version)
    run(make_scene(session))
    wait_for(lambda: session.state.not_compiled, 120.0)
    run(make_scene(session))
    assert session.rope.report.version == session.state.version
    assert session.rope.report.compiled == ()
