"""The checks of programming tasks: right solutions pass, wrong ones are refused and named."""

import contextlib
import inspect
import itertools
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple, cast

import numpy as np
import pytest
from msgspec.structs import replace

from app.lab.check.comparing import call, conform, form_of, same
from app.lab.check.inputs import inputs_of
from app.lab.check.program_check import Verdict, check_program
from app.lab.check.student_function import StudentFunction, special_cases
from app.lab.checking import Mistake, Wrong
from app.lab.course.folder import stub
from app.lab.course.source import read_source
from app.lab.course.task import Task, load_tasks
from app.lab.process.runner import BUSY, RunError, Runner
from app.lab.student.saved import store
from tests.app.lab.solutions.right_solutions import RIGHT
from tests.app.lab.solutions.students_mistakes import CASES as MISTAKES
from tests.app.lab.solutions.wrong_solutions import WRONG

TASKS = {task.name: task for task in load_tasks() if task.check is not None}
HEAD = "import numpy as np\n\n"


class Desk(NamedTuple):
    """One folder and one process for all solutions."""

    folder: Path
    runner: Runner


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Desk]:
    folder = tmp_path_factory.mktemp("student")
    with Runner(folder, time_limit=20.0) as runner:
        yield Desk(folder, runner)


def verdict_of(desk: Desk, task: Task, source: str) -> Verdict:
    """What the check says; each solution is in a file of its own, as the process loads a file once."""
    file = f"solution_{len(list(desk.folder.iterdir()))}.py"
    (desk.folder / file).write_text(HEAD + source, "utf-8")
    return check_program(desk.folder, desk.runner, replace(task, file=file))


def with_body(task: Task, body: str) -> str:
    """A function of the task's name and arguments with this body."""
    return f"def {task.name}({', '.join(task.arguments)}):\n" + textwrap.indent(textwrap.dedent(body), "    ") + "\n"


# Ways to hand back a right result, around the reference solution `reference`. Each takes the arguments and results of
# every task: numbers, arrays, tuples of arrays, functions.
WAYS = {
    "as it is": "return reference(*arguments)",
    "single precision results": "return convert(np.float32, reference(*arguments))",
    "computed in single precision": "return reference(*(single(a) for a in arguments))",
    "nested lists": "return convert(lambda value: np.asarray(value).tolist(), reference(*arguments))",
    "nested tuples": "return convert(nested_tuple, reference(*arguments))",
    "arrays in Fortran order": "return convert(np.asfortranarray, reference(*arguments))",
    "arrays of one element for numbers": (
        "return convert(lambda value: np.array([value]) if np.ndim(value) == 0 else value, reference(*arguments))"
    ),
}
TOOLS = """
def convert(function, value):
    return tuple(function(part) for part in value) if isinstance(value, tuple) else function(value)

def nested_tuple(value):
    return tuple(nested_tuple(part) for part in value) if np.ndim(value) else float(value)

def single(a):
    if isinstance(a, np.ndarray) and a.dtype.kind == "f":
        return a.astype(np.float32)
    return np.float32(a) if isinstance(a, float) else a
"""


@pytest.mark.parametrize("name", TASKS)
def test_a_right_result_is_right_in_any_form_and_in_another_hand(desk: Desk, name: str) -> None:
    task = TASKS[name]
    reference = inspect.getsource(task.function).replace(f"def {name}(", "def reference(")
    for way, body in WAYS.items():
        source = f"{reference}\n{TOOLS}\ndef {name}(*arguments):\n{textwrap.indent(body, '    ')}\n"
        verdict = verdict_of(desk, task, source)
        assert verdict.state == "right", (way, verdict)
    verdict = verdict_of(desk, task, with_body(task, RIGHT[name]))
    assert verdict.state == "right", verdict


CASES = [(name, mistake, body) for name, cases in WRONG.items() for mistake, body in cases]


@pytest.mark.parametrize(
    ("name", "mistake", "body"),  # every other one in a plain run
    [pytest.param(*case, id=f"{case[0]}-{i}", marks=() if i % 2 else pytest.mark.long) for i, case in enumerate(CASES)],
)
def test_a_wrong_solution_is_refused_and_its_mistake_named(desk: Desk, name: str, mistake: str, body: str) -> None:
    verdict = verdict_of(desk, TASKS[name], with_body(TASKS[name], body))
    assert verdict.state == "wrong", verdict
    assert verdict.mistake == mistake
    assert len(verdict.sentence) > 20


def test_a_wrong_function_is_placed_where_it_begins(desk: Desk) -> None:
    source = with_body(TASKS["net_buoyancy"], "return fluid_density * gravity * volume")
    places = (verdict_of(desk, TASKS["net_buoyancy"], before + source).place for before in ("", "# a comment\n\n"))
    first, second = (int(place.partition(":")[2]) for place in places)
    assert second == first + 2


@pytest.mark.parametrize(
    ("name", "words", "body"),  # two of three in a plain run
    [
        pytest.param(*case, id=f"{case[0]}-{i}", marks=() if i % 3 else pytest.mark.long)
        for i, case in enumerate(MISTAKES)
    ],
)
def test_a_mistake_as_students_make_it_is_named(desk: Desk, name: str, words: str, body: str) -> None:
    verdict = verdict_of(desk, TASKS[name], "KEPT = {}\n\n" + with_body(TASKS[name], body))
    assert verdict.state == "wrong", verdict
    assert words in verdict.sentence


def test_there_are_enough_wrong_solutions_and_nine_of_ten_have_a_name() -> None:
    assert len(CASES) >= 60
    assert set(WRONG) == set(RIGHT) == set(TASKS)
    assert min(len(cases) for cases in WRONG.values()) >= 2
    assert sum(bool(mistake) for _, mistake, _ in CASES) >= 0.9 * len(CASES)


def mistakes_of(task: Task) -> tuple[Mistake, ...]:
    """The mistakes that the check of a task knows."""
    return getattr(task.check, "MISTAKES", ())


def results_of(task: Task, function: Callable[..., Any]) -> list[Any]:
    """The results of a function at the random inputs, as the check compares them."""
    assert task.check is not None
    samples = inputs_of(task.check, task.name)
    normalise = getattr(task.check, "normalise", lambda value: value)
    return [normalise(conform(call(function, sample), call(task.function, sample))) for sample in samples]


def all_same(one: list[Any], other: list[Any]) -> bool:
    """True if two functions agree at all random inputs."""
    return all(same(a, b) for a, b in zip(one, other, strict=True))


def compiled(task: Task, body: str) -> Callable[..., Any]:
    """The function of a task with this body, in the process of the test."""
    known: dict[str, Any] = {"np": np}
    exec(with_body(task, body), known)
    return known[task.name]


@pytest.mark.parametrize("name", TASKS)
def test_every_listed_mistake_has_a_program_that_makes_it(name: str) -> None:
    """Without one, an error in a mistake's function is found by no test, and no student is told the name."""
    task = TASKS[name]
    mistakes = mistakes_of(task)
    names = {mistake.name for mistake in mistakes}
    made = [(mistake, results_of(task, compiled(task, body))) for mistake, body in WRONG[name] if mistake in names]
    without = []
    for mistake in mistakes:
        results = results_of(task, mistake.function)
        if not any(other == mistake.name and all_same(found, results) for other, found in made):
            without.append(f"{mistake.name}: {mistake.hint}")
    assert without == []


@pytest.mark.parametrize("name", TASKS)
def test_every_listed_mistake_is_one(name: str) -> None:
    """A mistake that equalled the reference would refuse right solutions; two that are equal cannot both be meant."""
    task = TASKS[name]
    mistakes = mistakes_of(task)
    results = [results_of(task, function) for function in (task.function, *(m.function for m in mistakes))]
    names = ["the reference", *(mistake.name for mistake in mistakes)]
    for i, one in enumerate(results):
        for j in range(i):
            assert not all_same(one, results[j]), f"{names[i]} is the same as {names[j]}"


@pytest.mark.parametrize("name", TASKS)
def test_a_function_without_body_is_not_begun(desk: Desk, name: str) -> None:
    assert verdict_of(desk, TASKS[name], stub(TASKS[name])).state == "not begun"


def test_a_byte_order_mark_begins_no_function() -> None:
    assert not read_source(b"\xef\xbb\xbf" + stub(TASKS["gravity"]).encode()).is_begun("gravity")


FORCE = with_body(TASKS["spring_force"], RIGHT["spring_force"])
STUB = stub(TASKS["spring_force"])
# Two definitions of one name -> the state of the last one, and the line on which it begins.
TWICE = {
    "right below the stub": (STUB + FORCE, "right", 0),
    "stub below the right one": (FORCE + STUB, "not begun", 0),
    "wrong below the right one": (FORCE + "\n" + with_body(TASKS["spring_force"], "return x1"), "wrong", "\ndef"),
    "assigned below the stub": (STUB + FORCE.replace("def s", "def a_s") + "spring_force = a_spring_force", "right", 0),
    "under a condition": (STUB + "if True:\n" + textwrap.indent(FORCE, "    "), "right", 0),
    "of a class": (FORCE + "class Mine:\n    def spring_force(self): ...\n", "right", 0),
}  # fmt: skip


@pytest.mark.parametrize(
    "case",  # a wrong function is explained, which takes seconds
    [pytest.param(case, marks=pytest.mark.long if "wrong" in TWICE[case] else ()) for case in TWICE],
)
def test_the_last_definition_of_a_name_counts(desk: Desk, case: str) -> None:
    source, state, mark = TWICE[case]
    verdict = verdict_of(desk, TASKS["spring_force"], source)
    assert verdict.state == state, verdict
    if mark:
        line = (HEAD + source).rpartition(mark)[0].count("\n") + 2
        assert verdict.place.endswith(f":{line}")


def test_a_result_that_is_not_a_number_is_said_with_the_case_in_which_it_comes(desk: Desk) -> None:
    task, words = TASKS["spring_force"], "it returns NaN (not a number) "
    body = next(body for mistake, body in WRONG["spring_force"] if mistake == "NaN")
    assert verdict_of(desk, task, with_body(task, body)).text.startswith(words + "where v1 = v2 (0/0)")
    always = verdict_of(desk, task, with_body(task, "return x1 * float('nan')"))
    assert always.text.startswith(words[:-1] + ": look for a division by 0")
    found = special_cases(("a", "b", "c"), (np.zeros(3), np.ones(3), 0.0), {})
    assert list(found) == [(0, "a = 0"), (2, "c = 0")]
    pairs = [(1, "a = b"), (0, "a = 0"), (1, "b = 0")]
    zeros = (np.zeros(3), np.zeros(3))
    assert list(special_cases(("a", "b"), zeros, {"a": "m", "b": "m"})) == pairs
    assert list(special_cases(("a", "b"), zeros, {"a": "m", "b": "m/s"})) == pairs[1:]


BROKEN = """import numpy as np


def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):
    r = x2 - x1
    return stiffness * (np.linalg.norm(r) - rest_length * r


def rope_acceleration(x, v):
    return 0 * x


# a method
def step_leapfrog(x, v):
    'Not begun.'
    ...
"""


def test_of_a_file_that_cannot_be_parsed_each_function_is_read_alone(tmp_path: Path) -> None:
    source = read_source(BROKEN.encode())
    names = ("spring_force", "rope_acceleration", "step_leapfrog", "step_rk4")
    assert [source.is_begun(name) for name in names] == [True, True, False, False]
    assert [source.name_at(line) for line in (4, 6, 10, 16, 1)] == [*names[:1], *names[:3], ""]
    saved = store({"rope.py": BROKEN.encode()}, tmp_path, 1, TASKS.values())
    assert saved.begun == {"spring_force", "rope_acceleration"}
    # With nothing else to blame, every function shows that the file does not run.
    assert read_source(b"import numpy as\n").is_begun("spring_force")
    assert read_source((STUB + "x = (\n").encode()).is_begun("spring_force")


@pytest.mark.parametrize("name", ["spring_force", "step_euler"])
def test_a_file_that_does_not_run_is_one_error_for_all_its_functions(tmp_path: Path, name: str) -> None:
    for code, words in {
        BROKEN: "rope.py does not run: line 6: SyntaxError: '(' was never closed.",
        HEAD + "x = 1 / 0\n": "rope.py does not run: line 3: ZeroDivisionError: division by zero.",
        HEAD + "import own\n": "rope.py does not run: own.py, line 1: ModuleNotFoundError: No module named 'nothing'.",
    }.items():
        (tmp_path / "rope.py").write_text(code, "utf-8")
        (tmp_path / "own.py").write_text("import nothing\n", "utf-8")
        with Runner(tmp_path) as runner:
            verdict = check_program(tmp_path, runner, TASKS[name])
        begun = code is not BROKEN or name == "spring_force"
        assert (verdict.state, verdict.sentence if begun else words) == ("failed" if begun else "not begun", words)


def test_an_endless_file_is_run_once_for_all_its_functions(tmp_path: Path) -> None:
    own = [task for task in TASKS.values() if task.file == "rope.py"]
    (tmp_path / "rope.py").write_text(HEAD + FORCE + "while True: pass\n", "utf-8")
    with Runner(tmp_path, time_limit=0.3) as runner:
        verdicts = [check_program(tmp_path, runner, task) for task in own]
        assert runner.starts == 1
    line = (HEAD + FORCE).count("\n") + 1
    said = f"rope.py does not run: line {line}: rope.py did not finish within 0.3 s: "
    assert len({verdict.sentence for verdict in verdicts}) == 1
    assert verdicts[0].sentence.startswith(said)
    assert "if __name__" in verdicts[0].sentence


# Bytes of a file -> what Python says of it, or "" if it runs.
ENCODINGS = {
    b"# gr\xf6\xdfe\n": r"line 1: SyntaxError: Non-UTF-8 code starting with '\xf6', but no encoding declared",
    b"\n\n\n# gr\xf6\xdfe\n": r"line 4: SyntaxError: Non-UTF-8 code starting with '\xf6', but no encoding declared",
    b"# coding: latin-1\n# gr\xf6\xdfe\n": "",
    b"\xef\xbb\xbf# gr\xc3\xb6\xc3\x9fe\n": "",
    b"# coding: nothing\n": "line 1: SyntaxError: unknown encoding: nothing",
}


@pytest.mark.parametrize("head", ENCODINGS)
def test_an_encoding_that_python_refuses_is_refused(tmp_path: Path, head: bytes) -> None:
    (tmp_path / "rope.py").write_bytes(head + (HEAD + FORCE).encode())
    python = subprocess.run([sys.executable, tmp_path / "rope.py"], capture_output=True, encoding="locale", check=False)
    with Runner(tmp_path) as runner:
        verdict = check_program(tmp_path, runner, TASKS["spring_force"])
    assert (python.returncode == 0) == (verdict.state == "right") == (ENCODINGS[head] == "")
    assert ENCODINGS[head] in verdict.sentence
    assert ("SyntaxError" in python.stderr) == bool(ENCODINGS[head])


def test_a_task_may_take_as_long_as_others_keep_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    runner = SimpleNamespace(effort=3.0, ask=lambda *_: [1.0])
    monkeypatch.setattr("app.lab.check.student_function.time.monotonic", lambda: clock[0])
    student = StudentFunction(cast(Runner, runner), TASKS["gravity"])
    clock[0] = 50.0
    assert student(1.0) == 1.0
    runner.effort = 13.1
    with pytest.raises(RunError, match="gravity is too slow: 10 s have passed"):
        student(1.0)
    runner.effort, clock[0] = 3.0, 101.0
    with pytest.raises(RunError, match="the machine is busy: 100 s have passed") as caught:
        student(1.0)
    assert caught.value.kind == BUSY


def test_the_effort_of_a_function_is_its_processor_time(tmp_path: Path) -> None:
    works = "end = time.process_time() + 0.2\n    while time.process_time() < end: pass"
    (tmp_path / "mine.py").write_text(
        f"import time\ndef f(x):\n    {works}\n    return x\ndef g(x):\n    time.sleep(0.3)\n    return x\n",
        "utf-8",
    )
    with Runner(tmp_path, time_limit=20.0) as runner:
        runner.call("mine.py", "f", 1.0)
        assert 0.15 < runner.effort < 0.35
        before = runner.effort
        runner.call("mine.py", "g", 1.0)
        assert runner.effort - before < 0.15


def test_a_busy_machine_is_no_failure_and_the_check_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refusals = iter([OSError(11, "Resource temporarily unavailable"), ConnectionError(), MemoryError])
    started = Runner._started

    def start(self: Runner, surroundings: dict[str, str]) -> object:
        refusal = next(refusals, None)
        if isinstance(refusal, OSError):
            raise refusal
        return started(self, surroundings)

    monkeypatch.setattr("app.lab.check.program_check.RETRY_INTERVAL", 0.0)
    monkeypatch.setattr(Runner, "_started", start)
    (tmp_path / "rope.py").write_text(HEAD + FORCE, "utf-8")
    with Runner(tmp_path) as runner:
        assert check_program(tmp_path, runner, TASKS["spring_force"]).state == "right"
        assert runner.starts == 3
    refusals = itertools.repeat(ConnectionError())
    with Runner(tmp_path) as runner:
        verdict = check_program(tmp_path, runner, TASKS["spring_force"])
    assert verdict.state == "not checked"
    assert verdict.text == ("could not be checked (the machine is busy: no process can be started: ConnectionError)")


@pytest.mark.parametrize("deep", ["-" * 100_000 + "1", "a" + ".a" * 100_000])
def test_a_file_that_nests_too_deeply_has_failed(desk: Desk, deep: str) -> None:
    task = TASKS["gravity"]
    source = f"def gravity(mass):\n    return {deep}\n"
    assert verdict_of(desk, task, source).state == "failed"
    assert read_source(source.encode()).has("gravity")


def test_a_change_affects_its_file_and_one_that_no_task_names_all_files(tmp_path: Path) -> None:
    first, second, third, fourth = (
        store(texts, tmp_path, 1, ())
        for texts in ({"rope.py": b""}, {"rope.py": b"#"}, {"rope.py": b"#", "mine.py": b""}, {"mine.py": b""})
    )
    tasks = list(TASKS.values())
    assert first.affected(first, tasks) == frozenset()
    assert second.affected(first, tasks) == first.affected(None, tasks) == fourth.affected(third, tasks) == {"rope.py"}
    assert third.affected(second, tasks) == {task.file for task in tasks}


def test_the_sign_reversed_is_named_in_every_task(desk: Desk) -> None:
    for name in set(TASKS) - {"cloth_links", "rain_hit"}:
        reference = inspect.getsource(TASKS[name].function).replace(f"def {name}(", "def reference(")
        body = "value = reference(*a)\n    return tuple(-p for p in value) if isinstance(value, tuple) else -value"
        verdict = verdict_of(desk, TASKS[name], f"{reference}\ndef {name}(*a):\n    {body}\n")
        assert verdict.state == "wrong", name
        assert "sign" in verdict.mistake or "grow" in verdict.mistake, (name, verdict)


ACCIDENTS = {
    "1 / 0": ("failed", "raised"), "np.full(3, np.nan)": ("wrong", "NaN"), "np.zeros((2, 2))": ("wrong", "wrong shape"),
    "None": ("wrong", "returns nothing"), "'abc'": ("wrong", "wrong type"), "{}": ("wrong", "wrong type"),
    "[[1], [2, 3]]": ("wrong", "wrong type"), "(x1, x2)": ("wrong", "wrong shape"), "3.0": ("wrong", "wrong shape"),
    "np.zeros(3)": ("wrong", "the result is 0"), "np.full(3, np.inf)": ("wrong", "infinite"),
    "1j * x1": ("wrong", "wrong type"), "exit()": ("failed", "ended"),
}  # fmt: skip


@pytest.mark.parametrize("expression", ACCIDENTS)
def test_what_is_no_result_is_told(desk: Desk, expression: str) -> None:
    task = TASKS["spring_force"]
    verdict = verdict_of(desk, task, with_body(task, f"return {expression}"))
    state, mistake = ACCIDENTS[expression]
    assert verdict.state == state, verdict
    assert verdict.mistake == mistake


def test_the_checks_do_not_change_the_arguments_of_each_other() -> None:
    task = TASKS["step_euler"]
    assert task.check is not None
    x, v, h, a = task.check.inputs(np.random.default_rng(1))
    kept = x.copy()
    call(lambda x, v, h, a: x.fill(0.0), (x, v, h, a))
    assert np.array_equal(x, kept)


def test_links_of_another_form_stay_as_they_are() -> None:
    (task,) = [task for task in load_tasks() if task.name == "cloth_links"]
    assert task.check.normalise(np.array([[3, 1], [0, 1]])).tolist() == [[0, 1], [1, 3]]
    for links in (np.arange(3), np.array([[3, 1, 0], [2, 0, 1]]), np.zeros((0, 2), int)):
        assert np.array_equal(task.check.normalise(links), links)


def test_a_step_of_third_order_with_four_evaluations_is_not_the_fourth() -> None:
    def kutta(x: Any, v: Any, h: float, acceleration: Callable[..., Any]) -> tuple[Any, Any]:
        a1 = acceleration(x, v)
        a2, v2 = acceleration(x + h / 2 * v, v + h / 2 * a1), v + h / 2 * a1
        a3, v3 = acceleration(x - h * v + 2 * h * v2, v - h * a1 + 2 * h * a2), v - h * a1 + 2 * h * a2
        acceleration(x, v)
        return x + h / 6 * (v + 4 * v2 + v3), v + h / 6 * (a1 + 4 * a2 + a3)

    (task,) = [task for task in load_tasks() if task.name == "step_rk4"]
    task.check.behaviour(task.function)
    with pytest.raises(Wrong, match=r"made the error only [78]\.\d times smaller: that is not the fourth order"):
        task.check.behaviour(kutta)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ([1.0], "a list of 1 entry"),
        ([[1.0], [2.0, 3.0]], "a list of 2 entries"),
        ((np.zeros(3), 2.0), "a tuple of an array of shape (3,) and a number"),
    ],
)
def test_the_form_of_a_result_is_told_in_words(value: object, text: str) -> None:
    assert form_of(value) == text


LEAPFROG = """
w = v + h / 2 * acceleration(x, v)
y = x + h * w
return {result}
"""
USUAL = "y, w + h / 2 * acceleration(y, w)"
ODD = "[y] if abs(y[0, 0] + 0.1) < 0.2 and y.shape == (1, 3) else (y, w + h / 2 * acceleration(y, w))"


@pytest.mark.parametrize("result", [USUAL, ODD])
def test_steps_in_the_process_are_those_of_single_calls(desk: Desk, result: str) -> None:
    task, messages = TASKS["step_leapfrog"], 0
    (desk.folder / f"steps_{len(result)}.py").write_text(
        HEAD + with_body(task, LEAPFROG.format(result=result)), "utf-8"
    )
    student = StudentFunction(desk.runner, replace(task, file=f"steps_{len(result)}.py"))
    alone = StudentFunction(desk.runner, student.task, is_watched=False)
    ask = student.ask

    def counted(*arguments: Any) -> Any:
        nonlocal messages
        messages += 1
        return ask(*arguments)

    student.ask = counted
    states = []
    x, v = np.array([[1.0, 0.0, 0.0]]), np.zeros((1, 3))
    for steps in (student.steps_of_oscillator(x, v, 0.3, 40), alone.steps_of_oscillator(x, v, 0.3, 40)):
        states.append([])
        with pytest.raises(Wrong, match="a list of 1 entry") if result == ODD else contextlib.nullcontext():
            for state in steps:
                states[-1].append(state)
    np.testing.assert_array_equal(*states)
    assert len(states[0]) == (4 if result == ODD else 40)
    assert messages < 8


def test_a_side_effect_of_a_late_step_is_found(desk: Desk) -> None:
    task = TASKS["step_leapfrog"]
    late = "global steps\nif y[0, 0] < 0 and len(y) == 1:\n    steps = 1\nreturn"
    body = LEAPFROG.format(result=USUAL).replace("return", late)
    verdict = verdict_of(desk, task, "steps = 0\n" + with_body(task, body))
    assert verdict.mistake == "state kept between calls"
    assert "it changes steps" in verdict.text
