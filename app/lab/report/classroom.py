"""The folders of a class on a teacher's page: each is checked again as its files are saved.

Functions run from copies, so that nothing is written into a folder. `Versions` decides what to check. One thread holds
a folder until it has finished; files saved meanwhile are found at the next look.
"""

import threading
import time
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.check.check import TaskResult
from app.lab.check.program_check import Verdict, check_program
from app.lab.course.answer_check import check_answer
from app.lab.course.answers import FILE, Answers, read_answers
from app.lab.course.folder import check_is_folder
from app.lab.course.source import read_source
from app.lab.course.task import Task
from app.lab.process.rope_march import FILE as ROPE_FILE
from app.lab.report.rope_picture import NOT_DRAWN, RopePicture, rope_picture
from app.lab.student.saved import Saved
from app.lab.student.versions import LOOK_INTERVAL, FileWatch, Versions

WORKERS = 2  # folders that are checked at the same time
MISSING = "The folder does not exist."


class Student(NamedTuple):
    """State of one folder. It is replaced, never changed."""

    folder: Path
    saved: Saved | None = None
    programs: Mapping[str, Verdict] = {}  # by task
    results: tuple[TaskResult, ...] = ()
    rope: RopePicture = RopePicture()
    at: str = ""  # name of the task whose result changed last; at first of the last one begun
    changed_at: str = ""  # clock time of that
    error: str = ""  # reason why the folder could not be checked, or its answers not be read
    name: str = ""  # as the student typed it


class Desk:
    """One folder. It belongs to one thread at a time."""

    def __init__(self, folder: Path, tasks: Sequence[Task]) -> None:
        self.tasks, self.versions, self.answers = tasks, Versions(folder, tasks), FileWatch(folder, FILE)
        self.student = Student(folder)
        self.drawn: Saved | None = None  # the version whose rope is drawn
        self.is_open = True  # something is to be looked at again

    def checked(self) -> Student:
        """The present state of the folder; the same object if nothing has changed.

        Raises OSError if the files cannot be copied.
        """
        student = self.student
        if not student.folder.is_dir():
            self.is_open = True
            return student if student.error == MISSING else student._replace(error=MISSING)
        is_saved, is_answered = self.versions.look() is not None, self.answers.has_changed()
        if not (is_saved or is_answered or self.is_open):
            return student
        self.is_open = True  # until this is done
        after = self.judged()
        self.is_open = bool(self.versions.unchecked()) or after.rope.text == NOT_DRAWN
        same = after.saved is student.saved and after.rope is student.rope and after.name == student.name
        return student if same and (after.results, after.error) == (student.results, student.error) else after

    def judged(self) -> Student:
        """The state of the folder, after a check of the functions that have no verdict."""
        versions, before, rope = self.versions, self.student, self.student.rope
        for task, saved in versions.unchecked():
            runner = versions.process(("check", saved.number, False), saved)
            verdict = check_program(saved.folder, runner, task, self.tasks)
            versions.judge(task, saved, verdict, final=verdict.state != "not checked")
        saved = versions.of(ROPE_FILE)
        if saved is not None and (saved is not self.drawn or rope.text == NOT_DRAWN):
            rope = rope_picture(versions.process(("check", saved.number, False), saved), saved)
            self.drawn = saved
        versions.end("check")
        answers = read_answers(before.folder)
        programs = dict(versions.verdicts)
        results = tuple(result_of(task, programs.get(task.name), answers) for task in self.tasks)
        after = Student(before.folder, versions.newest, programs, results, rope, before.at, before.changed_at)
        return turned(before, after)._replace(error=answers.error, name=answers.name)


class Classroom:
    """All folders, and the threads that check them. Use it in a `with` block."""

    def __init__(self, folders: Sequence[Path], tasks: Sequence[Task]) -> None:
        """Raises ValueError for a path that is no folder."""
        for folder in folders:
            check_is_folder(folder)
        self.students = {folder: Student(folder) for folder in dict.fromkeys(folders)}
        self.revision = 0  # number of changes of students
        self.news = threading.Condition()
        self.is_closed = threading.Event()
        self.turns = threading.Condition()
        self.desks = [Desk(folder, tuple(tasks)) for folder in self.students]
        # When each folder is looked at next [s], and its desk: those that no thread has now, in the order of the times.
        self.waiting = [(0.0, desk) for desk in self.desks]
        self.threads = [threading.Thread(target=self.work, name="class", daemon=True) for _ in range(WORKERS)]
        for thread in self.threads:
            thread.start()

    def __enter__(self) -> "Classroom":
        return self

    def __exit__(self, *_: object) -> None:
        self.is_closed.set()
        for desk in self.desks:
            desk.versions.abort()
        for condition in (self.news, self.turns):
            with condition:
                condition.notify_all()
        for thread in self.threads:
            thread.join()
        for desk in self.desks:
            desk.versions.close()

    def wait(self, revision: int, timeout: float) -> int:
        """Wait for a newer revision, at most `timeout` [s]; returns the present one."""
        with self.news:
            self.news.wait_for(lambda: self.is_closed.is_set() or self.revision != revision, timeout)
            return self.revision

    def work(self) -> None:
        """Check folder after folder, each in one thread at a time."""
        while (desk := self.next()) is not None:
            try:
                after = desk.checked()
            except Exception as error:  # a full disk, no more processes: the page survives, and the check is repeated
                after = desk.student._replace(error=f"The folder could not be checked: {error}")
                if after.error != desk.student.error:
                    traceback.print_exception(error)
            if after is not desk.student and not self.is_closed.is_set():
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
            while not self.is_closed.is_set():
                due = self.waiting[0][0] - time.monotonic() if self.waiting else None
                if due is not None and due <= 0.0:
                    return self.waiting.pop(0)[1]
                self.turns.wait(due)
        return None


def result_of(task: Task, program: Verdict | None, answers: Answers) -> TaskResult:
    """The result of one task."""
    return TaskResult(
        task, program, tuple(check_answer(q, answers.of(task, q), answers.unread_of(task, q)) for q in task.questions)
    )


def turned(before: Student, after: Student) -> Student:
    """The state with the student's current task."""
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
            function = read_source(student.saved.texts.get(file, b"")).name_at(int(line))
            if function in student.programs:
                return function
    return ""
