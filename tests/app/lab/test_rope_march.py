"""The march of a rope by a student's functions: what is wrong in a result is said of the function that made it."""

import queue
import types
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from app.lab.live_net import COMPILE_AFTER, MAX_REST, REST_RATIO, ROPE, Answer, Job, LiveNet, Loaded
from app.lab.rope_march import Forces, Functions, March, Segment, Unfit, march
from app.lab.saved import keep
from app.lab.task import load_tasks

FORCES = Forces(
    1.0, 800.0, 7.0, 1.0, 0.2, 10.0, -np.inf, 0.4, (9.0, 0.0, 3.0), (-20.0, 0.0, 0.0), 800.0, 5.0, 0.3, False, -1,
    (0.0, 0.0, 0.0), 0.0, 0.0, 1.0,
)  # fmt: skip


def test_nan_is_said_of_the_force_of_a_sphere_that_has_come_near() -> None:
    def sphere_force(x, v, centre, radius, stiffness, damping):
        return np.full(3, np.nan) if np.linalg.norm(x - centre) < 0.5 else np.zeros(3)

    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0], [-0.4, 0.0, 3.0]])
    module = types.SimpleNamespace(sphere_force=sphere_force)
    segment = Segment(2000, 1 / 960, FORCES, np.zeros((0, 4, 3)))
    functions = Functions(module, ["sphere_force"], "step_rk4", {})  # type: ignore[arg-type]
    with pytest.raises(Unfit, match="sphere_force returns NaN"):
        march(functions, x, np.zeros((3, 3)), [segment])


def test_an_error_of_the_lab_is_told_and_the_next_version_moves_the_rope(tmp_path: Path) -> None:
    told: list[str] = []
    live = LiveNet(ROPE, lambda saved, error: told.append(f"{saved.number} {error}"))
    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0]])
    job = Job(1, "rk4", x, 0.0 * x, [Segment(1, 0.01, FORCES, np.zeros((0, 4, 3)))], queue.SimpleQueue())

    def loaded(number: int, outcome: object) -> Loaded:
        """A version whose process gives this outcome, or raises it."""
        text = b"def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):\n    return x1\n"
        folder = tmp_path / str(number)
        folder.mkdir()
        runner = Mock(**{"march.side_effect": [outcome, outcome]})
        return Loaded(keep({"rope.py": text}, folder, number, load_tasks()), runner)

    done = March(x[None], x, 1, 1e-3, 1e-3, False)
    try:
        live.adopt(loaded(1, TypeError("not what was expected")))
        live.submit(job)
        assert job.answers.get(timeout=30.0).version == 0
        assert [text for text in told if "1 rope.py: the lab could not run" in text and "TypeError: not what" in text]
        second = loaded(2, done)
        second.runner.close.side_effect = ValueError("not closed")
        for version in (second, loaded(3, done), loaded(4, done)):  # the fourth closes the second
            live.adopt(version)
        live.submit(job)
        assert job.answers.get(timeout=30.0).version in (2, 3, 4)
        assert any("ValueError: not closed" in text for text in told)
        second.runner.close.side_effect = None
        live.adopt(loaded(5, done))
        live.submit(job)
        assert job.answers.get(timeout=30.0).version == 5
    finally:
        live.close()


def test_a_version_is_compiled_once_it_has_taken_as_long_as_compiling_does(tmp_path: Path) -> None:
    asked: list[int] = []
    live = LiveNet(ROPE, lambda saved, error: None, lambda saved: asked.append(saved.number))
    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0]])
    answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
    job = Job(1, "rk4", x, 0.0 * x, [Segment(1, 0.01, FORCES, np.zeros((0, 4, 3)))], answers)
    done = March(x[None], x, 1, 100.0, 0.4 * COMPILE_AFTER, False)
    text = b"def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):\n    return x1\n"
    try:
        for number in (1, 2):
            folder = tmp_path / str(number)
            folder.mkdir()
            saved = keep({"rope.py": text}, folder, number, load_tasks())
            live.adopt(Loaded(saved, Mock(**{"march.return_value": done})))
            for _ in range(2 * number):  # too few of the first version
                live.submit(job)
                assert answers.get(timeout=30.0).version == number
        assert asked == [2]
    finally:
        live.close()


def test_on_a_busy_hub_a_function_rests_and_is_not_compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.lab.live_net.ON_HUB", True)
    asked: list[int] = []
    rests: list[float] = []
    monkeypatch.setattr("app.lab.live_net.time", Mock(sleep=rests.append))
    live = LiveNet(ROPE, lambda saved, error: None, lambda saved: asked.append(saved.number))
    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0]])
    answers: queue.SimpleQueue[Answer] = queue.SimpleQueue()
    job = Job(1, "rk4", x, 0.0 * x, [Segment(1, 0.01, FORCES, np.zeros((0, 4, 3)))], answers)
    text = b"def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):\n    return x1\n"
    saved = keep({"rope.py": text}, tmp_path, 1, load_tasks())
    waited = [2.0 * COMPILE_AFTER, 2.0 * COMPILE_AFTER, 0.01, -1e-4]  # it takes `COMPILE_AFTER` each time
    marches = [March(x[None], x, 1, COMPILE_AFTER + wait, COMPILE_AFTER, False) for wait in waited]
    live.adopt(Loaded(saved, Mock(**{"march.side_effect": marches})))
    try:
        compiled = []
        for _ in marches:
            live.submit(job)
            assert answers.get(timeout=30.0).version == 1
            compiled.append(list(asked))
        assert compiled == [[], [], [1], [1]]
    finally:
        live.close()
    assert rests == pytest.approx([MAX_REST, MAX_REST, 0.01 * REST_RATIO, 0.0])
