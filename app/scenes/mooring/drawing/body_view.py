"""The body or vessel of the mooring, painted as ships are, in slices of its hull."""

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.scenes.mooring.arrangement import has_body, hull_of, is_round, width_of
from app.scenes.mooring.drawing.paint import linear
from app.scenes.mooring.frame import MooringFrame
from sim.floating.motion.rotation import rotation_matrix

# The body as drawn, from below: antifouling up to the waterline, a stripe and paint.
PAINTS = ((1.0, (112, 30, 26)), (1.012, (238, 240, 240)), (1.0, (240, 128, 24)))  # width over the hull's, colour
STRIPE = 0.045  # height, in widths of the hull
# Parts on deck, without weight: width over the hull's, height in widths of the hull, colour.
ON_DECK = ((0.46, 0.18, (236, 238, 238)), (0.06, 0.42, (60, 66, 74)), (0.13, 0.08, (250, 206, 60)))


class DrawnBody:
    """The body."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame, on_drag: Callable[[Any], Any]) -> None:
        """on_drag: takes the events of a mouse that drags it."""
        p = frame.params
        hull = hull_of(p)
        width, low, high = width_of(p), *(float(edge) for edge in hull.extents[2])
        line = min(max(-frame.rest[2], low + 2 * STRIPE * width), high - 2 * STRIPE * width)  # as it floats
        edges = [low, line, line + STRIPE * width, high, *(high + width * np.cumsum([part for _, part, _ in ON_DECK]))]
        self.slices = np.array(edges[:-1]) + 0.5 * np.diff(edges)  # heights [m] of their middles over the body's centre
        wide = [part for part, *_ in (*PAINTS, *ON_DECK)]
        self.handle = server.scene.add_batched_meshes_simple(
            "/body", (hull.vertices / (1.0, 1.0, high - low)).astype(np.float32), hull.faces.astype(np.uint32),
            flat_shading=not is_round(p), lod="off", **self.places(frame),
            batched_scales=np.column_stack([wide, wide, np.diff(edges)]).astype(np.float32),
            batched_colors=np.array([linear(colour) for *_, colour in (*PAINTS, *ON_DECK)], np.uint8),
        )  # fmt: skip
        self.handle.visible = has_body(p)
        self.handle.on_drag("left")(on_drag)

    def places(self, frame: MooringFrame) -> dict[str, Any]:
        """Places and rotations of the slices."""
        places = frame.body + self.slices[:, None] * rotation_matrix(frame.rotation)[:, 2]
        turns = np.tile(frame.rotation, (len(places), 1))
        return {"batched_positions": places.astype(np.float32), "batched_wxyzs": turns}

    def show(self, frame: MooringFrame) -> None:
        """Move it."""
        set_arrays(self.handle, **self.places(frame))

    def remove(self) -> None:
        """Remove it from the scene."""
        self.handle.remove()
