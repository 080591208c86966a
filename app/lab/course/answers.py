"""`answers.toml`: the student's name and answers. It is read leniently and written completely or not at all."""

import json
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from app.lab.course.task import Question, Task
from sim.files import replacing

FILE = "answers.toml"
MAX_SIZE = 2**20  # [bytes] of a file that is read
ENCODING = "utf-8-sig"  # for reading: some editors begin a file with a byte order mark
LINE = 100  # characters of a comment's line
NAME = re.compile(r"(?m)\Aname *=.*?(?=\r?$)|(?<=\n)name *=.*?(?=\r?$)")  # the line with the student's name
QUOTES = ('"""', "'''")  # around a text of several lines

DONE = "done"  # key of the completed steps
SHOWN = "answer_shown"  # key of a viewed answer, after which the prediction is fixed

Value = str | float


class Answers(NamedTuple):
    """Contents of answers.toml. error: why it could not be read, or ""."""

    name: str
    values: Mapping[tuple[str, str], Value]  # by task and question
    error: str = ""

    def of(self, task: Task, question: Question) -> Value | None:
        """The answer, or None; a number as a number, even if written as text."""
        value = self.values.get((task.name, question.key))
        if isinstance(value, str):
            value = value.strip()
        if question.kind == "number" and isinstance(value, str):
            value = number_in(value)
        if value == "" or (isinstance(value, float) and not math.isfinite(value)):
            return None
        return value

    def done(self, task: Task) -> frozenset[int]:
        """Numbers of the completed steps, from 1."""
        text = str(self.values.get((task.name, DONE), ""))
        return frozenset(int(word) for word in text.split() if word.isdecimal() and len(word) < 3)

    def is_shown(self, task: Task) -> bool:
        """True if the answer was viewed in the panel."""
        return self.values.get((task.name, SHOWN)) == "yes"


def number_in(text: str) -> Value:
    """The number in a text, with a point or a comma; the text itself without one."""
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return text


def read_answers(folder: Path) -> Answers:
    """The answers in a student's folder. Raises nothing: `error` says why a file cannot be read."""
    path = folder / FILE
    try:
        if path.stat().st_size > MAX_SIZE:
            return Answers("", {}, f"{FILE} is larger than {MAX_SIZE // 2**20} MiB")
        table = tomllib.loads(path.read_text(ENCODING))
    except OSError as error:
        return Answers("", {}, f"{FILE}: {error.strerror}")
    except (ValueError, RecursionError) as error:  # no TOML, no UTF-8, or a number of more digits than Python reads
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
    """A number of a TOML file as a float; infinite if it is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def change_answer(folder: Path, tasks: Sequence[Task], answers: Answers, task: str, key: str, value: Value) -> None:
    """Change one value of answers.toml. answers: those in the file. Raises OSError if that cannot be done.

    The file is whole at every moment. All the rest stays as it is, comments too, unless the file is written in a way
    that leaves no place for the value; then it is rewritten.
    """
    path = folder / FILE
    # As bytes, so that lines end as they did.
    text = path.read_bytes().decode(ENCODING) if path.exists() else ""
    changed = with_value(text, task, key, value)
    if changed is None:
        changed = answers_text(tasks, Answers(answers.name, {**answers.values, (task, key): value}))
    with replacing(path) as draft:
        draft.write_bytes(changed.encode())


def change_name(folder: Path, tasks: Sequence[Task], answers: Answers, name: str) -> None:
    """Change the student's name, as `change_answer` does a value. Raises OSError if that cannot be done."""
    path = folder / FILE
    text = path.read_bytes().decode(ENCODING) if path.exists() else ""
    changed = NAME.sub(lambda _: f"name = {quoted(name)}", text, count=1)
    if not is_toml(changed) or exact(changed) != {**exact(text), "name": name}:
        changed = answers_text(tasks, answers._replace(name=name))
    with replacing(path) as draft:
        draft.write_bytes(changed.encode())


def with_value(text: str, task: str, key: str, value: Value) -> str | None:
    """The text of answers.toml with one value changed and no other line; None if there is no plain place for it."""
    lines = text.split("\n")
    heads = [i for i, line in enumerate(lines) if line.strip() == f"[{task}]"]
    if not heads:  # a task without questions has no heading at first
        end = "\r" if "\r\n" in text else ""
        lines = [*text.removesuffix("\n").split("\n"), end, f"[{task}]{end}", ""]
        heads = [len(lines) - 2]
    if len(heads) != 1:
        return None
    begin = heads[0] + 1
    end = next((i for i in range(begin, len(lines)) if lines[i].startswith("[")), len(lines))
    assigns = re.compile(rf'\s*"?{re.escape(key)}"?\s*=')
    first = next((i for i in range(begin, end) if assigns.match(lines[i])), None)
    if first is None:  # above the comments of the next heading
        is_text = [bool(line.strip()) and (line[0] != "#" or line.rstrip()[-3:] in QUOTES) for line in lines]
        first = after = next(i for i in range(end, begin - 1, -1) if i == begin or is_text[i - 1])
    else:
        quotes = next((mark for mark in QUOTES if mark in lines[first]), "")
        ends = (i for i in range(first + 1, end + 1) if quotes in lines[i - 1])
        after = next((i for i in ends if not quotes or is_toml("\n".join(lines[first:i]))), first)
    assignment = f"{key} = {quoted(value)}"
    if "\r\n" in text:
        assignment = assignment.replace("\n", "\r\n") + "\r"
    changed = "\n".join([*lines[:first], assignment, *lines[after:]]).removesuffix("\r")
    table = exact(text)
    entries = table.get(task, {})
    if not isinstance(entries, dict):
        return None
    expected = {**table, task: {**entries, **exact(f"{key} = {quoted(value)}")}}
    # A line within a text may look like a heading or like an assignment: then the file does not say what it should.
    return changed if is_toml(changed) and exact(changed) == expected else None


def exact(text: str) -> dict[str, Any]:
    """A TOML file with its floats as they are written, because NaN differs from itself. Raises ValueError."""
    return tomllib.loads(text, parse_float=lambda digits: ("float", digits))


def is_toml(text: str) -> bool:
    """True if a text is TOML."""
    try:
        tomllib.loads(text)
    except (ValueError, RecursionError):
        return False
    return True


def answers_text(tasks: Sequence[Task], answers: Answers) -> str:
    """The text of answers.toml, with the questions as comments. Answers of unknown questions are kept."""
    left = dict(answers.values)
    lines = [
        "# Your answers. Write between the quotation marks; a number needs none.",
        "# A prediction cannot be changed later: write it down before you try.",
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
        rest = [key for owner, key in left if owner == task.name]  # other entries of the workbook, and former questions
        lines += ["", *(f"{quoted(key)} = {quoted(left.pop((task.name, key)))}" for key in rest)] if rest else []
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
    """A text in lines of at most `LINE` characters, if its words allow."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > LINE:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines
