"""Arrows that move a thing: dragging them posts its new position; where it moves by other means, they follow."""

import time
from collections.abc import Callable
from typing import Any

import viser

from app.messages import Command, Place, Vector, finite_vector

DRAG_TIME = 0.5  # [s] after the last drag event for which the arrows are not moved
MAX_POSITION_ERROR = 1e-4  # [m] by which the arrows may be off


class Gizmo:
    """The arrows of one thing, named as in `Place`."""

    def __init__(
        self, server: viser.ViserServer, post: Callable[[Command], None], thing: str, scale: float, **options: Any
    ) -> None:
        """scale: length of the arrows [m]. options: of viser's transform controls."""
        self.offset: Vector = (0.0, 0.0, 0.0)  # [m] of the arrows from the thing
        self.dragged_at = 0.0  # [s]
        # In a tuple: the position that was last shown, None if the arrows are hidden. No tuple: it is not known.
        self.shown: tuple[Vector | None] | None = None
        self.handle = server.scene.add_transform_controls(
            f"/{thing.replace(' ', '_')}_gizmo", scale=scale, disable_rotations=True,
            disable_sliders=True, depth_test=False, **options,
        )  # fmt: skip

        @self.handle.on_update
        async def _(event: Any) -> None:
            self.dragged_at, self.shown = time.monotonic(), None
            position = finite_vector(p - d for p, d in zip(event.target.position, self.offset, strict=True))
            if position is not None:
                post(Place(thing, position))

    def show(self, position: Vector | None, height: float = 0.0) -> None:
        """Move to where the thing is, unless the arrows are being dragged.

        position: [m] of the thing; None hides the arrows. height: [m] of the arrows above it, so that they do not cover
        it.
        """
        self.offset = 0.0, 0.0, height
        if position is not None:
            position = position[0], position[1], position[2] + height
        if self.shown == (position,):
            return
        self.handle.visible = position is not None
        if position is None:
            self.shown = (None,)
            return
        if time.monotonic() - self.dragged_at <= DRAG_TIME:
            return
        if max(abs(float(a) - b) for a, b in zip(self.handle.position, position, strict=True)) > MAX_POSITION_ERROR:
            self.handle.position = position
        self.shown = (position,)
