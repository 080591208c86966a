"""`answers.toml`: the student's name and answers. It is read leniently and written whole or not at all."""

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.task import Question, Task
from sim.files import replacing

FILE = "answers.toml"
MAX_SIZE = 2**20  # [bytes] of a file that is read
LINE = 100  # characters of a comment's line

Value = str | float


class Answers(NamedTuple):
    """What answers.toml holds. error: why it could not be read, or ""."""

    name: str
    values: Mapping[tuple[str, str], Value]  # by task and question
    error: str = ""

    def of(self, task: Task, question: Question) -> Value | None:
        """The answer, None where there is none; a number as a number, also where it was written as text."""
        value = self.values.get((task.name, question.key))
        if isinstance(value, str):
            value = value.strip()
        if question.kind == "number" and isinstance(value, str):
            value = number_in(value)
        if value == "" or (isinstance(value, float) and not math.isfinite(value)):
            return None
        return value


def number_in(text: str) -> Value:
    """The number that a text holds, with a point or a comma; the text where it holds none."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return text


def read_answers(folder: Path) -> Answers:
    """The answers in a student's folder. Raises nothing: what cannot be read is said in `error`."""
    path = folder / FILE
    try:
        if path.stat().st_size > MAX_SIZE:
            return Answers("", {}, f"{FILE} is larger than {MAX_SIZE // 2**20} MiB")
        table = tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        return Answers("", {}, f"{FILE}: {error.strerror}")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        return Answers("", {}, f"{FILE}: {error}")
    values: dict[tuple[str, str], Value] = {}
    for task, entries in table.items():
        for key, value in entries.items() if isinstance(entries, dict) else ():
            if isinstance(value, int | float) and not isinstance(value, bool):
                values[task, key] = as_number(value)
            elif isinstance(value, str):
                values[task, key] = value
    return Answers(str(table.get("name", "")).strip(), values)


def as_number(value: int | float) -> float:
    """A number of a TOML file as a float; infinite where it is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def write_answers(folder: Path, tasks: Sequence[Task], answers: Answers) -> None:
    """Write answers.toml, with the questions as comments. Raises OSError where that cannot be done.

    The file is whole at every moment. Answers to questions that no task asks are kept.
    """
    with replacing(folder / FILE) as draft:
        draft.write_text(answers_text(tasks, answers), "utf-8")


def answers_text(tasks: Sequence[Task], answers: Answers) -> str:
    """The text of answers.toml."""
    left = dict(answers.values)
    lines = [
        "# Your answers. Write between the quotation marks; a number needs none.",
        "# A prediction is kept as you made it: write it down before you try.",
        "",
        f"name = {quoted(answers.name)}",
    ]
    for task in tasks:
        if not task.questions:
            continue
        lines += ["", "", f"# {task.item}{' (optional)' if task.optional else ''}  {task.title}", f"[{task.name}]"]
        for question in task.questions:
            lines += ["", *(f"# {line}" for line in wrapped(question.ask))]
            if question.kind == "choice":
                lines += ["# Choose one of: " + ", ".join(quoted(choice) for choice in question.choices)]
            elif question.kind == "number":
                lines += [f"# A number{f' in {question.unit}' if question.unit else ''}"]
            lines += [f"{question.key} = {quoted(left.pop((task.name, question.key), ''))}"]
    for name in sorted({name for name, _ in left}):
        lines += ["", "", f"[{quoted(name)}]"]
        lines += [f"{quoted(key)} = {quoted(value)}" for (owner, key), value in left.items() if owner == name]
    return "\n".join(lines) + "\n"


def quoted(value: Value) -> str:
    """A value as TOML writes it."""
    if not isinstance(value, str):
        return repr(value)
    text = value.encode("utf-8", "replace").decode("utf-8")  # no half of a pair of code units
    lines = [json.dumps(line, ensure_ascii=False)[1:-1].replace("\x7f", "\\u007f") for line in text.split("\n")]
    return f'"{lines[0]}"' if len(lines) == 1 else '"""\n' + "\n".join(lines) + '"""'


def wrapped(text: str) -> list[str]:
    """A text in lines of at most `LINE` characters, as far as its words allow."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > LINE:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines
