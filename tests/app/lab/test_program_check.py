"""The checks of programming tasks: right solutions pass, wrong ones are refused and named."""

import inspect
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from msgspec.structs import replace

from app.lab.folder import stub
from app.lab.program_check import SAMPLES, SEED, Verdict, call, check_program, is_begun, same
from app.lab.runner import Runner
from app.lab.saved import is_there, keep
from app.lab.task import Task, load_tasks
from tests.app.lab.right_solutions import RIGHT
from tests.app.lab.wrong_solutions import WRONG

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
    (desk.folder / file).write_text(HEAD + source)
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
    "written into the arguments": (
        "result = reference(*arguments)\nfor a in arguments:\n    if isinstance(a, np.ndarray): a *= 0\nreturn result"
    ),
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


@pytest.mark.parametrize(("name", "mistake", "body"), CASES, ids=[f"{case[0]}-{i}" for i, case in enumerate(CASES)])
def test_a_wrong_solution_is_refused_and_its_mistake_named(desk: Desk, name: str, mistake: str, body: str) -> None:
    verdict = verdict_of(desk, TASKS[name], with_body(TASKS[name], body))
    assert verdict.state == "wrong", verdict
    assert verdict.mistake == mistake
    assert len(verdict.text) > 20


def test_there_are_enough_wrong_solutions_and_nine_of_ten_have_a_name() -> None:
    assert len(CASES) >= 60
    assert set(WRONG) == set(RIGHT) == set(TASKS)
    assert min(len(cases) for cases in WRONG.values()) >= 2
    assert sum(bool(mistake) for _, mistake, _ in CASES) >= 0.9 * len(CASES)


@pytest.mark.parametrize("name", TASKS)
def test_every_listed_mistake_is_one(name: str) -> None:
    """A mistake that equalled the reference would refuse right solutions; two that are equal cannot both be meant."""
    task = TASKS[name]
    assert task.check is not None
    rng = np.random.default_rng(SEED)
    samples = [tuple(task.check.inputs(rng)) for _ in range(SAMPLES)]
    normalise = getattr(task.check, "normalise", lambda value: value)
    results = [
        [normalise(call(f, s)) for s in samples] for f in (task.function, *(m.function for m in task.check.MISTAKES))
    ]
    names = ["the reference", *(mistake.name for mistake in task.check.MISTAKES)]
    for i, one in enumerate(results):
        for j in range(i):
            alike = all(same(a, b) for a, b in zip(one, results[j], strict=True))
            assert not alike, f"{names[i]} is the same as {names[j]}"


@pytest.mark.parametrize("name", TASKS)
def test_a_function_without_body_is_not_begun(desk: Desk, name: str) -> None:
    assert verdict_of(desk, TASKS[name], stub(TASKS[name])).state == "not begun"


def test_a_byte_order_mark_begins_no_function(tmp_path: Path) -> None:
    (tmp_path / TASKS["gravity"].file).write_bytes(b"\xef\xbb\xbf" + stub(TASKS["gravity"]).encode())
    assert not is_begun(tmp_path, TASKS["gravity"])


@pytest.mark.parametrize("deep", ["-" * 100_000 + "1", "a" + ".a" * 100_000])
def test_a_file_that_nests_too_deeply_has_failed(desk: Desk, deep: str) -> None:
    task = TASKS["gravity"]
    source = f"def gravity(mass):\n    return {deep}\n"
    assert verdict_of(desk, task, source).state == "failed"
    assert is_there(task, {task.file: source.encode()})


def test_a_change_affects_its_file_and_one_that_no_task_names_all_files(tmp_path: Path) -> None:
    first, second, third, fourth = (
        keep(texts, tmp_path, 1, ())
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
    "np.zeros(3)": ("wrong", ""), "np.full(3, np.inf)": ("wrong", ""), "1j * x1": ("wrong", "wrong type"),
    "exit()": ("failed", "ended"),
}  # fmt: skip


@pytest.mark.parametrize("expression", ACCIDENTS)
def test_what_is_no_result_is_told(desk: Desk, expression: str) -> None:
    task = TASKS["spring_force"]
    verdict = verdict_of(desk, task, with_body(task, f"return {expression}"))
    state, mistake = ACCIDENTS[expression]
    assert verdict.state == state, verdict
    assert verdict.mistake == mistake or (not mistake and "not used" in verdict.mistake)


def test_the_checks_do_not_change_the_arguments_of_each_other() -> None:
    task = TASKS["step_euler"]
    assert task.check is not None
    x, v, h, a = task.check.inputs(np.random.default_rng(1))
    kept = x.copy()
    call(lambda x, v, h, a: x.fill(0.0), (x, v, h, a))
    assert np.array_equal(x, kept)
