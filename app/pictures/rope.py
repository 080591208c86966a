"""The rope as a tube coloured by tension, its points as beads to be grabbed, root and sphere on gizmos."""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import viser

from app.colour import css_scale, scale_colours
from app.messages import Command, Grab, Place, Release, Snapshot, finite_vector
from app.paint import Painted
from app.pictures.race import RaceDrawing
from app.race import RaceGauge
from app.race_report import standings
from app.rope_knobs import ROOT, SPHERE, THICKNESS
from app.scenes.rope import Paid, RopePicture
from app.shapes import SIDES, ball, smooth_line, sweep, tube_faces

ROPE_COLOUR = (196, 154, 92)
BEAD_COLOUR = (58, 68, 86)
HELD_COLOUR = (255, 90, 60)
RINGS = 120  # about as many rings as a rope is drawn with
HANDS_OFF = 0.5  # [s] after its last drag that a gizmo is left alone


class Picture:
    """Draws `RopePicture`s."""

    CAMERA = ((-0.4, -4.3, 2.35), (-0.3, 0.0, 1.75))  # position, target [m]
    RACE_CAMERA = ((3.4, -2.7, 2.9), (0.45, 0.35, 1.75))

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server = server
        self.post = post
        self.tube: Painted | None = None
        self.beads: viser.BatchedMeshHandle | None = None
        self.count = 0
        self.race: RaceDrawing | None = None
        self.nearest = 0
        self.dragged_at = {"root": 0.0, "sphere": 0.0}
        scene = server.scene
        scene.configure_environment_map("studio", background=False, environment_intensity=0.6)
        self.floor = scene.add_grid(
            "/floor",
            width=24.0,
            height=24.0,
            infinite_grid=True,
            cell_size=0.25,
            section_size=1.0,
            cell_color=(196, 202, 212),
            section_color=(150, 160, 176),
            plane_color=(226, 230, 236),
            plane_opacity=1.0,
            fade_distance=26.0,
            shadow_opacity=0.3,
        )
        self.ball = scene.add_mesh_simple("/sphere/ball", *ball(32), color=(92, 140, 190), visible=False)
        self.gizmos = {
            "root": self.add_gizmo("root", ROOT, 0.34),
            "sphere": self.add_gizmo("sphere", SPHERE, 1.1),
        }
        self.gizmos["sphere"].visible = False
        self.hook = scene.add_mesh_simple("/hook", *ball(8), scale=1.9 * THICKNESS, color=(60, 66, 80))
        # One segment for the pull; its ends move while a point is held.
        self.pull = scene.add_line_segments(
            "/pull",
            np.zeros((1, 2, 3), np.float32),
            colors=HELD_COLOUR,
            thickness=4.0,
            thickness_units="screen",
            visible=False,
        )

    def add_gizmo(
        self, thing: str, position: tuple[float, float, float], scale: float
    ) -> viser.TransformControlsHandle:
        gizmo = self.server.scene.add_transform_controls(
            f"/{thing}_gizmo", scale=scale, position=position, disable_rotations=True, depth_test=False
        )

        @gizmo.on_update
        async def _(event: Any) -> None:
            self.dragged_at[thing] = time.monotonic()
            place = finite_vector(event.target.position)
            if place is not None:
                self.post(Place(thing, place))

        return gizmo

    def build(self, picture: RopePicture) -> None:
        """Make tube and beads for a new number of points."""
        n = len(picture.points)
        self.between = max(1, RINGS // (n - 1))
        rings = (n - 1) * self.between + 1
        self.line = np.zeros((rings, 3))
        self.vertices = np.zeros((rings * SIDES + 2, 3), np.float32)
        self.sweep(picture)
        if self.tube is not None:
            self.tube.remove()
        if self.beads is not None:
            self.beads.remove()
        self.tube = Painted(
            self.server,
            "/rope",
            self.vertices,
            tube_faces(rings),
            self.colours(picture),
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
        self.points = picture.points
        self.held = -1
        self.count = n

    def bead_radius(self, picture: RopePicture) -> float:
        n = len(picture.points)
        spacing = float(np.abs(np.diff(picture.points, axis=0)).sum()) / max(n - 1, 1)
        return float(np.clip(0.4 * spacing, 0.5 * THICKNESS, 1.9 * THICKNESS))

    async def on_bead(self, event: Any) -> None:
        self.drag(event, event.instance_index)

    async def on_tube(self, event: Any) -> None:
        """The same between beads, where they are close or hidden: the point nearest to where the drag began."""
        if event.phase == "start":
            self.nearest = int(np.argmin(np.linalg.norm(self.points - event.start_position, axis=1)))
        self.drag(event, self.nearest)

    def drag(self, event: Any, particle: int | None) -> None:
        target = finite_vector(event.end_position)
        if event.phase == "end" or target is None or particle is None:
            self.post(Release())
        else:
            self.post(Grab(particle, target))

    def sweep(self, picture: RopePicture) -> None:
        smooth_line(picture.points, self.between, self.line)
        sweep(self.line, THICKNESS, SIDES, self.vertices)

    def colours(self, picture: RopePicture) -> np.ndarray:
        """(vertices, 3) sRGB in 0..1: tension along the rope, or plain."""
        if picture.colour == "plain":
            return np.tile(np.array(ROPE_COLOUR, np.float32) / 255, (len(self.vertices), 1))
        links = np.arange(len(picture.tension)) + 0.5
        along = np.interp(np.arange(len(self.line)) / self.between, links, picture.tension)
        rings = scale_colours(along, 0.0, picture.full_scale)
        return np.concatenate([np.repeat(rings, SIDES, axis=0), rings[[0, -1]]])

    def show(self, picture: RopePicture) -> None:
        """Assign a new frame to the handles; call inside `server.atomic()`."""
        if picture.race is None:
            self.show_rope(picture)
        else:
            self.show_race(picture)
        self.pull.visible = picture.pull is not None
        if picture.pull is not None:
            points = picture.points if picture.race is None else picture.race.ropes.reshape(-1, 3)
            self.pull.points = np.array([[points[picture.pull.particle], picture.pull.target]], np.float32)
            self.pull.thickness = 2.0 + 5.0 * picture.pull.load
        self.floor.visible = picture.floor
        self.floor.cell_thickness = 1.0 if picture.grid else 0.0
        self.floor.section_thickness = 1.0 if picture.grid else 0.0
        self.ball.visible = self.gizmos["sphere"].visible = picture.sphere is not None
        self.follow("root", picture.root)
        if picture.sphere is not None:
            self.ball.position = picture.sphere[:3]
            self.ball.scale = picture.sphere[3]
            self.follow("sphere", picture.sphere[:3])

    def show_race(self, picture: RopePicture) -> None:
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

    def show_rope(self, picture: RopePicture) -> None:
        """The one rope."""
        if self.race is not None:
            self.race.remove()
            self.race = None
            self.look_from(self.CAMERA)
        if len(picture.points) != self.count:
            self.build(picture)
        assert self.tube is not None
        assert self.beads is not None
        self.points = picture.points
        self.sweep(picture)
        self.tube.set(self.vertices, self.colours(picture))
        self.beads.visible = picture.show_points
        if picture.show_points:
            self.beads.batched_positions = picture.points
        held = -1 if picture.pull is None else picture.pull.particle
        if held != self.held:
            colours = np.tile(np.array(BEAD_COLOUR, np.uint8), (self.count, 1))
            if held >= 0:
                colours[held] = HELD_COLOUR
            self.beads.batched_colors = colours
            self.held = held
        self.hook.visible = True
        self.hook.position = tuple(picture.points[0])

    def follow(self, thing: str, position: tuple[float, float, float]) -> None:
        """Move a gizmo to where its thing was put by other means, unless it is being dragged."""
        gizmo = self.gizmos[thing]
        away = max(abs(float(a) - b) for a, b in zip(gizmo.position, position, strict=True))
        if away > 1e-4 and time.monotonic() - self.dragged_at[thing] > HANDS_OFF:
            gizmo.position = position


def warm_up() -> Iterator[str]:
    """Compile what the drawing calls; yields what comes next."""
    yield "drawing"
    line, vertices = np.zeros((3, 3)), np.zeros((3 * SIDES + 2, 3), np.float32)
    smooth_line(np.zeros((2, 3), np.float32), 2, line)
    sweep(line, THICKNESS, SIDES, vertices)


def stiffness_knob(params: Any) -> str:
    """The knob that a map of step and stiffness is about."""
    return "stiffness" if params.units == "lab" else "axial_stiffness"


def readout(snapshot: Snapshot) -> str:
    """The stability gauge and the colour scale, or a race's standings, as HTML."""
    if isinstance(snapshot.gauge, RaceGauge):
        return standings(snapshot.gauge)
    g = snapshot.gauge.stability
    part = g.h_omega / g.limit if g.limit > 0 else float("inf")
    width, colour = min(part, 1.0) * 100, "#2b8a3e" if part < 0.8 else "#e67700" if part <= 1.0 else "#c92a2a"
    verdict = "stable" if part <= 1.0 else "unstable"
    picture = snapshot.picture
    paid, scale = price(snapshot.gauge.paid), ""
    if picture.colour == "tension":
        scale = (
            f'<div style="height:8px;border-radius:4px;background:{css_scale()}"></div>'
            '<div style="display:flex;justify-content:space-between">'
            f"<span>slack</span><span>tension</span><span>{picture.full_scale:.3g} N</span></div>"
        )
    return (
        f'<div style="display:flex;justify-content:space-between"><b>h ω = {g.h_omega:.3g}</b>'
        f"<span>limit {g.limit:.3g} at ζ = {g.zeta:.2g}</span>"
        f'<b style="color:{colour}">{verdict}</b></div>'
        '<div style="height:8px;border-radius:4px;background:rgba(128,128,128,.25);margin:2px 0 8px">'
        f'<div style="height:8px;border-radius:4px;width:{width:.0f}%;background:{colour}"></div></div>{paid}{scale}'
    )


def price(paid: Paid | None) -> str:
    """What an implicit method asks for its stability, as HTML; nothing of others."""
    if paid is None:
        return ""
    share = f", the rope's own damping {paid.dissipated:.3g} J" if paid.dissipated > 0.0 else ""
    return (
        f'<div style="margin-bottom:6px">paid: <b>{paid.corrections:.1f}</b> Newton corrections a step; the method '
        f"{'took' if paid.taken >= 0 else 'gave'} <b>{abs(paid.taken):.3g} J</b>{share}</div>"
    )


def marks(snapshot: Snapshot) -> dict[str, str]:
    """What is written under a knob: the largest value that holds with the others as they are."""
    g = snapshot.gauge
    if isinstance(g, RaceGauge):
        first = g.standings[0].gauge.critical_step
        limit = "" if first == float("inf") else f"rope 1 holds up to {first:.3g} s"
        return {"integrator": "", "time_step": limit, "stiffness": "", "axial_stiffness": ""}
    step, stiffness = g.stability.critical_step, g.largest_stiffness
    unit = "N/m" if g.knob == "stiffness" else "N"
    if step == float("inf"):
        return {"integrator": g.note, "time_step": "any step holds", g.knob: "any stiffness holds"}
    return {
        "integrator": g.note,
        "time_step": f"holds up to {step:.3g} s" if step > 0 else "no step holds with this method",
        g.knob: f"holds up to {stiffness:.3g} {unit}" if stiffness > 0 else "no stiffness holds at this step",
    }
