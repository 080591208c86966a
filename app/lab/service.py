"""A thread that handles one item after another, and lives whatever goes wrong: it has a student's functions run."""

import abc
import queue
import threading
from typing import Generic, TypeVar

from app.lab.runner import RunError, unexpected

T = TypeVar("T")


class Service(abc.ABC, Generic[T]):
    """`handle`, `fail` and `release` run on its thread."""

    def __init__(self, name: str, file: str = "Python") -> None:
        """Start the thread. file: of the student's, to which an error of the lab's own is attributed."""
        self.file = file
        self.inbox: queue.SimpleQueue[T | None] = queue.SimpleQueue()
        self.thread = threading.Thread(target=self.run, name=name, daemon=True)
        self.thread.start()

    def run(self) -> None:
        """Handle items until the end."""
        while (item := self.inbox.get()) is not None:
            try:
                self.handle(item)
            except Exception as error:
                self.fail(item, unexpected(error, self.file))
        self.release()

    @abc.abstractmethod
    def handle(self, item: T) -> None: ...

    @abc.abstractmethod
    def fail(self, item: T, error: RunError) -> None: ...

    @abc.abstractmethod
    def release(self) -> None: ...

    def close(self) -> None:
        """End the thread, and the processes that it holds."""
        self.inbox.put(None)
        self.thread.join()
