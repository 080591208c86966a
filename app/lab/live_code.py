"""What a scene runs of a student's functions."""

from collections.abc import Callable
from typing import NamedTuple

from app.lab.live_net import LiveNet
from app.lab.live_tables import LiveTables


class LiveCode(NamedTuple):
    """Where a scene has a student's functions run; each scene uses what it has a use for."""

    rope: LiveNet
    cloth: LiveNet
    tables: LiveTables

    def connect(self, scene: str, wake: Callable[[], None], begin_again: Callable[[], None]) -> None:
        """Serve another scene. wake: called when there is an answer. begin_again: when another version moves it."""
        for name, net in (("rope", self.rope), ("cloth", self.cloth)):
            if name == scene:
                net.connect(wake, begin_again)
            else:
                net.connect(nothing, nothing)
        self.tables.connect(wake)


def nothing() -> None:
    """What is done for a scene that has no use for a net."""
