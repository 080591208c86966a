"""The watch circle, and the path of the body: on the water, and again on the bed, where the body hides nothing.

A label names the circle once it is large enough to be seen as one.
"""

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.scenes.mooring.arrangement import depth_of, extent
from app.scenes.mooring.drawing.lines_view import radius_of
from app.scenes.mooring.frame import MooringFrame

CIRCLE_POINTS = 96
MAX_DRAWN_PATH = 400  # places of the body's path
NAME, NAME_ON_BED = "watch circle", "watch circle, on the bed"
LABELLED = 0.05  # radius of a circle with a name, in `extent`s
WATCH_COLOUR, PATH_COLOUR = (200, 30, 60), (250, 250, 250)


class WatchCircle:
    """The circle that the body has not left, and its path."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        far = extent(frame.params)
        self.least = LABELLED * far
        heights = 0.0, -depth_of(frame.params) + radius_of(far)
        self.names = [
            (server.scene.add_label(f"/watch/name_{i}", name, anchor="center-left", visible=False), height)
            for i, (name, height) in enumerate(zip((NAME, NAME_ON_BED), heights, strict=True))
        ]
        self.parts = [
            (part, add_stroke(server, f"/watch/{part}_{i}", colour, width), height)
            for i, height in enumerate(heights)
            for part, colour, width in (("circle", WATCH_COLOUR, 3.5), ("path", PATH_COLOUR, 2.0))
        ]

    def show(self, frame: MooringFrame) -> None:
        """Draw both, or hide them."""
        self.show_names(frame)
        for _, handle, _ in self.parts:
            if handle.visible != frame.params.watch:
                handle.visible = frame.params.watch
        if not frame.params.watch:
            return
        turn = 2 * np.pi * np.arange(CIRCLE_POINTS + 1) / CIRCLE_POINTS
        ring = np.array(frame.rest[:2]) + frame.offset * np.column_stack([np.cos(turn), np.sin(turn)])
        lines = {"circle": ring, "path": frame.path[-MAX_DRAWN_PATH:]}
        for part, handle, height in self.parts:
            line = lines[part]
            if len(line) > 1:
                level = np.column_stack([line, np.full(len(line), height)]).astype(np.float32)
                set_arrays(handle, points=np.stack([level[:-1], level[1:]], axis=1))

    def show_names(self, frame: MooringFrame) -> None:
        """Draw the names at the right edge of the circles, or hide them."""
        is_named = frame.params.watch and frame.offset >= self.least
        for label, height in self.names:
            if label.visible != is_named:
                label.visible = is_named
            place = frame.rest[0] + frame.offset, frame.rest[1], height
            if is_named and tuple(label.position) != place:
                label.position = place

    def remove(self) -> None:
        """Remove both from the scene."""
        for handle in (*(handle for _, handle, _ in self.parts), *(label for label, _ in self.names)):
            handle.remove()


def add_stroke(
    server: viser.ViserServer, name: str, colour: tuple[int, int, int], thickness: float
) -> viser.LineSegmentsHandle:
    """A line of pieces, so far of one without length."""
    return server.scene.add_line_segments(
        name, np.zeros((1, 2, 3), np.float32), colors=colour, thickness=thickness, thickness_units="screen"
    )
