"""`springtide lab DIR` in a real browser: the rope moves by what a student saves, and the panel says what is wrong."""

import inspect
import time
from pathlib import Path

import numpy as np
import pytest

from app.lab.process.rope_march import REFERENCE
from app.messages import Pause, Play
from app.scenes.rope.parameters import RopeParams
from tests.app.student_lab import student_lab

RIGHT = "import numpy as np\n\n" + inspect.getsource(REFERENCE["spring_force"])


@pytest.mark.stress
def test_a_wrong_turn_and_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_tab) -> None:
    monkeypatch.setattr("app.lab.student.live_net.COMPILE_AFTER", 1e6)  # compiling takes seconds: see tests/stress
    folder = tmp_path / "mine"
    with student_lab(folder) as (viewer, _):
        viewer.open("rope", RopeParams(integrator="rk4"))
        tab = open_tab(viewer.port)
        tab.wait(lambda: len(tab.vertices("/rope")) > 0)
        assert len(tab.vertices("/reference")) == 0
        (folder / "rope.py").write_text(RIGHT, "utf-8")
        start = time.monotonic()
        tab.wait(lambda: len(tab.vertices("/reference")) > 0)
        print(f"from saving to the rope moving by it in the page: {time.monotonic() - start:.2f} s")
        viewer.loop.commands.put(Pause())
        tab.wait(lambda: np.abs(tab.vertices("/rope").mean(0) - tab.vertices("/reference").mean(0)).max() < 1e-3)
        frame = viewer.loop.latest.frame
        assert np.allclose(frame.points, frame.reference, atol=1e-6)  # two ropes in one place
        viewer.loop.commands.put(Play())
        (folder / "rope.py").write_text(RIGHT.replace("    r = np", "    r = nq\n    r = np"), "utf-8")
        tab.wait(lambda: tab.page.get_by_text("rope.py, line 11: NameError: name 'nq' is not defined").count())
        assert tab.page.get_by_text("The last version that worked stays in use.").count() == 1
        (folder / "rope.py").write_text(RIGHT, "utf-8")
        tab.wait(lambda: tab.page.locator("[data-function=spring_force][data-state=right]").count())
        assert tab.page.get_by_text("NameError").count() == 0
        assert tab.errors == []
