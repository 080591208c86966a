"""The folders of a class while a teacher looks on: each is checked again as its files are saved.

Functions run from copies, so that nothing is written into a folder. Of a saved file only its own tasks are checked.
"""

import queue
import shutil
import tempfile
import threading
import time
import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import watchfiles

from app.lab.answer_check import check_answer
from app.lab.answers import Answers, read_answers
from app.lab.check import TaskResult
from app.lab.folder import check_is_folder
from app.lab.program_check import Verdict, check_program
from app.lab.rope_march import FILE as ROPE_FILE
from app.lab.rope_picture import RopePicture, rope_picture
from app.lab.runner import Runner
from app.lab.saved import Saved, keep, read_files
from app.lab.task import Task

WORKERS = 2  # folders that are checked at the same time
LOOK_INTERVAL = 500  # [ms] between two looks whether to end
SETTLE_TIME, MAX_SETTLE_TIME = 50, 400  # [ms] as of a student's own lab


class Student(NamedTuple):
    """State of one folder. It is replaced, never changed."""

    folder: Path
    number: int = 0  # how often it was checked
    saved: Saved | None = None
    programs: Mapping[str, Verdict] = {}  # by task
    results: tuple[TaskResult, ...] = ()
    rope: RopePicture = RopePicture()
    at: str = ""  # name of the task whose result changed last; at first of the last that is begun
    changed_at: str = ""  # clock time of that
    error: str = ""  # why the folder could not be checked, or its answers not be read


class Classroom:
    """All folders, a thread that watches them, and threads that check. Use it in a `with` block."""

    def __init__(self, folders: Sequence[Path], tasks: Sequence[Task]) -> None:
        """Raises ValueError for what is no folder."""
        for folder in folders:
            check_is_folder(folder)
        self.tasks = tuple(tasks)
        self.students = {folder: Student(folder) for folder in dict.fromkeys(folders)}
        self.revision = 0  # how often a student has changed
        self.news = threading.Condition()
        self.copies = Path(tempfile.mkdtemp(prefix="springtide-class-"))
        self.waiting: queue.SimpleQueue[Path | None] = queue.SimpleQueue()
        self.queued = set(self.students)
        self.stop = threading.Event()
        for folder in self.students:
            self.waiting.put(folder)
        self.threads = [threading.Thread(target=self.work, name="class", daemon=True) for _ in range(WORKERS)]
        self.threads.append(threading.Thread(target=self.watch, name="class watch", daemon=True))
        for thread in self.threads:
            thread.start()

    def __enter__(self) -> "Classroom":
        return self

    def __exit__(self, *_: object) -> None:
        self.stop.set()
        self.waiting.put(None)
        with self.news:
            self.news.notify_all()
        for thread in self.threads:
            thread.join()
        shutil.rmtree(self.copies, ignore_errors=True)

    def wait(self, revision: int, timeout: float) -> int:
        """Wait until there is something newer than a revision, at most `timeout` [s]; returns the present one."""
        with self.news:
            self.news.wait_for(lambda: self.stop.is_set() or self.revision != revision, timeout)
            return self.revision

    def watch(self) -> None:
        """Queue each folder in which a file is saved."""
        folders = {folder.resolve(): folder for folder in self.students}
        changes = watchfiles.watch(
            *folders, stop_event=self.stop, recursive=False, raise_interrupt=False, step=SETTLE_TIME,
            debounce=MAX_SETTLE_TIME, rust_timeout=LOOK_INTERVAL,
        )  # fmt: skip
        for found in changes:
            for parent in {Path(path).resolve().parent for _, path in found} & folders.keys():
                self.ask(folders[parent])

    def ask(self, folder: Path) -> None:
        """Have a folder checked; once, however often it is asked for meanwhile."""
        with self.news:
            if folder not in self.queued:
                self.queued.add(folder)
                self.waiting.put(folder)

    def work(self) -> None:
        """Check folder after folder."""
        while (folder := self.waiting.get()) is not None and not self.stop.is_set():
            with self.news:
                self.queued.discard(folder)
                before = self.students[folder]
            try:
                after = checked(before, self.tasks, Path(tempfile.mkdtemp(dir=self.copies)))
            except Exception as error:  # a full disk, no more processes: the page lives
                traceback.print_exception(error)
                after = before._replace(error=f"The folder could not be checked: {error}")
            with self.news:
                if after.number > self.students[folder].number or after.error:
                    self.students[folder] = after
                    self.revision += 1
                    self.news.notify_all()
        self.waiting.put(None)  # for the next thread


def checked(before: Student, tasks: Sequence[Task], copies: Path) -> Student:
    """The state of a folder as it is now. copies: an empty folder, which is removed at the end."""
    try:
        texts, answers = read_files(before.folder), read_answers(before.folder)
        saved = keep(texts, copies, before.number + 1, tasks)
        affected = saved.affected(before.saved, tasks)
        programs, rope = dict(before.programs), before.rope
        with Runner(copies) as runner:
            for task in tasks:
                if task.check is not None and (task.file in affected or task.name not in programs):
                    programs[task.name] = check_program(copies, runner, task)
            if ROPE_FILE in affected:
                rope = rope_picture(runner, saved)
    finally:
        shutil.rmtree(copies, ignore_errors=True)
    results = tuple(result_of(task, programs.get(task.name), answers) for task in tasks)
    after = Student(before.folder, saved.number, saved, programs, results, rope, before.at, before.changed_at)
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
    at = (new or begun or [""])[-1]
    return after._replace(at=at, changed_at=time.strftime("%H:%M:%S") if new else "")
