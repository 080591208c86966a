"""A worker thread that survives the exceptions of its actions; it has a student's functions run."""

import queue
import threading
from collections.abc import Callable

from app.lab.process.runner import RunError, unexpected


class Service:
    """The thread."""

    def __init__(self, name: str) -> None:
        self.inbox: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self.trouble: RunError | None = None  # an error of the lab's own in the last action
        self.thread = threading.Thread(target=self.run, name=name, daemon=True)
        self.thread.start()

    def do(self, action: Callable[[], None]) -> None:
        """Queue an action."""
        self.inbox.put(action)

    def run(self) -> None:
        """Take actions until the end."""
        while (action := self.inbox.get()) is not None:
            try:
                action()
                self.trouble = None
            except Exception as error:
                self.trouble = unexpected(error, "Python")

    def close(self) -> None:
        """End the thread after the queued actions; `Versions.abort` ends calls of a student's functions."""
        self.inbox.put(None)
        self.thread.join()
