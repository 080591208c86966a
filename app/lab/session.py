"""`springtide lab DIR` while it runs: looks at the student's folder, tries saved files, and runs them.

A thread looks twice a second for saved files. Each saved version is copied, tried in a separate process, and handed to
the rope (`live_net.py`) where it works; where it does not, the last one that worked goes on. The seas run by tables of
functions (`live_tables.py`), in the same way. What the panel shows is one frozen record, `state`, which is replaced and
never changed.
"""

import contextlib
import queue
import shutil
import tempfile
import threading
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.background_check import BackgroundCheck
from app.lab.folder import check_is_folder
from app.lab.live_code import LiveCode
from app.lab.live_net import CLOTH, ROPE, LiveNet, Loaded
from app.lab.live_tables import LiveTables
from app.lab.runner import BUSY, TIME_LIMIT, RunError, Runner
from app.lab.saved import Saved
from app.lab.task import Task
from app.lab.versions import LOOK_INTERVAL, Versions


class CodeState(NamedTuple):
    """State of the student's files."""

    version: int = 0  # of the files as saved last
    saved_at: str = ""  # clock time
    error: RunError | None = None  # what stops the newest version
    not_compiled: str = ""  # why a function of the version that runs could not be compiled
    begun: frozenset[str] = frozenset()  # functions with a body in the version that runs, or in the newest


class Session:
    """The student's folder while the lab is served. Raises ValueError where it is no folder."""

    def __init__(
        self, folder: Path, tasks: Sequence[Task], own_tasks: Sequence[Path] = (), time_limit: float = TIME_LIMIT
    ) -> None:
        """own_tasks: folders with a teacher's tasks, which are among these.

        time_limit: [s] of one call of a student's function.
        """
        check_is_folder(folder)
        self.folder, self.tasks, self.time_limit = folder, tasks, time_limit
        self.state = CodeState()
        self.copies = Path(tempfile.mkdtemp(prefix="springtide-lab-"))
        self.versions = Versions(folder, tasks, self.copies)
        self.saved: Saved | None = None  # the newest version that was taken up
        self.postponed: list[LiveNet] = []  # for which it could not be tried, as the machine is too busy
        self.spare: Runner | None = self.make_runner()  # with a process: starting it takes longer than a trial
        by_name = {task.name: task for task in tasks}
        self.to_compile: queue.SimpleQueue[Saved | None] = queue.SimpleQueue()
        self.rope = LiveNet(ROPE, self.note_failure, self.to_compile.put)
        self.cloth = LiveNet(CLOTH, self.note_failure)
        self.tables = LiveTables(by_name, time_limit)
        self.live = LiveCode(self.rope, self.cloth, self.tables)
        self.check = BackgroundCheck(own_tasks)
        self.values = LiveTables(by_name, time_limit)  # of functions that move nothing, beside the program's number
        self.rope_version = 0  # number of the last version that was tried for the rope
        self.compiler: Runner | None = None  # of the version that is being compiled
        self.trial: Runner | None = None  # in which a version is being tried
        self.stop = threading.Event()
        self.compiling = threading.Thread(target=self.compile_versions, name="student's compiler", daemon=True)
        self.compiling.start()
        self.thread = threading.Thread(target=self.watch, name="student's files", daemon=True)
        self.thread.start()

    def make_runner(self) -> Runner:
        """A process that waits for the folder of the next version."""
        runner = Runner(self.copies, self.time_limit)
        with contextlib.suppress(RunError):  # said when the version is tried
            runner.start()
        return runner

    def watch(self) -> None:
        """Load the files as they are, then each time that one is saved."""
        found: Saved | None = None
        while True:
            try:
                found = self.versions.look() or found  # one that could not be taken up is tried again
                if found is not None:
                    self.load(found)
                    found = None
                elif self.postponed and self.saved is not None:
                    nets, self.postponed = self.postponed, []
                    for net in nets:
                        self.try_version(net, self.saved, Runner(self.saved.folder, self.time_limit))
            except Exception as error:  # the thread lives: the files are taken up once that is possible
                self.note_trouble(error)
            if self.stop.wait(LOOK_INTERVAL):
                return

    def load(self, saved: Saved) -> None:
        """Take a version up."""
        affected = saved.affected(self.saved, self.tasks)
        names = [task.name for task in self.tasks if task.file in affected]
        self.check.request(saved.folder, names, saved.begun)
        self.tables.adopt(saved)
        self.values.adopt(saved)
        self.saved, self.postponed = saved, []
        runner, self.spare = self.spare or self.make_runner(), None
        runner.folder = saved.folder.resolve()
        self.state = self.state._replace(version=saved.number, saved_at=time.strftime("%H:%M:%S"), error=None)
        if ROPE.file in saved.texts and ROPE.file in affected:
            self.rope_version = saved.number
            if self.compiler is not None:
                self.compiler.abort()
            self.try_version(self.rope, saved, runner)
        if CLOTH.file in saved.texts and CLOTH.file in affected:
            self.try_version(self.cloth, saved, runner if runner.is_fresh else Runner(saved.folder, self.time_limit))
        self.spare = runner if runner.is_fresh else self.make_runner()

    def note_trouble(self, error: Exception) -> None:
        """The files could not be taken up, by no fault of theirs: a full disk, or no more processes."""
        text = f"the saved files cannot be taken up: {error}"
        if self.state.error is None or self.state.error.text != text:  # it is tried again twice a second
            traceback.print_exception(error)
            self.state = self.state._replace(error=RunError("ended", text, str(self.folder)))

    def try_version(self, net: LiveNet, saved: Saved, runner: Runner) -> None:
        """Hand a version to rope or cloth if it takes a few steps; say why where it does not.

        A runner that is still fresh after it was not needed.
        """
        self.trial = runner
        try:
            if self.stop.is_set():  # who closes sees the trial, or this sees that
                runner.abort()
            net.attempt(Loaded(saved, runner))
        except RunError as error:
            if not runner.is_fresh:
                runner.close()
            if error.kind == BUSY:
                self.postponed.append(net)
            self.note_failure(saved, error)
            return
        self.note_failure(saved, None)
        self.state = self.state._replace(begun=saved.begun, not_compiled="")
        net.adopt(Loaded(saved, Runner(saved.folder, self.time_limit) if runner.is_fresh else runner))

    def compile_versions(self) -> None:
        """Compile the functions that move the rope, and hand them over if that works; the latest version wins."""
        while (saved := self.to_compile.get()) is not None:
            self.compiler = runner = Runner(saved.folder, self.time_limit, compiles=True)
            if saved.number != self.rope_version or self.stop.is_set():  # who loads or closes sees the compiler, or
                continue  # this sees that
            try:
                names, why = runner.compile(saved.begun)
            except RunError as error:
                names, why = [], error.text
            self.compiler = None
            if saved.number == self.rope_version:  # else it was aborted
                self.state = self.state._replace(not_compiled=why)
            if names and not self.stop.is_set():
                self.rope.adopt(Loaded(saved, runner, tuple(names)))
            else:
                runner.close()

    def note_failure(self, saved: Saved, error: RunError | None) -> None:
        """A version cannot run, or the machine is no longer too busy for it (None).

        Errors of versions before the newest are out of date.
        """
        is_busy = self.state.error is not None and self.state.error.kind == BUSY
        if saved.number == self.state.version and (error is not None or is_busy):
            self.state = self.state._replace(error=error)

    def close(self) -> None:
        """End threads and processes, and remove the copies."""
        self.stop.set()
        if self.trial is not None:
            self.trial.abort()
        self.thread.join()
        self.to_compile.put(None)
        if self.compiler is not None:
            self.compiler.abort()
        self.compiling.join()
        if self.spare is not None:
            self.spare.close()
        self.rope.close()
        self.cloth.close()
        self.tables.close()
        self.check.close()
        self.values.close()
        shutil.rmtree(self.copies, ignore_errors=True)
