"""Processes that check several folders at the same time, and can all be ended."""

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path

from app.lab.process.runner import Runner


class Runners:
    """Hands out processes until it is aborted."""

    def __init__(self) -> None:
        self.aborted = threading.Event()
        self.running: set[Runner] = set()
        self.lock = threading.Lock()

    @contextlib.contextmanager
    def runner(self, folder: Path) -> Iterator[Runner]:
        """A process for a folder, in a `with` block."""
        with Runner(folder) as runner:
            with self.lock:
                self.running.add(runner)
                if self.aborted.is_set():
                    runner.abort()
            try:
                yield runner
            finally:
                with self.lock:
                    self.running.discard(runner)

    def abort(self) -> None:
        """End all processes, also later ones: each call of a student's function fails at once."""
        with self.lock:
            self.aborted.set()
            for runner in self.running:
                runner.abort()
