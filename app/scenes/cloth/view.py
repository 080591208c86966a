"""The cloth as a checked fabric or coloured by strain, which can be dragged anywhere; pins and sphere with arrows."""

import math
from typing import ClassVar, TypeAlias

import numpy as np
import viser

from app.formats.formatting import counted, number
from app.formats.packing import compile_packing
from app.messages import Snapshot, Vector
from app.render.cameras import framing_view
from app.render.colormap import scale_colours
from app.render.coloured_mesh import ColouredMesh
from app.render.handles.gizmo import Gizmo
from app.render.handles.viser_inside import set_arrays
from app.render.markup.html import Html, fill, info, join
from app.render.meshes import ball, rod, tube_faces
from app.scenes.cloth.frame import ClothFrame, ClothReadings
from app.scenes.cloth.parameters import ClothParams
from app.scenes.cloth.start import corner, sphere_home
from app.scenes.contract import Pieces, PostCommand
from app.scenes.springs.drawing.html import colour_scale, simple_drawing, stability_bar, step_mark
from app.scenes.springs.drawing.view import SecondNet, Sphere, SpringView
from app.scenes.springs.speed_advice import solver_words
from sim.springs.points.cells import faces

CLOTH_COLOUR = (176, 58, 72)
CHECK_COLOUR, CHECK_SHARES = (240, 226, 208), (0.0, 0.35, 0.75)  # where no, one or both threads have it
CHECKS = 8  # along the longer side
STUDENT_COLOUR, STUDENT_OPACITY = (20, 150, 90), 0.7  # a colour that no strain has
POINT_STEP = 2.0**-15  # [m] to which points are rounded for the page: no grain shows in the light on a fine cloth
PIN_COLOUR = (60, 66, 80)
PIN_RADIUS = 0.018  # [m] of the balls that mark the pins
PIN_ARROW_LENGTH, SPHERE_ARROW_LENGTH = 0.22, 0.3  # [m]
SPHERE_ARROW_GAP = -0.3  # [m] from the sphere to its arrows below it, where no cloth lies
POLE_COLOUR = (96, 88, 80)
POLE_WIDTH = 0.03  # [m]
POLE_OVERHANG = 0.06  # of the flag's height, above the flag
MIN_POLE_DROP = 0.1  # [m] smallest height of the flag from which the foot of the pole is computed

ClothSnapshot: TypeAlias = Snapshot[ClothParams, ClothFrame, ClothReadings]


def checks(rows: int, cols: int) -> np.ndarray:
    """(rows cols, 3) sRGB in 0..1 of a checked fabric, whose folds light and shadow show."""
    side = max(max(rows, cols) // (2 * CHECKS), 1)
    light = (np.arange(rows)[:, None] // side % 2) + (np.arange(cols) // side % 2)
    share = np.array(CHECK_SHARES)[light].reshape(-1, 1)
    return ((1.0 - share) * CLOTH_COLOUR + share * CHECK_COLOUR).astype(np.float32) / 255


# Corners of a loose cloth while it falls onto a sphere: parts of its half width from the middle, and below the start.
DRAPING = ((1.0, 0.0), (0.92, 0.65), (0.8, 1.3))


def reach_of(params: ClothParams) -> np.ndarray:
    """Points (n, 3) [m] around a level cloth, its way where it is loose, and the stroke of its sphere."""
    x, y, z = corner(params)
    x, y = abs(x), abs(y)
    ways = ((1.0, 0.0),) if params.pinned != "free" else DRAPING if params.sphere else ((1.0, 0.0), (1.0, z / x))
    points = [
        (side * out * x, end * out * y, max(z - down * x, 0.0))
        for side in (-1.0, 1.0) for end in (-1.0, 1.0) for out, down in ways
    ]  # fmt: skip
    if params.sphere:
        sphere_x, sphere_y, height = sphere_home(params)
        reach = params.sphere_radius + params.bob
        points += [(sphere_x, sphere_y, height - reach), (sphere_x, sphere_y, height + reach)]
    return np.array(points)


STRAIN = "Strain: by how much a thread is longer than at rest. 5 % is 5 mm on 100 mm."


class ClothView(SpringView[ClothParams, ClothFrame, ClothReadings]):
    """Draws `ClothFrame`s."""

    CAMERA = ((0.7, -1.5, 1.9), (0.12, 0.0, 1.12))  # position, target [m]; of a level cloth
    HANGING = ((0.62, -1.55, 1.75), (0.15, 0.0, 1.32))  # the same of one that hangs
    # Of the camera over a cloth with a sphere or a loose one: bearing, pitch [rad] where it is held and where it falls,
    # and the part of the picture that they fill.
    BEARING, PITCH, STEEP_PITCH, FRAME = math.radians(291.0), math.radians(9.0), math.radians(24.0), (0.74, -0.8, 0.75)
    FIELD_OF_VIEW = 1.3  # [rad]
    WARM_UP: ClassVar[Pieces] = {"packing": compile_packing}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        super().__init__(server, post)
        self.mesh: ColouredMesh | None = None
        self.shape = (0, 0)
        self.fabric = checks(0, 0)
        scene = server.scene
        self.pins = [Gizmo(server, post, name, PIN_ARROW_LENGTH, visible=False) for name in ("pin a", "pin b")]
        self.sphere = Sphere(server, post, SPHERE_ARROW_LENGTH, SPHERE_ARROW_GAP)
        self.pin_balls = [
            scene.add_mesh_simple(f"/pin_{name}", *ball(12), scale=PIN_RADIUS, color=PIN_COLOUR) for name in ("a", "b")
        ]
        self.pole = scene.add_mesh_simple(
            "/pole", rod(np.eye(3)[:2], POLE_WIDTH / 2), tube_faces(2), color=POLE_COLOUR, visible=False
        )
        self.pole_ends = np.zeros((2, 3))
        self.student = SecondNet(
            server, "/student", "yours (translucent)", color=STUDENT_COLOUR, opacity=STUDENT_OPACITY, side="double"
        )

    def first_view(self, params: ClothParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved."""
        if params.start != "level":
            return self.HANGING
        falls = params.pinned == "free"
        if not falls and not params.sphere:
            return self.CAMERA
        pitch = self.STEEP_PITCH if falls else self.PITCH
        return framing_view(reach_of(params), self.BEARING, pitch, self.FIELD_OF_VIEW, self.FRAME)

    def build(self, frame: ClothFrame) -> None:
        """Make the mesh for another grid."""
        rows, cols = self.shape = frame.points.shape[0], frame.points.shape[1]
        self.fabric = checks(rows, cols)
        if self.mesh is not None:
            self.mesh.remove()
        self.mesh = ColouredMesh(
            self.server, "/cloth", self.points, faces(rows, cols), self.colours(frame), columns=cols, step=POINT_STEP,
            color=CLOTH_COLOUR, side="double",
        )  # fmt: skip
        self.mesh.mesh.on_drag("left")(self.on_surface)

    def colours(self, frame: ClothFrame) -> np.ndarray:
        """(particles, 3) sRGB in 0..1: fabric, or strain."""
        if frame.params.colour == "fabric":
            return self.fabric
        return scale_colours(frame.strain.ravel().astype(np.float64), 0.0, 0.01 * frame.params.full_strain)

    def show(self, frame: ClothFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        p, self.points = frame.params, frame.points.reshape(-1, 3)
        if frame.points.shape[:2] != self.shape:
            self.build(frame)
        assert self.mesh is not None
        self.mesh.set(self.points, self.colours(frame))
        self.show_surroundings(p.floor, p.grid, frame.grab)
        self.sphere.show(frame.sphere, frame.sphere_home if p.handles else None)
        if frame.student is None:
            self.student.hide()
        else:
            own = frame.student.reshape(-1, 3)
            self.student.show(own, faces(*frame.student.shape[:2]), own[-1], self.points[-1])
        for index, (gizmo, pin_ball) in enumerate(zip(self.pins, self.pin_balls, strict=True)):
            pin_ball.visible = frame.pins is not None
            gizmo.show(None if frame.pins is None or not p.handles else frame.pins[index])
            if frame.pins is not None:
                pin_ball.position = tuple(frame.points[0, -index])
        self.pole.visible = p.start == "flag" and p.pinned in ("corners", "edge")
        if self.pole.visible:
            top, low = frame.points[0, 0], frame.points[0, -1]
            foot = low + (low - top) * (low[2] / max(float(top[2] - low[2]), MIN_POLE_DROP))
            ends = np.array([top + POLE_OVERHANG * (top - low), foot])
            if not np.array_equal(ends, self.pole_ends):
                self.pole_ends = ends
                set_arrays(self.pole, vertices=rod(ends, POLE_WIDTH / 2))

    def figures(self, snapshot: ClothSnapshot) -> str:
        """The stability bar."""
        return stability_bar(snapshot.readings.stability, exact=snapshot.readings.exact)

    def readout(self, snapshot: ClothSnapshot) -> str:
        """The cost of an implicit step and the colour scale, as HTML."""
        readings, strain, p = snapshot.readings, snapshot.frame.strain, snapshot.frame.params
        parts: list[Html] = []
        if readings.corrections:
            parts.append(fill("<div>{:.1f} corrections a step</div>", readings.corrections))
        parts += [fill("<div>{}</div>", words) for words in solver_words(readings.solver, "folds")]
        if readings.left_out:
            parts.append(
                fill("<div>too crowded: self-collision left out {}</div>", counted(readings.left_out, "particle"))
            )
        if readings.threads > 1:
            parts.append(fill("<div>forces computed on {} threads</div>", readings.threads))
        if p.colour == "strain" and self.mesh is not None and self.mesh.has_shader is False:
            parts.append(simple_drawing("strain"))
        elif p.colour == "strain":
            parts.append(colour_scale(
                "0", fill("strain {}", info(STRAIN, "7. Numbers on the screen")),
                f"{number(p.full_strain)} %",
                clipped=100.0 * float(strain.max()) > p.full_strain,
            ))  # fmt: skip
        return join(parts)

    def marks(self, snapshot: ClothSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest step that is stable with the others as they are."""
        readings, gauge = snapshot.readings, snapshot.readings.stability
        return {
            "integrator": readings.note,
            "time_step": step_mark(gauge.critical_step, gauge.accurate_step, gauge.landed_step),
        }


VIEW = ClothView
