"""The square sea as water, with its probe, rain and grid."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Snapshot
from app.scenes.phillips import Params, SeaPicture
from app.water import Look, Water, sky

EYE = (0.44, 0.5, 0.028)  # of the tile's length
TARGET = (0.62, 0.5, 0.004)
TILES = 5


class Picture:
    """Draws `SeaPicture`s."""

    CAMERA = (tuple(256.0 * c for c in EYE), tuple(256.0 * c for c in TARGET))

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: Water | None = None
        self.shape: tuple[int, float] = (0, 256.0)
        self.lit: tuple[Any, ...] = ()
        self.look = Look()
        self.last: SeaPicture | None = None

    def show(self, picture: SeaPicture) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        p = picture.params
        if self.lit != (p.sky, p.sun):
            self.lit = p.sky, p.sun
            self.light = sky(self.server, p.sky, math.radians(p.sun))
        look = self.dress(picture)
        shape = len(picture.vertices), p.length
        if self.water is None or shape != self.shape:
            if self.water is not None:
                self.water.remove()
            self.water = Water(self.server, "/sea", shape[0], shape[0], p.length, tiles=TILES, look=look)
            self.fly(p.length / self.shape[1])
            self.shape = shape
        elif look != self.look:
            self.water.set_look(look)
        self.look = look
        if self.last is None or picture.vertices is not self.last.vertices:
            self.water.set_surface(picture.vertices, picture.slopes, picture.foam, picture.time)
        self.last = picture

    def dress(self, picture: SeaPicture) -> Look:
        """The look under this sky: ripples carry what of Cox and Munk's slope the mesh does not."""
        p: Params = picture.params
        missing = max(0.003 + 0.00512 * p.wind_speed - picture.slope_resolved, 0.001)
        return dataclasses.replace(
            self.light,
            clouds=p.clouds,
            haze=p.visibility,
            ripple_slope=round(min(math.sqrt(missing), 0.25), 3),
            ripple_length=2.5 * p.length / len(picture.vertices),
            ripple_direction=math.radians(p.wind_direction),
            foam_scale=max(0.008 * p.length, 0.4),
            wireframe=p.overlay,
        )

    def fly(self, factor: float) -> None:
        """Take every camera along to a tile `factor` times as long."""
        if factor == 1.0:
            return
        first = self.server.initial_camera
        for camera in (first, *(client.camera for client in self.server.get_clients().values())):
            camera.position = np.asarray(camera.position) * factor
            camera.look_at = np.asarray(camera.look_at) * factor


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()


def readout(snapshot: Snapshot) -> str:
    """What of the sea can be said in numbers, as HTML."""
    g = snapshot.gauge
    return f"g = {g.gravity:.3g} m/s² · foam {g.foam:.1%} (Monahan {g.foam_asked:.1%})"


def marks(snapshot: Snapshot) -> dict[str, str]:
    """What is written under a knob."""
    return {}
