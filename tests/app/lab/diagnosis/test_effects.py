"""Side effects of a student's function are found, before anything else is said of it."""

import inspect
import os
import textwrap
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from app.lab.check.program_check import Verdict, check_program
from app.lab.course.task import Task, load_tasks
from app.lab.diagnosis.effects import ARGUMENT, EFFECTS, FILE, SETTING, STATE, alike, digest, is_writing
from app.lab.process.runner import Runner

TASKS = {task.name: task for task in load_tasks() if task.check is not None}
ARRAYS = {  # of eight tasks, an array that the function gets
    "spring_force": "x2", "rope_acceleration": "v", "sphere_force": "centre", "step_euler": "x", "step_rk4": "v",
    "step_leapfrog": "x", "cloth_forces": "x", "surface_colour": "water_colour",
}  # fmt: skip
HEAD = """import random
import numpy as np
TOTAL, LOG, CACHE, OUT = 0, [], {}, np.zeros(1)

class State:
    calls = 0

def helper(y):
    y *= 2

"""
# Kind of the effect, a text that the sentence has, and lines that a right function has too; A is an array it gets.
EFFECTS_OF_LINES = (
    (ARGUMENT, "its argument A", "A += 1"),
    (ARGUMENT, "its argument A", "A[:] = 0"),
    (ARGUMENT, "its argument A", "A[0] = 0.5"),
    (ARGUMENT, "its argument A", "r = A\nr -= 0.5"),
    (ARGUMENT, "its argument A", "part = A[1:]\npart *= 2"),
    (ARGUMENT, "its argument A", "np.asarray(A)[...] = 7"),
    (ARGUMENT, "its argument A", "np.add(A, 1, out=A)"),
    (ARGUMENT, "its argument A", "np.add.at(A, 0, 1)"),
    (ARGUMENT, "its argument A", "A.fill(3)"),
    (ARGUMENT, "its argument A", "A.ravel()[0] = 5"),
    (ARGUMENT, "its argument A", "A.T[0] = 7"),
    (ARGUMENT, "which helper runs: y *= 2", "helper(A)"),
    (STATE, "it changes TOTAL", "global TOTAL\nTOTAL += 1"),
    (STATE, "it changes LOG", "LOG.append(len(LOG))"),
    (STATE, "it changes CACHE", "CACHE['first'] = CACHE.get('first', result)"),
    (STATE, "it changes State.calls", "State.calls += 1"),
    (STATE, "it changes FUNCTION.calls", "FUNCTION.calls = getattr(FUNCTION, 'calls', 0) + 1"),
    (STATE, "it changes the default of the argument kept of FUNCTION", "kept.append(1)"),
    (STATE, "it changes OUT", "global OUT\nOUT = OUT + 1"),
    (STATE, "it draws random numbers", "result = noisy(result)"),
    (STATE, "two calls with the same arguments", "result = next(ROWS)(result)"),
    (STATE, "it draws random numbers, or sets their seed", "np.random.seed(1)"),
    (SETTING, "it changes numpy's error handling", "np.seterr(all='raise')"),
    (FILE, "it writes the file log.txt", "open('log.txt', 'a').close()"),
)  # fmt: skip
TOOLS = """
def noisy(value):
    factor = 1 + random.random()
    return tuple(factor * part for part in value) if isinstance(value, tuple) else factor * value

def rows():
    factor = 1.0
    while True:
        factor += 1
        yield lambda value: tuple(factor * p for p in value) if isinstance(value, tuple) else factor * value

ROWS = rows()
"""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Runner]:
    with Runner(tmp_path_factory.mktemp("student"), time_limit=20.0) as runner:
        yield runner


def verdict_of(runner: Runner, task: Task, source: str) -> Verdict:
    """What the check says of a file of its own."""
    file = f"solution_{len(list(runner.folder.iterdir()))}.py"
    (runner.folder / file).write_text(source, "utf-8")
    return check_program(runner.folder, runner, replace(task, file=file))


def right_but(task: Task, lines: str) -> str:
    """A file with a right function that does something else, too, in these lines."""
    name, arguments = task.name, ", ".join(task.arguments)
    reference = inspect.getsource(task.function).replace(f"def {name}(", "def reference(")
    lines = lines.replace("FUNCTION", name)
    own = f"def {name}({arguments}, kept=[]):\n    result = reference({', '.join(map(copy, task.arguments))})\n"
    return f"{HEAD}{reference}\n{TOOLS}\n{own}{textwrap.indent(lines, '    ')}\n    return result\n"


def copy(argument: str) -> str:
    """An argument of which the reference gets a copy."""
    return f"{argument}.copy() if isinstance({argument}, np.ndarray) else {argument}"


def test_lists_count_as_state_however_deep_they_lie_and_objects_of_libraries_do_not() -> None:
    kept: list[float] = []
    deep = [[[{"kept": kept}]]]
    before = digest(deep)
    assert digest(deep) == before
    kept.append(1.0)
    assert digest(deep) != before
    drawing, rooting = np.random.default_rng(3), np.vectorize(lambda x: x + 1.0, otypes=[float])
    before = digest([drawing, rooting])
    drawing.normal()
    rooting(np.ones(3))
    assert digest([drawing, rooting]) == before


@pytest.mark.parametrize("name", ARRAYS)
def test_a_right_function_with_a_side_effect_is_wrong_and_nothing_else_is_blamed(desk: Runner, name: str) -> None:
    task = TASKS[name]
    assert verdict_of(desk, task, right_but(task, "pass")).state == "right"
    for kind, words, lines in EFFECTS_OF_LINES:
        lines = lines.replace("A", ARRAYS[name]) if kind == ARGUMENT else lines
        source = right_but(task, lines)
        verdict = verdict_of(desk, task, source)
        assert (verdict.state, verdict.mistake) == ("wrong", kind), (lines, verdict)
        said = words.replace("argument A", f"argument {ARRAYS[name]}").replace("FUNCTION", name)
        assert said in verdict.text, verdict
        if ("differ" not in verdict.text and "random" not in words) or "LOG" in words:
            line = int(verdict.place.partition(":")[2] or 0)
            expected = "    y *= 2" if "helper" in lines else f"    {lines.splitlines()[-1].replace('FUNCTION', name)}"
            assert source.splitlines()[line - 1] == expected


def test_the_mistake_of_a_function_that_is_called_is_said_with_its_line_whoever_calls_it(tmp_path: Path) -> None:
    text = HEAD + (
        "def spring_force(x1, x2, v1, v2, stiffness, damping, rest_length):\n"
        "    r = x2\n    r -= x1\n    length = np.linalg.norm(r)\n"
        "    return stiffness * (length - rest_length) * r / length - damping * (v1 - v2)\n\n"
        "def rope_acceleration(x, v, mass, stiffness, damping, drag, rest_length, gravity):\n"
        "    F = -drag * v\n    for i in range(len(x) - 1):\n"
        "        f = spring_force(x[i], x[i + 1], v[i], v[i + 1], stiffness, damping, rest_length)\n"
        "        F[i] += f\n        F[i + 1] -= f\n"
        "    a = F / mass\n    a[:, 2] -= gravity\n    a[0] = 0\n    return a\n"
    )
    line = text[: text.index("r -= x1")].count("\n") + 1
    fixed = text.replace("r -= x1", "r = r - x1")
    for source, state in ((text, "wrong"), (fixed, "right")):
        (tmp_path / "rope.py").write_text(source, "utf-8")
        with Runner(tmp_path) as runner:
            verdicts = [check_program(tmp_path, runner, TASKS[name]) for name in ("spring_force", "rope_acceleration")]
            verdicts += [check_program(tmp_path, runner, TASKS[name]) for name in ("rope_acceleration", "spring_force")]
        assert [verdict.state for verdict in verdicts] == 4 * [state]
        if state == "wrong":
            assert {verdict.place for verdict in verdicts} == {f"rope.py:{line}"}
            assert verdicts[0].text.endswith(f"(line {line}: r -= x1). Write r = r - x1, which makes a new array.")
            assert f"its argument x (line {line}, which spring_force runs: r -= x1)" in verdicts[1].text


def test_a_result_that_was_kept_from_an_earlier_call_is_found_in_any_order(desk: Runner) -> None:
    """The first call of a function fills what it keeps: later ones change nothing any more."""
    task = TASKS["gravity"]
    source = "KEPT = {}\n\ndef gravity(m):\n    KEPT.setdefault('g', 9.81 * m ** (1 / 3))\n    return KEPT['g']\n"
    assert verdict_of(desk, task, source).mistake == STATE
    (desk.folder / "twice.py").write_text(source, "utf-8")
    for _ in range(2):
        verdict = check_program(desk.folder, desk, replace(task, file="twice.py"))
        assert (verdict.mistake, verdict.place) == (STATE, "twice.py:4")
    desk.call("twice.py", "gravity", 2.0)
    assert check_program(desk.folder, desk, replace(task, file="twice.py")).place == "twice.py:4"


# Functions that keep nothing, whatever they have beside them.
PURE = (
    "rng = np.random.default_rng(5)\n    return 9.81 * m ** (1 / 3) + 0 * rng.normal()",
    "with np.errstate(all='ignore'):\n        return 9.81 * m ** (1 / 3)",
    "y = np.array([m]); y *= 1; y += 0\n    return 9.81 * y[0] ** (1 / 3)",
    "print('m', m)\n    return cached(m)",
    "return 9.81 * bool(open(__file__).read()) * m ** (1 / 3)",
)


def test_what_keeps_nothing_is_right(desk: Runner) -> None:
    head = (
        "import functools\nimport numpy as np\n\n@functools.lru_cache\ndef cached(m):\n    return 9.81 * m ** (1 / 3)\n"
    )
    for body in PURE:
        verdict = verdict_of(desk, TASKS["gravity"], f"{head}\ndef gravity(m):\n    {body}\n")
        assert verdict.state == "right", (body, verdict)


def test_the_effects_are_those_that_a_verdict_may_name() -> None:
    assert {kind for kind, *_ in EFFECTS_OF_LINES} == set(EFFECTS)
    assert np.geterr()["divide"] == "warn"


def test_a_file_is_written_by_its_mode_or_its_flags() -> None:
    assert all(is_writing(mode, os.O_RDONLY) for mode in ("w", "a", "x", "r+", "rb+"))
    assert all(is_writing(None, flags) for flags in (os.O_WRONLY, os.O_RDWR | os.O_CREAT))
    assert not any(is_writing(mode, os.O_RDONLY) for mode in ("r", "rb", "", None))


def test_results_of_equal_calls_may_differ_by_rounding_relative_to_themselves() -> None:
    for size in (1e-9, 1.0, 1e9):
        one = size * np.array([1.0, -0.3, 0.0])
        assert alike(one, one * (1.0 + 1e-14))
        assert alike((one, 2.0), (one.copy(), 2.0))
        assert not alike(one, one + 0.01 * size)
        assert not alike((one, 2.0), (one, 2.0 + 0.01))
