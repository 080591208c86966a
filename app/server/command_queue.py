"""The queue of commands for a simulation."""

import queue
from collections.abc import Callable

from app.messages import Advance, Ask, Command, Load, Play, Reset, SceneCommand


class CommandQueue(queue.SimpleQueue[Command]):
    """Commands for the simulation.

    urgent: one is among them that should not wait for a long solve. begins_anew: one is among them after which the
    scene begins from its start, so that nothing of what runs is needed any more.
    share: where several simulations have one clock, passes a command to the others and returns what is left to do here.
    """

    urgent = begins_anew = False
    share: Callable[[Command], Command] | None = None

    def put(self, item: Command, block: bool = True, timeout: float | None = None) -> None:
        """Add a command, and pass it on to the other simulations on the same clock where it concerns them."""
        self.add(item if self.share is None else self.share(item))

    def add(self, item: Command) -> None:
        """Add a command. What goes on with the solve as it is can wait for it: drags, and going on."""
        super().put(item)
        self.urgent = self.urgent or not isinstance(item, SceneCommand | Play | Ask | Advance)
        self.begins_anew = self.begins_anew or begins_anew(item)


def begins_anew(command: Command) -> bool:
    """Whether the scene begins from its start after this command."""
    return isinstance(command, Reset) or (isinstance(command, Load) and command.state is None)
