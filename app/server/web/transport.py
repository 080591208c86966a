"""Hands the frames of the viewer thread to viser, one at a time.

viser's own `atomic()` holds a browser's next message back while a picture is handed over. But a message in preparation
then ends in the middle of a picture, or contains half of one that the next replaces. Therefore the viewer's thread does
not use `atomic()`: it hands over a complete picture on viser's event loop, which also composes messages. So mesh and
poses of one picture are always in one message, however slow a browser is.
"""

import collections
import contextlib
import threading
from collections.abc import Generator, Sequence
from typing import cast

import numpy as np
import viser

from app.render.handles.viser_inside import watch_messages

MAX_WAIT = 1.0  # [s] for viser's event loop to take a picture


def kind_and_size(value: object) -> tuple[str, int] | None:
    """("arrays" or "texts", bytes) of a property; None for a single number, which is negligible."""
    if isinstance(value, np.ndarray):
        return "arrays", value.nbytes
    if isinstance(value, tuple):
        sizes = [getattr(part, "nbytes", 0) for part in cast(tuple[object, ...], value)]
        return ("arrays", sum(sizes)) if any(sizes) else None
    if isinstance(value, str):
        return "texts", len(value.encode())
    return None


class Transport:
    """Messages to the browsers of one server from within `counted()`; each counts once for all browsers."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.sent: collections.Counter[str] = collections.Counter()
        self.counting_thread: int | None = None
        self.picture: list[object] = []  # messages of the picture under way
        self.delivery = threading.Event()  # viser has the last picture
        self.delivery.set()
        self.loop = server.get_event_loop()
        self.send_together = watch_messages(server, self.take)

    def take(self, message: object) -> bool:
        """Count a message of the picture under way, and hold it until the whole is sent."""
        if threading.get_ident() != self.counting_thread:
            return False
        self.count(message)
        self.picture.append(message)
        return True

    def count(self, message: object) -> None:
        """Count the properties that a message changes, or those of the node that it creates."""
        self.sent["messages"] += 1
        changes = getattr(message, "updates", None) or getattr(getattr(message, "props", None), "__dict__", {})
        for value in changes.values():
            pair = kind_and_size(value)
            if pair is not None:
                kind, size = pair
                self.sent[kind] += 1
                self.sent["bytes"] += size

    @contextlib.contextmanager
    def counted(self) -> Generator[None]:
        """Context in which messages of this thread are collected; at its end they are sent together: see `wait`."""
        self.counting_thread = threading.get_ident()
        try:
            yield
        finally:
            self.counting_thread = None
            picture, self.picture = self.picture, []
            if picture:
                self.hand_over(picture)

    def hand_over(self, picture: Sequence[object]) -> None:
        """Give viser the messages of a picture on its event loop, after those of the picture before."""
        self.wait()
        event = self.delivery = threading.Event()

        def send_all() -> None:
            # It cannot be split: the loop composes no message while this runs on it.
            self.send_together(picture)
            event.set()

        try:
            self.loop.call_soon_threadsafe(send_all)
        except RuntimeError:  # the server has ended
            event.set()

    def wait(self) -> None:
        """Wait until viser has the last frame, before another thread removes nodes."""
        self.delivery.wait(MAX_WAIT)
