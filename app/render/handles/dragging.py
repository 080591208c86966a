"""Dragging with the mouse: commands to the simulation, and the line from the grabbed point to the mouse."""

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.messages import Command, GrabTo, Pull, Release, finite_vector

GRAB_COLOUR, LIMIT_COLOUR = (255, 90, 60), (150, 0, 60)


def drag(post: Callable[[Command], None], event: Any, index: int | None) -> None:
    """Post the command of viser's drag event: its browser pulls thing `index` to the mouse, or lets go."""
    target = finite_vector(event.end_position)
    if event.phase == "end" or target is None or index is None:
        post(Release(event.client_id))
    else:
        post(GrabTo(int(index), target, event.client_id))


class SurfaceDrag:
    """Drags of a surface: each browser pulls the point that was nearest when its drag began."""

    def __init__(self, post: Callable[[Command], None]) -> None:
        self.post = post
        self.grabbed: dict[int, int] = {}  # client -> point

    def handle(self, event: Any, points: np.ndarray) -> None:
        """Post the command of viser's drag event. points: (n, 3) as drawn [m]."""
        if event.phase == "start":
            self.grabbed[event.client_id] = int(np.argmin(np.linalg.norm(points - event.start_position, axis=1)))
        drag(self.post, event, self.grabbed.get(event.client_id))
        if event.phase == "end":
            self.grabbed.pop(event.client_id, None)


class GrabLine:
    """A line that is drawn while something is grabbed. Where the force is at its limit, colour and words say so."""

    def __init__(self, server: viser.ViserServer, name: str = "/pull") -> None:
        self.server, self.name, self.is_at_limit = server, name, False
        self.words: viser.LabelHandle | None = None  # made at the first limit
        self.line = server.scene.add_line_segments(
            name,
            np.zeros((1, 2, 3), np.float32),
            colors=GRAB_COLOUR,
            thickness=4.0,
            thickness_units="screen",
            visible=False,
        )

    def show(self, ends: Any, load: float = 0.4, limit: str = "") -> None:
        """ends: (2, 3) [m], None while nothing is grabbed. load: fraction of the largest force of the grab, 0 to 1.

        limit: words for what limits it.
        """
        self.show_limit(ends, limit if ends is not None and load >= 1.0 else "")
        self.line.visible = ends is not None
        if ends is not None:
            self.line.points = np.array([ends], np.float32)
            self.line.thickness = 2.0 + 5.0 * load

    def show_pull(self, pull: Pull | None) -> None:
        """pull: of a body; None while nothing is grabbed."""
        if pull is None:
            self.show(None)
        else:
            self.show((pull.place, pull.target), pull.load, pull.limit)

    def show_limit(self, ends: Any, words: str) -> None:
        """Name the limit of the pull at the end of its line, or remove the name."""
        is_at_limit = words != ""
        if is_at_limit is not self.is_at_limit:
            self.is_at_limit = is_at_limit
            self.line.colors = np.array(LIMIT_COLOUR if is_at_limit else GRAB_COLOUR, np.uint8)
            if self.words is None:
                self.words = self.server.scene.add_label(f"{self.name}/limit", "", anchor="bottom-center")
            self.words.visible = is_at_limit
        if is_at_limit and self.words is not None:
            if self.words.text != words:
                self.words.text = words
            self.words.position = np.asarray(ends[1], float)
