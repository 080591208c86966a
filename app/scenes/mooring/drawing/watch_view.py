"""The watch circle, and the path of the body: on the water, and again on the bed, where the body hides nothing."""

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.scenes.mooring.arrangement import depth_of, extent
from app.scenes.mooring.drawing.lines_view import radius_of
from app.scenes.mooring.frame import MooringFrame

CIRCLE_POINTS = 96
MAX_DRAWN_PATH = 400  # places of the body's path
WATCH_COLOUR, PATH_COLOUR = (200, 30, 60), (250, 250, 250)


class WatchCircle:
    """The circle that the body has not left, and its path."""

    def __init__(self, server: viser.ViserServer, frame: MooringFrame) -> None:
        far = extent(frame.params)
        self.parts = [
            (part, add_stroke(server, f"/watch/{part}_{i}", colour, width), height)
            for i, height in enumerate((0.0, -depth_of(frame.params) + radius_of(far)))
            for part, colour, width in (("circle", WATCH_COLOUR, 3.5), ("path", PATH_COLOUR, 2.0))
        ]

    def show(self, frame: MooringFrame) -> None:
        """Draw both, or hide them."""
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

    def remove(self) -> None:
        """Remove both from the scene."""
        for _, handle, _ in self.parts:
            handle.remove()


def add_stroke(
    server: viser.ViserServer, name: str, colour: tuple[int, int, int], thickness: float
) -> viser.LineSegmentsHandle:
    """A line of pieces, so far of one without length."""
    return server.scene.add_line_segments(
        name, np.zeros((1, 2, 3), np.float32), colors=colour, thickness=thickness, thickness_units="screen"
    )
