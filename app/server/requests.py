"""Scenes that browsers request: of several waiting only the last counts."""

import itertools
import queue

from app.panel.history import SceneRequest


class SceneRequests:
    """The queue of requests; any thread may put."""

    def __init__(self) -> None:
        self.waiting: queue.SimpleQueue[SceneRequest] = queue.SimpleQueue()
        self.numbers = itertools.count(1)
        self.number = 0  # of the last request

    def put(self, request: SceneRequest) -> None:
        """Add a request."""
        self.number = next(self.numbers)  # before it can be taken out
        self.waiting.put(request)

    def pop(self) -> SceneRequest:
        """Wait for a request, and take the last one out."""
        request = self.waiting.get()
        while not self.waiting.empty():
            request = self.waiting.get()
        return request

    def is_newer(self, number: int) -> bool:
        """True if a scene was requested after the request of this number; it may already have been taken out."""
        return self.number != number or not self.waiting.empty()
