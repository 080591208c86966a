"""The benchmark of a class: its arithmetic, and the memory and processor time that it reads."""

import importlib
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmarks import command
from benchmarks.pupil import STIFFNESS, Pupil

CLASS = importlib.import_module("benchmarks.cases.program.class_")


def test_spread_is_median_95_percent_and_worst_from_either_end() -> None:
    values = [float(value) for value in range(1, 101)]
    assert CLASS.spread(values) == {"median": 50.5, "95 %": 95.0, "worst": 100.0}
    assert CLASS.spread(values, least=True) == {"median": 50.5, "95 %": 6.0, "worst": 1.0}
    assert all(math.isnan(value) for value in CLASS.spread([]).values())


def test_an_action_without_an_answer_is_late_and_a_saved_file_never() -> None:
    answers = [("button", 0.1), ("value", 0.3), ("task", math.nan), ("button", 0.2), ("saved function", 9.0)]
    assert CLASS.late([CLASS.Result(answers, 60.0, 1.0)]) == 50.0
    assert CLASS.answer_row("task", [CLASS.Result(answers, 60.0, 1.0)])["worst"] == math.inf


def test_pace_leaves_out_pauses_and_set_backs() -> None:
    pupil = Pupil(0, Path(), 0)
    pupil.frames = [0.0, 0.02, 0.04, 0.06, 5.0]
    pupil.clock = [(0.0, 3.0), (1.0, 3.5), (9.0, 3.5), (9.5, 0.0), (10.5, 1.0)]
    result = CLASS.result_of(pupil)
    assert result.pace == pytest.approx(0.75)
    assert result.rate == pytest.approx(50.0)


def test_a_value_is_sent_to_the_panel_s_own_control_though_a_task_shows_the_parameter_too() -> None:
    pupil = Pupil(0, Path(), 0)
    for uuid, value in (("own", 800.0), ("task's", 500.0)):
        pupil.learn({"type": "GuiTextMessage", "uuid": uuid, "props": {"label": STIFFNESS}}, 0.0)
        slider = {"type": "GuiMultiSliderMessage", "uuid": f"{uuid} slider", "value": [math.log10(value)], "props": {}}
        pupil.learn(slider, 0.0)
    assert (pupil.controls[STIFFNESS], pupil.stiffness) == ("own", pytest.approx(800.0))
    for uuid in ("task's", "task's slider", "own", "own slider"):
        assert pupil.controls
        pupil.learn({"type": "GuiRemoveMessage", "uuid": uuid}, 0.0)
    assert not pupil.controls


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is read from /proc")
def test_usage_counts_the_processes_of_a_lab() -> None:
    before = CLASS.usage(os.getpid())
    hold = "import time; held = bytearray(b'x' * 50_000_000); print(flush=True); time.sleep(60)"
    with subprocess.Popen([sys.executable, "-c", hold], stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        after = CLASS.usage(os.getpid())
        child.kill()
    # Pages of Python's own code are not private any more where no other process had them.
    assert 35.0 < after.private - before.private < 70.0
    end = time.thread_time() + 0.1
    while time.thread_time() < end:
        pass
    assert CLASS.usage(os.getpid()).seconds >= before.seconds + 0.08


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="refused before anything else")
@pytest.mark.parametrize("students", [0, -1, 101])
def test_a_class_of_no_size_is_refused(students: int) -> None:
    with pytest.raises(ValueError, match=r"--students: .* is not allowed; allowed: 1 to 100"):
        CLASS.rows(students=students)


def test_students_need_the_class() -> None:
    with pytest.raises(ValueError, match="--students: 3 is not allowed; allowed: a number together with"):
        command.run(["rope"], students=3)
