"""answers.toml: read leniently, written whole or not at all."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from app.lab.course.answer_check import check_answer
from app.lab.course.answers import FILE, Answers, answers_text, change_answer, read_answers, strangers
from app.lab.course.folder import right_answers
from app.lab.course.task import Question, TypicalError, load_tasks
from app.lab.student.workbook import answer_of
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
    [("0.5", 0.5), ('"0,5"', 0.5), ('" 0.5 "', 0.5), ("1", 1.0), ("nan", "nan"), ("inf", "inf"), ('""', None),
     ('" "', None), ("true", "true"), ("[1]", "[1]"), ('"half"', "half"), ("1" + "0" * 400, "1" + "0" * 400)],
)  # fmt: skip
def test_a_number_is_read_however_it_is_written_and_anything_else_is_repeated(
    tmp_path: Path, text: str, expected: object
) -> None:
    task = next(task for task in TASKS if any(question.kind == "number" for question in task.questions))
    question = next(question for question in task.questions if question.kind == "number")
    (tmp_path / FILE).write_text(f"[{task.name}]\n{question.key} = {text}\n", "utf-8")
    found = read_answers(tmp_path)
    verdict = check_answer(question, found.of(task, question), found.unread_of(task, question))
    assert verdict.answer == expected
    assert bool(found.error) == (isinstance(expected, str) and expected != "half")
    if isinstance(expected, str):
        assert verdict.state == "wrong"
        assert expected[:40] in verdict.text


@pytest.mark.parametrize(
    "data", [b"a = ", b"x = 1\nx = 2", b"[" * 100_000, b"x = " + b"9" * 5000, b"# " + b"x" * 2**21, b"= 3"]
)
def test_a_broken_file_is_said_to_be_broken(tmp_path: Path, data: bytes) -> None:
    (tmp_path / FILE).write_bytes(data)
    assert FILE in read_answers(tmp_path).error


def put(text: str, key: str, value: str) -> str:
    """answers.toml with this text behind an entry of the task `extra_draft`."""
    begin = text.index(f"\n{key} = ", text.index("[extra_draft]"))
    return f"{text[:begin]}\n{key} = {value}{text[text.index(chr(10), begin + 1) :]}"


SLIPS = {  # what is written, and what the message says
    "0,031": "write 0.031", "0.031 m": '"0.031 m"', ".031": "write 0.031", "deeper": '"deeper"', "”0.031”": "straight",
    "“0.031“": "straight", '"0.031': "quotation mark is missing", '0.031"': "quotation mark is missing",
    '"it "floats""': "within it", '"first\nsecond"': "several lines", "": "no answer yet", "nan": "number such as 0.5",
    "inf": "number such as 0.5", "[0.1]": "number such as 0.5", "true": "number such as 0.5", "3 1": "quotation marks",
    "≈ 3": "quotation marks", "0,031 # by hand": "quotation marks", "90/800": "quotation marks",
}  # fmt: skip


@pytest.mark.parametrize("value", SLIPS)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_slip_costs_one_answer_which_is_named_with_its_line_and_cure(
    tmp_path: Path, value: str, newline: str
) -> None:
    task = next(task for task in TASKS if task.name == "extra_draft")
    measure = next(question for question in task.questions if question.key == "measure")
    full = answers_text(TASKS, right_answers(TASKS)._replace(name="Åsa"))
    text = put(full, "measure", value)
    (tmp_path / FILE).write_bytes(text.replace("\n", newline).encode())
    found, whole = read_answers(tmp_path), right_answers(TASKS).values
    assert found.name == "Åsa"
    assert {**found.values, ("extra_draft", "measure"): 0} == {**whole, ("extra_draft", "measure"): 0}
    assert "extra_draft.measure, line" in found.error
    verdict = check_answer(measure, found.of(task, measure), found.unread_of(task, measure))
    assert verdict.state == "wrong"
    assert SLIPS[value] in verdict.text
    line = text[: text.index("\nmeasure = ", text.index("[extra_draft]")) + 1].count("\n") + 1
    assert f"Line {line}:" in verdict.text


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-16", "utf-8-sig"])
def test_a_file_of_another_encoding_is_read_and_written_as_utf_8(tmp_path: Path, encoding: str) -> None:
    text = put(answers_text(TASKS, Answers("Åsa", {})), "explain", '"lådan flyter på vattnet"')
    (tmp_path / FILE).write_bytes(text.encode(encoding, "replace"))
    found = read_answers(tmp_path)
    assert (found.name, found.error) == ("Åsa", "")
    assert found.values["extra_draft", "explain"] == "lådan flyter på vattnet"
    change_answer(tmp_path, TASKS, found, "extra_draft", "measure", 0.031)
    assert "lådan flyter på vattnet" in (tmp_path / FILE).read_bytes().decode("utf-8")


def test_backslashes_stay(tmp_path: Path) -> None:
    written = {
        r"\rho g V": r"\rho g V",
        r"\\rho": r"\rho",
        r"C:\Users\x": r"C:\Users\x",
        r"\u00e5 and \"it\"": 'å and "it"',
    }
    for text, meant in written.items():
        (tmp_path / FILE).write_text(put(answers_text(TASKS, Answers("", {})), "explain", f'"{text}"'), "utf-8")
        found = read_answers(tmp_path)
        assert (found.error, found.values["extra_draft", "explain"]) == ("", meant)
        change_answer(tmp_path, TASKS, found, "extra_draft", "explain", meant)
        assert read_answers(tmp_path).values["extra_draft", "explain"] == meant


def test_a_choice_may_have_capitals_and_a_misspelt_entry_is_named(tmp_path: Path) -> None:
    assert check_answer(CHOICE, "A").state == "right"
    text = answers_text(TASKS, Answers("", {})) + "\n[gravity]\nmeasured = 0.5\n"
    (tmp_path / FILE).write_text(text.replace("[gravity]\n", "[gravities]\n", 1), "utf-8")
    assert any("gravity.measured" in said for said in strangers(read_answers(tmp_path), TASKS))


# Sixty ways to write ten numbers: each is read, and as the panel reads it.
WAYS = {
    0.1125: ("0.1125", "0,1125", ".1125", "1.125e-1", "1,125E-01", "1.125*10^-1", "1.125 x 10^-1", "9/80", "0.1125 m",
             "11.25 cm", "112.5 mm", "0,1125m", "1.125 · 10⁻¹ m"),
    -0.5: ("-0.5", "−0.5", "-0,5", "-1/2", "–0.5", "-50 cm", "-5e-1"),
    4004001.0: ("4004001", "4,004,001", "4 004 001", "4004001.0", "4.004001e6", "4'004'001", "4\u00a0004\u00a0001"),
    30000.0: ("30000", "3e4", "30k", "30 km", "3.0*10^4", "30 000", "30000,0"),
    1.0: ("1", "1.0", "1,0", "100 cm", "1e0", "1 m"), 0.02: ("0.02", "2 cm", "0,02 m", "2e-2", "1/50", "20 mm"),
    1e-6: ("1e-6", "1 µm", "1 um", "10^-6", "0.000001"), 12.0: ("12", "12.", "12,0", "+12", "0.012 km"),
    0.0: ("0", "0.0", "0 m", "0,0"), 1234.5: ("1234.5", "1,234.5", "1.234,5", "1 234,5", "1234,5 m", "1.2345 km"),
}  # fmt: skip


def test_file_and_panel_read_numbers_alike() -> None:
    question = Question("n", "?", "number", unit="m")
    assert sum(map(len, WAYS.values())) >= 60
    for value, ways in WAYS.items():
        for text in ways:
            assert check_answer(question, text).answer == pytest.approx(value), text
            assert answer_of(question, text) == pytest.approx(value), text
    for text in ("30,000", "4,004,00", "half", "3 kg", "1.2.3"):
        assert check_answer(question, text).state == "wrong"
        with pytest.raises(ValueError, match="not saved"):
            answer_of(question, text)
    assert "two things" in check_answer(question, "30,000").text


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
from app.lab.student.workbook import answer_of
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
        (NUMBER, "two", "wrong", "“two” is not read: not a number"), (NUMBER, None, "not begun", ""),
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
