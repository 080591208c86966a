"""The tasks of the lab: each is a TOML file in a folder; a programming task also has a Python file of that name.

Tasks are discovered in their folder. The TOML file holds the words and questions; the Python file holds the reference
solution, a function named as the file, and what its check needs (`checking.py`). docs/lab.md shows a whole example.
"""

import importlib.util
import inspect
import math
import re
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import msgspec

from app.lab.course.live_values import Condition, names_in, read_conditions
from sim.validation import argument_error, as_float

TASKS = tuple(Path(__file__).parent / "tasks" / room for room in ("spill", "sea", "springs"))  # those of the course
NAME = re.compile(r"[a-z][a-z0-9_]*")
QUESTION_KINDS = ("choice", "number", "text")
CONDITIONS = ("when", "needs")  # keys of tables of conditions
LISTS = ("law", "show", "hide")  # keys of lists, which may be one text
PREDICTION = "predict"  # key of the question answered before the task


class TomlTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a task's TOML file; another entry than its fields is an error."""


class TypicalError(TomlTable, frozen=True):
    """A wrong answer that shows a typical misunderstanding."""

    answer: str | float
    text: str


class Question(TomlTable, frozen=True):
    """One question. A prediction is kept, and is neither right nor wrong; a text is for the teacher to judge."""

    key: str
    ask: str
    kind: str  # "choice", "number" or "text"
    choices: tuple[str, ...] = ()
    unit: str = ""
    right: str | float | None = None  # None: any answer counts
    tolerance: float = 0.05  # of a number, relative to the right one
    why: str = ""  # the explanation of the check
    read_off: str = ""  # name of the live value that answers it, or ""
    typical_errors: tuple[TypicalError, ...] = msgspec.field(name="typical_error", default=())

    def __post_init__(self) -> None:
        """Raises ValueError for a question that cannot be answered."""
        where, kind, right = f"question {self.key}", self.kind, self.right
        if not NAME.fullmatch(self.key):
            raise argument_error(where, self.key, "a key of small letters, digits and underscores")
        if kind not in QUESTION_KINDS:
            raise argument_error(where, kind, "one of " + ", ".join(QUESTION_KINDS))
        if kind == "choice" and (len(self.choices) < 2 or right not in (None, *self.choices)):
            raise argument_error(where, right, "at least two choices, one of them right")
        if kind == "number" and not math.isfinite(as_float(0.0 if right is None else right)):
            raise argument_error(where, right, "a finite number")
        if not math.isfinite(self.tolerance):
            raise argument_error(f"{where}: tolerance", self.tolerance, "a finite number")
        if kind == "text" and right is not None:
            raise argument_error(where, right, "no right answer: a text is judged by the teacher")

    @property
    def part(self) -> str:
        """The part of the task that it belongs to: "Predict", "Measure" or "Explain"."""
        return "Predict" if self.key == PREDICTION else "Explain" if self.kind == "text" else "Measure"

    def is_near(self, answer: float, value: float) -> bool:
        """True if a number counts as this value."""
        return abs(answer - value) <= self.tolerance * abs(value)


class TaskSetup(TomlTable, frozen=True):
    """Set-up of Springtide that shows the task."""

    scene: str
    look: str  # advice on actions and observations
    preset: str = ""
    parameters: dict[str, Any] = {}  # beside the preset
    show: tuple[str, ...] = ()  # names of the live values to keep visible
    # Parameters and headings whose lines answer a question: in a workbook they are shown once it is answered.
    hide: tuple[str, ...] = ()


class Step(TomlTable, frozen=True):
    """An action in the scene. The workbook ticks it off once all conditions hold at the same moment."""

    text: str
    when: Annotated[tuple[Condition, ...], msgspec.Meta(min_length=1)]


class Guide(TomlTable, frozen=True):
    """An item of the course lab for visitors without a folder: its question and its answer."""

    question: str  # in our own words
    answer: str  # with the names of live values in braces
    law: tuple[str, ...] = ()  # formulas, as `app/render/markup/formula.py` reads them
    needs: tuple[Condition, ...] = ()  # for which the answer holds

    def __post_init__(self) -> None:
        """Raises ValueError for an answer that cannot be filled in."""
        try:
            names_in(self.answer)
        except ValueError as error:
            raise argument_error("answer", self.answer, f"names in braces ({error})") from None


class TaskFile(TomlTable, frozen=True):
    """The TOML file of a task."""

    item: str  # of the course lab: its section, a hyphen, its number
    title: str
    statement: str
    optional: bool = False
    file: str = ""  # the student's file of a programming task
    order: int = 0  # among the tasks of one item
    setup: TaskSetup | None = None
    guide: Guide | None = None  # of the first task of an item
    steps: tuple[Step, ...] = msgspec.field(name="do", default=())
    questions: tuple[Question, ...] = msgspec.field(name="question", default=())

    def __post_init__(self) -> None:
        """Raises ValueError for a task that is not complete."""
        if not re.fullmatch(r"\d+\.\d+-\d+", self.item):
            raise argument_error("item", self.item, "a section, a hyphen and a number, as in 3.2-1")
        if self.file and not (self.file.endswith(".py") and NAME.fullmatch(self.file[:-3])):
            raise argument_error("file", self.file, "the name of a Python file")
        keys = [question.key for question in self.questions]
        if len(set(keys)) < len(keys):
            raise argument_error("question", ", ".join(keys), "a different key for each question")


class Task(TaskFile, frozen=True, kw_only=True):
    """One task of the lab."""

    name: str
    check: Any = None  # the Python file of a programming task; None if checks were not requested

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
    tasks: dict[str, Task] = {}
    for folder in (*TASKS, *folders):
        if not folder.is_dir():
            raise argument_error("--tasks", str(folder), "a folder with tasks in TOML files")
        for path in sorted(folder.glob("*.toml")):
            tasks[path.stem] = read_task(path, with_checks=with_checks)
    return tuple(sorted(tasks.values(), key=position))


def position(task: Task) -> tuple[tuple[int, ...], int, str]:
    """Position of a task in the lab."""
    return tuple(int(number) for number in re.findall(r"\d+", task.item)), task.order, task.name


def read_task(path: Path, *, with_checks: bool = True) -> Task:
    """The task in a TOML file. Raises ValueError for one that is not complete."""
    try:
        table = tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise argument_error("task", str(path), f"a TOML file ({error})") from None
    if not NAME.fullmatch(path.stem):
        raise argument_error("task", path.name, "a file name of small letters, digits and underscores")
    try:
        record = msgspec.convert(prepared("", table), TaskFile)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}; docs/lab.md lists the entries") from None
    code = path.with_suffix(".py")
    if bool(record.file) != code.exists():
        raise argument_error(f"{path.name}: file", record.file, "a name, if a Python file lies beside it, or no entry")
    if not record.file and not record.questions:
        raise argument_error("task", path.name, "a Python file of the same name beside it, or questions")
    check = load_check(code) if with_checks and record.file else None
    return Task(**msgspec.structs.asdict(record), name=path.stem, check=check)


def prepared(key: str, value: Any) -> Any:
    """An entry of a TOML file as a `TomlTable` has it: texts without blanks at their ends, lists, and conditions."""
    if key in CONDITIONS:
        if not isinstance(value, dict):
            raise argument_error(key, value, "a table")
        return read_conditions(key, value)
    if isinstance(value, dict):
        return {name: prepared(name, part) for name, part in value.items()}
    if isinstance(value, list):
        return [prepared("", part) for part in value]
    text = value.strip() if isinstance(value, str) else value
    return [text] if key in LISTS and isinstance(text, str) else text


def load_check(path: Path) -> ModuleType:
    """The Python file of a programming task. Raises ValueError if it lacks a part."""
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
