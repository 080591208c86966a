"""The course lab under accidents: in every function, kills while answers are written, results of every kind."""

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from msgspec.structs import replace

from app.lab.check.program_check import check_program
from app.lab.course.answers import Answers, read_answers
from app.lab.course.task import load_tasks
from app.lab.process.runner import Runner
from tests.app.lab.course.test_answers import ROOT
from tests.app.lab.solutions.answers_file import write_answers

TASKS = load_tasks()
FUNCTIONS = [task for task in TASKS if task.check is not None]
# What happens in the function -> the name that the check gives.
ACCIDENTS = {
    "while True: pass": "endless", "raise RuntimeError('mine')": "raised", "exit()": "ended",
    "import os; os._exit(1)": "ended", "np.ones(1 << 27)": "memory", "for i in range(1_000_000): print(i)": "printed",
    "return np.full((7, 5), 1.0)": "wrong shape", "return None": "returns nothing", "return {}": "wrong type",
}  # fmt: skip
# What odd results are made of.
VALUES = (
    "None", "1", "-1.5", "float('nan')", "float('inf')", "'text'", "b'x'", "{}", "set()", "1j", "True", "10**400",
    "object()", "len", "np.zeros(0)", "np.ones(3)", "np.ones((3, 3), 'f4')", "np.array(['a'])", "np.array([None, 1])",
    "np.ma.ones(3)", "range(3)", "np.datetime64('2020')", "np.matrix([[1, 2]])", "np.float16(1)", "np.longdouble(1)",
    "[[1], [2, 3]]", "(x for x in 'ab')",
)  # fmt: skip


@pytest.mark.parametrize("body", ACCIDENTS)
@pytest.mark.parametrize("task", FUNCTIONS, ids=lambda task: task.name)
def test_every_accident_in_every_function_is_named_within_three_seconds(tmp_path: Path, task, body: str) -> None:
    (tmp_path / task.file).write_text(f"import numpy as np\n\ndef {task.name}(*arguments):\n    {body}\n", "utf-8")
    (tmp_path / "warm.py").write_text("def f():\n    return 1\n", "utf-8")
    with Runner(tmp_path) as runner:
        runner.call("warm.py", "f")  # the process runs while a student works
        start = time.monotonic()
        verdict = check_program(tmp_path, runner, task)
        taken = time.monotonic() - start
    assert verdict.state in ("failed", "wrong")
    assert verdict.mistake == ACCIDENTS[body], verdict
    assert taken < 3.0


# What the page does: one value after the other, each told once it is kept.
PAGE_WRITER = """
import sys
from pathlib import Path
from app.lab.course.task import load_tasks
from app.lab.student.workbook import Workbook
book = Workbook(load_tasks(with_checks=False), Path(sys.argv[1]))
task = next(task for task in book.tasks if task.name == "extra_draft")
measure, explain = task.questions[1:]
number = 0
while True:
    number += 1
    book.answer(task, measure, str(number))
    book.answer(task, explain, f"Sentence {number}.\\n" * 100)
    book.store(task.name, "done", str(number))
    print(number, flush=True)
"""


@pytest.mark.parametrize("seed", range(50))
def test_a_kill_at_fifty_moments_loses_only_what_the_page_was_just_writing(tmp_path: Path, seed: int) -> None:
    write_answers(tmp_path, TASKS, Answers("Ada", {("filler", str(i)): "x" * 1000 for i in range(100)}))
    path = tmp_path / "answers.toml"
    path.write_text(path.read_text("utf-8").replace("[extra_draft]", "# my note\n[extra_draft]"), "utf-8")
    writer = subprocess.Popen([sys.executable, "-c", PAGE_WRITER, str(tmp_path)], cwd=ROOT, stdout=subprocess.PIPE)
    assert writer.stdout is not None
    writer.stdout.readline()
    time.sleep(random.Random(seed).uniform(0.0, 0.1))
    writer.kill()
    told = 1 + len(writer.stdout.read().splitlines())
    writer.wait()
    back = read_answers(tmp_path)
    assert back.error == ""
    assert back.name == "Ada"
    assert len([key for key in back.values if key[0] == "filler"]) == 100
    assert "# my note\n[extra_draft]" in path.read_text("utf-8")
    kept = (
        back.values["extra_draft", "measure"],
        back.values["extra_draft", "explain"],
        back.values["extra_draft", "done"],
    )
    numbers = int(kept[0]), int(str(kept[1]).split()[1].rstrip(".")), int(kept[2])
    # In this order they are written, so that each is as new as the one before it, or older by one.
    assert told + 1 >= numbers[0] >= numbers[1] >= numbers[2] >= told
    assert str(kept[1]).strip() == "\n".join([f"Sentence {numbers[1]}."] * 100)


@pytest.mark.parametrize("task", FUNCTIONS, ids=lambda task: task.name)
def test_no_odd_result_stops_the_check_or_is_taken_for_right(tmp_path: Path, task) -> None:
    rng = random.Random(task.name)
    made = [*VALUES, *(f"({rng.choice(VALUES)}, {rng.choice(VALUES)})" for _ in range(30))]
    made += [f"[{', '.join(rng.choice(VALUES) for _ in range(rng.randint(1, 4)))}]" for _ in range(30)]
    with Runner(tmp_path) as runner:
        for number, value in enumerate(made):
            file = f"try_{number}.py"
            (tmp_path / file).write_text(
                f"import numpy as np\n\ndef {task.name}(*arguments):\n    return {value}\n", "utf-8"
            )
            verdict = check_program(tmp_path, runner, replace(task, file=file))
            assert verdict.state in ("failed", "wrong"), value
        assert runner.starts == 1
