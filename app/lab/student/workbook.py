"""The workbook: the shown task, and the answers of a student's folder, if there is one.

Browsers' callbacks write answers on one thread, completed steps are ticked off on another. Each change reads
answers.toml, changes one value and writes the whole file; a lock separates changes from each other and from earlier
reads of the file. Meanwhile edits of the student with an editor are kept.
"""

import itertools
import threading
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from app.lab.course.answer_check import AnswerVerdict, check_answer, chosen
from app.lab.course.answers import DONE, FILE, SHOWN, Answers, Value, change_answer, change_name, read_answers
from app.lab.course.folder import MAX_PICTURES, PICTURES
from app.lab.course.live_values import LiveNumber, LiveValues
from app.lab.course.task import PREDICTION, Question, Task, TaskSetup
from app.lab.student.versions import FileWatch
from app.render.markup.formula import formula
from sim.files import replacing
from sim.parameters import choice_error
from sim.quantities import read_number
from sim.validation import argument_error

MAX_TEXT = 4000  # characters of an answer
MAX_NAME = 100  # characters of a name
ALLOWED_CONTROLS = "\n\t"


class Workbook:
    """The tasks to go through, one at a time, and the answers so far."""

    def __init__(
        self,
        tasks: Sequence[Task],
        folder: Path | None = None,
        programs: Callable[[], Mapping[str, str]] = dict[str, str],
    ) -> None:
        """folder: made by `springtide lab new`; without one only the guides of the items are shown.

        programs: function -> state of its latest check.

        Raises ValueError if there is nothing to show, or a law is no formula.
        """
        self.all_tasks, self.folder, self.programs = tuple(tasks), folder, programs
        self.tasks = tuple(task for task in tasks if folder is not None or task.guide is not None)
        if not self.tasks:
            raise argument_error("tasks", "none", "at least one task")
        for task in self.tasks:
            check_laws(task)
        self.lock = threading.RLock()
        self.answers = Answers("", {})
        self.file = None if folder is None else FileWatch(folder, FILE, 0.0)
        self.revision: int = 0  # number of changes of the answers
        self.looked_at: set[str] = set()  # without a folder: names of the tasks that show their answer
        self.refresh()
        self.index = 0 if folder is None else self.first_open()

    # ----- the shown task

    @property
    def task(self) -> Task:
        """The shown task."""
        return self.tasks[self.index]

    def first_open(self) -> int:
        """Next task: the first incomplete one, from the last one begun on."""
        begun = {name for (name, _), value in self.answers.values.items() if value != ""}
        last = max((i for i, task in enumerate(self.tasks) if task.name in begun), default=0)
        is_open = [i for i, task in enumerate(self.tasks) if not self.is_complete(task)]
        return next((i for i in is_open if i >= last), is_open[0] if is_open else 0)

    def named(self, name: str) -> Task:
        """The task with this name, or the first with this item (3.2-1). Raises ValueError for an unknown one."""
        for task in self.tasks:
            if name in (task.name, task.item):
                return task
        raise choice_error("task", name, dict.fromkeys(task.item for task in self.tasks))

    def go(self, index: int) -> None:
        """Show another task; beyond the first and the last one nothing happens."""
        self.index = min(max(index, 0), len(self.tasks) - 1)

    def go_to_scene(self, scene: str) -> None:
        """Without a folder: show the first task of a scene, where the one that is shown is of another."""
        if self.folder is not None or self.set_up_of(self.task).scene == scene:
            return
        own = (i for i, task in enumerate(self.tasks) if self.set_up_of(task).scene == scene)
        self.index = next(own, self.index)

    def set_up_of(self, task: Task) -> TaskSetup:
        """Set-up of the task, or of another task of its item."""
        others = (other.setup for other in self.all_tasks if other.item == task.item and other.setup is not None)
        setup = task.setup or next(others, None)
        return TaskSetup("", "") if setup is None else setup

    # ----- answers

    def refresh(self) -> None:
        """Read answers.toml if it may have changed since the last read."""
        if self.folder is None or self.file is None:
            return
        with self.lock:
            if self.file.has_changed() or not (self.folder / FILE).exists():
                answers = read_answers(self.folder)
                if answers != self.answers:
                    self.answers = answers
                    self.revision += 1

    def verdict(self, task: Task, question: Question) -> AnswerVerdict:
        """The answer to a question, and the check's result."""
        return check_answer(question, self.answers.of(task, question), self.answers.unread_of(task, question))

    def is_complete(self, task: Task) -> bool:
        """True if every question is answered, and none wrongly."""
        return all(self.verdict(task, question).state in ("right", "given") for question in task.questions)

    def state(self, task: Task) -> str:
        """ "right", "begun" or "open", by the answers and the check of the function."""
        program = self.programs().get(task.name, "not begun") if task.file else ""
        if program in ("right", "") and self.is_complete(task):
            return "right"
        answered = any(self.verdict(task, question).answer is not None for question in task.questions)
        return "begun" if answered or self.done(task) or program not in ("", "not begun") else "open"

    def hidden(self) -> frozenset[str]:
        """Parameters and headings whose lines would answer a question of the shown task."""
        task = self.task
        judged = (question for question in task.questions if question.right is not None)
        if self.folder is None or all(self.verdict(task, q).state != "not begun" for q in judged):
            return frozenset()
        return frozenset(self.set_up_of(task).hide)

    def answer(self, task: Task, question: Question, text: str) -> None:
        """Save an answer as typed or chosen; an empty one removes it.

        Raises ValueError for one that is not allowed, OSError if the file cannot be written.
        """
        if question.key == PREDICTION and self.is_shown(task):
            raise ValueError("You have seen the answer, so the prediction can no longer be changed.")
        self.store(task.name, question.key, answer_of(question, text))

    def rename(self, text: str) -> None:
        """Save the student's name. Raises ValueError for one that is not allowed, OSError as `answer` does."""
        name = " ".join(text.split())
        if len(name) > MAX_NAME or not name.isprintable():
            raise ValueError(f"A name has at most {MAX_NAME} characters, and no control characters.")
        if self.folder is None or name == self.answers.name:
            return
        with self.lock:
            change_name(self.folder, self.all_tasks, self.read_whole(self.folder), name)
            self.refresh()

    def read_whole(self, folder: Path) -> Answers:
        """The answers in the file. Raises ValueError if it is no TOML, so that a change would lose entries."""
        answers = read_answers(folder)
        if answers.is_broken and (folder / FILE).exists():
            raise ValueError(f"{answers.error}. Nothing is saved until you repair this.")
        return answers

    def store(self, task: str, key: str, value: Value) -> None:
        """Change one value of answers.toml. Raises ValueError if the file cannot be read, OSError for writing."""
        if self.folder is None:
            return
        with self.lock:
            change_answer(self.folder, self.all_tasks, self.read_whole(self.folder), task, key, value)
            self.refresh()

    def add_picture(self, task: Task, words: str, picture: bytes) -> str:
        """Save a picture of a task; returns its name.

        words: its subject, as a part of the name, without spaces and dots.

        Raises ValueError if there are as many as the report shows, OSError if it cannot be written.
        """
        assert self.folder is not None
        folder = self.folder / PICTURES
        folder.mkdir(exist_ok=True)
        if sum(1 for _ in folder.iterdir()) >= MAX_PICTURES:
            raise ValueError(f"The report shows {MAX_PICTURES} pictures. Delete some in {PICTURES} first.")
        stem = f"{task.name}-{words}"
        names = (f"{stem}{end}.jpg" for end in itertools.chain([""], map("-{}".format, itertools.count(2))))
        path = next(folder / name for name in names if not (folder / name).exists())
        with replacing(path) as draft:
            draft.write_bytes(picture)
        return path.name

    # ----- completed steps, and the shown answer

    def done(self, task: Task) -> frozenset[int]:
        """Numbers of the completed steps, from 1."""
        return self.answers.done(task)

    def watch(self, task: Task, values: LiveValues) -> None:
        """Tick off the next step if it is completed now. Raises the errors of `keep`."""
        done = self.done(task)
        number = next((i for i in range(1, len(task.steps) + 1) if i not in done), None)
        if self.folder is None or number is None:
            return
        if all(condition.holds(values) for condition in task.steps[number - 1].when):
            self.store(task.name, DONE, " ".join(str(i) for i in sorted(done | {number})))

    def is_shown(self, task: Task) -> bool:
        """True if the answer has been shown."""
        if self.folder is None:
            return task.name in self.looked_at
        return self.answers.is_shown(task)

    def show_answer(self, task: Task) -> None:
        """Show the answer. Raises ValueError if a prediction comes first, and the errors of `keep`."""
        if self.folder is None:
            self.looked_at ^= {task.name}
            return
        first = next((q for q in task.questions if q.key == PREDICTION), None)
        if first is not None and self.verdict(task, first).state != "given":
            raise ValueError("Write your prediction first: it is saved but not graded.")
        if not self.is_shown(task):
            self.store(task.name, SHOWN, "yes")


def check_laws(task: Task) -> None:
    """Raises ValueError if a law of the task's guide is no formula."""
    for law in task.guide.law if task.guide is not None else ():
        try:
            formula(law)
        except ValueError as error:
            raise argument_error(f"{task.name}.toml: law", law, f"a formula ({error})") from None


def answer_of(question: Question, text: str) -> Value:
    """Stored form of a text from outside. Raises ValueError, with a line for the student, if it is not allowed."""
    if len(text) > MAX_TEXT:
        raise ValueError(f"An answer has at most {MAX_TEXT} characters. This one is longer and was not saved.")
    if any(unicodedata.category(c) in ("Cc", "Cs") and c not in ALLOWED_CONTROLS for c in text):
        raise ValueError("The answer has control characters and was not saved.")
    word = text.strip()
    if not word or question.kind == "text":
        return word
    if question.kind == "choice":
        if chosen(question, word) not in question.choices:
            raise ValueError(f"{word!r} is not one of the choices.")
        return chosen(question, word)
    try:
        return read_number(word, question.unit)
    except ValueError as reason:
        unit = f" in {question.unit}" if question.unit else ""
        raise ValueError(f"{word!r} was not saved: {reason}. Write a number{unit}, such as 0.5.") from None


def read_off(question: Question, values: LiveValues) -> str:
    """The live value that answers a question, as it would be typed; "" if the scene has none now."""
    value = values.get(question.read_off)
    return f"{value.value:.6g}" if isinstance(value, LiveNumber) and abs(value.value) < 1e300 else ""
