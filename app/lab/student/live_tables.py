"""Tables of a student's functions for a sea: a thread that has them computed in a separate process.

A scene requests functions at arguments (`LiveTables.want`). Their results become a `Table`; a scene takes the available
tables and never waits. `Versions` decides which version of a function computes one. The panel shows functions without a
use in the scene at its numbers in the same way (`scene_values.py`).
"""

import math
import time
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.lab.course.task import Task
from app.lab.process.runner import RunError
from app.lab.process.tabulate import Interval
from app.lab.student.saved import Saved
from app.lab.student.service import Service
from app.lab.student.versions import Use, Versions

RETRY_INTERVAL = 0.5  # [s] until a call is repeated for which the machine was too busy


class Call(NamedTuple):
    """A function at some arguments."""

    columns: tuple[NDArray[np.float64], ...]  # (n, ...) each: row i holds the arguments of call i
    allowed: Interval  # range of the function's values
    shape: tuple[int, ...] | None = ()  # of the result; None: the number of its entries
    program: float = math.nan  # the program's own result, if there is one call

    def same(self, other: "Call") -> bool:
        """True if both are the same request."""
        return len(self.columns) == len(other.columns) and all(
            np.array_equal(a, b) for a, b in zip(self.columns, other.columns, strict=True)
        )


class Table(NamedTuple):
    """Result of a student's function."""

    version: int  # of the files
    call: Call
    values: NDArray[np.float64]  # (n, *shape)


class TableReport(NamedTuple):
    """A scene's report on the functions that move it, for the panel. It is replaced, never changed."""

    running: Mapping[str, str] = {}  # function -> what it moves
    idle: Mapping[str, str] = {}  # function -> reason why the scene does not use it at present
    differences: tuple[tuple[str, float, float, str], ...] = ()  # name, the student's, the program's, unit
    off: bool = False  # the scene could use them, and uses the program's


class TableUser:
    """The part of `LiveTables` that moves a sea; for the simulation thread."""

    def __init__(self, live: "LiveTables") -> None:
        self.live = live
        self.taken: dict[str, Table] = {}  # used by the sea

    def ask(self, calls: Mapping[str, Call], idle: Mapping[str, str]) -> None:
        """Request these tables. idle: function -> reason why it is not used; its table is no longer taken."""
        self.taken = {name: table for name, table in self.taken.items() if name in calls}
        self.live.report = self.live.report._replace(idle=idle)
        self.live.want(calls)

    def take(self) -> dict[str, tuple[Table | None, Table | None]]:
        """Take the available tables; returns, for each changed function, those before and now."""
        before, self.taken = self.taken, dict(self.live.tables) if self.live.shown else {}
        pairs = {name: (before.get(name), self.taken.get(name)) for name in {*before, *self.taken}}
        return {name: pair for name, pair in pairs.items() if pair[0] is not pair[1]}


class LiveTables(Service):
    """`want` is for the simulation thread; `look` for the one that looks at files; `show` for the panel."""

    def __init__(self, versions: Versions, tasks: Iterable[Task], lane: str) -> None:
        """lane: of the versions, for these tables."""
        self.versions = versions
        self.uses = {task.name: Use(lane, task.name, task.file) for task in tasks}
        self.shown = True  # the scene uses the student's functions instead of the program's
        self.tables: Mapping[str, Table] = {}  # function -> its table; replaced, never changed
        self.calls: Mapping[str, Call] = {}
        self.asked: dict[str, tuple[Saved, Call]] = {}  # function -> newest version and arguments of the last attempt
        self.wake: Callable[[], None] = lambda: None
        self.report = TableReport()
        super().__init__(f"student's {lane}")

    @property
    def errors(self) -> dict[str, RunError]:
        """Errors of the newest version of the requested functions."""
        errors = {name: self.versions.errors.get(self.uses[name]) for name in self.calls}
        return {name: error for name, error in errors.items() if error is not None}

    def connect(self, wake: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there are other tables, or they are to be shown or not."""
        self.wake = wake
        self.report = TableReport()  # replaced by the simulation thread
        self.want({})

    def want(self, calls: Mapping[str, Call]) -> None:
        """Request these tables, of functions by name; the latest request wins."""
        self.calls = calls
        self.look()

    def look(self) -> None:
        """Bring the tables up to date with calls and versions."""
        self.do(self.compute)

    def show(self, shown: bool) -> None:
        """Run the scene by the student's functions, or by the program's."""
        self.shown = shown
        self.wake()

    def compute(self) -> None:
        """Compute the tables that are out of date, unless a newer request arrives."""
        if not self.inbox.empty():
            return
        before, calls, tables, is_busy = self.tables, self.calls, {}, False
        for name, call in calls.items():
            try:
                table = self.table_of(self.uses[name], call)
            except RunError:  # the machine is too busy
                table, is_busy = before.get(name), True
            if table is not None:
                tables[name] = table
        self.asked = {name: asked for name, asked in self.asked.items() if name in calls}
        self.tables = tables
        if tables.keys() != before.keys() or any(tables[name] is not before[name] for name in tables):
            self.wake()
        if is_busy:
            time.sleep(RETRY_INTERVAL)
            self.look()

    def table_of(self, use: Use, call: Call) -> Table | None:
        """The table of a function; None if no version works. Raises RunError on a machine that is too busy."""
        newest = self.versions.of(use.file)
        if newest is None:
            return None
        saved, last = self.asked.pop(use.name, (None, call))
        if saved is not newest or not last.same(call):
            done = self.versions.run(
                use,
                lambda begun: begun & {use.name},
                lambda runner, _: runner.table(use.file, use.name, call.columns, call.shape, call.allowed),
            )
            table = None if done is None else Table(done.saved.number, call, done.value)
        else:
            table = self.tables.get(use.name)
        self.asked[use.name] = newest, call
        return table
