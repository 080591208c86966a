"""The queue of commands for a simulation."""

import queue
from collections.abc import Callable

from app.messages import Advance, Ask, Command, Play, SceneCommand


class CommandQueue(queue.SimpleQueue[Command]):
    """Commands for the simulation, and whether one is among them that should not wait for a long solve.

    share: where several simulations have one clock, passes a command to the others and returns what is left to do here.
    """

    urgent = False
    share: Callable[[Command], Command] | None = None

    def put(self, item: Command, block: bool = True, timeout: float | None = None) -> None:
        """Add a command, and pass it on to the other simulations on the same clock where it concerns them."""
        self.add(item if self.share is None else self.share(item))

    def add(self, item: Command) -> None:
        """Add a command. What goes on with the solve as it is can wait for it: drags, and going on."""
        super().put(item)
        self.urgent = self.urgent or not isinstance(item, SceneCommand | Play | Ask | Advance)
