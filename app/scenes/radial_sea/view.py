"""The radial sea as water, its bodies as models, the rig with its fire, and a window into the sea."""

import importlib.resources
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Place, Snapshot, finite_vector
from app.render.cameras import place_cameras
from app.render.dragging import PullLine, drag
from app.render.follow_camera import FollowCamera
from app.render.material import Material
from app.render.meshes import ball
from app.render.skies import set_sky
from app.render.water import Water
from app.scenes.radial_sea.bodies import OWN
from app.scenes.radial_sea.cutaway import WAY
from app.scenes.radial_sea.cutaway_view import Walls
from app.scenes.radial_sea.fire_view import Flames
from app.scenes.radial_sea.frame import RadialFrame
from app.scenes.radial_sea.materials import material_of
from app.scenes.radial_sea.report import marks_of, notes_of, readout_of
from app.scenes.radial_sea.scene import RADIUS
from app.scenes.radial_sea.well_blowout import FIRE, RIG

SUN = 1.25  # [rad] bearing of the sun, beyond the buoys as the camera starts
SUNLIGHT = 2.2  # intensity of the lamp that stands for a sun of strength 5
HANDLE = 0.75  # [m] radius of what is dragged, at size 1
OWN_COLOUR = (64, 132, 186)  # of a hull from a file
EYE_EVERY = 0.2  # [s] between looks at where the camera is
VIEWS = {  # camera and target [m] when one of them is followed
    "rig": ((RIG[0] - 62.0, RIG[1] - 84.0, 40.0), (RIG[0] + 10.0, RIG[1] - 4.0, 16.0)),
    "from above": ((-9.5, -11.0, 8.5), (6.0, 3.6, -1.0)),
}
BODY_VIEW = (-5.2, -6.2, 2.4), (0.0, 0.0, 0.0)  # [m] of camera and target from a followed body at size 1.5
WINDOW_VIEW = (
    (4.8 * WAY[0] - 1.0 * WAY[1], 4.8 * WAY[1] + 1.0 * WAY[0], 0.9),
    (-1.0 * WAY[1], 1.0 * WAY[0], 0.1),
)
FOLLOWED = {"first buoy": 0, "second buoy": 1, "box": 2, "window": 0}


def model(name: str) -> bytes:
    """A GLB of the assets."""
    return importlib.resources.files("assets").joinpath(f"{name}.glb").read_bytes()


class View:
    """Draws `RadialFrame`s."""

    CAMERA = ((-6.5, -7.5, 3.0), (3.9, 3.2, 1.0))  # position, target [m]
    FIELD_OF_VIEW = 1.3  # [rad]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: Water | None = None
        self.grid: Any = None
        self.lit = ""
        self.light = self.material = Material()
        self.last: RadialFrame | None = None
        self.groups: dict[str, tuple[Any, np.ndarray]] = {}
        self.handles: viser.BatchedMeshHandle | None = None
        self.kinds: tuple[str, ...] = ()
        self.size = 0.0
        self.follow, self.follow_camera = "free", FollowCamera()
        self.eye_at = 0.0
        scene = server.scene
        self.rig = scene.add_glb("/rig", model("rig"), position=(*RIG, 0.0), cast_shadow=False, receive_shadow=False)
        self.glow = scene.add_light_point(
            "/glow", color=(255, 140, 50), intensity=0.0, distance=160.0, decay=1.2, position=FIRE, visible=False
        )
        self.flames: Flames | None = None
        self.walls: Walls | None = None
        self.pull = PullLine(server)

    def show(self, picture: RadialFrame) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        p = picture.params
        if self.lit != p.sky:
            self.lit = p.sky
            self.light = set_sky(self.server, p.sky, SUN)
            self.shine()
        self.show_sea(picture)
        if self.walls is None and picture.section is not None:
            self.walls = Walls(self.server, "/section", picture.section)
        if self.walls is not None:
            self.walls.show(picture.section, self.light, picture.column)
        self.show_bodies(picture)
        if self.rig.visible != p.rig:
            self.rig.visible = p.rig
        if self.flames is None and (picture.fire is not None or picture.jet is not None):
            self.flames = Flames(self.server, "/flames")
        if self.flames is not None:
            self.flames.show(picture.fire, picture.jet)
        burning = picture.fire is not None
        if self.glow.visible != burning:
            self.glow.visible = burning
        if burning:
            self.glow.intensity = 900.0 * (1.0 + 0.25 * float(np.sin(23.0 * picture.time) * np.sin(8.3 * picture.time)))
        self.move_camera(picture)
        self.last = picture

    def shine(self) -> None:
        """Light bodies and rig by the sun of this sky; viser's own lamps stand elsewhere."""
        self.server.scene.configure_default_lights(enabled=False, cast_shadow=False)
        x, y, z = self.light.sun_direction
        red, green, blue = (int(255 * c) for c in self.light.sun_color)
        strength = SUNLIGHT * self.light.sun_strength / 5.0
        for name, place, share in (("sun", (x, y, z + 0.35), 1.0), ("fill", (-0.6, -0.7, 0.5), 0.45)):
            self.server.scene.add_light_directional(
                f"/{name}", color=(red, green, blue), intensity=share * strength, position=place, cast_shadow=False
            )

    def show_sea(self, picture: RadialFrame) -> None:
        material = material_of(self.light, picture)
        if self.water is None or picture.grid is not self.grid:
            if self.water is not None:
                self.water.remove()
            self.grid = picture.grid
            self.water = Water(self.server, "/sea", 1, len(self.grid), RADIUS, faces=self.grid.faces, material=material)
        elif material != self.material:
            self.water.set_material(material)
        self.material = material
        s = picture.surface
        if self.last is None or s is not self.last.surface:
            self.water.set_surface(s.vertices[None], s.slope[None], picture.foam[None], picture.time)

    def show_bodies(self, picture: RadialFrame) -> None:
        if picture.kinds != self.kinds or picture.params.size != self.size:
            for handle, _ in self.groups.values():
                handle.remove()
            self.groups = {}
            self.kinds, self.size = picture.kinds, picture.params.size
            for kind in sorted(set(self.kinds)):
                chosen = np.array([i for i, other in enumerate(self.kinds) if other == kind])
                poses = {"batched_wxyzs": picture.rotations[chosen], "batched_positions": picture.positions[chosen]}
                plain = {"lod": "off", "cast_shadow": False, "receive_shadow": False}
                name = f"/bodies/{kind}"
                if kind == OWN:
                    assert picture.own is not None
                    vertices, faces = picture.own.vertices.astype(np.float32), picture.own.faces.astype(np.uint32)
                    handle: Any = self.server.scene.add_batched_meshes_simple(
                        name, vertices, faces, batched_colors=OWN_COLOUR, flat_shading=True, **poses, **plain
                    )
                else:
                    handle = self.server.scene.add_batched_glb(
                        name, model(kind), batched_scales=np.full(len(chosen), self.size, np.float32), **poses, **plain
                    )
                self.groups[kind] = handle, chosen
            self.add_handles(picture)
        for handle, chosen in self.groups.values():
            handle.batched_positions = picture.positions[chosen]
            handle.batched_wxyzs = picture.rotations[chosen]
        if self.handles is not None:
            self.handles.batched_positions = picture.positions
        self.pull.show(picture.pull)

    def add_handles(self, picture: RadialFrame) -> None:
        """Clear balls about the bodies, to be dragged: viser loses a page that drags instances of a GLB (1.1)."""
        if self.handles is not None:
            self.handles.remove()
            self.handles = None
        n = len(picture.positions)
        if n == 0:
            return
        vertices, faces = ball(4)
        sizes = np.full(n, self.size, np.float32)
        if picture.own is not None:
            sizes[-1] = 0.5 * np.ptp(picture.own.extents, axis=1).mean() / HANDLE
        self.handles = self.server.scene.add_batched_meshes_simple(
            "/handles",
            HANDLE * vertices,
            faces,
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
            batched_positions=picture.positions,
            batched_scales=sizes,
            opacity=0.0,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )
        self.handles.on_drag("left")(self.on_body)

    async def on_body(self, event: Any) -> None:
        drag(self.post, event, event.instance_index)

    def move_camera(self, picture: RadialFrame) -> None:
        """Fly to what is followed when it is chosen, then go along with it; and tell the scene where the camera is."""
        p = picture.params
        body = FOLLOWED.get(p.follow, -1)
        here = picture.positions[body].astype(float) if 0 <= body < len(picture.positions) else None
        cameras = {number: client.camera for number, client in self.server.get_clients().items()}
        if here is not None:
            here[2] = 0.0  # a camera that heaves with the body would hide that it heaves
        if p.follow != self.follow:
            self.follow = p.follow
            if here is not None:
                offset = np.array(WINDOW_VIEW if p.follow == "window" else BODY_VIEW) * p.size / 1.5
                self.follow_camera.start(here, offset)
                view = tuple(here + offset)
            else:
                view = VIEWS.get(p.follow, self.CAMERA)
            place_cameras(self.server, view[0], view[1])
        elif here is not None:
            self.follow_camera.follow(here, cameras)
        now = time.monotonic()
        if p.centre == "camera" and cameras and now - self.eye_at > EYE_EVERY:
            self.eye_at = now
            eye = finite_vector(next(iter(cameras.values())).position)
            if eye is not None:
                self.post(Place("eye", eye))

    def readout(self, snapshot: Snapshot) -> str:
        """The bodies' drafts and periods, as HTML."""
        return readout_of(snapshot)

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """What is written under a parameter."""
        return marks_of(snapshot)

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """What folds out below the controls."""
        return notes_of(snapshot)

    def close(self) -> None:
        """Nothing to give back: removing the nodes removes all."""


def warm_up() -> Iterator[str]:
    """Nothing here is compiled."""
    yield from ()
