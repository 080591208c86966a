"""The rope as a tube coloured by tension, its points as beads to be dragged, root and sphere with arrows."""

import math
from typing import Any, ClassVar, TypeAlias

import numpy as np
import viser
from numpy.typing import NDArray

from app.formats.formatting import number
from app.formats.packing import compile_packing
from app.messages import Snapshot, Vector
from app.render.coloured_mesh import ColouredMesh
from app.render.handles.viser_inside import set_arrays
from app.render.markup.html import Html, bold, fill, join
from app.render.meshes import ball, rod, tube_faces
from app.render.tubes import compile_tube
from app.scenes.contract import Pieces, PostCommand
from app.scenes.rope.frame import NumericalCost, RopeFrame, RopeReadings
from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.start import root_home, start_points
from app.scenes.springs.drawing.html import colour_scale, simple_drawing, stability_bar, step_mark
from app.scenes.springs.drawing.ropes_view import MAX_BEAD_RATIO, RopesDrawing, RopesView
from app.scenes.springs.drawing.view import SecondNet, Sphere
from app.scenes.springs.net_motion import SolverReport, rope_lengths
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, SPHERE, build_rope
from app.scenes.springs.speed_advice import held, solver_words

ROPE_COLOUR = (196, 154, 92)
REFERENCE_COLOUR = (60, 110, 190)
REFERENCE_OPACITY = 0.35
TUBE_STEP = 2.0**-15  # [m] to which points of the tube are rounded for the page
REFERENCE_RADIUS = 1.35 * ROPE_RADIUS  # [m]: seen around the student's rope where both are in one place
BEAD_COLOUR = (58, 68, 86)
HANGER_COLOUR = (60, 66, 80)
HANGER_RADIUS, HANGER_HEIGHT = 0.012, 25.0  # [m] of the rod that holds an end: it leaves the picture
STONE = 2000.0  # [kg/m3] of the weight at the tip
SPHERE_ARROW_LENGTH = 0.45  # [m]
SPHERE_ARROW_GAP = 0.08  # [m] between the top of the sphere and its arrows
SHOWN_SHARE = 0.6  # of the picture's height that the rope takes at most as it hangs
SHOWN_SWING = 2.15  # lengths of the rope in the picture's height, so that it stays in the picture as it swings
START_SIDE = 0.15  # lengths of the rope from the root towards its start, to the target; with drag it swings less beyond
SHOWN_UNDAMPED_SWING = 2.6  # the same without drag: it swings to both sides as far as it began
ELEVATION = 0.25  # [rad] of the camera over its target, so that the shadow on the floor is in the picture
LOWER = 0.03  # heights of the picture from the middle of the rope down to the target
START_SHARE = 0.65  # of the picture's height that a rope takes which does not begin level
LEAST_ASPECT = 1.0  # width over height of a picture in which it is whole
COLOUR_TOLERANCE = 2e-3  # of the colour scale that a link may be from its drawn colour: less than 1/256 of it

RopeSnapshot: TypeAlias = Snapshot[RopeParams, RopeFrame, RopeReadings]


class TensionRope(RopesDrawing):
    """One rope in the colours of its tension, or in one colour."""

    RINGS = 120
    BEADS = "/points"
    BEAD_ROWS = 8

    def __init__(self, server: viser.ViserServer, frame: RopeFrame) -> None:
        super().__init__(server, frame, frame.points[None], ("/rope",))

    def make_tube(self, frame: RopeFrame, number: int, name: str) -> ColouredMesh:
        """The node of the tube."""
        self.paint(frame)
        return ColouredMesh(
            self.server, name, self.vertices[number], self.tube.faces, self.rgb, columns=self.SIDES, step=TUBE_STEP,
            color=ROPE_COLOUR, side="double",
        )  # fmt: skip

    def bead_colours(self) -> np.ndarray:
        """Colours of the beads, none grabbed."""
        return np.tile(np.array(BEAD_COLOUR, np.uint8), (self.points.shape[1], 1))

    @property
    def meshes(self) -> list[Any]:
        """The drawn mesh of the tube."""
        return [tube.mesh for tube in self.tubes]

    def paint(self, frame: RopeFrame) -> None:
        """Compute the tube's colours, which then stand for this frame and for all that look the same."""
        self.tension = frame.tension
        self.painted = frame.params.colour, frame.full_scale
        if frame.params.colour == "plain":
            self.rgb = np.tile(np.array(ROPE_COLOUR, np.float32) / 255, (self.tube.shape[0], 1))
        else:
            self.rgb = self.tube.colours(frame.tension, frame.full_scale)

    def colours_differ(self, frame: RopeFrame) -> bool:
        """True if a frame's colours can be told from those that are shown."""
        if self.painted != (frame.params.colour, frame.full_scale):
            return True
        return float(np.abs(frame.tension - self.tension).max()) >= COLOUR_TOLERANCE * frame.full_scale

    def show(self, frame: RopeFrame) -> None:
        """Assign a new frame; called while a picture is handed over as one."""
        repaint = self.colours_differ(frame)
        self.shape_tubes(frame.points[None], always=repaint)
        if repaint:
            self.paint(frame)
        self.tubes[0].set(self.vertices[0], self.rgb if repaint else None)
        self.show_beads(frame.params.show_points, frame.grab)


class Hanger:
    """The rod that holds an end of the rope, from above or from below, with a ball at its end.

    It moves by its vertices, as the rope does: a slow page applies positions of nodes at other times.
    """

    def __init__(self, server: viser.ViserServer, name: str) -> None:
        sphere, faces = ball(6)
        rods = (
            rod(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, end]]), HANGER_RADIUS) for end in (HANGER_HEIGHT, -HANGER_HEIGHT)
        )
        self.shapes = [
            np.concatenate([MAX_BEAD_RATIO * ROPE_RADIUS * sphere, each]).astype(np.float32) for each in rods
        ]
        self.mesh = server.scene.add_mesh_simple(
            name, self.shapes[0], np.concatenate([faces, tube_faces(2) + np.uint32(len(sphere))]),
            color=HANGER_COLOUR, cast_shadow=False, visible=False,
        )  # fmt: skip
        self.pose: tuple[float, ...] = ()

    def show(self, end: NDArray[np.float32] | None, *, from_below: bool) -> None:
        """Move to an end of the rope (3,) [m]; None: draw nothing."""
        self.mesh.visible = end is not None
        if end is not None and (*end.tolist(), from_below) != self.pose:
            self.pose = (*end.tolist(), from_below)
            set_arrays(self.mesh, vertices=self.shapes[from_below] + end)


class Weight:
    """The weight at the tip, as a ball of stone. It moves by its vertices, as the rope does."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.unit_ball, faces = ball()
        self.mesh = server.scene.add_mesh_simple("/weight", self.unit_ball, faces, color=HANGER_COLOUR, visible=False)
        self.state: tuple[float, ...] = ()

    def show(self, tip: NDArray[np.float32], mass: float) -> None:
        """Move to the tip (3,) [m]. mass: [kg], 0 without a weight."""
        self.mesh.visible = mass > 0.0
        if mass > 0.0 and (*tip.tolist(), mass) != self.state:
            self.state = (*tip.tolist(), mass)
            radius = (0.75 * mass / (math.pi * STONE)) ** (1.0 / 3.0)
            set_arrays(self.mesh, vertices=(radius * self.unit_ball + tip).astype(np.float32))


class RopeView(RopesView[RopeParams, RopeFrame, RopeReadings]):
    """Draws `RopeFrame`s."""

    FIELD_OF_VIEW = 1.3  # [rad]
    WARM_UP: ClassVar[Pieces] = {"drawing": compile_tube, "packing": compile_packing}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        super().__init__(server, post)
        self.sphere = Sphere(server, post, SPHERE_ARROW_LENGTH, SPHERE_ARROW_GAP)
        self.hanger, self.end_hanger = Hanger(server, "/hanger"), Hanger(server, "/end-hanger")
        self.weight = Weight(server)
        self.reference = SecondNet(
            server, "/reference", "yours", color=REFERENCE_COLOUR, opacity=REFERENCE_OPACITY, receive_shadow=False
        )

    def first_view(self, params: RopeParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: in front of the rope as it hangs and swings."""
        if params.start != "level":
            return view_of_start(params)
        net = build_rope(params)
        length, stretch = rope_lengths(net)
        fall = length + min(stretch, length)
        if params.floor:
            fall = min(fall, ROOT[2])
        swing, side = (SHOWN_SWING, START_SIDE) if net.drag > 0.0 else (SHOWN_UNDAMPED_SWING, 0.0)
        height, x = max(fall / SHOWN_SHARE, swing * length), -side * length
        distance, target = 0.5 * height / math.tan(0.5 * self.FIELD_OF_VIEW), ROOT[2] - 0.5 * fall - LOWER * height
        position = x, -distance * math.cos(ELEVATION), target + distance * math.sin(ELEVATION)
        return position, (x, 0.0, target)

    def draw(self, frame: RopeFrame) -> TensionRope:
        """A drawing for the number of points of a frame."""
        return TensionRope(self.server, frame)

    def show(self, frame: RopeFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        self.show_ropes(frame, frame.points[None])
        p = frame.params
        is_free = frame.reference is not None or not p.end_held  # beside a student's rope the end is free
        self.hanger.show(self.points[0], from_below=p.start == "over")
        self.end_hanger.show(None if is_free else self.points[-1], from_below=False)
        self.weight.show(self.points[-1], 0.0 if frame.reference is not None else p.tip_mass)
        self.sphere.show(frame.sphere, frame.sphere[:3] if frame.sphere and p.handles else None)
        if frame.reference is None:
            self.reference.hide()
        else:
            tube = self.ropes.tube
            vertices = tube.vertices(frame.reference, REFERENCE_RADIUS)
            self.reference.show(vertices, tube.faces, self.points[-1], frame.reference[-1])

    def figures(self, snapshot: RopeSnapshot) -> str:
        """The stability bar."""
        return stability_bar(snapshot.readings.stability)

    def readout(self, snapshot: RopeSnapshot) -> str:
        """The cost of an implicit method and the colour scale, as HTML."""
        frame, scale = snapshot.frame, ""
        if frame.params.colour == "tension" and self.ropes is not None and self.ropes.tubes[0].has_shader is False:
            scale = simple_drawing("tension")
        elif frame.params.colour == "tension":
            scale = colour_scale(
                "slack", "tension", f"{number(frame.full_scale)} N",
                clipped=float(frame.tension.max()) > frame.full_scale,
            )  # fmt: skip
        return cost_text(snapshot.readings.cost) + solver_text(snapshot.readings.solver) + scale

    def marks(self, snapshot: RopeSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest value that is stable with the others as they are."""
        g = snapshot.readings
        step, stiffness = g.stability.critical_step, g.largest_stiffness
        unit = "N/m" if g.parameter == "stiffness" else "N"
        text = f"limit {number(held(stiffness))} {unit}" if stiffness > 0 else "no stiffness is stable at this step"
        if step == float("inf"):
            text = "every stiffness is stable"
        return {
            "integrator": g.note,
            "time_step": step_mark(step, g.stability.accurate_step, g.stability.landed_step),
            g.parameter: text,
        }


def view_of_start(params: RopeParams) -> tuple[Vector, Vector]:
    """Position and target [m] of a camera before a rope that hangs, is held or lies over the sphere from its start."""
    points = start_points(params, root_home(params))
    if params.start == "over":  # the sphere, and the way of the weight down to the floor
        top = SPHERE[2] + params.sphere_radius
        points = np.vstack([points, (*SPHERE[:2], top), (*SPHERE[:2], 0.0)])
    elif params.floor:
        points[:, 2] = np.maximum(points[:, 2], 0.0)
    low, high = points.min(axis=0), points.max(axis=0)
    if params.end_held:  # as far as a rope that is held at both ends can hang
        low[2] = min(low[2], high[2] - 0.5 * params.length)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    distance = max(half[2], half[0] / LEAST_ASPECT) / (START_SHARE * math.tan(0.5 * RopeView.FIELD_OF_VIEW))
    up = distance * math.sin(ELEVATION)
    x, y, z = (float(each) for each in middle)
    return (x, y - distance * math.cos(ELEVATION), z + up), (x, y, z)


def cost_text(cost: NumericalCost | None) -> Html:
    """The cost of an implicit method, as HTML; empty for explicit ones."""
    if cost is None:
        return Html("")
    energy = cost.numerical_dissipation
    damping = f", {number(cost.damping_dissipation)} J by damping" if cost.damping_dissipation > 0.0 else ""
    return fill(
        '<div style="margin-bottom:6px">{} corrections a step. Energy {} by the method: {}{}.</div>',
        bold(f"{cost.corrections:.1f}"),
        "taken" if energy >= 0 else "added",
        bold(f"{number(abs(energy))} J"),
        damping,
    )


def solver_text(report: SolverReport) -> Html:
    """The failures of the method, as HTML."""
    return join([fill('<div style="margin-bottom:6px">{}</div>', words) for words in solver_words(report, "strands")])


VIEW = RopeView
