"""A particle that a browser has grabbed, and pulls with the mouse."""

from typing import NamedTuple

from app.messages import Vector
from app.scenes.springs.tracking import CriticallyDampedTracker


class GrabFrame(NamedTuple):
    """The grab as drawn."""

    particle: int  # flat index
    target: Vector  # [m] where it is pulled to
    load: float  # the force over the largest force of a grab, 0 to 1


class GrabbedParticle(NamedTuple):
    """A particle that is grabbed."""

    client: int  # the browser that drags
    particle: int  # flat index
    hand: CriticallyDampedTracker  # smooth path of the mouse, which jumps some twenty times a second


class ParticleGrab:
    """At most one grabbed particle, as a net has one grab. While a browser has one, those of others are ignored."""

    def __init__(self) -> None:
        self.grabbed: GrabbedParticle | None = None

    def may_move(self, client: int) -> bool:
        """True if this browser has grabbed a particle, or nobody has."""
        return self.grabbed is None or self.grabbed.client == client

    def move(self, client: int, particle: int, start: Vector, target: Vector) -> None:
        """Pull `particle`, which is at `start` [m], towards `target` [m], unless another browser has grabbed one."""
        if not self.may_move(client):
            return
        if self.grabbed is None or self.grabbed.particle != particle:
            self.grabbed = GrabbedParticle(client, particle, CriticallyDampedTracker(start))
        self.grabbed.hand.target = target

    def release(self, client: int) -> None:
        """Release the particle that this browser has grabbed."""
        if self.grabbed is not None and self.grabbed.client == client:
            self.grabbed = None

    def clear(self) -> None:
        """Release it, whoever has grabbed it."""
        self.grabbed = None
