"""The square sea as water, with its rain, its probe and its grid."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Point, Snapshot, finite_vector
from app.pictures.rain import RainMesh
from app.scenes.phillips import Params, SeaPicture
from app.sea_report import lab_says, low_pass_line, planet_line, span, table, viscosity_line, wind_line
from app.water import Look, Water, sky

LENGTH = Params().length  # [m] tile of the first view
VIEWS = {  # eye and target, of the tile's length: over the middle of the tile, into the sun
    "deck": ((0.47, 0.5, 0.013), (0.53, 0.5, 0.0113)),
    "bow": ((0.36, 0.5, 0.042), (0.56, 0.5, 0.004)),
    "mast": ((0.42, 0.5, 0.06), (0.53, 0.5, 0.035)),
    "gull": ((0.2, 0.5, 0.2), (0.55, 0.5, 0.0)),
}
TILES = 5
FAR = 20_000.0  # [m] where the view ends
OVERCAST = (0.80, 0.92, 1.02)  # filter before the sky under a closed cover of clouds
BUOY = (240, 96, 32)
FARTHEST = 1e5  # [m] from which a click is taken
RIPPLE_CELLS = 2.5  # longest ripple of the shader, in cells of the mesh: where the mesh leaves off


def scaled(place: tuple[float, float, float], factor: float) -> tuple[float, float, float]:
    return place[0] * factor, place[1] * factor, place[2] * factor


class Picture:
    """Draws `SeaPicture`s."""

    CAMERA = scaled(VIEWS["deck"][0], LENGTH), scaled(VIEWS["deck"][1], LENGTH)
    FOV = 0.65  # [rad]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: Water | None = None
        self.rain: RainMesh | None = None
        self.buoy: viser.FrameHandle | None = None
        self.shape: tuple[int, float] = (0, LENGTH)
        self.view = "deck"
        self.lit: tuple[Any, ...] = ()
        self.look = Look()
        self.last: SeaPicture | None = None
        server.scene.remove_click_callback("all")  # of the scene that was open before
        server.scene.on_click()(self.on_click)

    def on_click(self, event: Any) -> None:
        origin, direction = finite_vector(event.ray_origin, FARTHEST), finite_vector(event.ray_direction)
        if origin is not None and direction is not None:
            self.post(Point(origin, direction))

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
            self.follow(p.length / self.shape[1])
            self.shape = shape
        elif look != self.look:
            self.water.set_look(look)
        self.look = look
        if p.view != self.view:
            self.view = p.view
            for camera in self.cameras():
                camera.position, camera.look_at = (scaled(place, p.length) for place in VIEWS[p.view])
        if self.last is None or picture.vertices is not self.last.vertices:
            self.water.set_surface(picture.vertices, picture.slopes, picture.foam, picture.time)
            self.show_rain(picture)
            self.show_probe(picture)
        self.last = picture

    def dress(self, picture: SeaPicture) -> Look:
        """The look under this sky: ripples carry what of Cox and Munk's slope the mesh does not."""
        p: Params = picture.params
        missing = max(min(0.003, 0.0015 * p.wind_speed) + 0.00512 * p.wind_speed - picture.slope_resolved, 0.001)
        # Under a closed cover there is no sun, and its colour is gone from the sky.
        overcast = min(max((p.clouds - 0.6) / 0.4, 0.0), 1.0)
        grey = np.array(OVERCAST) * overcast + np.array(self.light.tint) * (1.0 - overcast)
        return dataclasses.replace(
            self.light,
            clouds=p.clouds,
            tint=tuple(float(c) for c in grey),
            sun_strength=self.light.sun_strength * (1.0 - 0.93 * overcast),
            exposure=self.light.exposure * p.daylight,
            haze=p.visibility,
            ripple_slope=round(min(math.sqrt(missing), 0.25), 2),
            ripple_length=RIPPLE_CELLS * p.length / len(picture.vertices),
            ripple_direction=math.radians(p.wind_direction),
            foam_scale=max(0.008 * p.length, 0.4),
            wireframe=p.grid,
        )

    def show_rain(self, picture: SeaPicture) -> None:
        rain = picture.rain
        if self.rain is not None and (rain is None or len(rain.drops) != self.rain.count):
            self.rain.remove()
            self.rain = None
        if rain is not None:
            if self.rain is None:
                self.rain = RainMesh(self.server, rain)
            self.rain.show(rain)

    def show_probe(self, picture: SeaPicture) -> None:
        if picture.probe is None:
            if self.buoy is not None:
                self.buoy.visible = False
            return
        if self.buoy is None:
            self.buoy = add_buoy(self.server)
        self.buoy.visible = True
        self.buoy.position = picture.probe
        self.buoy.scale = picture.params.length / LENGTH

    def cameras(self) -> list[Any]:
        """The camera of each browser, and the one that new browsers begin with."""
        return [self.server.initial_camera, *(client.camera for client in self.server.get_clients().values())]

    def follow(self, factor: float) -> None:
        """Take every camera along to a tile `factor` times as long."""
        for camera in self.cameras():
            camera.far = FAR
            if factor != 1.0:
                camera.position = np.asarray(camera.position) * factor
                camera.look_at = np.asarray(camera.look_at) * factor


def add_buoy(server: viser.ViserServer) -> viser.FrameHandle:
    """A spar with a ball, 3 m high on a tile of `LENGTH`."""
    scene = server.scene
    frame = scene.add_frame("/probe", show_axes=False)
    scene.add_cylinder("/probe/spar", radius=0.09, height=4.2, color=(245, 245, 240), position=(0, 0, 0.9))
    scene.add_cylinder("/probe/float", radius=0.45, height=0.6, color=BUOY, position=(0, 0, 0.2))
    scene.add_icosphere("/probe/ball", radius=0.3, color=BUOY, position=(0, 0, 3.0))
    return frame


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()


def readout(snapshot: Snapshot) -> str:
    """The statistics, the foam and the rain, as HTML."""
    g = snapshot.gauge
    lines = [table(g.report)] if g.report is not None else []
    if snapshot.picture.params.foam:
        lines.append(f"Foam on {g.foam:.1%} of the sea; Monahan measured {g.foam_asked:.1%}.")
    if g.rain is not None:
        r = g.rain
        rings = (
            f"a ring is as of {r.drops_a_ring:.1e} drops at once" if r.drops_a_ring else "no rings on so wide a grid"
        )
        lines.append(
            f"Rain: {r.fallen:.3g} drops have fallen on {r.span:.0f} m × {r.span:.0f} m. Drawn: {r.drawn} in the air, "
            f"each for {r.weight:.3g}; {r.hits} have hit; {rings}."
        )
    if snapshot.picture.probe is not None:
        x, y, z = snapshot.picture.probe
        lines.append(f"Probe at ({x:.1f}, {y:.1f}) m: {z:+.2f} m, found to {g.residual:.0e} m.")
    return "".join(f'<div style="margin-top:4px">{line}</div>' for line in lines)


def marks(snapshot: Snapshot) -> dict[str, str]:
    """What is written under a knob."""
    p, g = snapshot.picture.params, snapshot.gauge
    cell = p.length / int(p.size)
    return {
        "wind_speed": wind_line(p),
        "planet_mass": planet_line(p),
        "low_pass": low_pass_line(p),
        "viscosity": viscosity_line(p, g.age),
        "loop_period": f"repeats every {span(p.loop_period)}" if p.loop_period else "never repeats",
        "size": f"cells of {cell:.3g} m, shortest wave {2 * cell:.3g} m",
        "mesh": f"drawn every {p.length / len(snapshot.picture.vertices):.3g} m",
        "foam_by_wind": f"Jacobian below {g.threshold:.2f}" if math.isfinite(g.threshold) else "no foam",
    }


def notes(snapshot: Snapshot) -> dict[str, str]:
    """What folds out below the controls."""
    return {"Lab says, physics says": lab_says(snapshot.picture.params, snapshot.gauge.report)}
