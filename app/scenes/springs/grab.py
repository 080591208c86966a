"""A particle that a browser has grabbed, and pulls with the mouse."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.springs import Grab


class GrabFrame(NamedTuple):
    """The grab as drawn."""

    particle: int  # flat index
    target: Vector  # [m] where it is pulled to
    load: float  # the force over the largest force of a grab, 0 to 1
    limit: float  # [N] the largest force


class GrabSpring(NamedTuple):
    """The spring between a particle and the mouse."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    max_force: float  # [N]


SpringOf: TypeAlias = Callable[[int], GrabSpring]  # flat index of a particle -> the spring of its grab


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

    def pull(self, t: float, duration: float, shape: tuple[int, int], spring_of: SpringOf) -> Grab | None:
        """The grab over the next `duration` [s] from time t [s], None if nothing is grabbed. Moves the hand on.

        shape: rows and columns of the net; the particles of several nets are numbered through.
        """
        if self.grabbed is None:
            return None
        _, particle, hand = self.grabbed
        hand.advance(t, duration)
        row, column = divmod(particle % (shape[0] * shape[1]), shape[1])
        return Grab(row, column, hand.position, *spring_of(particle))

    def frame(self, x: NDArray[np.float64], spring_of: SpringOf, offset: float = 0.0) -> GrabFrame | None:
        """The grab as drawn, None if nothing is grabbed.

        x: (3, rows, columns) [m] of the net with the particle. offset: [m] of its drawing along y.
        """
        if self.grabbed is None:
            return None
        _, particle, hand = self.grabbed
        position, spring = x.reshape(3, -1)[:, particle % x[0].size], spring_of(particle)
        distance = float(np.linalg.norm(np.asarray(hand.position) - position))
        load = min(1.0, distance * spring.stiffness / spring.max_force)
        return GrabFrame(
            particle, (hand.position[0], hand.position[1] + offset, hand.position[2]), load, spring.max_force
        )

    def clear(self) -> None:
        """Release it from any client."""
        self.grabbed = None
