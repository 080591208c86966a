"""What the drags of several browsers post."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from app.formats.formatting import largest_force
from app.messages import Command, GrabTo, Pull, Release
from app.render.handles.dragging import GRAB_COLOUR, LIMIT_COLOUR, GrabLine, SurfaceDrag, drag

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


def test_the_line_of_a_pull_says_when_its_force_is_the_largest(server: Any) -> None:
    line, ends = GrabLine(server), (np.zeros(3), (1.0, 2.0, 3.0))
    line.show(ends, 0.99, "15 N: the most")
    assert line.words is None
    for load, is_at_limit in ((1.0, True), (0.5, False), (1.0, True)):
        line.show(ends, load, "15 N: the most")
        assert line.words is not None
        assert line.words.visible is is_at_limit
        assert tuple(np.ravel(line.line.colors)[:3]) == (LIMIT_COLOUR if is_at_limit else GRAB_COLOUR)
    assert line.words is not None
    assert line.words.text == "15 N: the most"
    assert tuple(line.words.position) == (1.0, 2.0, 3.0)
    line.show(None)
    assert not line.words.visible
    line.show_pull(Pull((0.0, 0.0, 0.0), (1.0, 1.0, 3.0), 1.0, largest_force(2.4e5)))
    assert line.words.visible
    assert line.words.text == "240 kN: the largest mouse force"
    line.show_pull(None)
    assert not line.words.visible
    assert not line.line.visible
    line.show(ends)  # of a thing whose limit is not known
    assert not line.words.visible
