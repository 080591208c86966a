"""Tables of a student's functions that a sea runs by: a thread that has them computed, in a separate process.

A scene says which functions it has a use for, and at which arguments (`LiveTables.want`). What they return becomes a
`Table`; a scene takes the tables that there are and never waits. Where the newest version of a function fails, the
last version that worked goes on. The panel shows functions that move nothing at the numbers of a scene in the same way
(`scene_values.py`).
"""

import math
import time
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.lab.runner import BUSY, RunError, Runner
from app.lab.saved import Saved
from app.lab.service import Service
from app.lab.tabulate import Range
from app.lab.task import Task

RETRY_INTERVAL = 0.5  # [s] until a call is made again for which the machine was too busy
COSTLY = ("endless", "ended", "memory")  # kinds of errors that may end the process


class Call(NamedTuple):
    """A function at some arguments."""

    columns: tuple[NDArray[np.float64], ...]  # (n, ...) each: row i holds the arguments of call i
    allowed: Range  # what the function may return
    shape: tuple[int, ...] | None = ()  # of what it returns; None: its number of entries counts
    program: float = math.nan  # the program's own result, where there is one call

    def same(self, other: "Call") -> bool:
        """True if both ask for the same."""
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
    idle: Mapping[str, str] = {}  # function -> why the scene has no use for it just now
    differences: tuple[tuple[str, float, float, str], ...] = ()  # what, the student's, the program's, unit
    off: bool = False  # the scene could run by them, and runs by the program's


class TableUser:
    """The part of `LiveTables` that moves a sea; for the simulation thread."""

    def __init__(self, live: "LiveTables") -> None:
        self.live = live
        self.taken: dict[str, Table] = {}  # that the sea runs by

    def ask(self, calls: Mapping[str, Call], idle: Mapping[str, str]) -> None:
        """Ask for these tables. idle: function -> why it has no use just now; its table is not taken any more."""
        self.taken = {name: table for name, table in self.taken.items() if name in calls}
        self.live.report = self.live.report._replace(idle=idle)
        self.live.want(calls)

    def take(self) -> dict[str, tuple[Table | None, Table | None]]:
        """Take the tables that there are: of each function for which this changes something, those before and now."""
        before, self.taken = self.taken, dict(self.live.tables) if self.live.shown else {}
        pairs = {name: (before.get(name), self.taken.get(name)) for name in {*before, *self.taken}}
        return {name: pair for name, pair in pairs.items() if pair[0] is not pair[1]}


class LiveTables(Service[Saved | Mapping[str, Call]]):
    """`want` is for the simulation thread; `adopt` for who loads versions; `show` for the panel."""

    def __init__(self, tasks: Mapping[str, Task], time_limit: float) -> None:
        """time_limit: [s] of one call of a student's function."""
        self.tasks, self.time_limit = tasks, time_limit
        self.shown = True  # whether the scene runs by the student's functions, or by the program's
        self.tables: Mapping[str, Table] = {}  # function -> its table; replaced, never changed
        self.errors: Mapping[str, RunError] = {}  # function -> what stops its newest version; replaced, never changed
        self.newest: Saved | None = None
        self.working: dict[str, Saved] = {}  # function -> the last version that worked
        self.failed: set[tuple[int, str]] = set()  # version and function that are not called again
        self.runners: dict[int, Runner] = {}  # version -> its process
        self.calls: Mapping[str, Call] = {}
        self.tried: dict[str, tuple[int, Call]] = {}  # function -> version and arguments of the last attempt
        self.is_busy = False  # the machine was too busy for a call of these
        self.wake: Callable[[], None] = lambda: None
        self.report = TableReport()
        super().__init__("student's tables")

    def connect(self, wake: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there are other tables, or they are to be shown or not."""
        self.wake = wake
        self.report = TableReport()  # replaced by the simulation thread
        self.inbox.put({})

    def want(self, calls: Mapping[str, Call]) -> None:
        """Have these tables, of functions by name; of several wishes the last one counts."""
        self.inbox.put(calls)

    def adopt(self, saved: Saved) -> None:
        """Take a version of the files, as they were saved."""
        self.inbox.put(saved)

    def show(self, shown: bool) -> None:
        """Run the scene by the student's functions, or by the program's."""
        self.shown = shown
        self.wake()

    def handle(self, item: Saved | Mapping[str, Call]) -> None:
        """Take a version or a request, and compute the latest request by the latest version."""
        if isinstance(item, Saved):
            self.take(item)
        else:
            self.calls = item
        if self.inbox.empty():
            self.compute()

    def fail(self, item: Saved | Mapping[str, Call], error: RunError) -> None:
        """The next version or wish is computed."""
        self.tried.clear()
        self.errors = {**self.errors, "": error}

    def close(self) -> None:
        """End the thread without waiting for a call."""
        for runner in list(self.runners.values()):
            runner.abort()
        super().close()

    def release(self) -> None:
        """End the process of each version."""
        for runner in self.runners.values():
            runner.close()

    def take(self, saved: Saved) -> None:
        """Go over to a version: a function of a file that has not changed is not called again."""
        affected = saved.affected(self.newest, self.tasks.values())
        same = {name for name, task in self.tasks.items() if task.file not in affected}
        before = 0 if self.newest is None else self.newest.number
        self.tried = {name: (saved.number, call) for name, (_, call) in self.tried.items() if name in same}
        self.errors = {name: error for name, error in self.errors.items() if name in same}
        self.failed |= {(saved.number, name) for number, name in self.failed if number == before and name in same}
        self.newest = saved

    def compute(self) -> None:
        """Bring the tables up to date with calls and versions."""
        before, found, self.is_busy = self.tables, {}, False
        for name, call in self.calls.items():
            table = self.table_of(name, call)
            if table is not None:
                found[name] = table
        self.tried = {name: tried for name, tried in self.tried.items() if name in self.calls}
        self.errors = {name: error for name, error in self.errors.items() if name in self.calls}
        needed = {saved.number for saved in (self.newest, *self.working.values()) if saved is not None}
        for number in set(self.runners) - needed:
            self.runners.pop(number).close()
        self.tables = found
        if found.keys() != before.keys() or any(found[name] is not before[name] for name in found):
            self.wake()
        if self.is_busy:
            time.sleep(RETRY_INTERVAL)
            self.inbox.put(self.calls)

    def table_of(self, name: str, call: Call) -> Table | None:
        """The table of a function by the newest version that works; None where there is none."""
        newest = self.newest
        if newest is None or name not in newest.begun:
            self.working.pop(name, None)
            return None
        number, last = self.tried.get(name, (0, call))
        if number == newest.number and last.same(call):
            return self.tables.get(name)
        self.tried[name] = newest.number, call
        for saved in (newest, self.working.get(name)):
            if saved is None or (saved.number, name) in self.failed:
                continue
            try:
                values = self.runner(saved).table(self.tasks[name].file, name, call.columns, call.shape, call.allowed)
            except RunError as error:
                if saved is newest:
                    self.errors = {**self.errors, name: error}
                if error.kind == BUSY:
                    self.is_busy = True
                    del self.tried[name]
                    return self.tables.get(name)
                if error.kind in COSTLY:
                    self.failed.add((saved.number, name))
                continue
            if saved is newest:
                self.errors = {other: error for other, error in self.errors.items() if other != name}
            self.working[name] = saved
            return Table(saved.number, call, values)
        return None

    def runner(self, saved: Saved) -> Runner:
        """The process of a version."""
        if saved.number not in self.runners:
            self.runners[saved.number] = Runner(saved.folder, self.time_limit)
        return self.runners[saved.number]
