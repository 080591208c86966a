"""A camera that moves along with a body, while its user may still turn it."""

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.messages import Vector
from app.render.cameras import SAME_PLACE, is_waiting, place_camera, place_of, set_camera

HAND_TIME = 0.4  # [s] for which a camera is left alone after its user moved it
MIN_BODY_MOTION = 0.02  # [m] that the body moves before the cameras follow
MAX_PLACES = 900  # places that are remembered, for half a minute: a slow page may still report one of them


@dataclass
class FollowedView:
    """The camera of one browser beside the body. Places are (2, 3) [m]: camera and target."""

    offset: NDArray[np.float64]  # (2, 3) [m] camera and target from the body, as the user has put them
    hand_moved: float = -np.inf  # when the user last moved the camera [s]
    places: NDArray[np.float64] = field(default_factory=lambda: np.full((MAX_PLACES, 2, 3), np.inf))  # the last ones
    next_place: int = 0  # index in `places` of the oldest one

    def remember(self, place: NDArray[np.float64]) -> None:
        """Keep a place, instead of the oldest one."""
        self.places[self.next_place] = place
        self.next_place = (self.next_place + 1) % MAX_PLACES

    def is_own(self, place: NDArray[np.float64]) -> bool:
        """True if a reported place is one of those remembered.

        Camera and target arrive one after the other, so that a page may report a new one with an old one: each is
        compared by itself.
        """
        return bool(np.abs(place - self.places).max(axis=2).min(axis=0).max() <= SAME_PLACE)

    def put(self, camera: Any, body: NDArray[np.float64]) -> None:
        """Put the camera beside the body at `body` (3,) [m]."""
        place = body + self.offset
        set_camera(camera, *place)
        self.remember(place)


class FollowCamera:
    """Keeps the camera of each browser where its user has put it beside a body.

    A page reports the place of its camera late. A reported place counts as moved by the user only once the page has
    taken the first one, and only if it is not one of the last places where this class has put it.
    """

    def __init__(self) -> None:
        self.body = np.zeros(3)  # [m] where the cameras last followed to
        self.start_offset = np.zeros((2, 3))  # [m] of a new view
        self.views: dict[int, FollowedView] = {}  # by client

    def start(self, body: NDArray[np.float64], offset: Iterable[Vector]) -> None:
        """Start beside a body at `body` (3,) [m]; offset: camera and target from it [m]."""
        self.body, self.start_offset = body, np.array(list(offset))
        self.views = {}

    def follow(self, body: NDArray[np.float64], cameras: Mapping[int, Any], now: float | None = None) -> None:
        """Follow to `body` (3,) [m] with the cameras by client; now: [s] of any clock, None for the computer's."""
        now = time.monotonic() if now is None else now
        body_moved = float(np.abs(body - self.body).max()) > MIN_BODY_MOTION
        for client in self.views.keys() - cameras.keys():
            del self.views[client]
        for client, camera in cameras.items():
            view = self.views.get(client)
            if view is None:
                view = self.views[client] = FollowedView(self.start_offset)
                place = body + view.offset
                place_camera(camera, *place)
                view.remember(place)
            if is_waiting(camera):
                continue
            place = place_of(camera)
            elsewhere = not view.is_own(place)
            if elsewhere:
                view.offset, view.hand_moved = place - body, now
                view.remember(place)
            elif body_moved and now - view.hand_moved > HAND_TIME:
                view.put(camera, body)
        if body_moved:
            self.body = body
