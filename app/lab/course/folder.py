"""`springtide lab new`: the student's folder, made from the tasks."""

import ast
import inspect
import os
import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path

from app.lab.course.answers import FILE, Answers, Value, answers_text
from app.lab.course.task import Task
from sim.validation import argument_error

PICTURES = "pictures"  # folder for pictures of the screen, which the report shows
MAX_PICTURES = 60  # that the report shows


def check_is_folder(folder: Path) -> None:
    """Raises ValueError if the folder does not exist."""
    if not folder.is_dir():
        what = "not a folder" if folder.exists() else "no such folder"
        raise ValueError(f"DIR: {folder}: {what}; `springtide lab new DIR` makes one with the exercises")


def folder_names(folders: Iterable[Path]) -> dict[Path, str]:
    """A unique name for each folder: the last part of its path, with as many parts before it as necessary.

    Two paths of one folder have the same name.
    """
    paths = {folder: Path(os.path.abspath(folder)) for folder in folders}
    names = {}
    for folder, path in paths.items():
        others = set(paths.values()) - {path}
        ends = (path.parts[-count:] for count in range(1, len(path.parts) + 1))
        own = next((end for end in ends if not any(other.parts[-len(end) :] == end for other in others)), path.parts)
        names[folder] = Path(*own).as_posix()
    return names


def make_folder(folder: Path, tasks: Sequence[Task], *, solutions: bool = False) -> list[Path]:
    """Write the exercises into a new or empty folder; returns the files. solutions: with the reference solutions.

    Raises ValueError if the folder holds something, OSError if it cannot be written.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise argument_error("DIR", str(folder), "a new or empty folder")
    return add_exercises(folder, tasks, solutions=solutions)


def add_exercises(folder: Path, tasks: Sequence[Task], *, solutions: bool = False) -> list[Path]:
    """Write the exercises into a folder without touching existing files; returns the files written.

    The answers come last: with them a folder is complete. Raises OSError if the folder cannot be written.
    """
    texts = {name: file_text(name, tasks, solutions=solutions) for name in files_of(tasks)}
    texts["README.md"] = readme_text(folder.absolute().name, tasks)
    texts[FILE] = answers_text(tasks, right_answers(tasks) if solutions else Answers("", {}))
    (folder / PICTURES).mkdir(parents=True, exist_ok=True)
    missing = [folder / name for name in texts if not (folder / name).exists()]
    for path in missing:
        path.write_text(texts[path.name], "utf-8")
    return missing


def files_of(tasks: Sequence[Task]) -> list[str]:
    """The Python files of the programming tasks, in the order of the lab."""
    return list(dict.fromkeys(task.file for task in tasks if task.file))


def file_text(name: str, tasks: Sequence[Task], *, solutions: bool) -> str:
    """A Python file with its functions, as stubs or as in the reference."""
    own = [task for task in tasks if task.file == name]
    head = (
        '"""Your functions. Write each body in place of the three dots; `springtide lab check` tests it."""'
        "\n\nimport numpy as np\n"
    )
    blocks = [
        f"\n\n# {task.item}{' (optional)' if task.optional else ''}  {task.title}\n"
        + (inspect.getsource(task.function) if solutions else stub(task))
        for task in own
    ]
    return head + "".join(blocks)


def stub(task: Task) -> str:
    """The function with its docstring, and `...` as body."""
    source = inspect.getsource(task.function)
    node = ast.parse(source).body[0]
    assert isinstance(node, ast.FunctionDef)
    lines = source.splitlines()[: node.body[0].end_lineno]
    return "\n".join(lines) + "\n    ...\n"


def right_answers(tasks: Sequence[Task]) -> Answers:
    """Right answers to all questions, for the teacher: of a prediction any, of a text the explanation of the task."""
    values: dict[tuple[str, str], Value] = {}
    for task in tasks:
        for question in task.questions:
            if question.right is not None:
                value = question.right
            elif question.kind == "choice":
                value = question.choices[0]
            elif question.kind == "number":
                value = 1.0
            else:
                value = question.why or "Any sentence counts; the teacher reads it."
            values[task.name, question.key] = value
    return Answers("Reference solutions", values)


def readme_text(name: str, tasks: Sequence[Task]) -> str:
    """The README of the student's folder: instructions and every task."""
    mandatory, quoted = sum(not task.optional for task in tasks), shlex.quote(name)
    lines = [
        "# Springs and waves: the lab",
        "",
        f"{mandatory} tasks, and {len(tasks) - mandatory} optional ones. For each one:",
        "",
        "1. Read it below. Predict first: write your prediction into `answers.toml`.",
        "2. Write the function, if the task has one. The docstring has the equation, the units and the shapes.",
        "3. Look at it in Springtide.",
        "4. Check your work. Check as often as you like.",
        f"5. Answer the questions, in the panel or in `{FILE}`. Write your name there too.",
        "",
        "Run these commands in the folder above this one:",
        "",
        f"- `springtide lab {quoted}` opens the scenes in a browser. They run your functions as you save them.",
        "  The tab Lab of the panel has the tasks below. It sets them up, saves your answers and takes pictures.",
        f"- `springtide lab check {quoted}` says what is right, and what is wrong and why.",
        f"- `springtide lab check {quoted} --report report.html` writes the page that you hand in.",
        f"  It includes the pictures (PNG or JPEG) in `{PICTURES}`; those named after a task appear in that task.",
        "",
        "Functions take and return numpy arrays and numbers. Loops are as good as array operations. You may add",
        "functions and files of your own.",
    ]
    section = ""
    for task in tasks:
        if task.item.partition("-")[0] != section:
            section = task.item.partition("-")[0]
            lines += ["", f"## {heading_of(section)}"]
        lines += ["", f"### {task.item} {task.title}{' (optional)' if task.optional else ''}", "", task.statement]
        if task.file:
            lines += ["", f"Write `{task.name}` in `{task.file}`."]
        if task.setup is not None:
            preset = f' --preset "{task.setup.preset}"' if task.setup.preset else ""
            scene = f"--scene {task.setup.scene}{preset}"
            lines += ["", f"See it: `springtide lab {quoted} {scene}`. {task.setup.look}"]
        if task.questions:
            lines += ["", "Questions:", *(f"- `{question.key}`: {question.ask}" for question in task.questions)]
    return "\n".join(lines) + "\n"


def heading_of(section: str) -> str:
    """Heading of the tasks of a section: 4 is the program's own, the course lab ends with 3."""
    return "Beyond the course lab" if section.startswith("4") else f"Section {section} of the course lab"
