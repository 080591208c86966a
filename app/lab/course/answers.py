"""`answers.toml`: the student's name and answers. It is read leniently and written completely or not at all."""

import difflib
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from app.lab.course.answers_text import Unread, is_toml, loads, read_entries
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
    """Contents of answers.toml. error: its unreadable parts in words, or "".

    unread: the entries that could not be read, by task and question; all others are in `values`.
    """

    name: str
    values: Mapping[tuple[str, str], Value]  # by task and question
    error: str = ""
    unread: Mapping[tuple[str, str], Unread] = {}
    is_broken: bool = False  # the file is no TOML, or cannot be opened

    def of(self, task: Task, question: Question) -> Value | None:
        """The answer as it is written, or None."""
        value = self.values.get((task.name, question.key))
        if isinstance(value, str):
            value = value.strip()
        return None if value == "" else value

    def unread_of(self, task: Task, question: Question) -> Unread | None:
        """The answer if it could not be read, or None."""
        return self.unread.get((task.name, question.key))

    def done(self, task: Task) -> frozenset[int]:
        """Numbers of the completed steps, from 1."""
        text = str(self.values.get((task.name, DONE), ""))
        return frozenset(int(word) for word in text.split() if word.isdecimal() and len(word) < 3)

    def is_shown(self, task: Task) -> bool:
        """True if the answer was viewed in the panel."""
        return self.values.get((task.name, SHOWN)) == "yes"


def read_answers(folder: Path) -> Answers:
    """The answers in a student's folder. Raises nothing: `error` names unreadable parts."""
    path = folder / FILE
    try:
        if path.stat().st_size > MAX_SIZE:
            return Answers("", {}, f"{FILE} is larger than {MAX_SIZE // 2**20} MiB", is_broken=True)
        text = decoded(path.read_bytes())
    except OSError as error:
        return Answers("", {}, f"{FILE}: {error.strerror}", is_broken=True)
    unread: dict[tuple[str, str], Unread] = {}
    wrong, is_broken = "", False
    try:
        table = loads(text)
    except (ValueError, RecursionError) as error:  # no TOML, or a number of more digits than Python reads
        table, unread, wrong = read_entries(text)
        wrong, is_broken = wrong or ("" if unread else str(error)), True
    values: dict[tuple[str, str], Value] = {}
    for task, entries in table.items():
        for key, value in entries.items() if isinstance(entries, dict) else ():
            if isinstance(value, str) or (isinstance(value, int | float) and is_finite(value)):
                values[task, key] = value if isinstance(value, str) else float(value)
            else:
                line = next((i for i, line in enumerate(text.split("\n"), 1) if re.match(rf"\s*{key}\s*=", line)), 0)
                unread[task, key] = Unread(
                    line, toml_text(value), "write a number such as 0.5, or a text in quotation marks"
                )
    said = [wrong] if wrong else []
    said += [f"{'.'.join(part for part in key if part)}, {entry.sentence}" for key, entry in unread.items()]
    rest = f" ({len(said) - 1} more)" if len(said) > 1 else ""
    error = f"{FILE}: {said[0]}{rest}" if said else ""
    return Answers(str(table.get("name", "")).strip(), values, error, unread, is_broken)


def decoded(data: bytes) -> str:
    """The text of a file in the encoding that an editor of any country may have used."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", "replace")
    try:
        return data.decode(ENCODING)
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def is_finite(value: int | float | bool) -> bool:
    """True for a number that a float can have."""
    try:
        return not isinstance(value, bool) and math.isfinite(float(value))
    except OverflowError:
        return False


def toml_text(value: Any) -> str:
    """A value of TOML as it is written, about."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def strangers(answers: Answers, tasks: Sequence[Task]) -> list[str]:
    """Sentences on entries that belong to no question, such as a misspelt one."""
    known = {(task.name, question.key) for task in tasks for question in task.questions}
    sentences = []
    for task, key in answers.values:
        if (task, key) not in known and key not in (DONE, SHOWN) and answers.values[task, key] != "":
            near = difflib.get_close_matches(key, [other for name, other in known if name == task], 1)
            sentences.append(f"{FILE} {task}.{key}: there is no such question{f'; is it {near[0]}?' if near else ''}")
    return sentences


def change_answer(folder: Path, tasks: Sequence[Task], answers: Answers, task: str, key: str, value: Value) -> None:
    """Change one value of answers.toml. answers: those in the file. Raises OSError if that cannot be done.

    The file is whole at every moment. All the rest stays as it is, comments too, unless the file is written in a way
    that leaves no place for the value; then it is rewritten.
    """
    path = folder / FILE
    # As bytes, so that lines end as they did.
    text = decoded(path.read_bytes()) if path.exists() else ""
    changed = with_value(text, task, key, value)
    if changed is None:
        changed = answers_text(tasks, Answers(answers.name, {**answers.values, (task, key): value}))
    with replacing(path) as draft:
        draft.write_bytes(changed.encode())


def change_name(folder: Path, tasks: Sequence[Task], answers: Answers, name: str) -> None:
    """Change the student's name, as `change_answer` does a value. Raises OSError if that cannot be done."""
    path = folder / FILE
    text = decoded(path.read_bytes()) if path.exists() else ""
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
    return loads(text, parse_float=lambda digits: ("float", digits))


def answers_text(tasks: Sequence[Task], answers: Answers) -> str:
    """The text of answers.toml, with the questions as comments. Answers of unknown questions are kept."""
    left = dict(answers.values)
    lines = [
        '# Your answers. Write between the quotation marks. A number may have its unit: "11.25 cm".',
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
    """A value as TOML writes it, without the short escapes, which are read as backslashes."""
    if not isinstance(value, str):
        return repr(value)
    text = value.encode("utf-8", "replace").decode("utf-8")  # no half of a pair of code units
    lines = ["".join(map(written, line)) for line in text.split("\n")]
    return f'"{lines[0]}"' if len(lines) == 1 else '"""\n' + "\n".join(lines) + '"""'


def written(character: str) -> str:
    """One character of a text of TOML."""
    if character in '"\\':
        return f"\\{character}"
    is_control = (character < " " and character != "\t") or character == "\x7f"
    return f"\\u{ord(character):04x}" if is_control else character


def wrapped(text: str) -> list[str]:
    """A text in lines of at most `LINE` characters, if its words allow."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > LINE:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines
