"""`springtide lab DIR` while it runs: a thread looks at the student's folder twice a second.

The rope (`live_net.py`), the seas (`live_tables.py`) and the check ask `Versions` for the version that they run.
"""

import threading
import time
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from app.lab.course.folder import check_is_folder
from app.lab.course.task import Task
from app.lab.process.runner import TIME_LIMIT, RunError
from app.lab.student.background_check import BackgroundCheck
from app.lab.student.live_code import LiveCode
from app.lab.student.live_net import CLOTH, ROPE, LiveNet
from app.lab.student.live_tables import LiveTables
from app.lab.student.service import Service
from app.lab.student.versions import LOOK_INTERVAL, Versions


class CodeState(NamedTuple):
    """State of the student's files."""

    version: int = 0  # of the files as saved last
    saved_at: str = ""  # clock time
    error: RunError | None = None  # of the newest version
    not_compiled: str = ""  # reason why a function of the version that runs could not be compiled


class Session:
    """The student's folder while the lab is served. Raises ValueError if it is no folder."""

    def __init__(
        self, folder: Path, tasks: Sequence[Task], own_tasks: Sequence[Path] = (), time_limit: float = TIME_LIMIT
    ) -> None:
        """own_tasks: folders with a teacher's tasks, which are among these.

        time_limit: [s] of one call of a student's function.
        """
        check_is_folder(folder)
        self.folder, self.tasks = folder, tasks
        self.versions = Versions(folder, tasks, time_limit)
        self.saved_at = ""
        self.trouble: RunError | None = None  # reason why the files could not be taken up
        self.compiler = Service("student's compiler")
        self.rope = LiveNet(ROPE, self.versions, lambda: self.compiler.do(self.compile))
        self.cloth = LiveNet(CLOTH, self.versions)
        self.tables = LiveTables(self.versions, tasks, "sea")
        self.live = LiveCode(self.rope, self.cloth, self.tables)
        self.check = BackgroundCheck(self.versions, own_tasks)
        # Of functions that move nothing, beside the program's number.
        self.values = LiveTables(self.versions, tasks, "values")
        self.services = self.compiler, self.rope, self.cloth, self.tables, self.values, self.check
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self.watch, name="student's files", daemon=True)
        self.thread.start()

    @property
    def state(self) -> CodeState:
        """State of the files now."""
        versions, newest = self.versions, self.versions.newest
        uses = [net.material.use for net in (self.rope, self.cloth)]
        errors = [self.trouble, *(versions.errors.get(use) for use in uses if versions.of(use.file) is newest)]
        errors += [*self.tables.errors.values(), *(service.trouble for service in self.services)]
        compiled = versions.compiled.get(ROPE.use)
        return CodeState(
            0 if newest is None else newest.number,
            self.saved_at,
            next((error for error in errors if error is not None), None),
            compiled.why if compiled is not None and compiled.saved is versions.of(ROPE.use.file) else "",
        )

    @property
    def begun(self) -> frozenset[str]:
        """Functions of the saved version that have a body."""
        return frozenset() if self.versions.newest is None else self.versions.newest.begun

    def watch(self) -> None:
        """Take the files up as they are, then each time that one is saved."""
        while True:
            try:
                self.look()
                self.trouble = None
            except Exception as error:  # the thread lives: the files are taken up once that is possible
                self.note_trouble(error)
            if self.stop.wait(LOOK_INTERVAL):
                return

    def look(self) -> None:
        """Look at the files once; raises OSError if they cannot be copied."""
        if self.versions.look() is not None:
            self.trouble, self.saved_at = None, time.strftime("%H:%M:%S")
            for service in (self.tables, self.values, self.check):
                service.look()
        for net in (self.rope, self.cloth):
            net.attempt()
        self.versions.warm()

    def compile(self) -> None:
        """Compile the functions that move the rope."""
        self.versions.compile(ROPE.use)

    def note_trouble(self, error: Exception) -> None:
        """Report that the files could not be loaded for a reason outside them: a full disk, or no more processes."""
        text = f"the saved files could not be loaded: {error}"
        if self.trouble is None or self.trouble.text != text:  # it is tried again twice a second
            traceback.print_exception(error)
            self.trouble = RunError("ended", text, str(self.folder))

    def close(self) -> None:
        """End threads and processes, and remove the copies."""
        self.stop.set()
        self.versions.abort()
        self.thread.join()
        for service in self.services:
            service.close()
        self.versions.close()
