"""The drag of one particle by a browser."""

from typing import NamedTuple

from app.messages import Vector
from app.scenes.springs.tracking import CriticallyDampedTracker


class PullFrame(NamedTuple):
    """The pull as drawn."""

    particle: int  # flat index
    target: Vector  # [m] where it is pulled to
    load: float  # the force over the largest force of a drag, 0 to 1


class Hold(NamedTuple):
    """A particle that is held."""

    client: int  # the browser that drags
    particle: int  # flat index
    hand: CriticallyDampedTracker  # smooth path of the mouse, which jumps some twenty times a second


class Drag:
    """At most one held particle, as a net has one pull. While a browser holds one, those of others are ignored."""

    def __init__(self) -> None:
        self.hold: Hold | None = None

    def may_move(self, client: int) -> bool:
        """True if this browser holds a particle, or nobody does."""
        return self.hold is None or self.hold.client == client

    def move(self, client: int, particle: int, start: Vector, target: Vector) -> None:
        """Pull `particle`, which is at `start` [m], towards `target` [m], unless another browser holds one."""
        if not self.may_move(client):
            return
        if self.hold is None or self.hold.particle != particle:
            self.hold = Hold(client, particle, CriticallyDampedTracker(start))
        self.hold.hand.target = target

    def release(self, client: int) -> None:
        """Release the particle that this browser holds."""
        if self.hold is not None and self.hold.client == client:
            self.hold = None

    def clear(self) -> None:
        """Let go, whoever holds."""
        self.hold = None
