"""answers.toml: read leniently, written whole or not at all."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from app.lab.course.answer_check import check_answer
from app.lab.course.answers import FILE, Answers, answers_text, change_answer, read_answers
from app.lab.course.task import Question, TypicalError, load_tasks
from tests.app.lab.solutions.answers_file import write_answers

ROOT = Path(__file__).parents[4]
TASKS = load_tasks()
FIRST = next(task for task in TASKS if task.questions)
ODD = (
    "",
    "plain",
    'a "quote" and \\ and \\n',
    "two\nlines\n\n'''\"\"\"",
    "tab\t\x07\x7f",
    "åäö 波 🌊",
    "# not a comment",
    "[x]\r\n",
)


@pytest.mark.parametrize("text", ODD)
def test_any_text_survives_being_written(tmp_path: Path, text: str) -> None:
    given = Answers(
        text.strip(), {(FIRST.name, FIRST.questions[0].key): text, ("other", "k"): text, ("other", "n"): -1.5e-300}
    )
    write_answers(tmp_path, TASKS, given)
    back = read_answers(tmp_path)
    assert back.error == ""
    assert back.name == text.strip()
    assert {key: value for key, value in back.values.items() if value != ""} == {
        key: value for key, value in given.values.items() if value != ""
    }


def test_half_a_surrogate_pair_does_not_stop_the_writing(tmp_path: Path) -> None:
    write_answers(tmp_path, TASKS, Answers("x\ud800y", {}))
    assert read_answers(tmp_path).name == "x?y"


def test_every_question_has_its_place(tmp_path: Path) -> None:
    table = tomllib.loads(answers_text(TASKS, Answers("", {})))
    asked = {(task.name, question.key) for task in TASKS for question in task.questions}
    assert {(name, key) for name, entries in table.items() if isinstance(entries, dict) for key in entries} == asked


@pytest.mark.parametrize(
    ("text", "expected"),
    [("0.5", 0.5), ('"0,5"', 0.5), ('" 0.5 "', 0.5), ("1", 1.0), ("nan", None), ("inf", None), ('""', None),
     ('" "', None), ("true", None), ("[1]", None), ('"half"', "half"), ("1" + "0" * 400, None)],
)  # fmt: skip
def test_a_number_is_read_however_it_is_written(tmp_path: Path, text: str, expected: object) -> None:
    task = next(task for task in TASKS if any(question.kind == "number" for question in task.questions))
    question = next(question for question in task.questions if question.kind == "number")
    (tmp_path / FILE).write_text(f"[{task.name}]\n{question.key} = {text}\n", "utf-8")
    assert read_answers(tmp_path).of(task, question) == expected


@pytest.mark.parametrize(
    "data", [b"a = ", b"\xff\xfe", b"x = 1\nx = 2", b"[" * 100_000, b"x = " + b"9" * 5000, b"# " + b"x" * 2**21]
)
def test_a_broken_file_is_said_to_be_broken(tmp_path: Path, data: bytes) -> None:
    (tmp_path / FILE).write_bytes(data)
    assert FILE in read_answers(tmp_path).error


def test_a_byte_order_mark_is_read_over(tmp_path: Path) -> None:
    (tmp_path / FILE).write_bytes(b'\xef\xbb\xbfname = "Ada"\n[filler]\na = 1\n')
    change_answer(tmp_path, TASKS, read_answers(tmp_path), "filler", "a", 2.0)
    back = read_answers(tmp_path)
    assert (back.error, back.name, back.values) == ("", "Ada", {("filler", "a"): 2.0})


@pytest.mark.parametrize("value", [2.0, "two\nlines"])
@pytest.mark.parametrize("tail", ["", "b = 3\n", "\n[other]\nx = inf\n"])
def test_all_but_the_value_stays_as_it_is_with_nan_and_any_line_ends(tmp_path: Path, value: object, tail: str) -> None:
    for end in ("\n", "\r\n"):
        before = f'name = "Ada"\n# mine\n[filler]\na = 1\n{tail}z = nan\n'.replace("\n", end)
        (tmp_path / FILE).write_bytes(before.encode())
        change_answer(tmp_path, TASKS, read_answers(tmp_path), "filler", "a", value)
        written = "2.0" if value == 2.0 else f'"""{end}two{end}lines"""'
        assert (tmp_path / FILE).read_bytes().decode() == before.replace("a = 1", f"a = {written}")
        assert read_answers(tmp_path).values["filler", "a"] == value


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_task_without_questions_gets_a_heading_at_the_end(tmp_path: Path, end: str) -> None:
    before = f"# mine{end}[filler]{end}a = 1{end}"
    (tmp_path / FILE).write_bytes(before.encode())
    for value in ("1", "1 2"):
        change_answer(tmp_path, TASKS, read_answers(tmp_path), "net_buoyancy", "done", value)
        written = f'{end}[net_buoyancy]{end}done = "{value}"{end}'
        assert (tmp_path / FILE).read_bytes().decode() == before + written


def test_no_file_is_said(tmp_path: Path) -> None:
    assert FILE in read_answers(tmp_path).error


# A process that is killed when half of the file is written.
KILLED = """
import os, sys
from pathlib import Path
from app.lab.course.answers import change_answer, read_answers
from app.lab.course.task import load_tasks

def write_half(path, data):
    with open(path, "wb") as file:
        file.write(data[: len(data) // 2])
    os._exit(3)

Path.write_bytes = write_half
folder = Path(sys.argv[1])
change_answer(folder, load_tasks(with_checks=False), read_answers(folder), "filler", "0", "new")
"""


def test_a_kill_while_an_answer_is_written_breaks_nothing(tmp_path: Path) -> None:
    given = Answers("Ada", {("filler", str(i)): "x" * 1000 for i in range(100)})
    write_answers(tmp_path, TASKS, given)
    before = read_answers(tmp_path)
    assert subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], cwd=ROOT, check=False).returncode == 3
    assert read_answers(tmp_path) == before


NUMBER = Question("n", "?", "number", right=2.0, tolerance=0.1, why="so", typical_errors=(TypicalError(4, "twice"),))
CHOICE = Question("c", "?", "choice", ("a", "b", "x"), right="a", typical_errors=(TypicalError("b", "not b"),))


@pytest.mark.parametrize(
    ("question", "answer", "state", "text"),
    [
        (NUMBER, 2.19, "right", "so"), (NUMBER, 1.79, "wrong", "measure"), (NUMBER, 4.1, "wrong", "twice"),
        (NUMBER, "two", "wrong", "not a number"), (NUMBER, None, "not begun", ""),
        (CHOICE, "a", "right", ""), (CHOICE, "b", "wrong", "not b"), (CHOICE, "x", "wrong", "measure"),
        (CHOICE, "z", "wrong", "one of the choices"), (CHOICE, 1.0, "wrong", "one of the choices"),
        (Question("p", "?", "choice", ("a", "b")), "b", "given", ""), (Question("p", "?", "number"), 1.0, "given", ""),
        (Question("t", "?", "text"), "It falls down.", "given", ""),
        (Question("t", "?", "text"), "yes", "wrong", "sentence"),
    ],
)  # fmt: skip
def test_answers_are_judged(question: Question, answer: str | float | None, state: str, text: str) -> None:
    verdict = check_answer(question, answer)
    assert verdict.state == state
    assert text in verdict.text
