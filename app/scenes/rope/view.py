"""The rope as a tube coloured by tension, its points as beads to be grabbed, root and sphere on gizmos."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.messages import Command, Snapshot
from app.render.colormap import SCALE, paint_tube
from app.render.coloured_mesh import ColouredMesh
from app.render.dragging import HELD_COLOUR, PullLine, drag, nearest
from app.render.gizmo import Gizmo
from app.render.ground import Ground
from app.render.meshes import SIDES, ball, smooth_line, sweep, tube_faces
from app.scenes.race.race import RaceReadings
from app.scenes.race.report import standings
from app.scenes.race.view import RaceDrawing
from app.scenes.rope.parameters import ROOT, SPHERE, THICKNESS
from app.scenes.rope.scene import Paid, RopeFrame
from app.scenes.springs.report import colour_scale, stability_bar

ROPE_COLOUR = (196, 154, 92)
BEAD_COLOUR = (58, 68, 86)
RINGS = 120  # about as many rings as a rope is drawn with
UNSEEN = 2e-4  # [m] that a point may be from where it is drawn: far below a pixel
SHADE = 2e-3  # of the colour scale that a link may be from how it is painted: no more than a step of a screen's 256


class View:
    """Draws `RopeFrame`s."""

    CAMERA = ((-0.4, -4.3, 2.35), (-0.3, 0.0, 1.75))  # position, target [m]
    FIELD_OF_VIEW = 1.3  # [rad]
    RACE_CAMERA = ((3.4, -2.7, 2.9), (0.45, 0.35, 1.75))

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server = server
        self.post = post
        self.tube: ColouredMesh | None = None
        self.beads: viser.BatchedMeshHandle | None = None
        self.count = 0
        self.race: RaceDrawing | None = None
        self.nearest = 0
        self.ball_at: Any = None  # the sphere as it is shown
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.6)
        self.ground = Ground(server, (226, 230, 236), (196, 202, 212), (150, 160, 176))
        self.ball = scene.add_mesh_simple("/sphere/ball", *ball(32), color=(92, 140, 190), visible=False)
        self.root = Gizmo(server, post, "root", 0.34, position=ROOT)
        self.sphere = Gizmo(server, post, "sphere", 1.1, position=SPHERE, visible=False)
        self.hook = scene.add_mesh_simple("/hook", *ball(8), scale=1.9 * THICKNESS, color=(60, 66, 80))
        self.pull = PullLine(server)

    def build(self, picture: RopeFrame) -> None:
        """Make tube and beads for a new number of points."""
        n = len(picture.points)
        self.between = max(1, RINGS // (n - 1))
        rings = (n - 1) * self.between + 1
        self.line = np.zeros((rings, 3))
        self.vertices, self.rgb = np.zeros((2, rings * SIDES + 2, 3), np.float32)
        self.form(picture, True)
        if self.tube is not None:
            self.tube.remove()
        if self.beads is not None:
            self.beads.remove()
        self.tube = ColouredMesh(
            self.server,
            "/rope",
            self.vertices,
            tube_faces(rings),
            self.rgb,
            color=ROPE_COLOUR,
            side="double",
        )
        self.beads = self.server.scene.add_batched_meshes_simple(
            "/points",
            *ball(8 if n <= 200 else 4),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
            batched_positions=picture.points,
            batched_scales=np.full(n, self.bead_radius(picture), np.float32),
            batched_colors=np.tile(np.array(BEAD_COLOUR, np.uint8), (n, 1)),
            lod="off",
        )
        self.beads.on_drag("left")(self.on_bead)
        self.tube.mesh.on_drag("left")(self.on_tube)
        self.held = -1
        self.hook_at: Any = None
        self.count = n

    def bead_radius(self, picture: RopeFrame) -> float:
        n = len(picture.points)
        spacing = float(np.abs(np.diff(picture.points, axis=0)).sum()) / max(n - 1, 1)
        return float(np.clip(0.4 * spacing, 0.5 * THICKNESS, 1.9 * THICKNESS))

    async def on_bead(self, event: Any) -> None:
        drag(self.post, event, event.instance_index)

    async def on_tube(self, event: Any) -> None:
        """The same between beads, where they are close or hidden: the point nearest to where the drag began."""
        if event.phase == "start":
            self.nearest = nearest(self.points, event)
        drag(self.post, event, self.nearest)

    def form(self, picture: RopeFrame, repaint: bool) -> None:
        """The tube, and its colours, which then stand for this picture and all that look the same."""
        self.points = picture.points
        smooth_line(picture.points, self.between, self.line)
        sweep(self.line, THICKNESS, SIDES, self.vertices)
        if not repaint:
            return
        self.tension = picture.tension
        self.painted = picture.colour, picture.full_scale
        if picture.colour == "plain":
            self.rgb[:] = np.array(ROPE_COLOUR, np.float32) / 255
        else:
            paint_tube(picture.tension, self.between, picture.full_scale, SCALE, SIDES, self.rgb)

    def colours_differ(self, picture: RopeFrame) -> bool:
        """Whether anybody could tell a picture's colours from those that are shown."""
        if self.painted != (picture.colour, picture.full_scale):
            return True
        return float(np.abs(picture.tension - self.tension).max()) >= SHADE * picture.full_scale

    def show(self, picture: RopeFrame) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        if picture.race is None:
            self.show_rope(picture)
        else:
            self.show_race(picture)
        if picture.pull is None:
            self.pull.show(None)
        else:
            points = picture.points if picture.race is None else picture.race.ropes.reshape(-1, 3)
            self.pull.show((points[picture.pull.particle], picture.pull.target), picture.pull.load)
        self.ground.show(picture.floor, picture.grid)
        self.root.show(picture.root)
        self.sphere.show(None if picture.sphere is None else picture.sphere[:3])
        if picture.sphere != self.ball_at:
            self.ball_at = picture.sphere
            self.ball.visible = picture.sphere is not None
            if picture.sphere is not None:
                self.ball.position = picture.sphere[:3]
                self.ball.scale = picture.sphere[3]

    def show_race(self, picture: RopeFrame) -> None:
        """The ropes of a race, in place of the one."""
        race = picture.race
        assert race is not None
        if self.race is None:
            self.look_from(self.RACE_CAMERA)
        if self.race is not None and self.race.shape != race.ropes.shape:
            self.race.remove()
            self.race = None
        if self.race is None:
            self.race = RaceDrawing(self.server, race, self.on_bead)
        self.race.show(race, picture.show_points)
        self.hook.visible = False
        if self.tube is not None and self.beads is not None:
            self.tube.remove()
            self.beads.remove()
            self.tube = self.beads = None
            self.count = 0

    def look_from(self, camera: tuple[tuple[float, float, float], tuple[float, float, float]]) -> None:
        """Move every camera to where a race, or one rope, is best seen."""
        for client in (self.server.initial_camera, *(c.camera for c in self.server.get_clients().values())):
            client.position, client.look_at = camera

    def show_rope(self, picture: RopeFrame) -> None:
        """The one rope."""
        if self.race is not None:
            self.race.remove()
            self.race = None
            self.look_from(self.CAMERA)
        if len(picture.points) != self.count:
            self.build(picture)
        assert self.tube is not None
        assert self.beads is not None
        repaint = self.colours_differ(picture)
        if repaint or float(np.abs(picture.points - self.points).max()) >= UNSEEN:
            self.form(picture, repaint)
        self.tube.set(self.vertices, self.rgb if repaint else None)
        self.beads.visible = picture.show_points
        if picture.show_points:
            self.beads.batched_positions = self.points
        held = -1 if picture.pull is None else picture.pull.particle
        if held != self.held:
            colours = np.tile(np.array(BEAD_COLOUR, np.uint8), (self.count, 1))
            if held >= 0:
                colours[held] = HELD_COLOUR
            self.beads.batched_colors = colours
            self.held = held
        self.hook.visible = True
        at = tuple(self.points[0].tolist())
        if at != self.hook_at:
            self.hook_at = at
            self.hook.position = at

    def readout(self, snapshot: Snapshot) -> str:
        """The stability gauge and the colour scale, or a race's standings, as HTML."""
        if isinstance(snapshot.readings, RaceReadings):
            return standings(snapshot.readings)
        picture, scale = snapshot.frame, ""
        if picture.colour == "tension":
            scale = colour_scale("slack", "tension", f"{picture.full_scale:.3g} N")
        return stability_bar(snapshot.readings.stability) + price(snapshot.readings.paid) + scale

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """What is written under a parameter: the largest value that holds with the others as they are."""
        g = snapshot.readings
        if isinstance(g, RaceReadings):
            first = g.standings[0].gauge.critical_step
            limit = "" if first == float("inf") else f"rope 1 holds up to {first:.3g} s"
            return {"integrator": "", "time_step": limit, "stiffness": "", "axial_stiffness": ""}
        step, stiffness = g.stability.critical_step, g.largest_stiffness
        unit = "N/m" if g.parameter == "stiffness" else "N"
        if step == float("inf"):
            return {"integrator": g.note, "time_step": "any step holds", g.parameter: "any stiffness holds"}
        return {
            "integrator": g.note,
            "time_step": f"holds up to {step:.3g} s" if step > 0 else "no step holds with this method",
            g.parameter: f"holds up to {stiffness:.3g} {unit}" if stiffness > 0 else "no stiffness holds at this step",
        }

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """No folders."""
        return {}

    def close(self) -> None:
        """Nothing to give back: removing the nodes removes all."""


def warm_up() -> Iterator[str]:
    """Compile what the drawing calls; yields what comes next."""
    yield "drawing"
    line, vertices = np.zeros((3, 3)), np.zeros((3 * SIDES + 2, 3), np.float32)
    smooth_line(np.zeros((2, 3), np.float32), 2, line)
    sweep(line, THICKNESS, SIDES, vertices)
    paint_tube(np.ones(1, np.float32), 2, 1.0, SCALE, SIDES, vertices)


def price(paid: Paid | None) -> str:
    """What an implicit method asks for its stability, as HTML; nothing of others."""
    if paid is None:
        return ""
    share = f", the rope's own damping {paid.dissipated:.3g} J" if paid.dissipated > 0.0 else ""
    return (
        f'<div style="margin-bottom:6px">paid: <b>{paid.corrections:.1f}</b> Newton corrections a step; the method '
        f"{'took' if paid.taken >= 0 else 'gave'} <b>{abs(paid.taken):.3g} J</b>{share}</div>"
    )
