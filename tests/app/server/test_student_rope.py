"""`springtide lab DIR` as the server runs it: what is saved moves the rope, and nothing of it stops the lab."""

import inspect
import time
from pathlib import Path

import pytest

from app.lab.process.rope_march import REFERENCE
from app.scenes import scene_named
from app.scenes.race.parameters import RaceParams
from app.server.viewer import Viewer
from tests.app.lab.student.test_session import taken
from tests.app.student_lab import student_lab
from tests.waiting import wait_for

RIGHT = "import numpy as np\n\n" + inspect.getsource(REFERENCE["spring_force"])


def test_a_saved_function_moves_the_rope_and_an_endless_one_stops_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e6)
    monkeypatch.setattr(Viewer, "visitors", lambda self: [1])
    folder = tmp_path / "mine"
    with student_lab(folder, time_limit=1.0) as (viewer, session):
        wait_for(lambda: taken(session) == 1)  # what the new folder holds; to restart with it is no start of a run
        viewer.open("rope")
        loop = viewer.loop
        assert loop.latest.frame.reference is None
        (folder / "rope.py").write_text(RIGHT, "utf-8")
        wait_for(lambda: loop.latest.frame.reference is not None)
        assert loop.run.identity.number == 2  # both ropes began again
        (folder / "rope.py").write_text(RIGHT.replace("    r = np", "    while True: pass\n    r = np"), "utf-8")
        wait_for(lambda: session.state.version == 3)
        ticks, started = loop.run.counts["ticks"], time.monotonic()
        wait_for(lambda: session.state.error is not None)
        waited = time.monotonic() - started
        assert session.state.error is not None
        assert session.state.error.kind == "endless"
        assert loop.run.counts["ticks"] - ticks > 3 * waited  # the loop of the scene continues meanwhile
        assert not loop.run.halted
        assert loop.latest.frame.reference is not None
        viewer.make_scene(scene_named("race"), RaceParams(), viewer.commands.put)  # which runs nothing of the student's
        (folder / "rope.py").write_text(RIGHT + "\n# once more\n", "utf-8")
        wait_for(lambda: taken(session) == 4)
        assert loop.run.identity.number == 2
