"""The radial sea as water, its bodies as models, the rig with its fire, and the cutaway."""

import time
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import viser

from app.formats.formatting import fixed, number
from app.formats.packing import compile_packing
from app.formats.surface_fields import compile_surface_fields
from app.messages import Command, Place, Snapshot, Vector, finite_vector, vector_of
from app.render.cameras import place_cameras
from app.render.follow_camera import FollowCamera
from app.render.handles.dragging import GrabLine, drag
from app.render.markup.html import bold, fill
from app.render.material import Material
from app.render.skies import Sky
from app.render.water import DrawnWater
from app.scenes.contract import Pieces, SceneView
from app.scenes.radial_sea.cutaway import DIRECTION
from app.scenes.radial_sea.drawing.bodies_view import DrawnBodies, model
from app.scenes.radial_sea.drawing.cutaway_view import Walls
from app.scenes.radial_sea.drawing.fire_view import Flames
from app.scenes.radial_sea.drawing.materials import material_of, waterlines_of
from app.scenes.radial_sea.drawing.moorings_view import DrawnMoorings
from app.scenes.radial_sea.drawing.stain_view import Stains
from app.scenes.radial_sea.frame import RadialFrame, RadialReadings
from app.scenes.radial_sea.oil.well_blowout import FIRE, RIG
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.report import marks_of, notes_of, readout_of
from sim.ocean.any_sea import RadialSurface
from sim.ocean.radial.radial_grid import RadialGrid

SUN_BEARING = 1.25  # [rad] from +x: beyond the buoys, as seen from the first view
SUN_LAMP_INTENSITY = 2.2  # of the lamp that stands for a sun of SUN_LAMP_STRENGTH
SUN_LAMP_STRENGTH = 5.0
FILL_LAMP = (-0.6, -0.7, 0.5), 0.45  # direction towards the lamp that lights the shadows, and its share of the sun's
GLOW_INTENSITY = 900.0  # of the lamp in the fire
CAMERA_INTERVAL = 0.2  # [s] between two messages to the scene about where the camera is
VIEWS = {  # position and target [m] of the camera when one of them is chosen to be followed
    "rig": ((RIG[0] - 62.0, RIG[1] - 84.0, 40.0), (RIG[0] + 10.0, RIG[1] - 4.0, 16.0)),
    "from above": ((-9.5, -11.0, 7.0), (6.0, 3.6, 2.6)),
}
BODY_VIEW = (-5.2, -6.2, 2.4), (0.0, 0.0, 0.0)  # [m] of camera and target from a followed body at VIEW_SIZE
CUTAWAY_VIEW = (
    (4.8 * DIRECTION[0] - 1.0 * DIRECTION[1], 4.8 * DIRECTION[1] + 1.0 * DIRECTION[0], 0.9),
    (-1.0 * DIRECTION[1], 1.0 * DIRECTION[0], 0.1),
)
VIEW_SIZE = 1.5  # of the bodies that these two views are made for
FOLLOWED_BODY = {"first buoy": 0, "second buoy": 1, "box": 2, "cutaway": 0}  # number of the body that is followed


class RadialSeaView(SceneView[RadialSeaParams, RadialFrame, RadialReadings]):
    """Draws `RadialFrame`s."""

    CAMERA = ((-6.5, -7.5, 3.0), (3.9, 3.2, 1.0))  # position, target [m]
    FIELD_OF_VIEW = 1.3  # [rad]
    WARM_UP: ClassVar[Pieces] = {"packing": compile_packing, "fields of the surface": compile_surface_fields}

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: DrawnWater | None = None
        self.grid: RadialGrid | None = None
        self.sky = Sky(server)
        self.light = self.material = Material()
        self.surface: RadialSurface | None = None  # as drawn
        self.bodies, self.moorings = DrawnBodies(server, self.on_body_drag), DrawnMoorings(server)
        self.followed, self.follow_camera = "free", FollowCamera()
        self.followed_body: np.ndarray | None = None  # (3,) [m] where the followed body is, at mean water
        self.camera_told_at = 0.0
        scene = server.scene
        self.rig = scene.add_glb("/rig", model("rig"), position=(*RIG, 0.0), cast_shadow=False, receive_shadow=False)
        self.glow = scene.add_light_point(
            "/glow", color=(255, 140, 50), intensity=0.0, distance=160.0, decay=1.2, position=FIRE, visible=False
        )
        self.flames: Flames | None = None
        self.walls: Walls | None = None
        self.grab_lines: list[GrabLine] = []
        self.stains = Stains(server)

    def first_view(self, params: RadialSeaParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: beside the followed object."""
        if self.followed_body is None or params.follow not in FOLLOWED_BODY:
            return VIEWS.get(params.follow, self.CAMERA)
        position, target = self.followed_body + offset_of_view(params)
        return vector_of(position), vector_of(target)

    def show(self, frame: RadialFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        p = frame.params
        if self.sky.shown != (p.sky, SUN_BEARING):
            self.light = self.sky.set(p.sky, SUN_BEARING)
            self.sky.show_stars(is_clear=True)
            self.place_lamps()
        self.show_sea(frame)
        self.show_cutaway(frame)
        self.bodies.show(frame)
        self.moorings.show(frame)
        self.stains.show(frame)
        self.show_pulls(frame)
        if self.rig.visible != p.rig:
            self.rig.visible = p.rig
        self.show_fire(frame)
        self.move_camera(frame)

    @property
    def has_cutaway(self) -> bool:
        """False if a browser draws the water without a shader: all of it, so that it hides a cutaway."""
        return self.water is None or self.water.has_shader is not False

    def show_cutaway(self, frame: RadialFrame) -> None:
        """Draw the walls of the cutaway with their labels, or hide them."""
        if not self.has_cutaway:
            frame = frame._replace(cutaway=None)
        if self.walls is None and frame.cutaway is not None:
            self.walls = Walls(self.server, "/cutaway", frame.cutaway)
        if self.walls is not None:
            self.walls.show(frame, None if frame.cutaway is None else keel_of(frame))

    def place_lamps(self) -> None:
        """Light bodies and rig by the sun of this sky; viser's own lamps stand elsewhere."""
        self.server.scene.configure_default_lights(enabled=False, cast_shadow=False)
        x, y, z = self.light.sun_direction
        red, green, blue = (int(255 * c) for c in self.light.sun_color)
        intensity = SUN_LAMP_INTENSITY * self.light.sun_strength / SUN_LAMP_STRENGTH
        for name, place, share in (("sun", (x, y, z + 0.35), 1.0), ("fill", *FILL_LAMP)):
            self.server.scene.add_light_directional(
                f"/{name}", color=(red, green, blue), intensity=share * intensity, position=place, cast_shadow=False
            )

    def show_sea(self, frame: RadialFrame) -> None:
        """Draw the water; a grid of another size is another mesh."""
        material = material_of(self.light, frame)
        if self.water is None or frame.grid is not self.grid:
            if self.water is not None:
                self.water.remove()
            self.grid = frame.grid
            self.water = DrawnWater(self.server, "/sea", frame.grid, material)
        elif material != self.material:
            self.water.set_material(material)
        self.material = material
        s = frame.surface
        if s is not self.surface:
            self.surface = s
            frame.sent.numbers = self.water.set_surface(
                s.vertices[None], s.slope[None], frame.foam[None], frame.time, frame.grid_middle
            )
            self.water.set_waterlines(waterlines_of(frame))

    def show_fire(self, frame: RadialFrame) -> None:
        """Draw flames, smoke and the oil of the jet, and the light of the fire."""
        if self.flames is None and (frame.fire is not None or frame.jet is not None):
            self.flames = Flames(self.server, "/flames")
        if self.flames is not None:
            self.flames.show(frame.fire, frame.jet, self.light, 1e6 * frame.params.fire_power)
        burning = frame.fire is not None
        if self.glow.visible != burning:
            self.glow.visible = burning
        if burning:
            flicker = float(np.sin(23.0 * frame.time) * np.sin(8.3 * frame.time))
            self.glow.intensity = GLOW_INTENSITY * (1.0 + 0.25 * flicker)

    async def on_body_drag(self, event: Any) -> None:
        """A browser drags a body, or lets it go."""
        drag(self.post, event, event.instance_index)

    def show_pulls(self, frame: RadialFrame) -> None:
        """Draw a line from each grabbed body to where it is pulled."""
        while len(self.grab_lines) < len(frame.grabs):
            self.grab_lines.append(GrabLine(self.server, f"/pull{len(self.grab_lines)}"))
        for i, line in enumerate(self.grab_lines):
            line.show_pull(frame.grabs[i] if i < len(frame.grabs) else None)

    def move_camera(self, frame: RadialFrame) -> None:
        """Move to the followed object when it is chosen, then along with it; report the camera's place to the scene."""
        p = frame.params
        body = FOLLOWED_BODY.get(p.follow, -1)
        target = frame.positions[body].astype(float) if 0 <= body < len(frame.positions) else None
        cameras = {number: client.camera for number, client in self.server.get_clients().items()}
        if target is not None:
            target[2] = 0.0  # a camera that heaved with the body would hide that the body heaves
        self.followed_body = target
        if p.follow != self.followed:
            self.followed = p.follow
            if target is not None:
                self.follow_camera.start(target, offset_of_view(p))
            place_cameras(self.server, *self.first_view(p))
        elif target is not None:
            self.follow_camera.follow(target, cameras)
        now = time.monotonic()
        if p.centre == "camera" and cameras and now - self.camera_told_at > CAMERA_INTERVAL:
            self.camera_told_at = now
            place = finite_vector(next(iter(cameras.values())).position)
            if place is not None:
                self.post(Place("camera", place))

    def figures(self, snapshot: Snapshot) -> str:
        """The draft of the first body, and the height of the waves."""
        height = number(snapshot.readings.height)
        waves = fill("Waves: {} m high", bold(height)) if snapshot.readings.height > 0.0 else fill("No waves")
        if not snapshot.readings.bodies:
            return waves
        body = snapshot.readings.bodies[0]
        return fill("{}: {} m deep · {}", body.title, bold(fixed(body.draft, 2)), waves)

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """Parameter -> the line under its control."""
        lacks = snapshot.frame.cutaway is not None and not self.has_cutaway
        return {**marks_of(snapshot), "cutaway": "Simple drawing: no cutaway" if lacks else ""}

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return {"Drafts, waves": readout_of(snapshot), **notes_of(snapshot)}


def keel_of(frame: RadialFrame) -> float | None:
    """Height [m] of the lowest point of the first body; None without bodies."""
    if not frame.kinds:
        return None
    w, i, j, k = frame.rotations[0].tolist()
    up = np.array([2.0 * (i * k - w * j), 2.0 * (j * k + w * i), 1.0 - 2.0 * (i * i + j * j)])
    return float(frame.positions[0, 2]) + float((frame.hulls[frame.kinds[0]].vertices @ up).min())


def offset_of_view(params: RadialSeaParams) -> np.ndarray:
    """(2, 3) [m] from the followed body to a camera that has not been moved, and to its target."""
    return np.array(CUTAWAY_VIEW if params.follow == "cutaway" else BODY_VIEW) * params.size / VIEW_SIZE


VIEW = RadialSeaView
