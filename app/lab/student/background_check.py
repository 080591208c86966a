"""Checks of a student's saved files as in `springtide lab check`, in a low-priority process beside the scenes.

The process takes a folder and a function as a line of JSON, and answers with its verdict as another.
"""

import contextlib
import dataclasses
import json
import subprocess
import sys
import threading
from collections.abc import Iterable
from pathlib import Path

import msgspec

from app.lab.check.program_check import Verdict, check_program, not_checked
from app.lab.course.task import Task, load_tasks
from app.lab.process.child_processes import end_with_this_program
from app.lab.process.runner import ROOT, Runner, unexpected
from app.lab.process.shared import BACKGROUND_NICENESS, lower_priority
from app.lab.student.saved import Saved
from app.lab.student.service import Service
from app.lab.student.versions import Versions

RETRY_INTERVAL = 2.0  # [s] until a failed check is repeated
START = "import sys; sys.path.insert(0, sys.argv[1]); from app.lab.student.background_check import main; main()"
ENDED = Verdict("not checked", "The check ended twice without a result. Save the file again.")


class BackgroundCheck(Service):
    """The process, seen from the lab. It checks the functions without a verdict in `Versions`."""

    def __init__(self, versions: Versions, folders: Iterable[Path] = ()) -> None:
        """folders: with a teacher's own tasks."""
        self.versions, self.folders = versions, tuple(folders)
        self.process: subprocess.Popen[str] | None = None
        self.closed = threading.Event()
        self.starting = threading.Lock()  # held while the process is started or ended
        super().__init__("student's checks")

    @property
    def waiting(self) -> frozenset[str]:
        """Functions under check."""
        return frozenset(task.name for task, saved in self.versions.unchecked() if task.name in saved.begun)

    def look(self) -> None:
        """Check the functions that were saved."""
        self.do(self.check)

    def check(self) -> None:
        """Check functions until each has a verdict, repeating failed checks."""
        open_names: set[str] = set()  # unchecked in this round
        while not self.closed.is_set():
            pairs = [(task, saved) for task, saved in self.versions.unchecked() if task.name not in open_names]
            if pairs:
                task, saved = pairs[0]
                verdict, final = self.verdict(task, saved)
                if not final:
                    open_names.add(task.name)
                if not self.closed.is_set():
                    self.versions.judge(task, saved, verdict, final=final)
            elif open_names:
                open_names.clear()
                self.closed.wait(RETRY_INTERVAL)
            else:
                return

    def verdict(self, task: Task, saved: Saved) -> tuple[Verdict, bool]:
        """The verdict on a function of a version, and whether it is final."""
        if task.name not in saved.begun:
            return Verdict("not begun"), True
        try:
            verdict = self.ask(saved.folder, task.name) or self.ask(saved.folder, task.name) or ENDED
        except Exception as error:
            return Verdict("not checked", unexpected(error, task.file).text), True
        if verdict.state != "not checked" or verdict is ENDED:
            return verdict, True
        return dataclasses.replace(verdict, text=f"{verdict.text}; trying again"), False

    def ask(self, folder: Path, name: str) -> Verdict | None:
        """The verdict of the process on a function; None if it ends before."""
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
            return msgspec.json.decode(process.stdout.readline(), type=Verdict)
        end(process)
        return None

    def ready(self) -> "subprocess.Popen[str]":
        """The process, started unless it runs."""
        if self.process is not None and self.process.poll() is None:
            return self.process
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", START, str(ROOT), *map(str, self.folders)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            start_new_session=True,  # Ctrl-C in the terminal is the lab's to handle
        )
        end_with_this_program(process, background=True)
        return process

    def close(self) -> None:
        """End the process permanently; it ends its children."""
        with self.starting:
            self.closed.set()
            if self.process is not None:
                self.process.terminate()
        super().close()
        if self.process is not None:
            end(self.process)


def end(process: "subprocess.Popen[str]") -> None:
    """End a process, unless it has ended, and close its pipes."""
    process.terminate()
    process.wait()
    for stream in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):  # unsent data is dropped
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
            verdict = check_program(Path(folder), runner, tasks[name], tasks.values())
            print(msgspec.json.encode(verdict).decode(), flush=True)
