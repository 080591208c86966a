"""Checks of a student's saved files in a process of low priority, as by `springtide lab check`, while the scenes run.

The process takes a folder and a function as a line of JSON, and answers with its verdict as another.
"""

import contextlib
import dataclasses
import json
import subprocess
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from app.lab.process import BACKGROUND_NICENESS, lower_priority
from app.lab.program_check import Verdict, check_program, not_checked
from app.lab.runner import ROOT, RunError, Runner
from app.lab.service import Service
from app.lab.task import load_tasks

RETRY_INTERVAL = 2.0  # [s] until functions are checked again that could not be checked
START = "import sys; sys.path.insert(0, sys.argv[1]); from app.lab.background_check import main; main()"
ENDED = Verdict("not checked", "The check ended twice without a result. Save the file again.")


class BackgroundCheck(Service[Path]):
    """The process, as the lab sees it. `verdicts` and `waiting` are replaced, never changed."""

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        """folders: with a teacher's own tasks."""
        self.folders = tuple(folders)
        self.verdicts: Mapping[str, Verdict] = {}  # function -> what its check came to
        self.waiting: tuple[str, ...] = ()  # functions that are being checked, in the order of the requests
        self.process: subprocess.Popen[str] | None = None
        self.closed = threading.Event()
        self.lock = threading.Lock()  # requests come from one thread, verdicts from another
        self.starting = threading.Lock()  # held by the one that starts the process or ends it
        super().__init__("student's checks")

    def request(self, folder: Path, names: Sequence[str], begun: frozenset[str]) -> None:
        """Check these functions of a folder, and those that still wait; those that are not begun need no check."""
        with self.lock:
            self.waiting = tuple(name for name in dict.fromkeys((*self.waiting, *names)) if name in begun)
            done = {name: verdict for name, verdict in self.verdicts.items() if name not in names}
            self.verdicts = {**done, **{name: Verdict("not begun") for name in names if name not in begun}}
            self.inbox.put(folder)

    def handle(self, item: Path) -> None:
        """Check the functions that wait, unless or until there is another request.

        Those that cannot be checked go on waiting, and the request is made again.
        """
        for name in self.waiting if self.inbox.empty() else ():
            verdict = self.ask(item, name) or self.ask(item, name) or ENDED
            with self.lock:
                if self.closed.is_set() or not self.inbox.empty():
                    return  # the verdict is out of date
                if verdict.state == "not checked" and verdict is not ENDED:
                    again = dataclasses.replace(verdict, text=f"{verdict.text}; trying again")
                    self.verdicts = {**self.verdicts, name: again}
                else:
                    self.settle({name: verdict})
        if self.waiting and self.inbox.empty() and not self.closed.wait(RETRY_INTERVAL):
            with self.lock:
                if self.inbox.empty():  # else a newer request has come, of which the functions that wait are part
                    self.inbox.put(item)

    def fail(self, item: Path, error: RunError) -> None:
        """Say it of all functions that wait."""
        with self.lock:
            self.settle(dict.fromkeys(self.waiting, Verdict("not checked", error.text)))

    def settle(self, verdicts: Mapping[str, Verdict]) -> None:
        """Show these verdicts of functions that waited."""
        self.verdicts = {**self.verdicts, **verdicts}
        self.waiting = tuple(name for name in self.waiting if name not in verdicts)

    def ask(self, folder: Path, name: str) -> Verdict | None:
        """The verdict of the process on a function; None where it ends before."""
        with self.starting:
            if self.closed.is_set():
                return None
            try:
                process = self.process = self.ready()
            except OSError as error:  # no more processes or memory
                return not_checked(f"the machine is busy: no process can be started: {error.strerror or error}")
        assert process.stdin is not None
        assert process.stdout is not None
        with contextlib.suppress(OSError, ValueError):
            process.stdin.write(json.dumps([str(folder), name]) + "\n")
            process.stdin.flush()
            return Verdict(**json.loads(process.stdout.readline()))
        end(process)
        return None

    def ready(self) -> "subprocess.Popen[str]":
        """The process, started unless it runs."""
        if self.process is not None and self.process.poll() is None:
            return self.process
        return subprocess.Popen(
            [sys.executable, "-P", "-c", START, str(ROOT), *map(str, self.folders)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,  # Ctrl-C in the terminal is the lab's to handle
        )

    def close(self) -> None:
        """End the process, for good; it ends its children."""
        with self.starting:
            self.closed.set()
            if self.process is not None:
                self.process.terminate()
        super().close()

    def release(self) -> None:
        """Reap the process."""
        if self.process is not None:
            end(self.process)


def end(process: "subprocess.Popen[str]") -> None:
    """End a process, unless it has ended, and close its pipes."""
    process.terminate()
    process.wait()
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):  # what was not yet sent is dropped
            if stream is not None:
                stream.close()


def main() -> None:
    """The process."""
    lower_priority(BACKGROUND_NICENESS)
    tasks = {task.name: task for task in load_tasks(*map(Path, sys.argv[2:]))}
    with contextlib.ExitStack() as opened, contextlib.suppress(BrokenPipeError):
        runner: Runner | None = None
        for line in sys.stdin:
            folder, name = json.loads(line)
            if runner is None or runner.folder != Path(folder).resolve():
                opened.close()
                runner = opened.enter_context(Runner(Path(folder)))
            print(json.dumps(dataclasses.asdict(check_program(Path(folder), runner, tasks[name]))), flush=True)
