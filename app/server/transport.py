"""Counts what the viewer's thread hands to viser: the ledger's arrays, texts and bytes, sent or unchanged.

viser compares what is assigned to a handle with what the handle holds and sends it only where it differs. Both ends of
that are watched here: the assignment, and the message that follows or does not. The names with an underscore are
viser's own and a reason for the pin in pyproject.toml; `tests/app/test_ledger.py` fails when they change.
"""

import collections
import contextlib
import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import viser
from viser._assignable_props_api import AssignablePropsBase

from app.messages import WorkCount

_counting = threading.local()  # .traffic: who counts on this thread, if anyone
_assign = AssignablePropsBase.__setattr__


def kind_and_size(value: Any) -> tuple[str, int] | None:
    """("arrays" or "texts", bytes) of a property; None of a single number, which is not worth counting."""
    if isinstance(value, np.ndarray):
        return "arrays", value.nbytes
    if isinstance(value, tuple) and value and isinstance(value[0], np.ndarray):
        return "arrays", sum(array.nbytes for array in value)
    if isinstance(value, str):
        return "texts", len(value.encode())
    return None


def count(counter: collections.Counter[str], value: Any) -> None:
    """Add a property to `counter`."""
    found = kind_and_size(value)
    if found is not None:
        kind, size = found
        counter[kind] += 1
        counter["bytes"] += size


def _counted_assign(handle: Any, name: str, value: Any) -> None:
    """`handle.name = value`, noting where viser found nothing new in it."""
    traffic: TransportCounters | None = getattr(_counting, "traffic", None)
    if traffic is None:
        _assign(handle, name, value)
        return
    before = traffic.messages
    _assign(handle, name, value)
    if traffic.messages == before and name in handle._prop_hints:
        count(traffic.unchanged, value)


AssignablePropsBase.__setattr__ = _counted_assign  # type: ignore[method-assign]


class TransportCounters:
    """What goes to the browsers of one server from within `counted()`; a message counts once, however many look."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.sent: collections.Counter[str] = collections.Counter()
        self.unchanged: collections.Counter[str] = collections.Counter()
        self.messages = 0
        connection = server._websock_server
        queue = connection.queue_message

        def queue_message(message: Any) -> None:
            if getattr(_counting, "traffic", None) is self:
                self.count(message)
            queue(message)

        connection.queue_message = queue_message  # type: ignore[method-assign]

    def count(self, message: Any) -> None:
        """Count what a message changes, or what it makes."""
        self.messages += 1
        changes = getattr(message, "updates", None) or getattr(getattr(message, "props", None), "__dict__", {})
        for value in changes.values():
            count(self.sent, value)

    @contextlib.contextmanager
    def counted(self) -> Iterator[None]:
        """While open, what this thread hands over is counted."""
        _counting.traffic = self
        try:
            yield
        finally:
            _counting.traffic = None

    def begin(self) -> None:
        """Another scene: count anew."""
        self.sent.clear()
        self.unchanged.clear()

    def work(self) -> dict[str, WorkCount]:
        sent, unchanged = self.sent, self.unchanged
        return {
            "arrays sent": WorkCount(sent["arrays"], unchanged["arrays"]),
            "texts sent": WorkCount(sent["texts"], unchanged["texts"]),
            "sent to each browser": WorkCount(sent["bytes"], unchanged["bytes"], "B"),
        }
