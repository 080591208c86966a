"""The march of a rope by a student's functions: what is wrong in a result is said of the function that made it."""

import queue
import types
from collections.abc import Callable, Iterator
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from app.lab.course.task import load_tasks
from app.lab.process.compiled import first_line
from app.lab.process.rope_march import Forces, Functions, MarchResult, Segment, Unfit, march
from app.lab.process.runner import BUSY, RunError
from app.lab.student.live_net import COMPILE_AFTER, MAX_REST, REST_RATIO, ROPE, LiveNet, Marched
from app.lab.student.versions import Versions
from tests.waiting import wait_for

FORCES = Forces(1.0, 800.0, 7.0, 1.0, 0.2, 10.0, sr=0.4, sx=9.0, sz=3.0, svx=-20.0, friction=0.3)


def test_nan_is_said_of_the_force_of_a_sphere_that_has_come_near() -> None:
    def sphere_force(x, v, centre, radius, stiffness, damping):
        return np.full(3, np.nan) if np.linalg.norm(x - centre) < 0.5 else np.zeros(3)

    x = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0], [-0.4, 0.0, 3.0]])
    module = types.SimpleNamespace(sphere_force=sphere_force)
    segment = Segment(2000, 1 / 960, FORCES, np.zeros((0, 4, 3)))
    functions = Functions(module, ["sphere_force"], "step_rk4", {})  # type: ignore[arg-type]
    with pytest.raises(Unfit, match="sphere_force returns NaN"):
        march(functions, x, np.zeros((3, 3)), [segment])


X = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0]])
X3 = np.array([[0.0, 0.0, 3.0], [-0.2, 0.0, 3.0], [-0.4, 0.0, 3.0]])


@pytest.mark.parametrize("pair", [tuple, list, np.array])
def test_a_step_returns_positions_and_velocities_as_a_pair_of_any_kind(pair: Callable[[object], object]) -> None:
    step = types.SimpleNamespace(step_rk4=lambda x, v, h, acceleration: pair((x + h * v, v)))
    functions = Functions(step, ["step_rk4"], "step_rk4", {})  # type: ignore[arg-type]
    found = march(functions, X3, np.ones((3, 3)), [Segment(3, 0.01, FORCES, np.zeros((0, 4, 3)))])
    assert found.steps == 3
    assert found.v == pytest.approx(np.ones((3, 3)))


def test_a_march_without_a_step_ends_where_it_began() -> None:
    functions = Functions(types.SimpleNamespace(), [], "step_rk4", {})  # type: ignore[arg-type]
    found = march(functions, X3, 0.0 * X3, [])
    assert (found.steps, found.left, found.x.shape) == (0, False, (0, 3, 3))


@pytest.mark.parametrize(
    ("value", "kind", "words"),
    [
        ((X3,), "wrong shape", "returns 1 entry;"),
        (X3, "wrong shape", "returns 3 entries"),
        (1.5, "wrong type", "returns a value of type float"),
        (np.array(1.5), "wrong type", "returns a value of type ndarray"),
        ("xv", "wrong type", "returns a value of type str"),
    ],
)
def test_a_step_that_returns_no_pair_is_told_of_what_it_returns(value: object, kind: str, words: str) -> None:
    step = types.SimpleNamespace(step_rk4=lambda *_: value)
    functions = Functions(step, ["step_rk4"], "step_rk4", {})  # type: ignore[arg-type]
    with pytest.raises(Unfit, match=words) as said:
        march(functions, X3, 0.0 * X3, [Segment(1, 0.01, FORCES, np.zeros((0, 4, 3)))])
    assert said.value.kind == kind


FORCE = "def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):\n    return x1\n"


class Folder:
    """A folder with one function, and processes that come to given outcomes."""

    def __init__(self, path: Path, asked: list[int]) -> None:
        self.path, self.processes = path, {}
        self.versions = Versions(path, load_tasks())
        self.live = LiveNet(ROPE, self.versions, lambda: asked.append(self.version))

    @property
    def version(self) -> int:
        """The version that was saved last."""
        saved = self.versions.of("rope.py")
        assert saved is not None
        return saved.number

    def save(self, *outcomes: object) -> None:
        """Save a version, which takes over. outcomes: of its marches, the last one of all later ones too."""
        (self.path / "rope.py").write_text(f"{FORCE}# {len(self.processes)}\n", "utf-8")
        assert self.versions.look() is not None
        left = list(outcomes)

        def march(*_: object) -> object:
            found = left.pop(0) if len(left) > 1 else left[0]
            if isinstance(found, Exception):
                raise found
            return found

        process = self.processes[self.version] = Mock(march=march, is_fresh=False)
        self.versions.processes["rope", self.version, False] = process
        assert self.versions.attempt(ROPE.use, lambda begun: begun, lambda runner, own: None)

    def march(self) -> int:
        """The version that takes a step; 0 for none."""
        answers: queue.SimpleQueue[Marched] = queue.SimpleQueue()
        self.live.march("rk4", X, 0.0 * X, [Segment(1, 0.01, FORCES, np.zeros((0, 4, 3)))], answers)
        done = answers.get(timeout=30.0)
        return 0 if done is None else done.saved.number

    def close(self) -> None:
        self.live.close()
        self.versions.close()


def marched(seconds: float, effort: float) -> MarchResult:
    """A step that takes so long [s]."""
    return MarchResult(X[None], X, 1, seconds, effort, False)


@pytest.fixture
def asked() -> list[int]:
    """The versions that were to be compiled."""
    return []


@pytest.fixture
def folder(tmp_path: Path, asked: list[int]) -> Iterator[Folder]:
    found = Folder(tmp_path, asked)
    yield found
    found.close()


def test_an_error_of_the_lab_is_told_and_the_next_version_moves_the_rope(folder: Folder) -> None:
    works = marched(1e-3, 1e-3)
    folder.save(TypeError("not what was expected"))
    assert folder.march() == 0
    assert "the lab could not run" in folder.versions.errors[ROPE.use].text
    assert "TypeError: not what" in folder.versions.errors[ROPE.use].text
    folder.save(works)
    assert folder.march() == 2
    assert not folder.versions.errors
    folder.processes[2].close.side_effect = ValueError("not closed")
    folder.save(works, works, TypeError("later"))
    assert folder.march() == 0
    wait_for(lambda: folder.live.trouble)
    assert folder.live.trouble is not None
    assert "ValueError: not closed" in folder.live.trouble.text
    assert folder.march() == 3
    assert folder.march() == 2  # in a new process, as the one before was ended
    assert "TypeError: later" in folder.versions.errors[ROPE.use].text
    folder.save(works)
    assert folder.march() == 4
    assert not folder.versions.errors


def test_a_version_is_compiled_once_it_has_taken_as_long_as_compiling_does(folder: Folder, asked: list[int]) -> None:
    for number in (1, 2):
        folder.save(marched(100.0, 0.4 * COMPILE_AFTER))
        assert [folder.march() for _ in range(2 * number)] == [number] * 2 * number  # too few of the first version
    wait_for(lambda: asked == [2])


def test_on_a_busy_hub_a_function_rests_and_is_not_compiled(
    folder: Folder, asked: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.lab.student.live_net.ON_HUB", True)
    rests: list[float] = []
    monkeypatch.setattr("app.lab.student.live_net.time", Mock(sleep=rests.append))
    waited = [2.0 * COMPILE_AFTER, 2.0 * COMPILE_AFTER, 0.01, -1e-4]  # it takes `COMPILE_AFTER` each time
    folder.save(*(marched(COMPILE_AFTER + wait, COMPILE_AFTER) for wait in waited))
    compiled = []
    for number in range(1, len(waited) + 1):
        assert folder.march() == 1
        wait_for(lambda number=number: len(rests) == number)
        compiled.append(list(asked))
    assert compiled == [[], [], [1], [1]]
    assert rests == pytest.approx([MAX_REST, MAX_REST, 0.01 * REST_RATIO, 0.0])


def test_a_version_that_fails_later_leaves_the_rope_to_the_one_before(folder: Folder) -> None:
    works, fails = marched(1e-3, 1e-3), RunError("raised", "too low", "rope.py", 11)
    folder.save(works)
    assert folder.march() == 1
    folder.save(works, fails)
    assert [folder.march() for _ in range(3)] == [2, 1, 1]
    assert folder.versions.errors[ROPE.use] is fails
    folder.save(fails)  # its trial has worked
    assert folder.march() == 1


def test_a_busy_machine_is_no_fault_of_a_version(folder: Folder) -> None:
    works, busy = marched(1e-3, 1e-3), RunError(BUSY, "no process", "Python")
    folder.save(works, busy, works)
    assert [folder.march() for _ in range(2)] == [1, 0]
    assert folder.versions.errors[ROPE.use] is busy
    assert folder.march() == 1
    assert not folder.versions.errors


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "Failed in nopython mode pipeline (step: x)\n\nNo implementation of function",
            "No implementation of function",
        ),
        ("Failed in nopython mode\nDuring: resolving\nFile 'rope.py', line 3\n", "Failed in nopython mode"),
        ("division by zero", "division by zero"),
        (" \n ", "ZeroDivisionError"),
    ],
)
def test_of_a_compiler_s_error_the_line_is_told_that_says_why(text: str, told: str) -> None:
    assert first_line(ZeroDivisionError(text)) == told


def test_friction_on_the_student_s_sphere_acts_against_the_motion_along_it() -> None:
    """The student gives the push along the normal; the program's friction is Coulomb's, by this push."""

    def sphere_force(x: np.ndarray, v: np.ndarray, c: np.ndarray, radius: float, k: float, b: float) -> np.ndarray:
        distance = np.linalg.norm(x - c)
        return k * (radius - distance) * (x - c) / distance

    module = types.ModuleType("rope")
    module.sphere_force = sphere_force  # type: ignore[attr-defined]
    functions = Functions(module, ("sphere_force",), "step_euler", {})
    forces = Forces(1.0, 800.0, 7.0, 1.0, 0.2, 10.0, sr=1.0, contact_k=50.0, friction=0.3)
    functions.segment = Segment(1, 1e-3, forces, np.zeros((0, 4, 3)))
    for v in (np.array([2.0, 0.0, 0.0]), np.array([0.0, -3.0, 1.0])):
        a = np.zeros((2, 3))
        functions.add_surroundings(np.array([[5.0, 0.0, 0.0], [0.0, 0.0, 0.9]]), np.array([0.0 * v, v]), a)
        assert a[1, 2] == pytest.approx(5.0)
        assert a[1, :2] == pytest.approx(-0.3 * 5.0 * v[:2] / np.linalg.norm(v[:2]))


def test_the_mouse_pulls_a_point_as_a_damped_spring_that_gives_way() -> None:
    x, v = np.array([[0.0, 0.0, 3.0], [-0.5, 0.0, 3.0], [-1.0, 0.0, 3.0]]), np.zeros((3, 3))
    v[2] = 0.4, 0.0, -0.3
    free = Forces(2.0, 800.0, 7.0, 0.0, 0.5, 0.0)
    gap = np.array([0.3, -0.4, 0.0])
    for most, size in ((1e9, 20.0 * 0.5), (4.0, 4.0)):
        place = dict(zip(("grab_x", "grab_y", "grab_z"), x[2] + gap, strict=True))
        found = []
        for forces in (free, free._replace(grabbed=2, grab_k=20.0, grab_b=3.0, grab_max=most, **place)):
            functions = Functions(types.SimpleNamespace(), [], "step_rk4", {})  # type: ignore[arg-type]
            functions.segment = Segment(1, 1e-3, forces, np.zeros((0, 4, 3)))
            a = np.zeros((3, 3))
            functions.add_surroundings(x, v, a)
            found.append(a)
        pull = 2.0 * (found[1] - found[0])
        np.testing.assert_allclose(pull[2], size * gap / 0.5 - 3.0 * v[2], atol=1e-12)
        assert not pull[:2].any()
