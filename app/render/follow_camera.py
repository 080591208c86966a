"""A camera that goes along with a body, and still lets itself be turned."""

import time
from collections.abc import Iterable
from typing import Any

import numpy as np

from app.messages import Vector

SAME = 0.02  # [m] within which a camera, or its target, is where it was put
HANDS_ON = 0.4  # [s] since a hand last moved the camera, for which it is left alone
SETTLING = 1.5  # [s] from a camera's first placing: until then a page may still answer with where it was before
STEP = 0.02  # [m] that the body goes before the cameras follow
KEPT = 900  # placings, half a minute of them, that a slow page may still answer with


class FollowCamera:
    """Keeps each browser's camera where its user has put it beside a body.

    A page answers late, so what it says of its camera is the hand of a user only where it is none of the last placings.
    """

    def __init__(self) -> None:
        self.here = np.zeros(3)
        self.offset = np.zeros((2, 3))  # [m] camera and target from the body as it begins
        self.first = np.zeros((2, 3))  # [m] where both then are: a page that has just come may take them up late
        self.mine: dict[int, np.ndarray] = {}  # client -> the same, as its user has it now
        self.placed: dict[int, np.ndarray] = {}  # client -> (KEPT, 2, 3), the last ones in a ring
        self.turn: dict[int, int] = {}
        self.since: dict[int, float] = {}  # client -> when it was first placed [s]
        self.moved: dict[int, float] = {}  # client -> when a hand last moved its camera [s]

    def start(self, here: np.ndarray, offset: Iterable[Vector]) -> None:
        """Begin beside a body at `here` (3,) [m]; offset: camera and target from it [m]."""
        self.here, self.offset = here, np.array(list(offset))
        self.first = here + self.offset
        self.mine, self.placed, self.turn, self.since, self.moved = {}, {}, {}, {}, {}

    def go(self, here: np.ndarray, cameras: dict[int, Any], now: float | None = None) -> None:
        """Follow to `here` (3,) [m] with the cameras by client; now [s]: a clock."""
        now = time.monotonic() if now is None else now
        on = float(np.abs(here - self.here).max()) > STEP
        for client, camera in cameras.items():
            if client not in self.mine:
                before = np.array([camera.position, camera.look_at], float)
                self.mine[client], self.turn[client], self.since[client] = self.offset, 0, now
                self.placed[client] = np.full((KEPT, 2, 3), np.inf)
                self.remember(client, before)
                self.remember(client, self.first)
                self.place(client, camera, here)
                continue
            at = np.array([camera.position, camera.look_at], float)
            # The two arrive one after the other, so that a page may answer with a new one and an old.
            off = np.abs(at - self.placed[client]).max(axis=2).min(axis=0)
            elsewhere = bool(off.max() > SAME)
            if elsewhere and now - self.since[client] > SETTLING:
                self.mine[client], self.moved[client] = at - here, now
                self.remember(client, at)
            elif (on or elsewhere) and now - self.moved.get(client, -np.inf) > HANDS_ON:
                self.place(client, camera, here)
        if on:
            self.here = here

    def place(self, client: int, camera: Any, here: np.ndarray) -> None:
        """Put a camera beside `here`."""
        at = here + self.mine[client]
        camera.position, camera.look_at = at
        self.remember(client, at)

    def remember(self, client: int, at: np.ndarray) -> None:
        """Keep a placing (2, 3) [m] in the place of the oldest."""
        self.placed[client][self.turn[client]] = at
        self.turn[client] = (self.turn[client] + 1) % KEPT
