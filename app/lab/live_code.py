"""What a scene runs of a student's functions."""

from collections.abc import Callable
from typing import NamedTuple

from app.lab.live_rope import LiveRope
from app.lab.live_tables import LiveTables


class LiveCode(NamedTuple):
    """Where a scene has a student's functions run; each scene uses what it has a use for."""

    rope: LiveRope
    tables: LiveTables

    def connect(self, wake: Callable[[], None], begin_again: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there is an answer. begin_again: when another version moves a net."""
        self.rope.connect(wake, begin_again)
        self.tables.connect(wake)
