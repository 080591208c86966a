"""The student's functions that a scene runs."""

from collections.abc import Callable
from typing import NamedTuple

from app.lab.student.live_net import LiveNet
from app.lab.student.live_tables import LiveTables


class LiveCode(NamedTuple):
    """Services that run a student's functions for a scene; each scene uses those that it needs."""

    rope: LiveNet
    cloth: LiveNet
    tables: LiveTables

    def connect(self, scene: str, wake: Callable[[], None], begin_again: Callable[[], None]) -> None:
        """Serve another scene. wake: called with each answer. begin_again: called when another version takes over."""
        for name, net in (("rope", self.rope), ("cloth", self.cloth)):
            if name == scene:
                net.connect(wake, begin_again)
            else:
                net.connect(nothing, nothing)
        self.tables.connect(wake)


def nothing() -> None:
    """Empty service for a scene without springs."""
