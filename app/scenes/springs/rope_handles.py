"""Parts of a rope that a user moves: its root, the sphere, and one dragged point."""

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from app.messages import GrabTo, Place, Release, SceneCommand, Vector, vector_of
from app.scenes.springs.grab import GrabFrame, GrabSpring, ParticleGrab, SpringOf
from app.scenes.springs.rope_parameters import ROOT, SPHERE, SharedRopeParams
from app.scenes.springs.tracking import CriticallyDampedTracker
from sim.springs import Net
from sim.springs.state import State

MAX_GRAB_RATE = 30.0  # [1/s] natural frequency of the grab of a free point
MAX_GRAB_RATE_STEP = 0.5  # the same times the time step, so that it is stable at any step


def grab_spring(net: Net, step: float, max_force: float) -> SpringOf:
    """The spring of a grab, which damps a free point critically. step: [s]. max_force: [N]."""
    masses = net.masses[0]

    def of_point(point: int) -> GrabSpring:
        rate, mass = min(MAX_GRAB_RATE, MAX_GRAB_RATE_STEP / step), float(masses[point % masses.size])
        return GrabSpring(mass * rate**2, 2.0 * mass * rate, max_force)

    return of_point


def offset_of(number: int, ropes: int, spacing: float) -> float:
    """Drawn y [m] of rope `number`, from 0, of `ropes`. All move in the same place; only the drawing differs."""
    return (number - 0.5 * (ropes - 1)) * spacing


class RopeHandles:
    """Smooth paths of root, sphere and dragged point, as a browser sends places that jump."""

    def __init__(self) -> None:
        self.home = ROOT  # [m] where the root was put; it swings about it where the parameters ask for that
        self.root = CriticallyDampedTracker(ROOT)
        self.end: CriticallyDampedTracker | None = None  # of a last point that is held
        self.sphere = CriticallyDampedTracker(SPHERE)
        self.grab = ParticleGrab()

    def move_root(self, position: Vector) -> None:
        """Move the root, or the centre of its swing."""
        self.home = self.root.target = position

    def move_end(self, position: Vector) -> None:
        """Move a last point that is held."""
        if self.end is not None:
            self.end.target = position

    def handle(self, command: SceneCommand, ropes: Sequence[State], spacing: float = 0.0) -> None:
        """Move root or sphere, pull a point, or release it.

        The points of several ropes are numbered through. spacing: [m] between ropes as drawn, along y.
        """
        match command:
            case Place("root", position):
                self.move_root(position)
            case Place("sphere", position):
                self.sphere.target = position
            case GrabTo(index, (x, y, z), client) if 0 <= index < sum(state.x.shape[2] for state in ropes):
                number, point = divmod(index, ropes[0].x.shape[2])
                target = x, y - offset_of(number, len(ropes), spacing), z
                is_end = self.end is not None and point == ropes[0].x.shape[2] - 1
                if point > 0 and not is_end:
                    self.grab.move(client, index, vector_of(ropes[number].x[:, 0, point]), target)
                elif self.grab.may_move(client):
                    self.move_end(target) if is_end else self.move_root(target)
            case Release(client):
                self.grab.release(client)
            case _:
                pass

    @property
    def at_rest(self) -> bool:
        """True if nothing is moved."""
        ends_rest = self.root.at_rest and (self.end is None or self.end.at_rest)
        return ends_rest and self.sphere.at_rest and self.grab.grabbed is None

    def restart(self, root: Vector = ROOT, end: Vector | None = None) -> None:
        """Root, held end and sphere at rest where a new scene has them; nothing grabbed."""
        self.home = root
        self.end = None if end is None else CriticallyDampedTracker(end)
        self.root.place_at(root)
        self.sphere.place_at(SPHERE)
        self.grab.clear()

    def net_during(self, net: Net, t: float, duration: float, step: float, params: SharedRopeParams) -> Net:
        """`net` with the motions of root, sphere and grab over the next `duration` [s] from time t [s].

        step: [s]. The same object where nothing moves, as in most frames.
        """
        x, y, z = self.home
        swing = params.root_swing * math.sin(2.0 * math.pi * (t + duration) / params.swing_period)
        self.root.target = x + swing, y, z
        if self.at_rest and not (net.pin_paths or net.grab or any(net.sphere_velocity)):
            return net
        held = {(0, 0): self.root.advance(t, duration)}
        if self.end is not None:
            held[0, net.shape[1] - 1] = self.end.advance(t, duration)
        before = self.sphere.position
        self.sphere.advance(t, duration)
        velocity = tuple((b - a) / duration for a, b in zip(before, self.sphere.position, strict=True))
        return dataclasses.replace(
            net,
            pin_paths=tuple((pin, path) for pin, path in held.items() if path is not None),
            sphere=(*before, net.sphere[3]) if net.sphere else None,
            sphere_velocity=velocity,
            epoch=t,
            grab=self.grab.pull(t, duration, net.shape, grab_spring(net, step, params.pull)),
        )

    def grab_frame(
        self, ropes: Sequence[NDArray[np.float64]], spring_of: SpringOf, spacing: float = 0.0
    ) -> GrabFrame | None:
        """The grab as drawn, None if nothing is grabbed.

        ropes: (3, 1, points) of each [m]. spacing: [m] between ropes as drawn, along y.
        """
        number = self.grab.grabbed.particle // ropes[0].shape[2] if self.grab.grabbed else 0
        return self.grab.frame(ropes[number], spring_of, offset_of(number, len(ropes), spacing))
