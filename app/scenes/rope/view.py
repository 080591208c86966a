"""The rope as a tube coloured by tension, its points as beads to be dragged, root and sphere with arrows."""

import math
from typing import Any, ClassVar, TypeAlias

import numpy as np
import viser

from app.formats.formatting import number
from app.formats.packing import compile_packing
from app.messages import Snapshot, Vector
from app.render.colormap import SCALE, set_tube_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.dragging import GRAB_COLOUR
from app.render.gizmo import Gizmo
from app.render.html import Html, bold, fill
from app.render.injection import add_contact_shadow
from app.render.meshes import SIDES, ball, smooth_line, sweep, tube_faces
from app.render.viser_inside import set_arrays
from app.scenes.contract import Pieces, PostCommand
from app.scenes.rope.frame import NumericalCost, RopeFrame, RopeReadings
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.html import colour_scale, simple_drawing, stability_bar, step_mark
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, build_rope
from app.scenes.springs.view import ROOT_ARROW_LENGTH, SecondNet, Sphere, SpringView, compile_tube

ROPE_COLOUR = (196, 154, 92)
REFERENCE_COLOUR = (60, 110, 190)
REFERENCE_OPACITY = 0.35
TUBE_STEP = 2.0**-15  # [m] to which points of the tube are rounded for the page
REFERENCE_RADIUS = 1.35 * ROPE_RADIUS  # [m]: seen around the student's rope where both are in one place
BEAD_COLOUR = (58, 68, 86)
HOOK_COLOUR = (60, 66, 80)
SPHERE_ARROW_LENGTH = 0.45  # [m]
SPHERE_ARROW_GAP = 0.08  # [m] between the top of the sphere and its arrows
RING_COUNT = 120  # rings of the drawn tube, about
MAX_BEAD_RADIUS = 1.9 * ROPE_RADIUS  # [m]
MIN_BEAD_RADIUS = 0.5 * ROPE_RADIUS  # [m]
SHOWN_SHARE = 0.6  # of the picture's height that the rope takes at most as it hangs
SHOWN_SWING = 1.75  # lengths of the rope in the picture's height, so that it stays in the picture as it swings
ELEVATION = 0.25  # [rad] of the camera over its target, so that the shadow on the floor is in the picture
LOWER = 0.03  # heights of the picture from the middle of the rope down to the target
POSITION_TOLERANCE = 2e-4  # [m] that a point may be from where it is drawn: far below a pixel
COLOUR_TOLERANCE = 2e-3  # of the colour scale that a link may be from its drawn colour: less than 1/256 of it

RopeSnapshot: TypeAlias = Snapshot[RopeParams, RopeFrame, RopeReadings]


class RopeView(SpringView[RopeParams, RopeFrame, RopeReadings]):
    """Draws `RopeFrame`s."""

    FIELD_OF_VIEW = 1.3  # [rad]
    WARM_UP: ClassVar[Pieces] = {"drawing": compile_tube, "packing": compile_packing}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        super().__init__(server, post)
        self.tube: ColouredMesh | None = None
        self.beads: viser.BatchedMeshHandle | None = None
        self.count = 0  # points that tube and beads are made for
        self.root = Gizmo(server, post, "root", ROOT_ARROW_LENGTH, position=ROOT)
        self.sphere = Sphere(server, post, SPHERE_ARROW_LENGTH, SPHERE_ARROW_GAP)
        self.hook = server.scene.add_mesh_simple("/hook", *ball(8), scale=MAX_BEAD_RADIUS, color=HOOK_COLOUR)
        self.reference = SecondNet(
            server, "/reference", "yours", color=REFERENCE_COLOUR, opacity=REFERENCE_OPACITY, receive_shadow=False
        )

    def first_view(self, params: RopeParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: in front of the rope as it hangs."""
        length, stretch = rope_lengths(build_rope(params))
        fall = length + min(stretch, length)
        if params.floor:
            fall = min(fall, ROOT[2])
        height = max(fall / SHOWN_SHARE, SHOWN_SWING * length)
        distance, target = 0.5 * height / math.tan(0.5 * self.FIELD_OF_VIEW), ROOT[2] - 0.5 * fall - LOWER * height
        position = 0.0, -distance * math.cos(ELEVATION), target + distance * math.sin(ELEVATION)
        return position, (0.0, 0.0, target)

    def build(self, frame: RopeFrame) -> None:
        """Make tube and beads for a new number of points."""
        n = len(frame.points)
        self.samples = max(1, RING_COUNT // (n - 1))  # rings a link
        rings = (n - 1) * self.samples + 1
        self.line = np.zeros((rings, 3))
        self.vertices, self.rgb = np.zeros((2, rings * SIDES + 2, 3), np.float32)
        self.shape_tube(frame)
        self.set_tube_colours(frame)
        if self.tube is not None:
            self.tube.remove()
        if self.beads is not None:
            self.beads.remove()
        self.faces = tube_faces(rings)
        self.tube = ColouredMesh(
            self.server, "/rope", self.vertices, self.faces, self.rgb, columns=SIDES, step=TUBE_STEP,
            color=ROPE_COLOUR, side="double",
        )  # fmt: skip
        add_contact_shadow(self.server, "/rope")
        self.beads = self.server.scene.add_batched_meshes_simple(
            "/points",
            *ball(8 if n <= 200 else 4),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
            batched_positions=frame.points,
            batched_scales=np.full(n, bead_radius(frame.points), np.float32),
            batched_colors=np.tile(np.array(BEAD_COLOUR, np.uint8), (n, 1)),
            lod="off",
        )
        self.beads.on_drag("left")(self.on_bead)
        self.tube.mesh.on_drag("left")(self.on_surface)
        self.shown_grab = -1  # point that is drawn as grabbed
        self.shown_hook: Any = None
        self.count = n

    def shape_tube(self, frame: RopeFrame) -> None:
        """Compute the tube's vertices, which then stand for this frame and for all that look the same."""
        self.points = frame.points
        smooth_line(frame.points, self.samples, self.line)
        sweep(self.line, ROPE_RADIUS, SIDES, self.vertices)

    def set_tube_colours(self, frame: RopeFrame) -> None:
        """Compute the tube's colours, which then stand for this frame and for all that look the same."""
        self.tension = frame.tension
        self.painted = frame.params.colour, frame.full_scale
        if frame.params.colour == "plain":
            self.rgb[:] = np.array(ROPE_COLOUR, np.float32) / 255
        else:
            set_tube_colours(frame.tension, self.samples, frame.full_scale, SCALE, SIDES, self.rgb)

    def colours_differ(self, frame: RopeFrame) -> bool:
        """True if a frame's colours can be told from those that are shown."""
        if self.painted != (frame.params.colour, frame.full_scale):
            return True
        return float(np.abs(frame.tension - self.tension).max()) >= COLOUR_TOLERANCE * frame.full_scale

    def show(self, frame: RopeFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        if len(frame.points) != self.count:
            self.build(frame)
        assert self.tube is not None
        assert self.beads is not None
        repaint = self.colours_differ(frame)
        if repaint or float(np.abs(frame.points - self.points).max()) >= POSITION_TOLERANCE:
            self.shape_tube(frame)
        if repaint:
            self.set_tube_colours(frame)
        self.tube.set(self.vertices, self.rgb if repaint else None)
        p = frame.params
        self.beads.visible = p.show_points
        if p.show_points:
            set_arrays(self.beads, batched_positions=self.points)
        grabbed = -1 if frame.grab is None else frame.grab.particle
        if grabbed != self.shown_grab:
            colours = np.tile(np.array(BEAD_COLOUR, np.uint8), (self.count, 1))
            if grabbed >= 0:
                colours[grabbed] = GRAB_COLOUR
            self.beads.batched_colors = colours
            self.shown_grab = grabbed
        root = tuple(self.points[0].tolist())
        # A slow page moves a node later than the vertices of the rope: while the root moves, the hook is not shown.
        self.hook.visible = self.shown_hook in (None, root)
        if root != self.shown_hook:
            self.shown_hook = root
            self.hook.position = root
        self.root.show(frame.root if p.handles else None)
        self.sphere.show(frame.sphere, frame.sphere[:3] if frame.sphere and p.handles else None)
        self.show_surroundings(p.floor, p.grid, frame.grab)
        if frame.reference is None:
            self.reference.set_visible(False)
        else:
            line, vertices = np.empty_like(self.line), np.empty_like(self.vertices)
            smooth_line(frame.reference, self.samples, line)
            sweep(line, REFERENCE_RADIUS, SIDES, vertices)
            self.reference.show(vertices, self.faces, self.points[-1], frame.reference[-1])

    def figures(self, snapshot: RopeSnapshot) -> str:
        """The stability bar."""
        return stability_bar(snapshot.readings.stability)

    def readout(self, snapshot: RopeSnapshot) -> str:
        """The cost of an implicit method and the colour scale, as HTML."""
        frame, scale = snapshot.frame, ""
        if frame.params.colour == "tension" and self.tube is not None and self.tube.has_shader is False:
            scale = simple_drawing("tension")
        elif frame.params.colour == "tension":
            scale = colour_scale(
                "slack", "tension", f"{number(frame.full_scale)} N",
                clipped=float(frame.tension.max()) > frame.full_scale,
            )  # fmt: skip
        return cost_text(snapshot.readings.cost) + scale

    def marks(self, snapshot: RopeSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest value that is stable with the others as they are."""
        g = snapshot.readings
        step, stiffness = g.stability.critical_step, g.largest_stiffness
        unit = "N/m" if g.parameter == "stiffness" else "N"
        text = f"limit {number(stiffness)} {unit}" if stiffness > 0 else "no stiffness is stable at this step"
        if step == float("inf"):
            text = "every stiffness is stable"
        return {"integrator": g.note, "time_step": step_mark(step), g.parameter: text}


def bead_radius(points: np.ndarray) -> float:
    """Radius [m] of the beads at points (n, 3) [m]: smaller where they are close to each other."""
    spacing = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()) / max(len(points) - 1, 1)
    return float(np.clip(0.4 * spacing, MIN_BEAD_RADIUS, MAX_BEAD_RADIUS))


def cost_text(cost: NumericalCost | None) -> Html:
    """The cost of an implicit method, as HTML; empty for explicit ones."""
    if cost is None:
        return Html("")
    energy = cost.numerical_dissipation
    damping = f", {number(cost.damping_dissipation)} J by damping" if cost.damping_dissipation > 0.0 else ""
    return fill(
        '<div style="margin-bottom:6px">{} Newton iterations a step. Energy {} by the method: {}{}.</div>',
        bold(f"{cost.corrections:.1f}"),
        "taken" if energy >= 0 else "added",
        bold(f"{number(abs(energy))} J"),
        damping,
    )


VIEW = RopeView
