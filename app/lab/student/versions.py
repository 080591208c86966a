"""The saved versions of a student's folder, the process of each that runs, and the failures of their functions.

The only place that decides which version runs: rope, cloth, seas, checks and the teacher's page ask it. A save is a new
version only of those files whose functions it may have changed.

Files are found by their time stamps, which costs little, works on network drives, and survives a folder that is removed
and made again. After a change the files are read for some seconds whatever their stamps: a clock of files can be as
coarse as 2 s, and a second save within it changes no stamp.
"""

import contextlib
import os
import shutil
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Generic, NamedTuple, TypeAlias, TypeVar

from app.lab.check.program_check import Verdict, settled
from app.lab.course.task import Task
from app.lab.process.runner import BUSY, TIME_LIMIT, RunError, Runner, unexpected
from app.lab.student.saved import Saved, read_files, store

LOOK_INTERVAL = 0.5  # [s] between two looks
SETTLE_TIME = 0.05  # [s] without a further change before a save is read: editors write a file in several steps
MAX_SETTLE_TIME = 0.4  # [s]
COARSE_TIME = 3.0  # [s] after a change during which files are read at each look
MAX_WORKED = 2  # versions that worked, kept as copies for each use
COSTLY = ("endless", "ended", "memory")  # kinds of errors that may end the process
Stamps = frozenset[tuple[str, int, int, int]]
Key: TypeAlias = tuple[str, int, bool]  # of a process: who asks, version, whether it compiles
Own: TypeAlias = Callable[[frozenset[str]], frozenset[str]]  # functions with a body -> those of them that a use needs
T = TypeVar("T")


def stamps(folder: Path, ending: str) -> Stamps | None:
    """Name, inode, size [bytes] and time of change [ns] of each file directly in a folder; None without a folder.

    ending: of their names.
    """
    records: set[tuple[str, int, int, int]] = set()
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.endswith(ending):
                    with contextlib.suppress(OSError):  # removed meanwhile, or a link to nothing
                        stat = os.stat(entry.path)  # as `entry.stat` gives no inode on Windows
                        records.add((entry.name, stat.st_ino, stat.st_size, stat.st_mtime_ns))
    except OSError:  # the folder was removed, or its drive is away
        return None
    return frozenset(records)


class FileWatch:
    """Looks at the files of a folder that have one ending."""

    def __init__(self, folder: Path, ending: str, max_settle: float = MAX_SETTLE_TIME) -> None:
        """max_settle: [s] that a look waits at most until a save is complete."""
        self.folder, self.ending, self.max_settle = folder, ending, max_settle
        self.seen: Stamps | None = None
        self.sure_at = 0.0  # [s] of the monotonic clock from which equal stamps mean equal files

    def has_changed(self) -> bool:
        """True if a file may have changed since the last look. Waits until a save is complete."""
        now = stamps(self.folder, self.ending)
        if now is None:
            return False
        if now == self.seen:
            return time.monotonic() < self.sure_at
        end = time.monotonic() + self.max_settle
        while self.seen is not None and time.monotonic() < end:
            time.sleep(SETTLE_TIME)
            before, now = now, stamps(self.folder, self.ending)
            if now == before:
                break
        if now is None:
            return False
        self.seen, self.sure_at = now, time.monotonic() + COARSE_TIME
        return True

    def forget(self) -> None:
        """Have the next look report its changes again, as they could not be loaded."""
        self.seen = None


class Use(NamedTuple):
    """One use of a student's functions, such as moving the rope."""

    lane: str  # who asks: makes one call at a time, in processes of its own
    name: str
    file: str
    # Each call continues from the result of the last one: a version is tried before it takes over, and a failure holds
    # for all later calls. Otherwise a failure holds for its arguments, unless it is costly.
    goes_on: bool = False


class Done(NamedTuple, Generic[T]):
    """Result of a job."""

    value: T
    saved: Saved  # the version that did it
    own: frozenset[str]  # functions of the student's that it needed
    compiled: tuple[str, ...]  # functions that are compiled in its process


class Compiled(NamedTuple):
    """Outcome of compiling a version."""

    saved: Saved
    names: tuple[str, ...]  # compiled functions; none: it runs in plain Python
    why: str  # others could not be compiled


class Versions:
    """The versions of one folder. `look` and `warm` are for one thread, and so are the calls of each lane."""

    def __init__(self, folder: Path, tasks: Sequence[Task], time_limit: float = TIME_LIMIT) -> None:
        """time_limit: [s] of one call of a student's function."""
        self.folder, self.tasks, self.time_limit = folder, tasks, time_limit
        self.copies = Path(tempfile.mkdtemp(prefix="springtide-lab-"))
        self.files = FileWatch(folder, ".py")
        self.newest: Saved | None = None
        # These four are replaced, never changed.
        self.of_file: Mapping[str, Saved] = {}  # file of tasks -> version in which its functions were saved last
        self.errors: Mapping[Use, RunError] = {}  # of the newest version
        self.alone: Mapping[str, Verdict] = {}  # function -> outcome of its own check as it was saved last
        self.compiled: Mapping[Use, Compiled] = {}
        self.judged: dict[str, int] = {}  # function -> version of its final verdict
        self.tried: dict[Use, int] = {}  # number of the version that was tried last
        self.worked: dict[Use, list[Saved]] = {}  # in the order of their numbers
        self.failed: dict[tuple[Use, Key, frozenset[str]], RunError] = {}
        self.processes: dict[Key, Runner] = {}
        self.running: dict[Use, Key] = {}  # process that does the last job
        self.compiling: tuple[Saved, Runner] | None = None
        self.spare: Runner | None = None  # runs, and waits for the folder of the next version
        self.is_closed = False
        self.lock = threading.Lock()  # for what several threads change; never held during a call

    def look(self) -> Saved | None:
        """The newest version, if it was saved since the last look; None otherwise.

        Raises OSError if it cannot be copied; the next look tries it again.
        """
        if not self.files.has_changed():
            return None
        texts = read_files(self.folder)
        if self.newest is not None and texts == self.newest.texts:
            return None
        number = 1 if self.newest is None else self.newest.number + 1
        folder = self.copies / str(number)
        try:
            folder.mkdir(exist_ok=True)
            saved = store(texts, folder, number, self.tasks)
        except OSError:
            self.files.forget()
            raise
        affected = saved.affected(self.newest, self.tasks)
        files = {task.file for task in self.tasks if task.file}
        with self.lock:
            self.newest, old = saved, self.of_file
            self.of_file = {file: saved if file in affected else old.get(file, saved) for file in files}
            changed = {task.name for task in self.tasks if task.file in affected}
            self.alone = {name: verdict for name, verdict in self.alone.items() if name not in changed}
            self.errors = {use: error for use, error in self.errors.items() if use.file not in affected}
            if self.compiling is not None and self.compiling[0] not in self.of_file.values():
                self.compiling[1].abort()
        self.tidy()
        return saved

    def tidy(self) -> None:
        """Remove the copies of versions that no file, use or process has any more."""
        with self.lock:
            worked = [saved for versions in self.worked.values() for saved in versions]
            needed = {saved.number for saved in (*self.of_file.values(), *worked)} | {key[1] for key in self.processes}
            needed.add(self.newest.number if self.newest is not None else 0)
            self.failed = {attempt: error for attempt, error in self.failed.items() if attempt[1][1] in needed}
        for path in self.copies.iterdir():
            if path.name.isdecimal() and int(path.name) not in needed:  # a function may have written something else
                shutil.rmtree(path, ignore_errors=True)

    def of(self, file: str) -> Saved | None:
        """The version in which the functions of a file were saved last; None before the first look."""
        return self.of_file.get(file)

    def run(self, use: Use, own: Own, job: Callable[[Runner, frozenset[str]], T]) -> Done[T] | None:
        """Result of a job by the newest version in which these functions have not failed, or by one before it.

        None if none of them works, or the student has written nothing for this use. job: gets a process and the
        student's functions. Raises RunError of the kind `BUSY` if the machine is too busy: it can be tried again.
        """
        for saved, compiled in self.choices(use):
            names = own(saved.begun)
            key = use.lane, saved.number, bool(compiled)
            if not names:
                with self.lock:
                    self.running.pop(use, None)
                self.end_idle(key)
                self.note(use, saved)
                self.say(use, saved, None)
                break
            error = self.failed.get((use, key, names))
            if error is None:
                with self.lock:
                    self.running[use] = key
                runner = self.process(key, saved)
                try:
                    value = job(runner, names)
                except Exception as problem:
                    error = problem if isinstance(problem, RunError) else unexpected(problem, use.file)
                    self.note_failure(use, key, names, error)
                else:
                    self.say(use, saved, None)
                    self.note(use, saved)
                    self.end_idle(key)
                    return Done(value, saved, names, compiled)
            if not compiled:  # else plain Python is tried next, and says where it was
                self.say(use, saved, error)
            if error.kind == BUSY:
                raise error
        return None

    def choices(self, use: Use) -> Iterator[tuple[Saved, tuple[str, ...]]]:
        """The versions that a use may run by, the preferred one first, each with the functions that are compiled."""
        newest, order = self.of(use.file), self.worked.get(use, [])[::-1]
        if newest is not None and not use.goes_on:
            order = [newest, *(saved for saved in order if saved is not newest)]
        compilation = self.compiled.get(use)
        for saved in order:
            if (
                compilation is not None
                and compilation.saved is saved
                and (use.lane, saved.number, True) in self.processes
            ):
                yield saved, compilation.names
            yield saved, ()

    def attempt(self, use: Use, own: Own, job: Callable[[Runner, frozenset[str]], object]) -> bool:
        """Try the newest version by a job, unless that has been done. True if it takes over with this.

        It does so without a job where the student has written nothing for this use. On a machine that is too busy the
        next call tries it again.
        """
        saved = self.of(use.file)
        if saved is None or self.tried.get(use) == saved.number:
            return False
        key = use.lane, saved.number, False
        names = own(saved.begun)
        if names:
            try:
                job(self.process(key, saved), names)
            except RunError as error:
                self.drop(key)
                self.say(use, saved, error)
                if error.kind != BUSY:
                    self.tried[use] = saved.number
                return False
        self.tried[use] = saved.number
        self.say(use, saved, None)
        self.note(use, saved)
        self.end_idle(key)
        return True

    def compile(self, use: Use) -> None:
        """Compile the functions of the newest version, which then runs by them, unless another is saved meanwhile."""
        saved = self.of(use.file)
        if saved is None:
            return
        runner = Runner(saved.folder, self.time_limit, compiles=True)
        with self.lock:
            self.compiling = saved, runner
            if self.is_closed or self.of_file[use.file] is not saved:
                runner.abort()
        try:
            names, why = runner.compile(saved.begun)
        except RunError as error:
            names, why = [], error.text
        with self.lock:
            self.compiling = None
            self.compiled = {**self.compiled, use: Compiled(saved, tuple(names), why)}
            if names and not self.is_closed and self.of_file[use.file] is saved:
                self.processes[use.lane, saved.number, True] = runner
                return
        runner.close()

    @property
    def verdicts(self) -> Mapping[str, Verdict]:
        """The verdict on each function as it was saved last, given those on the functions that it calls."""
        alone = self.alone
        return {name: settled(name, alone) for name in alone}

    def unchecked(self) -> list[tuple[Task, Saved]]:
        """The functions that have no final verdict as they were saved last, in the order of the lab."""
        pairs = [(task, self.of_file.get(task.file)) for task in self.tasks if task.check is not None]
        return [(task, saved) for task, saved in pairs if saved and self.judged.get(task.name) != saved.number]

    def judge(self, task: Task, saved: Saved, verdict: Verdict, *, final: bool) -> None:
        """Take the verdict on a function, unless it has been saved again. final: it is not to be checked again."""
        with self.lock:
            if self.of_file[task.file] is saved:
                self.alone = {**self.alone, task.name: verdict}
                if final:
                    self.judged[task.name] = saved.number

    def process(self, key: Key, saved: Saved) -> Runner:
        """The process of a version, which is not yet started unless the spare one can be taken."""
        with self.lock:
            if key not in self.processes:
                runner, self.spare = self.spare or Runner(self.copies, self.time_limit), None
                runner.enter(saved.folder)
                if self.is_closed:
                    runner.abort()
                self.processes[key] = runner
            return self.processes[key]

    def warm(self) -> None:
        """Start a process for the next version, as starting takes longer than a trial."""
        if self.spare is None:
            runner = Runner(self.copies, self.time_limit)
            with contextlib.suppress(RunError):  # said when a version is tried
                runner.start()
            with self.lock:
                self.spare = runner
                if self.is_closed:
                    runner.abort()

    def drop(self, key: Key) -> None:
        """End a process; one that does not know its folder yet becomes the spare one."""
        with self.lock:
            runner = self.processes.pop(key, None)
            if runner is not None and runner.is_fresh and self.spare is None:
                self.spare, runner = runner, None
        if runner is not None:
            runner.close()

    def end(self, lane: str) -> None:
        """End the processes of a lane."""
        for key in [key for key in self.processes if key[0] == lane]:
            self.drop(key)

    def end_idle(self, key: Key) -> None:
        """End the processes of a lane before this one by which nothing runs."""
        with self.lock:
            needed = {key, *self.running.values()}
            idle = [other for other in self.processes if other[0] == key[0] and other < key and other not in needed]
        for other in idle:
            self.drop(other)

    def note(self, use: Use, saved: Saved) -> None:
        """Note that a version works; of those before it, those that have not failed are kept."""
        with self.lock:
            failed = {key[1] for other, key, _ in self.failed if other == use and not key[2]}
            by_number = {one.number: one for one in (*self.worked.get(use, []), saved)}
            lasting = (saved, self.of_file[use.file])
            survivors = [one for _, one in sorted(by_number.items()) if one in lasting or one.number not in failed]
            self.worked[use] = survivors[-MAX_WORKED:]

    def note_failure(self, use: Use, key: Key, names: frozenset[str], error: RunError) -> None:
        """Note that functions have failed in a process."""
        if error.kind != BUSY and (use.goes_on or error.kind in COSTLY):
            with self.lock:
                self.failed[use, key, names] = error
            self.processes[key].close()
        elif self.processes[key].is_fresh:  # an error of syntax
            self.drop(key)

    def say(self, use: Use, saved: Saved, error: RunError | None) -> None:
        """Have the error of a version shown, or none any more, if it is the newest."""
        with self.lock:
            if self.of_file[use.file] is saved:
                others = {other: failure for other, failure in self.errors.items() if other != use}
                self.errors = others if error is None else {**others, use: error}

    def abort(self) -> None:
        """End all processes from another thread: calls that are under way fail at once, and so do later ones."""
        with self.lock:
            self.is_closed = True
            compiling = () if self.compiling is None else self.compiling[1:]
            for runner in (*self.processes.values(), *compiling, *([self.spare] if self.spare else [])):
                runner.abort()

    def close(self) -> None:
        """End the processes and remove the copies, once no other thread asks any more."""
        self.abort()
        for runner in (*self.processes.values(), *([self.spare] if self.spare else [])):
            runner.close()
        shutil.rmtree(self.copies, ignore_errors=True)
