"""The folders of a class while a teacher looks on: each is checked again as its files are saved.

Functions run from copies, so that nothing is written into a folder. Of a saved file only its own tasks are checked.
One thread has a folder until it is done with it; what was saved meanwhile is found when the folder is looked at again.
"""

import shutil
import tempfile
import threading
import time
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.answer_check import check_answer
from app.lab.answers import FILE, Answers, read_answers
from app.lab.check import TaskResult
from app.lab.folder import check_is_folder
from app.lab.program_check import Verdict, check_program
from app.lab.rope_march import FILE as ROPE_FILE
from app.lab.rope_picture import NOT_DRAWN, RopePicture, rope_picture
from app.lab.runner import Runner
from app.lab.runners import Runners
from app.lab.saved import Saved
from app.lab.source import read_source
from app.lab.task import Task
from app.lab.versions import LOOK_INTERVAL, Look, Versions

WORKERS = 2  # folders that are checked at the same time
MISSING = "The folder is not there."


class Student(NamedTuple):
    """State of one folder. It is replaced, never changed."""

    folder: Path
    saved: Saved | None = None
    programs: Mapping[str, Verdict] = {}  # by task
    results: tuple[TaskResult, ...] = ()
    rope: RopePicture = RopePicture()
    at: str = ""  # name of the task whose result changed last; at first of the last that is begun
    changed_at: str = ""  # clock time of that
    error: str = ""  # why the folder could not be checked, or its answers not be read

    @property
    def is_open(self) -> bool:
        """True if something could not be checked, as the machine was too busy."""
        return self.rope.text == NOT_DRAWN or any(v.state == "not checked" for v in self.programs.values())


class Desk:
    """One folder, and how far it has been looked at. It belongs to one thread at a time."""

    def __init__(self, folder: Path, tasks: Sequence[Task], copies: Path) -> None:
        self.versions, self.answers = Versions(folder, tasks, copies), Look(folder, FILE)
        self.student = Student(folder)
        self.is_open = True  # something is to be checked again

    def look(self) -> bool:
        """True if something is to be checked. Raises OSError where the files cannot be copied."""
        before = self.versions.newest
        if self.versions.look() is not None:
            self.is_open = True
            if before is not None:
                shutil.rmtree(before.folder, ignore_errors=True)
        if self.answers.has_changed():
            self.is_open = True
        return self.is_open


class Classroom:
    """All folders, and threads that look at them and check. Use it in a `with` block."""

    def __init__(self, folders: Sequence[Path], tasks: Sequence[Task]) -> None:
        """Raises ValueError for what is no folder."""
        for folder in folders:
            check_is_folder(folder)
        self.tasks = tuple(tasks)
        self.copies = Path(tempfile.mkdtemp(prefix="springtide-class-"))
        self.students = {folder: Student(folder) for folder in dict.fromkeys(folders)}
        self.revision = 0  # how often a student has changed
        self.news = threading.Condition()
        self.runners = Runners()
        self.turns = threading.Condition()
        # When each folder is looked at next [s], and its desk: those that no thread has now, in the order of the times.
        self.waiting = [(0.0, Desk(folder, tasks, Path(tempfile.mkdtemp(dir=self.copies)))) for folder in self.students]
        self.threads = [threading.Thread(target=self.work, name="class", daemon=True) for _ in range(WORKERS)]
        for thread in self.threads:
            thread.start()

    def __enter__(self) -> "Classroom":
        return self

    def __exit__(self, *_: object) -> None:
        self.runners.abort()
        for condition in (self.news, self.turns):
            with condition:
                condition.notify_all()
        for thread in self.threads:
            thread.join()
        shutil.rmtree(self.copies, ignore_errors=True)

    def wait(self, revision: int, timeout: float) -> int:
        """Wait until there is something newer than a revision, at most `timeout` [s]; returns the present one."""
        with self.news:
            self.news.wait_for(lambda: self.runners.aborted.is_set() or self.revision != revision, timeout)
            return self.revision

    def work(self) -> None:
        """Look at folder after folder; one that is checked is looked at again after that, and by no other thread."""
        while (desk := self.next()) is not None:
            try:
                after = self.checked(desk)
            except Exception as error:  # a full disk, no more processes: the page lives, and it is tried again
                after = desk.student._replace(error=f"The folder could not be checked: {error}")
                desk.is_open = True
                if after.error != desk.student.error:
                    traceback.print_exception(error)
            if after is not desk.student and not self.runners.aborted.is_set():
                desk.student = after
                with self.news:
                    self.students[after.folder] = after
                    self.revision += 1
                    self.news.notify_all()
            with self.turns:
                self.waiting.append((time.monotonic() + LOOK_INTERVAL, desk))
                self.turns.notify()

    def next(self) -> Desk | None:
        """The desk that is due, once one is; None at the end."""
        with self.turns:
            while not self.runners.aborted.is_set():
                due = self.waiting[0][0] - time.monotonic() if self.waiting else None
                if due is not None and due <= 0.0:
                    return self.waiting.pop(0)[1]
                self.turns.wait(due)
        return None

    def checked(self, desk: Desk) -> Student:
        """The state of a folder as it is now; the same object if nothing has changed."""
        student = desk.student
        if not student.folder.is_dir():
            desk.is_open = True
            return student if student.error == MISSING else student._replace(error=MISSING)
        if not desk.look():
            return student
        saved = desk.versions.newest
        assert saved is not None
        with self.runners.runner(saved.folder) as runner:
            after = checked(student, saved, self.tasks, runner)
        desk.is_open = after.is_open
        same = after.saved is student.saved and after.rope is student.rope
        return student if same and (after.results, after.error) == (student.results, student.error) else after


def checked(before: Student, saved: Saved, tasks: Sequence[Task], runner: Runner) -> Student:
    """The state of a folder with a version of its files. runner: of the copies."""
    answers = read_answers(before.folder)
    affected = saved.affected(before.saved, tasks)
    programs, rope = dict(before.programs), before.rope
    for task in tasks:
        verdict = programs.get(task.name)
        is_open = verdict is None or verdict.state == "not checked"
        if task.check is not None and (task.file in affected or is_open):
            programs[task.name] = check_program(saved.folder, runner, task)
    if ROPE_FILE in affected or rope.text == NOT_DRAWN:
        rope = rope_picture(runner, saved)
    results = tuple(result_of(task, programs.get(task.name), answers) for task in tasks)
    after = Student(before.folder, saved, programs, results, rope, before.at, before.changed_at)
    return turned(before, after)._replace(error=answers.error)


def result_of(task: Task, program: Verdict | None, answers: Answers) -> TaskResult:
    """The result of one task."""
    return TaskResult(task, program, tuple(check_answer(q, answers.of(task, q)) for q in task.questions))


def turned(before: Student, after: Student) -> Student:
    """The state with the task that the student is at."""
    pairs = zip(before.results, after.results, strict=True) if before.results else ()
    new = [result.task.name for old, result in pairs if old != result]
    if before.results and not new:
        return after
    begun = [result.task.name for result in after.results if result.state != "not begun"]
    at = broken_at(after, new or begun) or (new or begun or [""])[-1]
    return after._replace(at=at, changed_at=time.strftime("%H:%M:%S") if new else "")


def broken_at(student: Student, names: Sequence[str]) -> str:
    """The task of the function in which a file was broken; "" if none of these functions is in such a file."""
    for verdict in (student.programs.get(name) for name in names):
        file, _, line = verdict.place.partition(":") if verdict is not None else ("", "", "")
        if verdict is not None and verdict.file == file and line and student.saved is not None:
            found = read_source(student.saved.texts.get(file, b"")).name_at(int(line))
            if found in student.programs:
                return found
    return ""
