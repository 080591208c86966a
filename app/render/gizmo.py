"""Arrows that move a thing: a drag posts where it is put, and the arrows follow where it goes by other means."""

import time
from collections.abc import Callable
from typing import Any

import viser

from app.messages import Command, Place, Vector, finite_vector

HANDS_OFF = 0.5  # [s] after its last drag that the arrows are left alone
STILL = 1e-4  # [m] by which they may be off


class Gizmo:
    """The arrows of one thing, named as in `Place`."""

    def __init__(
        self, server: viser.ViserServer, post: Callable[[Command], None], thing: str, scale: float, **options: Any
    ) -> None:
        """options: of viser's transform controls."""
        self.dragged_at = 0.0
        self.shown: tuple[Vector | None] | None = None  # what it was last found, or put, to show
        self.handle = server.scene.add_transform_controls(
            f"/{thing.replace(' ', '_')}_gizmo", scale=scale, disable_rotations=True, depth_test=False, **options
        )

        @self.handle.on_update
        async def _(event: Any) -> None:
            self.dragged_at, self.shown = time.monotonic(), None
            place = finite_vector(event.target.position)
            if place is not None:
                post(Place(thing, place))

    def show(self, position: Vector | None) -> None:
        """Move to where the thing was put by other means, unless being dragged; None hides."""
        if self.shown == (position,):
            return
        self.handle.visible = position is not None
        if position is None:
            self.shown = (None,)
            return
        if time.monotonic() - self.dragged_at <= HANDS_OFF:
            return
        if max(abs(float(a) - b) for a, b in zip(self.handle.position, position, strict=True)) > STILL:
            self.handle.position = position
        self.shown = (position,)
