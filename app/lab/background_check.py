"""Checks of a student's saved files in a process of low priority, as by `springtide lab check`, while the scenes run.

The process takes requests as lines of JSON, `{"number", "folder", "names"}`, and answers each function with a line
`{"number", "name", "state", "text", "mistake"}`. A new request ends the one before it.
"""

import contextlib
import dataclasses
import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from app.lab.process import NICENESS
from app.lab.program_check import Verdict, check_program
from app.lab.runner import ROOT, Runner
from app.lab.task import load_tasks

START = "import sys; sys.path.insert(0, sys.argv[1]); from app.lab.background_check import main; main()"
ENDED = Verdict("failed", "The check ended twice without a result. Save the file again.")


class BackgroundCheck:
    """The process, as the lab sees it. `verdicts` and `waiting` are replaced, never changed."""

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        """folders: with a teacher's own tasks."""
        self.folders = tuple(folders)
        self.verdicts: Mapping[str, Verdict] = {}  # function -> what its check came to
        self.waiting: frozenset[str] = frozenset()  # functions that are being checked
        self.number = 0  # of the last request
        self.folder = Path()  # of the last request
        self.repeated = 0  # the request that was made once more, as its process ended
        self.process: subprocess.Popen[str] | None = None
        self.closed = False
        self.lock = threading.Lock()  # requests come from one thread, verdicts from another
        self.sending = threading.Lock()  # held by the one that starts a process or writes to it

    def request(self, folder: Path, names: Sequence[str], begun: frozenset[str]) -> None:
        """Check these functions of a folder; those that are not begun need no check."""
        with self.lock:
            to_check = [name for name in {**dict.fromkeys(self.waiting), **dict.fromkeys(names)} if name in begun]
            done = {name: verdict for name, verdict in self.verdicts.items() if name not in names}
            self.verdicts = {**done, **{name: Verdict("not begun") for name in names if name not in begun}}
            self.waiting = frozenset(to_check)
            self.number += 1
            self.folder = folder
            number = self.number
        if to_check:
            self.send(number, folder, to_check)

    def send(self, number: int, folder: Path, names: Sequence[str]) -> None:
        """Have the process check these functions, unless the request is out of date."""
        line = json.dumps({"number": number, "folder": str(folder), "names": names}) + "\n"
        with self.sending:
            for _ in range(2):  # once more, where the process has ended
                if self.closed or number != self.number:
                    return
                process = self.ready()
                assert process.stdin is not None
                with contextlib.suppress(OSError):
                    process.stdin.write(line)
                    process.stdin.flush()
                    return
                self.end_process()

    def ready(self) -> "subprocess.Popen[str]":
        """The process, started unless it runs."""
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", START, str(ROOT), *map(str, self.folders)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                process_group=0,  # Ctrl-C in the terminal is the lab's to handle
            )
            threading.Thread(target=self.read, args=(self.process,), name="verdicts", daemon=True).start()
        return self.process

    def read(self, process: "subprocess.Popen[str]") -> None:
        """Take verdicts until the process ends.

        Where it ends by itself, what was not checked is checked once more; the second time it has failed.
        """
        assert process.stdout is not None
        with contextlib.suppress(ValueError, OSError):  # closed from here
            for line in process.stdout:
                found = json.loads(line)
                with self.lock:
                    if found["number"] == self.number:
                        verdict = Verdict(**found["verdict"])
                        self.verdicts = {**self.verdicts, found["name"]: verdict}
                        self.waiting = self.waiting - {found["name"]}
        process.kill()  # it has ended, or soon will: no request must go to it
        process.wait()
        with self.lock:
            number, names = self.number, sorted(self.waiting)
            if process is not self.process or not names:
                return
            if self.repeated == number:
                self.verdicts = {**self.verdicts, **dict.fromkeys(names, ENDED)}
                self.waiting = frozenset()
                return
            self.repeated = number
        self.send(number, self.folder, names)

    def close(self) -> None:
        """End the process, for good."""
        with self.sending:
            self.closed = True
            self.end_process()

    def end_process(self) -> None:
        """End the process; it ends its children."""
        process, self.process = self.process, None
        if process is not None:
            process.terminate()
            process.wait()
            for stream in (process.stdin, process.stdout):
                with contextlib.suppress(OSError):  # what was not yet sent is dropped
                    if stream is not None:
                        stream.close()


def serve(requests: "queue.SimpleQueue[dict[str, object] | None]", say: Callable[[dict[str, object]], None]) -> None:
    """Check the requested tasks until None comes."""
    tasks = {task.name: task for task in load_tasks(*map(Path, sys.argv[2:]))}
    while (request := requests.get()) is not None:
        folder, names = Path(str(request["folder"])), request["names"]
        assert isinstance(names, list)
        with Runner(folder) as runner:
            for name in names:
                if not requests.empty():
                    break
                verdict = check_program(folder, runner, tasks[name])
                say({"number": request["number"], "name": name, "verdict": dataclasses.asdict(verdict)})


def main() -> None:
    """The process."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    requests: queue.SimpleQueue[dict[str, object] | None] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            requests.put(json.loads(line))
        requests.put(None)  # the lab has ended

    threading.Thread(target=read, daemon=True).start()

    def say(found: dict[str, object]) -> None:
        print(json.dumps(found), flush=True)

    with contextlib.suppress(BrokenPipeError):
        serve(requests, say)
