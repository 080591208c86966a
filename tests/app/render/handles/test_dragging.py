"""What the drags of several browsers post."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from app.messages import Command, GrabTo, Release
from app.render.handles.dragging import SurfaceDrag, drag

POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])


def event(client: int, phase: str, start: tuple[float, ...], end: tuple[float, ...]) -> Any:
    """An event with the fields of viser's that are read."""
    return SimpleNamespace(client_id=client, phase=phase, start_position=start, end_position=end)


def test_two_browsers_drag_the_same_surface_by_points_of_their_own() -> None:
    posted: list[Command] = []
    surface = SurfaceDrag(posted.append)
    surface.handle(event(1, "start", (0.1, 0.0, 0.0), (0.1, 0.0, 0.0)), POINTS)
    surface.handle(event(2, "start", (1.9, 0.0, 0.0), (1.9, 0.0, 0.0)), POINTS)
    surface.handle(event(1, "update", (0.1, 0.0, 0.0), (0.0, 1.0, 0.0)), POINTS + 5.0)  # it has moved meanwhile
    surface.handle(event(2, "end", (1.9, 0.0, 0.0), (1.9, 1.0, 0.0)), POINTS)
    surface.handle(event(1, "end", (0.1, 0.0, 0.0), (0.0, 1.0, 0.0)), POINTS)
    assert posted == [
        GrabTo(0, (0.1, 0.0, 0.0), 1), GrabTo(2, (1.9, 0.0, 0.0), 2), GrabTo(0, (0.0, 1.0, 0.0), 1),
        Release(2), Release(1),
    ]  # fmt: skip
    assert surface.grabbed == {}


def test_a_drag_to_a_place_that_is_not_finite_lets_go() -> None:
    posted: list[Command] = []
    drag(posted.append, event(3, "update", (0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0)), 1)
    drag(posted.append, event(3, "update", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), None)
    assert posted == [Release(3), Release(3)]
