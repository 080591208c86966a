"""The square sea as water, with its rain, its probe and its grid."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Point, Snapshot, Vector, finite_vector
from app.render.water import Look, Water, sky
from app.scenes.square_sea import report
from app.scenes.square_sea.parameters import SURFACE_TENSION, gravity
from app.scenes.square_sea.rain_view import RainMesh
from app.scenes.square_sea.scene import Params, SeaFrame

LENGTH = Params().length  # [m] tile of the first view
VIEWS = {  # [m]: height of the eye, how far ahead it looks, and how high there
    "swimmer": (1.7, 6.0, 0.5),
    "deck": (2.6, 11.5, 2.2),
    "bridge": (4.5, 30.0, 3.6),
    "mast": (8.0, 40.0, 6.0),
    "gull": (40.0, 70.0, 0.0),
}
BEHIND = 20.0  # [m] the eye is at most behind the middle of the tile, where the rain is
TILES = 5
FAR = 20_000.0  # [m] where the view ends
OVERCAST = (0.80, 0.92, 1.02)  # filter before the sky under a closed cover of clouds
BUOY = (240, 96, 32)
FARTHEST = 1e5  # [m] from which a click is taken
RIPPLE_CELLS = 2.5  # longest ripple of the shader, in cells of the mesh: where the mesh leaves off
SHORTEST = 3.0  # shortest ripple, in capillary lengths 2 pi sqrt(tension/(density gravity))
FOAM_CELLS = 0.9  # size of a patch of bubbles, in cells of the mesh: so it hides the mesh's own facets


def camera_of(view: str, length: float) -> tuple[Vector, Vector]:
    """Eye and target [m] of a view over a tile of `length` [m]: as high in metres over every sea."""
    height, ahead, there = VIEWS[view]
    x = 0.5 * length - min(0.14 * length, BEHIND)
    return (x, 0.5 * length, height), (x + ahead, 0.5 * length, there)


class View:
    """Draws `SeaFrame`s."""

    CAMERA = camera_of(Params().view, LENGTH)
    FIELD_OF_VIEW = 0.65  # [rad]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: Water | None = None
        self.rain: RainMesh | None = None
        self.buoy: viser.FrameHandle | None = None
        self.shape: tuple[int, float] = (0, LENGTH)
        self.view = Params().view
        self.lit: tuple[Any, ...] = ()
        self.look = Look()
        self.last: SeaFrame | None = None
        server.scene.remove_click_callback("all")  # of the scene that was open before
        server.scene.on_click()(self.on_click)

    def on_click(self, event: Any) -> None:
        origin, direction = finite_vector(event.ray_origin, FARTHEST), finite_vector(event.ray_direction)
        if origin is not None and direction is not None:
            self.post(Point(origin, direction))

    def show(self, picture: SeaFrame) -> None:
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
            self.follow(self.shape[1], p.length)
            self.shape = shape
        elif look != self.look:
            self.water.set_look(look)
        self.look = look
        if p.view != self.view:
            self.view = p.view
            for camera in self.cameras():
                camera.position, camera.look_at = camera_of(p.view, p.length)
        if self.last is None or picture.vertices is not self.last.vertices:
            self.water.set_surface(picture.vertices, picture.slopes, picture.foam, picture.time)
            self.show_rain(picture)
            self.show_gauge(picture)
        self.last = picture

    def dress(self, picture: SeaFrame) -> Look:
        """The look under this sky: ripples carry what of Cox and Munk's slope the mesh does not."""
        p: Params = picture.params
        missing = max(min(0.003, 0.0015 * p.wind_speed) + 0.00512 * p.wind_speed - picture.slope_resolved, 0.001)
        cell, g = p.length / len(picture.vertices), gravity(p)
        capillary = 2.0 * math.pi * math.sqrt(SURFACE_TENSION / (1000.0 * g))
        # Under a closed cover there is no sun, and its colour is gone from the sky.
        overcast = min(max((p.clouds - 0.6) / 0.4, 0.0), 1.0)
        grey = np.array(OVERCAST) * overcast + np.array(self.light.tint) * (1.0 - overcast)
        return dataclasses.replace(
            self.light,
            clouds=p.clouds,
            tint=tuple(float(c) for c in grey),
            sun_strength=self.light.sun_strength * (1.0 - 0.93 * overcast),
            disc=(1.0 - overcast) ** 2,
            gloom=0.25 + 0.45 * overcast,
            exposure=self.light.exposure * p.daylight,
            haze=p.visibility,
            ripple_slope=round(min(math.sqrt(missing), 0.25), 2),
            ripple_length=RIPPLE_CELLS * cell,
            ripple_shortest=SHORTEST * capillary,
            ripple_direction=math.radians(p.wind_direction),
            gravity=g,
            foam_scale=max(FOAM_CELLS * cell, 0.4),
            wireframe=p.grid,
        )

    def show_rain(self, picture: SeaFrame) -> None:
        rain = picture.rain
        if self.rain is not None and (rain is None or len(rain.drops) != self.rain.count):
            self.rain.remove()
            self.rain = None
        if rain is not None:
            if self.rain is None:
                self.rain = RainMesh(self.server, rain, self.look.exposure)
            self.rain.show(rain)

    def show_gauge(self, picture: SeaFrame) -> None:
        if picture.gauge is None:
            if self.buoy is not None:
                self.buoy.visible = False
            return
        if self.buoy is None:
            self.buoy = add_buoy(self.server)
        self.buoy.visible = True
        self.buoy.position = picture.gauge

    def cameras(self) -> list[Any]:
        """The camera of each browser, and the one that new browsers begin with."""
        return [self.server.initial_camera, *(client.camera for client in self.server.get_clients().values())]

    def follow(self, old: float, new: float) -> None:
        """Take every camera from above the middle of a tile of side `old` [m] to that of one of side `new`."""
        for camera in self.cameras():
            camera.far = FAR
            if old != new:
                eye, target = np.asarray(camera.position), np.asarray(camera.look_at)
                place = 0.5 * new + np.clip(eye[:2] - 0.5 * old, -new, new)
                to = np.array([*place, eye[2]])
                # Setting the position moves the target along.
                camera.position, camera.look_at = to, to + target - eye

    def readout(self, snapshot: Snapshot) -> str:
        """Statistics, foam, rain and wave gauge, as HTML."""
        return report.readout(snapshot)

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """Parameter -> the line under its control."""
        return report.marks(snapshot)

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return dict(report.notes(snapshot))

    def close(self) -> None:
        """Nothing to give back: removing the nodes removes all."""


def add_buoy(server: viser.ViserServer) -> viser.FrameHandle:
    """A spar with a ball, 3 m high."""
    scene = server.scene
    frame = scene.add_frame("/gauge", show_axes=False)
    scene.add_cylinder("/gauge/spar", radius=0.09, height=4.2, color=(245, 245, 240), position=(0, 0, 0.9))
    scene.add_cylinder("/gauge/float", radius=0.45, height=0.6, color=BUOY, position=(0, 0, 0.2))
    scene.add_icosphere("/gauge/ball", radius=0.3, color=BUOY, position=(0, 0, 3.0))
    return frame


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()
