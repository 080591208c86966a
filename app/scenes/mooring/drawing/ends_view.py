"""The ends of the lines: balls at anchors and fairleads, and the numbers of the lines."""

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.handles.viser_inside import set_arrays
from app.render.meshes import ball
from app.scenes.mooring.arrangement import extent
from app.scenes.mooring.drawing.paint import linear
from app.scenes.mooring.frame import MooringFrame

ANCHOR_SIZE, FAIRLEAD_SIZE = 0.02, 0.009  # radius, in the same
ANCHOR_COLOUR, LIFTED_COLOUR, FAIRLEAD_COLOUR = (50, 54, 62), (214, 40, 40), (30, 32, 38)


class DrawnEnds:
    """Anchors, fairleads and numbers. An anchor that is pulled upwards is red."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        far = extent(frame.params)
        self.anchors = balls(server, "/anchors", frame.anchors, ANCHOR_SIZE * far, ANCHOR_COLOUR)
        self.fairleads = balls(server, "/fairleads", frame.fairleads, FAIRLEAD_SIZE * far, FAIRLEAD_COLOUR)
        self.lifted = np.zeros(len(frame.anchors), bool)
        self.above = 2 * ANCHOR_SIZE * far  # [m] of a number over its anchor
        self.numbers = [
            server.scene.add_label(f"/number_{i + 1}", str(i + 1), position=tuple(place), anchor="bottom-center")
            for i, place in enumerate((frame.points[:, 0] + (0.0, 0.0, self.above)).tolist())
        ]

    def show(self, frame: MooringFrame) -> None:
        """Move and colour them."""
        set_arrays(self.anchors, batched_positions=frame.anchors)
        set_arrays(self.fairleads, batched_positions=frame.fairleads)
        if (frame.uplift != self.lifted).any():
            self.lifted = frame.uplift
            self.anchors.batched_colors = np.array(
                [linear(LIFTED_COLOUR if one else ANCHOR_COLOUR) for one in self.lifted], np.uint8
            )
        for number, (x, y, z) in zip(self.numbers, frame.points[:, 0].tolist(), strict=True):
            place = x, y, z + self.above
            if tuple(number.position) != place:
                number.position = place

    def remove(self) -> None:
        """Remove them from the scene."""
        for part in (self.anchors, self.fairleads, *self.numbers):
            part.remove()


def balls(
    server: viser.ViserServer, name: str, places: NDArray[np.float32], radius: float, colour: tuple[int, int, int]
) -> Any:
    """A ball at each place (n, 3) [m]."""
    vertices, faces = ball(6)
    n = len(places)
    return server.scene.add_batched_meshes_simple(
        name, (radius * vertices).astype(np.float32), faces, lod="off",
        batched_wxyzs=np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (n, 1)), batched_positions=places,
        batched_colors=np.tile(np.array(linear(colour), np.uint8), (n, 1)),
    )  # fmt: skip
