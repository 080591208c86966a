"""The tasks of the lab: each is a TOML file in a folder and, for what is to be programmed, a Python file of that name.

A task is found by being there. The TOML file holds its words and questions; the Python file holds the reference
solution, a function named as the file, and what its check needs (`checking.py`). docs/lab.md shows a whole example.
"""

import dataclasses
import importlib.util
import inspect
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

from app.lab.live_values import Condition, names_in, read_conditions
from sim.parameters import Value
from sim.validation import argument_error, as_float

TASKS = Path(__file__).parent / "tasks"  # those of the course
NAME = re.compile(r"[a-z][a-z0-9_]*")
QUESTION_KINDS = ("choice", "number", "text")
PREDICTION = "predict"  # key of the question that is answered before


@dataclasses.dataclass(frozen=True)
class TypicalError:
    """A wrong answer that says what was misunderstood."""

    answer: str | float
    text: str


@dataclasses.dataclass(frozen=True)
class Question:
    """One question. A prediction is kept, and is neither right nor wrong; a text is for the teacher to judge."""

    key: str
    ask: str
    kind: str  # "choice", "number" or "text"
    choices: tuple[str, ...] = ()
    unit: str = ""
    right: str | float | None = None  # None: any answer counts
    tolerance: float = 0.05  # of a number, relative to the right one
    why: str = ""  # the explanation that the check gives
    read_off: str = ""  # name of the live value that answers it, or ""
    typical_errors: tuple[TypicalError, ...] = ()

    @property
    def part(self) -> str:
        """The part of the task that it belongs to: "Predict", "Measure" or "Explain"."""
        return "Predict" if self.key == PREDICTION else "Explain" if self.kind == "text" else "Measure"

    def is_near(self, answer: float, value: float) -> bool:
        """Whether a number counts as this value."""
        return abs(answer - value) <= self.tolerance * abs(value)


@dataclasses.dataclass(frozen=True)
class Setup:
    """Where in Springtide the task can be seen."""

    scene: str
    preset: str
    look: str  # what to do and to look at
    parameters: Mapping[str, Value] = dataclasses.field(default_factory=dict[str, Value])  # beside the preset
    show: tuple[str, ...] = ()  # names of the live values to keep in sight


@dataclasses.dataclass(frozen=True)
class Step:
    """Something to do in the scene. The workbook ticks it off once all conditions hold at the same moment."""

    text: str
    when: tuple[Condition, ...]


@dataclasses.dataclass(frozen=True)
class Guide:
    """An item of the course lab for those who look only: its question and its answer."""

    question: str  # in our own words
    law: tuple[str, ...]  # formulas, as `app/render/formula.py` reads them
    answer: str  # with the names of live values in braces
    needs: tuple[Condition, ...]  # for which the answer holds


@dataclasses.dataclass(frozen=True)
class Task:
    """One task of the lab."""

    name: str
    item: str  # of the course lab: its section, a hyphen, its number
    title: str
    statement: str
    optional: bool
    file: str  # the student's file of a programming task, or ""
    order: int  # among the tasks of one item
    setup: Setup | None
    guide: Guide | None  # of the first task of an item
    steps: tuple[Step, ...]
    questions: tuple[Question, ...]
    check: ModuleType | None  # of a programming task; None where checks were not asked for

    @property
    def function(self) -> Any:
        """The reference solution of a programming task."""
        return getattr(self.check, self.name)

    @property
    def arguments(self) -> tuple[str, ...]:
        """The names of the function's arguments."""
        return tuple(inspect.signature(self.function).parameters)


def load_tasks(*folders: Path, with_checks: bool = True) -> tuple[Task, ...]:
    """The tasks of the course and of these folders, in the order of the lab; a later one replaces one of its name.

    with_checks: run the Python files too, which takes much longer than reading the texts.

    Raises ValueError for a file that is no task, with the file's name and what is wrong.
    """
    found: dict[str, Task] = {}
    for folder in (TASKS, *folders):
        if not folder.is_dir():
            raise argument_error("--tasks", str(folder), "a folder with tasks in TOML files")
        for path in sorted(folder.glob("*.toml")):
            found[path.stem] = read_task(path, with_checks=with_checks)
    return tuple(sorted(found.values(), key=position))


def position(task: Task) -> tuple[tuple[int, ...], int, str]:
    """Where a task stands in the lab."""
    return tuple(int(number) for number in re.findall(r"\d+", task.item)), task.order, task.name


def read_task(path: Path, *, with_checks: bool = True) -> Task:
    """The task in a TOML file. Raises ValueError for one that is not complete."""
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise argument_error("task", str(path), f"a TOML file ({error})") from None
    if not NAME.fullmatch(path.stem):
        raise argument_error("task", path.name, "a file name of small letters, digits and underscores")
    rest = Table(path.name, table)
    code = path.with_suffix(".py")
    setup, guide = rest.sub("setup"), rest.sub("guide")
    task = Task(
        name=path.stem,
        item=rest.text("item"),
        title=rest.text("title"),
        statement=rest.text("statement"),
        optional=rest.flag("optional"),
        file=rest.text("file") if code.exists() else "",
        order=int(rest.number("order", 0)),
        setup=None if setup is None else read_setup(setup),
        guide=None if guide is None else read_guide(guide),
        steps=tuple(read_step(entry) for entry in rest.subs("do")),
        questions=tuple(read_question(entry) for entry in rest.subs("question")),
        check=load_check(code) if with_checks and code.exists() else None,
    )
    rest.end()
    if not re.fullmatch(r"\d+\.\d+-\d+", task.item):
        raise argument_error(f"{path.name}: item", task.item, "a section, a hyphen and a number, as in 3.2-1")
    if task.file and not (task.file.endswith(".py") and NAME.fullmatch(task.file[:-3])):
        raise argument_error(f"{path.name}: file", task.file, "the name of a Python file")
    if not task.file and not task.questions:
        raise argument_error("task", path.name, "a Python file of the same name beside it, or questions")
    keys = [question.key for question in task.questions]
    if len(set(keys)) < len(keys):
        raise argument_error(f"{path.name}: question", ", ".join(keys), "a key of its own for each question")
    return task


def read_setup(table: "Table") -> Setup:
    """The set-up of a TOML file. Raises ValueError for one that is not complete."""
    setup = Setup(
        scene=table.text("scene"),
        preset=table.text("preset", ""),
        look=table.text("look"),
        parameters=table.mapping("parameters", {}),
        show=table.texts("show"),
    )
    table.end()
    return setup


def read_guide(table: "Table") -> Guide:
    """The guide of a TOML file. Raises ValueError for one that is not complete."""
    needs = read_conditions(table.file, table.mapping("needs", {}))
    guide = Guide(table.text("question"), table.texts("law"), table.text("answer"), needs)
    table.end()
    try:
        names_in(guide.answer)
    except ValueError as error:
        raise argument_error(f"{table.file}: answer", guide.answer, f"names in braces ({error})") from None
    return guide


def read_step(table: "Table") -> Step:
    """Something to do, of a TOML file. Raises ValueError for one that is not complete."""
    step = Step(table.text("text"), read_conditions(table.file, table.mapping("when")))
    table.end()
    if not step.when:
        raise argument_error(f"{table.file}: when", "none", "at least one condition")
    return step


def read_question(table: "Table") -> Question:
    """A question of a TOML file. Raises ValueError for one that cannot be answered."""
    kind = table.text("kind")
    right = table.value("right", None)
    errors = tuple(TypicalError(entry.value("answer"), entry.text("text")) for entry in table.subs("typical_error"))
    question = Question(
        key=table.text("key"),
        ask=table.text("ask"),
        kind=kind,
        choices=tuple(str(choice) for choice in table.value("choices", ())),
        unit=table.text("unit", ""),
        right=right if kind != "number" or right is None else as_float(right),
        tolerance=table.number("tolerance", 0.05),
        why=table.text("why", ""),
        read_off=table.text("read_off", ""),
        typical_errors=errors,
    )
    table.end()
    where = f"{table.file}: question {question.key}"
    if not NAME.fullmatch(question.key):
        raise argument_error(where, question.key, "a key of small letters, digits and underscores")
    if kind not in QUESTION_KINDS:
        raise argument_error(where, kind, "one of " + ", ".join(QUESTION_KINDS))
    if kind == "choice" and (len(question.choices) < 2 or right not in (None, *question.choices)):
        raise argument_error(where, right, "at least two choices, one of them the right one")
    if kind == "number" and not math.isfinite(as_float(0.0 if right is None else right)):
        raise argument_error(where, right, "a finite number")
    if kind == "text" and right is not None:
        raise argument_error(where, right, "no right answer: a text is judged by the teacher")
    return question


def load_check(path: Path) -> ModuleType:
    """The Python file of a programming task. Raises ValueError where it lacks a part."""
    spec = importlib.util.spec_from_file_location(f"springtide_task_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # whatever a teacher's file does
        raise argument_error("task", path.name, f"Python that runs ({type(error).__name__}: {error})") from None
    for part in (path.stem, "inputs"):
        if not callable(getattr(module, part, None)):
            raise argument_error("task", path.name, f"a function {part}")
    if not (getattr(module, path.stem).__doc__ or "").strip():
        raise argument_error("task", path.name, f"a docstring of {path.stem}: students read it")
    return module


class Table:
    """A table of a TOML file that is read entry by entry; what is left over at the end is an error."""

    def __init__(self, file: str, entries: Mapping[str, Any]) -> None:
        self.file = file
        self.entries = dict(entries)

    def value(self, key: str, *default: Any) -> Any:
        """Any entry. Raises ValueError where it is missing and has no default."""
        if key not in self.entries and not default:
            raise argument_error(self.file, sorted(self.entries), f"an entry {key}")
        return self.entries.pop(key, *default)

    def text(self, key: str, *default: str) -> str:
        """A text without blanks at its ends. Raises ValueError for another type."""
        value = self.value(key, *default)
        if not isinstance(value, str):
            raise argument_error(f"{self.file}: {key}", value, "a text")
        return value.strip()

    def texts(self, key: str) -> tuple[str, ...]:
        """A list of texts, or one text; empty where the entry is missing. Raises ValueError for another value."""
        value = self.value(key, [])
        found = [value] if isinstance(value, str) else value
        if not isinstance(found, list) or not all(isinstance(text, str) for text in found):
            raise argument_error(f"{self.file}: {key}", value, "texts")
        return tuple(found)

    def number(self, key: str, default: float) -> float:
        """A finite number. Raises ValueError for another value."""
        value = self.value(key, default)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise argument_error(f"{self.file}: {key}", value, "a finite number")
        return float(value)

    def flag(self, key: str) -> bool:
        """true or false; false where the entry is missing. Raises ValueError for another value."""
        value = self.value(key, False)
        if not isinstance(value, bool):
            raise argument_error(f"{self.file}: {key}", value, "true or false")
        return value

    def mapping(self, key: str, *default: dict[str, Any]) -> dict[str, Any]:
        """A table of values. Raises ValueError for another value."""
        value = self.value(key, *default)
        if not isinstance(value, dict):
            raise argument_error(f"{self.file}: {key}", value, "a table")
        return value

    def sub(self, key: str) -> "Table | None":
        """The table of this name, if there is one. Raises ValueError for what is no table."""
        entries = self.value(key, None)
        if entries is not None and not isinstance(entries, dict):
            raise argument_error(f"{self.file}: {key}", entries, "a table")
        return None if entries is None else Table(self.file, entries)

    def subs(self, key: str) -> Sequence["Table"]:
        """The list of tables of this name. Raises ValueError for another value."""
        entries = self.value(key, [])
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            raise argument_error(f"{self.file}: {key}", entries, f"tables [[{key}]]")
        return [Table(self.file, entry) for entry in entries]

    def end(self) -> None:
        """Raises ValueError where an entry was not read."""
        if self.entries:
            raise argument_error(self.file, ", ".join(sorted(self.entries)), "only the entries that docs/lab.md lists")
